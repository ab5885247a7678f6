"""What an object affords to one human now: by its states, by who holds it, by what the body can do."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.body.skeleton import Skeleton
from ahmss.database.records import Affordance, ObjectKind
from ahmss.database.statefile import HELD, ONESELF
from ahmss.database.workspace import Workspace
from ahmss.errors import CommandError
from ahmss.main.company import KIND
from ahmss.main.description import Scene
from ahmss.world.schema import ObjectRecord

__all__ = ["Actor", "Meant", "meant", "offered", "reach", "why_not"]

_AHEAD = 0.1  # metres that an arm which reaches ahead comes less high than one that is straight up


@dataclass(frozen=True, slots=True)
class Actor:
    """The human that acts: its name in the world, its body, where it is and what it holds in which hand."""

    name: str
    skeleton: Skeleton
    root: Array
    rotations: Array
    holds: dict[str, str]


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
        actions = ", ".join(kind.affordances) or "nothing"
        raise CommandError(f'{name} does not afford "{action}"; it affords: {actions}')
    if not affordance.of:
        return Meant(name, record, kind, affordance, scene.pose(name))
    inner = f"{name}/{affordance.of}"
    if inner not in scene.objects:
        raise CommandError(f"{name} {action}: its {affordance.of} is not in the world any more")
    return meant(workspace, scene, inner, action)


def why_not(what: Meant, actor: Actor, title: str = "") -> str:
    """Why the human can't do it now, in one sentence that begins with the title; "" where it can."""
    affordance, record = what.affordance, what.record
    title = title or f"{what.name} {affordance.name}"
    held = _held(what, actor)
    mine = held == "here"
    states = {name: value for name, value in record.states.items() if not isinstance(value, bool)}
    known = {HELD: held, ONESELF: "yes" if record.kind == KIND and what.name == actor.name else "no"}
    if affordance.when is not None and not affordance.when.holds({**states, **known}):
        asked = {clause.state for clause in affordance.when.clauses()}
        shown = states | {name: value for name, value in known.items() if name in asked}
        now = ", ".join(f"{name} is {value}" for name, value in shown.items()) or "it has no states"
        return f"{title}: only when {affordance.when.text}; {now}"
    lacks = _lacks(affordance, actor) or ("" if mine else _too_high(what, actor))
    if lacks:
        return f"{title}: {lacks}"
    if affordance.hold in ("keep", "release") and not mine:
        by = f"; {record.holder} holds it" if record.holder else ""
        if record.holder == actor.name:
            by = "; it was let go just now"
        return f"{title}: {actor.name} does not hold it{by}"
    if affordance.hold == "take" and mine:
        return f"{title}: {actor.name} holds it already"
    return ""


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
        "free_hands": 2.0 - len(set(actor.holds.values()) - {""}),
        "full_hands": float(len(set(actor.holds.values()) - {""})),
    }
    seats = [name for name, hand in actor.holds.items() if not hand]
    if seats and affordance.needs.get("standing", 0.0) > 0.0:
        return f"one must stand for that; `do {seats[0]} stand_up` first"
    for need, least in affordance.needs.items():
        if has.get(need, math.inf) < least - 1e-9:
            return f"needs {need} {least:g}; {actor.name} has {has[need]:.4g}"
    return ""


def _too_high(what: Meant, actor: Actor) -> str:
    """Why the hand does not come so high as where the object stands now, or ""; only what takes a hand is asked."""
    site = what.kind.sites.get(what.affordance.site or "")
    if site is None or what.affordance.needs.get("free_hands", 0.0) <= 0.0:
        return ""
    height = float((what.pose[:3] + rotate(what.pose[3:], np.array(site.position)))[2])
    most = reach(actor.skeleton) - _AHEAD
    if height <= most:
        return ""
    return f"it is {height:.2f} m high there; {actor.name} reaches {most:.2f} m"


@lru_cache(maxsize=64)
def reach(skeleton: Skeleton) -> float:
    """How high the palm reaches with a raised arm, metres."""
    rotations, root = skeleton.upright()
    places, _ = forward(rotations, root, skeleton.offsets)
    arm = float(np.linalg.norm(skeleton.offsets[INDEX["right_lower_arm"]]))
    forearm = float(np.linalg.norm(skeleton.offsets[INDEX["right_hand"]]))
    return float(places[INDEX["right_upper_arm"], 2]) + arm + forearm + float(skeleton.grips[0, 0])
