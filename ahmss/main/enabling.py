"""What to do first, where something does not happen because an object is in another state: a key is to be turned."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from ahmss.database.records import Affordance, ObjectKind
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError
from ahmss.states.behaviour import Behaviour
from ahmss.states.condition import Clause
from ahmss.states.following import Value
from ahmss.states.hindered import hindered, sources
from ahmss.world.schema import ObjectRecord

__all__ = ["bringing", "not_enabled"]


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

    def behaviour(of: str) -> Behaviour:
        return workspace.objects.get(objects[of].kind).behaviour

    def now(of: str) -> Mapping[str, Value] | None:
        return objects[of].states if of in objects else None

    def drives(affordance: Affordance) -> str:
        declared = workspace.algorithms.find(affordance.human_algorithm).parameters or {}
        usual = declared["state"].default if "state" in declared else ""
        return str(affordance.parameters.get("state", usual))

    try:
        for one in hindered([(name, state, value) for state, value in states.items()], now, behaviour):
            clause = one.lacks
            has = (now(one.at) or {}).get(clause.state)
            for source, wanted in sources(one.at, clause, now, behaviour):
                action = bringing(workspace.objects.get(objects[source].kind), wanted, drives)
                if action:
                    first = f"`do {_short(source, objects)} {action}` first"
                    yield f"{one.object} {one.state} stays as it is, since {one.at} {clause.state} is {has}; {first}"
    except AhmssError:  # a broken file is told to who uses its kind
        return


def _short(name: str, objects: Mapping[str, ObjectRecord]) -> str:
    """The last part of a name where no other object's ends in it, else all of it."""
    last = name.rpartition("/")[2]
    return last if sum(other == last or other.endswith(f"/{last}") for other in objects) == 1 else name
