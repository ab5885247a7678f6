"""Which hand does it, and how far it is from there."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.quaternion import rotate
from ahmss.database.records import Affordance, ObjectKind
from ahmss.errors import CommandError
from ahmss.main.afforded import Actor
from ahmss.main.command import Act

__all__ = ["away", "choose", "free", "places"]

_AT_IT = 0.2  # metres from an object within which a palm is at it
_ASIDE = 0.15  # metres to the left of the middle from which on the left hand is the nearer


def choose(act: Act, affordance: Affordance, at: Array, actor: Actor, name: str) -> str:
    """The hand that is meant: as said, the one that holds the object, or the nearer free one where a hand is asked.

    A free palm that is at the object (n, 3) already, because it has just been reached for, is nearer than any.
    What is taken is taken in a hand, unless its action says that it needs none: a chair is sat on.

    Raises:
        CommandError: the other hand holds what the action is done with, or the one that was said holds something else.
    """
    holding = actor.holds.get(name, "")
    if act.hand and holding and act.hand != holding and affordance.hold in ("keep", "release"):
        raise CommandError(
            f"{name} {act.action}: {actor.name} holds it in the {holding} hand; leave out `hand {act.hand}`"
        )
    if act.hand in actor.full and not holding and not act.follows and affordance.needs.get("free_hands", 0.0) > 0.0:
        held = next((thing for thing, side in actor.holds.items() if side in (act.hand, "")), "something")
        raise CommandError(
            f"{name} {act.action}: {actor.name} holds {held} in the {act.hand} hand; leave out `hand {act.hand}`, or "
            "put that down first"
        )
    if act.hand or name in actor.holds:
        return act.hand or holding
    in_hand = affordance.hold == "take" and affordance.needs.get("free_hands", 1.0) > 0.0
    if "hand" not in affordance.asks and not in_hand:
        return ""
    busy = actor.full
    near = {side: away(side, at, actor) for side in ("right", "left")}
    if at_it := [side for side, distance in near.items() if distance < _AT_IT and side not in busy]:
        return min(at_it, key=lambda side: near[side])
    # The hips' z axis points back and y to the left.
    left = rotate(actor.rotations[0], np.array([0.0, 1.0, 0.0]))
    hand = "left" if float((at[0] - actor.root) @ left) > _ASIDE else "right"
    other = "right" if hand == "left" else "left"
    return other if hand in busy and other not in busy else hand


def places(kind: ObjectKind, affordance: Affordance, pose: Array) -> Array:
    """Where an object in a pose (7,) is (1, 3), and where on it the action takes place (2, 3)."""
    site = kind.sites.get(affordance.site or "")
    on_it = [] if site is None else [pose[:3] + rotate(pose[3:7], np.array(site.position))]
    return np.array([pose[:3], *on_it])


def away(hand: str, at: Array, actor: Actor) -> float:
    """Metres from a palm to the nearest of places (n, 3)."""
    palm = grips(actor.skeleton, actor.rotations, actor.root)[1 if hand == "left" else 0, :3]
    return float(np.linalg.norm(at - palm, axis=-1).min())


def free(actor: Actor) -> str:
    """A hand that holds nothing, the right one first; the right one where both do."""
    return next((side for side in ("right", "left") if side not in actor.full), "right")
