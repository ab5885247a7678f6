"""What to do first, where something does not happen because an object is in another state: a key is to be turned."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from difflib import get_close_matches

from ahmss.database.records import Affordance, ObjectKind
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError
from ahmss.states.behaviour import Behaviour
from ahmss.states.condition import Clause
from ahmss.states.following import Value
from ahmss.states.hindered import hindered, sources
from ahmss.world.schema import ObjectRecord

__all__ = ["bringing", "not_enabled", "what_sets"]


def bringing(kind: ObjectKind, clause: Clause, drives: Callable[[Affordance], str]) -> str:
    """The action of an object, as it is typed after its name, that brings a state of it what a clause asks for; "".

    drives: the state that an action's motion changes, "": that is not told.
    """
    behind = {clause.state}
    for one in kind.consequences:
        if (
            not one.of
            and not one.at
            and one.state == clause.state
            and one.when
            and clause.holds({one.state: one.to or ""})
        ):
            behind |= {cause.state for cause in one.when.clauses()}
    moving = [affordance for affordance in kind.affordances.values() if affordance.object_algorithm is not None]
    for affordance in moving:
        said = affordance.parameters.get("position")
        if said is not None and not clause.holds({clause.state: said}):
            continue
        if drives(affordance) in behind or (len(moving) == 1 and not drives(affordance)):
            asks = said is None and clause.operator == "==" and clause.state == "position" and drives(affordance)
            return f"{affordance.name} position={clause.value}" if asks else affordance.name
    return ""


def not_enabled(
    workspace: Workspace, objects: Mapping[str, ObjectRecord], name: str, states: Mapping[str, Value]
) -> Iterator[str]:
    """What does not happen as an object's states become these, why, and what to do first; in sentences.

    objects: the world's, as they are before.
    """
    wiring = _Wiring(workspace, objects)
    try:
        changes = [(name, state, value) for state, value in states.items()]
        for one in hindered(changes, wiring.states, wiring.behaviour):
            has = (wiring.states(one.at) or {}).get(one.lacks.state)
            for typed in wiring.bringing(one.at, one.lacks):
                since = f"{one.object} {one.state} stays as it is, since {one.at} {one.lacks.state} is {has}"
                yield f"{since}; `do {typed}` first"
    except AhmssError:  # a broken file is told to who uses its kind
        return


def what_sets(workspace: Workspace, objects: Mapping[str, ObjectRecord], name: str, word: str) -> tuple[str, str]:
    """The state of an object that a word names, or a value of which, and the action of another object, as it is typed
    after `do`, that changes it; ("", "")."""
    wiring = _Wiring(workspace, objects)
    with suppress(AhmssError):  # a broken file is told to who uses its kind
        for state, declared in wiring.behaviour(name).states.items():
            others = [value for value in declared.values if value != objects[name].states.get(state)]
            wanted = others if get_close_matches(word, [state]) else get_close_matches(word, others)
            for typed in (typed for value in wanted for typed in wiring.bringing(name, Clause(state, "==", value))):
                return state, typed
    return "", ""


@dataclass(frozen=True)
class _Wiring:
    """The objects of a world as what follows from their states asks for them."""

    workspace: Workspace
    objects: Mapping[str, ObjectRecord]

    def behaviour(self, of: str) -> Behaviour:
        return self.workspace.objects.get(self.objects[of].kind).behaviour

    def states(self, of: str) -> Mapping[str, Value] | None:
        return self.objects[of].states if of in self.objects else None

    def drives(self, affordance: Affordance) -> str:
        declared = self.workspace.algorithms.find(affordance.human_algorithm).parameters or {}
        usual = declared["state"].default if "state" in declared else ""
        return str(affordance.parameters.get("state", usual))

    def bringing(self, name: str, clause: Clause) -> Iterator[str]:
        """The actions of other objects, as they are typed after `do`, that bring an object what a clause asks for."""
        for source, wanted in sources(name, clause, self.states, self.behaviour):
            action = bringing(self.workspace.objects.get(self.objects[source].kind), wanted, self.drives)
            if action:
                yield f"{_short(source, self.objects)} {action}"


def _short(name: str, objects: Mapping[str, ObjectRecord]) -> str:
    """The last part of a name where no other object's ends in it, else all of it."""
    last = name.rpartition("/")[2]
    return last if sum(other == last or other.endswith(f"/{last}") for other in objects) == 1 else name
