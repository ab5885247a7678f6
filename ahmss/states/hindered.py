"""What does not follow from a change of states since a condition of it lacks another state, and what would bring that.

A button is pressed and its pump does not start, as a key has not enabled it: the files say that the key does.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

from ahmss.states.behaviour import Behaviour
from ahmss.states.condition import Clause
from ahmss.states.following import Change, Value, beside, follow, in_words, wired_to

__all__ = ["Hindrance", "hindered", "sources"]

StatesOf = Callable[[str], Mapping[str, Value] | None]
BehaviourOf = Callable[[str], Behaviour]


@dataclass(frozen=True)
class Hindrance:
    """That an object's state does not become what it would, since the object `at` lacks what a clause asks for."""

    object: str
    state: str
    at: str
    lacks: Clause


def hindered(changes: Sequence[Change], states_of: StatesOf, behaviour_of: BehaviourOf) -> Iterator[Hindrance]:
    """What hinders that more comes of changes: of a condition with several clauses, one of which they make true, those
    that are not.

    Args:
        changes: what is asked for. states_of: the states of an object before, None where there is none. behaviour_of:
            of the object.
    """
    after: dict[str, dict[str, Value]] = {}
    came: set[tuple[str, str]] = set()
    for name, state, value in follow(changes, states_of, behaviour_of):
        before = dict(states_of(name) or {})
        if before.get(state) != value:
            came.add((name, state))
        after[name] = {**before, **after.get(name, {}), state: value}
    for name, state in sorted(came):
        now = in_words(after[name])
        for owner, one in wired_to(name, states_of, behaviour_of):
            target = beside(owner, one.of)
            known = after.get(target) or states_of(target)
            if one.when is None or one.when.holds(now) or known is None or known.get(one.state) == one.to:
                continue
            if (target, one.state) in came:  # it has become something else
                continue
            for clauses in one.when.alternatives:
                lacking = [clause for clause in clauses if not clause.holds(now)]
                if any(clause.state == state and clause not in lacking for clause in clauses):
                    yield from (Hindrance(target, one.state, name, clause) for clause in lacking)


def sources(name: str, clause: Clause, states_of: StatesOf, behaviour_of: BehaviourOf) -> Iterator[tuple[str, Clause]]:
    """The objects whose states bring an object what a clause asks for, and what these states are to be."""
    owner = name
    while owner:
        for one in behaviour_of(owner).consequences if states_of(owner) is not None else ():
            at = beside(owner, one.at)
            if beside(owner, one.of) != name or one.state != clause.state or one.to is None or one.when is None:
                continue
            if at != name and states_of(at) is not None and clause.holds({clause.state: one.to}):
                yield from ((at, clauses[0]) for clauses in one.when.alternatives if len(clauses) == 1)
        owner = owner.rpartition("/")[0]
