"""What follows from a change of states: consequences, the consequences of these, and so on to the end."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence

from ahmss.errors import WorldError
from ahmss.states.behaviour import Behaviour, Consequence

__all__ = ["Change", "Value", "beside", "follow", "in_words", "wired_to"]

Value = str | float | bool
Change = tuple[str, str, Value]
"""An object, one of its states, and the value that it gets."""

_MOST = 1000  # changes that may come of one request


def follow(
    changes: Sequence[Change],
    states_of: Callable[[str], Mapping[str, Value] | None],
    behaviour_of: Callable[[str], Behaviour],
) -> list[Change]:
    """All changes that come of these, themselves first, in the order in which they happen.

    What changes the same state a second time is left out: what was asked for stands, and a circle ends where it comes
    back. A consequence for an object that is not there, or has no such state, is none: a switch may stand alone.

    Args:
        changes: what is asked for; the objects have these states.
        states_of: the present states of an object, None where there is none of that name.
        behaviour_of: of the object.

    Raises:
        WorldError: a consequence sets what its state can't be, or far too much follows; says which.
    """
    taken = {(name, state) for name, state, _ in changes}
    now: dict[str, dict[str, Value]] = {}
    waiting, done = deque(changes), list[Change]()
    while waiting:
        change = waiting.popleft()
        name, state, value = change
        before = now.get(name) or dict(states_of(name) or {})
        after = now[name] = {**before, state: value}
        done.append(change)
        if len(done) > _MOST:
            raise WorldError(f"{changes[0][0]} {changes[0][1]}: more than {_MOST} consequences follow from one change")
        if before.get(state) == value:
            continue
        for owner, one in wired_to(name, states_of, behaviour_of):
            target = beside(owner, one.of)
            known = now.get(target) or states_of(target)
            if known is None or one.state not in known or (target, one.state) in taken:
                continue
            if _happens(one, state, before, after):
                taken.add((target, one.state))
                told = _value(one, name, after, behaviour_of(name), target, known, behaviour_of(target))
                waiting.append((target, one.state, told))
    return done


def wired_to(
    name: str, states_of: Callable[[str], Mapping[str, Value] | None], behaviour_of: Callable[[str], Behaviour]
) -> Iterator[tuple[str, Consequence]]:
    """What may follow from a change of an object: its own, and those that what contains it names it in."""
    for one in behaviour_of(name).wired.get("", ()):
        yield name, one
    owner, _, within = name.rpartition("/")
    while owner:
        if states_of(owner) is not None:
            for one in behaviour_of(owner).wired.get(within, ()):
                yield owner, one
        owner, _, last = owner.rpartition("/")
        within = f"{last}/{within}"


def beside(name: str, of: str) -> str:
    """The object that a consequence of `name` means: its own path, upwards with `..`; "" where that leads nowhere."""
    path = name.split("/")
    for step in of.split("/") if of else ():
        if step != "..":
            path.append(step)
        elif path:
            path.pop()
    return "/".join(path)


def _happens(one: Consequence, state: str, before: Mapping[str, Value], after: Mapping[str, Value]) -> bool:
    """Whether the change of `state` brings it about."""
    source = bool(one.source) and one.source == state
    if one.when is None:
        return source
    return one.when.holds(in_words(after)) and (source or not one.when.holds(in_words(before)))


def in_words(states: Mapping[str, Value]) -> dict[str, str | float]:
    """States as conditions ask for them."""
    return {name: value for name, value in states.items() if not isinstance(value, bool)}


def _value(
    one: Consequence, name: str, own: Mapping[str, Value], behaviour: Behaviour,
    target: str, present: Mapping[str, Value], other: Behaviour,
) -> Value:  # fmt: skip
    """What the target's state becomes."""
    state = other.states.get(one.state)
    value: Value | None = own.get(one.source) if one.source else one.to
    if state is None:  # its kind says nothing of it, so anything will do
        return "" if value is None else value
    if one.to == "toggle":
        return state.other(present[one.state])
    if one.source:
        source = behaviour.states.get(one.source)
        if source is not None and source.is_number and state.is_number:
            return state.low + source.share(value) * (state.high - state.low)
    parsed = None if value is None or isinstance(value, bool) else state.parse(value)
    if parsed is None:
        raise WorldError(f'{name} sets {target} {one.state} to "{value}", which it can\'t be; allowed: {state.allowed}')
    return parsed
