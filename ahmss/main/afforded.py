"""What an object affords to one human now: by its states, by who holds it, by what the body can do."""

from __future__ import annotations

import contextlib
import difflib
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache, partial

import numpy as np

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.body.skeleton import Skeleton
from ahmss.database.records import Affordance, ObjectKind
from ahmss.database.statefile import HELD, ONESELF
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, CommandError
from ahmss.main.company import KIND
from ahmss.main.description import Scene
from ahmss.main.enabling import bringing, what_sets
from ahmss.states.condition import Condition
from ahmss.states.wording import lacking, said, so_now
from ahmss.world.schema import ObjectRecord

__all__ = [
    "Actor", "Meant", "comes_up_to", "height_of", "meant", "offered", "reach", "sentence_of",
    "too_high", "why_not",
]  # fmt: skip

_AHEAD = 0.1  # metres that an arm which reaches ahead comes less high than one that is straight up


@dataclass(frozen=True, slots=True)
class Actor:
    """The human that acts: its name in the world, its body, where it is and what it holds in which hand.

    between: of that what it holds between both hands.
    """

    name: str
    skeleton: Skeleton
    root: Array
    rotations: Array
    holds: dict[str, str]
    between: frozenset[str] = frozenset()

    @property
    def full(self) -> set[str]:
        """The hands, of "right" and "left", that hold something."""
        return {"right", "left"} if self.between else set(self.holds.values()) - {""}


@dataclass(frozen=True, slots=True)
class Meant:
    """What an action of an object comes to: the object that affords it, itself or one that it contains.

    pose: (7,) where that is now.
    """

    name: str
    record: ObjectRecord
    kind: ObjectKind
    affordance: Affordance
    pose: Array


def meant(workspace: Workspace, scene: Scene, name: str, action: str) -> Meant:
    """The object and the affordance that an action means.

    Raises:
        CommandError: the object does not afford it, or what it contains is not in the world any more.
        DataError: a kind's file is wrong.
    """
    record = scene.objects[name]
    kind = workspace.objects.get(record.kind)
    affordance = kind.affordances.get(action)
    if affordance is None:
        near = difflib.get_close_matches(action, kind.affordances, 1)
        hint = f"did you mean {near[0]}?" if near else f"it affords: {', '.join(kind.affordances) or 'nothing'}"
        if not near and (part := _part_affording(workspace, scene, name, action)):
            hint = f"{part} does, which is in it"
        elif not near and (set_by := what_sets(workspace, scene.objects, name, action))[0]:
            hint = "its state {} is set by `do {}`".format(*set_by)
        raise CommandError(f'{name} does not afford "{action}"; {hint}')
    if not affordance.of:
        return Meant(name, record, kind, affordance, scene.pose(name))
    inner = f"{name}/{affordance.of}"
    if inner not in scene.objects:
        raise CommandError(f"{name} {action}: its {affordance.of} is not in the world any more")
    return meant(workspace, scene, inner, action)


def _part_affording(workspace: Workspace, scene: Scene, name: str, action: str) -> str:
    """An object in this one that affords an action, or ""."""
    for inner, record in scene.objects.items():
        with contextlib.suppress(AhmssError):  # a broken file hides its own kind only
            if inner.startswith(f"{name}/") and action in workspace.objects.get(record.kind).affordances:
                return inner
    return ""


def why_not(what: Meant, actor: Actor, title: str = "") -> str:
    """Why the human can't do it now, in one sentence that begins with the title; "" where it can."""
    affordance, record = what.affordance, what.record
    title = title or f"{what.name} {affordance.name}"
    held = _held(what, actor)
    mine = held == "here"
    states = {name: value for name, value in record.states.items() if not isinstance(value, bool)}
    known = {HELD: held, ONESELF: "yes" if record.kind == KIND and what.name == actor.name else "no"}
    if affordance.when is not None and not affordance.when.holds({**states, **known}):
        return f"{title}: {_otherwise(what, actor, affordance.when, states | known)}"
    if affordance.hold == "take" and mine:
        has = "sits on" if _is_seat(what.kind) else "holds"
        return f"{title}: {actor.name} {has} it already"
    lacks = _lacks(affordance, actor) or ("" if mine else too_high(what, actor))
    if lacks:
        return f"{title}: {lacks}"
    if affordance.hold in ("keep", "release") and not mine and _is_seat(what.kind):
        return f"{title}: {actor.name} does not sit on it"
    if affordance.hold in ("keep", "release") and not mine:
        by = f"; {record.holder} holds it" if record.holder else ""
        if record.holder == actor.name:
            by = "; it was let go just now"
        return f"{title}: {actor.name} does not hold it{by}"
    return ""


def _otherwise(what: Meant, actor: Actor, when: Condition, now: Mapping[str, str | float]) -> str:
    """Why a condition that asks for another state than there is now does not hold, in words."""
    holder = what.record.holder
    told = {
        "here": f"{actor.name} holds it already",
        "elsewhere": f"{holder} has it",
        "no": f"{actor.name} does not hold it",
    }
    if any(when.holds({**now, HELD: held}) for held in told):
        return told[str(now[HELD])]
    lacks = lacking(when, now)
    if all(any(clause.state == ONESELF for clause in clauses) for clauses in lacks):
        return "one does that to others, not to oneself" if now[ONESELF] == "yes" else "one does that by oneself only"
    says = partial(_said_of, what, actor)
    there = what.affordance.parameters.get("position") in now.values()  # what it would bring is so already
    clauses = [] if there else [clause for some in lacks for clause in some]
    action = next(filter(None, (bringing(what.kind, clause, _drives) for clause in clauses)), "")
    first = f"; `do {what.name} {action}` first" if action else ""
    return f"only when {said(lacks, says)}; {so_now(lacks, now, says) or 'it has no such state'}{first}"


def _said_of(what: Meant, actor: Actor, state: str, value: str) -> str:
    """A state in words: "its position is out", or as its file says, "aiko holds something"."""
    if state == HELD:
        who = {"here": f"{actor.name} holds it", "elsewhere": "somebody else holds it", "no": "nobody holds it"}
        return who.get(value) or f"not so that {who[value.removeprefix('not ')]}"
    if state == ONESELF:
        return "it is done to oneself" if value in ("yes", "not no") else "it is done to others"
    verb = what.kind.states[state].verb
    return f"{what.name} {verb} {value}" if verb else f"its {state.replace('_', ' ')} is {value}"


def _drives(affordance: Affordance) -> str:
    return str(affordance.parameters.get("state", ""))


def _is_seat(kind: ObjectKind) -> bool:
    """Whether it is had by sitting on it: taken, but in no hand."""
    return any(one.hold == "take" and one.needs.get("free_hands", 1.0) == 0.0 for one in kind.affordances.values())


def sentence_of(workspace: Workspace, kind: ObjectKind, affordance: Affordance) -> str:
    """What an action is, in a sentence: as its object's file says, or where that says nothing as its algorithm does."""
    if affordance.sentence or affordance.of:
        return affordance.sentence
    try:
        return workspace.algorithms.find(affordance.human_algorithm, kind.directory).sentence
    except AhmssError as error:  # its file is broken: that is what there is to say of it
        return str(error)


def offered(what: Meant, actor: Actor) -> bool:
    """Whether it is a choice: the human can do it, and nobody else has what its object algorithm would move."""
    moves = what.affordance.object_algorithm is not None
    return not why_not(what, actor) and not (moves and _held(what, actor) == "elsewhere")


def _held(what: Meant, actor: Actor) -> str:
    """Whether this human has it ("here"), another ("elsewhere"), or nobody ("no"), as far as is known here."""
    if what.name in actor.holds:
        return "here"
    return "elsewhere" if what.record.holder not in ("", actor.name) else "no"


def _lacks(affordance: Affordance, actor: Actor) -> str:
    """What this body has too little of, or ""."""
    has = {
        "reach": reach(actor.skeleton),
        "stature": actor.skeleton.stature,
        "free_hands": 2.0 - len(actor.full),
        "full_hands": float(len(actor.full)),
    }
    seats = [name for name, hand in actor.holds.items() if not hand]
    if seats and affordance.needs.get("standing", 0.0) > 0.0:
        return f"one must stand for that; `do {seats[0]} stand_up` first"
    held = [name for name, hand in actor.holds.items() if hand]
    if has["free_hands"] < affordance.needs.get("free_hands", 0.0):
        takes = "both hands" if affordance.needs["free_hands"] > 1.0 else "a free hand"
        return f"it takes {takes}, and {actor.name} holds {' and '.join(held)}; put that down first"
    if has["full_hands"] < affordance.needs.get("full_hands", 0.0):
        return f"it takes something in the hand, and {actor.name} holds nothing"
    for need, least in affordance.needs.items():
        if has.get(need, math.inf) < least - 1e-9:
            return f"it takes a {need} of {least:g} m, and {actor.name}'s is {has[need]:.4g} m"
    return ""


def too_high(what: Meant, actor: Actor) -> str:
    """Why the hand does not come so high as where the object stands now, or ""."""
    height, most = height_of(what), comes_up_to(actor.skeleton)
    if height is None or height <= most:
        return ""
    return f"it is {height:.2f} m high there; {actor.name} reaches {most:.2f} m"


def height_of(what: Meant) -> float | None:
    """How high a hand is to come, metres; None for what takes no hand."""
    site = what.kind.sites.get(what.affordance.site or "")
    if site is None or what.affordance.needs.get("free_hands", 0.0) <= 0.0:
        return None
    return float((what.pose[:3] + rotate(what.pose[3:], np.array(site.position)))[2])


def comes_up_to(skeleton: Skeleton) -> float:
    """How high a hand comes that reaches ahead, metres."""
    return reach(skeleton) - _AHEAD


@lru_cache(maxsize=64)
def reach(skeleton: Skeleton) -> float:
    """How high the palm reaches with a raised arm, metres."""
    rotations, root = skeleton.upright()
    places, _ = forward(rotations, root, skeleton.offsets)
    arm = float(np.linalg.norm(skeleton.offsets[INDEX["right_lower_arm"]]))
    forearm = float(np.linalg.norm(skeleton.offsets[INDEX["right_hand"]]))
    return float(places[INDEX["right_upper_arm"], 2]) + arm + forearm + float(skeleton.grips[0, 0])
