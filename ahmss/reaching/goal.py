"""Where a palm shall come to, and the palms that fulfil it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.reaching.comfort import around_axis, palms_at
from ahmss.reaching.reacher import Reacher

__all__ = ["Goal", "palms_of", "turned_askew", "turned_otherwise"]

_OTHERWISE = np.radians(25.0)  # that palms differ by, which come by another way
_ASKEW = np.radians([15.0, 30.0])  # of what a hand closes around, as far as it still holds it well
_OUT = np.array([1.0, 0.0, 0.0])


@dataclass(frozen=True, eq=False)
class Goal:
    """Where a palm shall come to.

    place (3,), world. rotation: (4,) of the palm's frame, or None where it is free. around: (7,) a frame around whose
    z axis it is free, x away from the human. before: metres that the palm stays before the place, along its own x.
    palms: for each side the palms (n, 7) that fulfil it, where these are known otherwise.
    """

    place: Array
    rotation: Array | None = None
    around: Array | None = None
    before: float = 0.0
    palms: Mapping[str, Array] = field(default_factory=dict[str, Array])


def palms_of(goal: Goal, reacher: Reacher, shoulder: Array) -> Array:
    """The palms (n, 7) that fulfil a goal, for an arm whose shoulder is at (3,)."""
    if goal.palms:
        return goal.palms[reacher.side]
    if goal.rotation is not None:
        turned = goal.rotation[None]
    elif goal.around is not None:
        turned = around_axis(goal.around, reacher.sign)
    else:
        turned = palms_at(shoulder, goal.place, reacher.sign)
    return _before(goal, turned)


def turned_askew(goal: Goal) -> list[Goal]:
    """The goal with palms that lie askew of the axis around which it is free, a little and more; none where it is not.

    An arm that is raised high, or hangs low, comes to an upright thing so: its wrist need not bend so far to the side.
    """
    if goal.around is None:
        return []
    found: list[Goal] = []
    for askew in _ASKEW:
        rolls = from_axis_angle(_OUT, np.array([askew, -askew]))[:, None]
        palms = {
            side: _before(goal, multiply(around_axis(goal.around, sign), rolls).reshape(-1, 4))
            for side, sign in (("right", -1.0), ("left", 1.0))
        }
        found.append(replace(goal, palms=palms))
    return found


def _before(goal: Goal, turned: Array) -> Array:
    """Palms (n, 7) with rotations (n, 4), as far before a goal's place as it says."""
    return np.concatenate([goal.place - goal.before * rotate(turned, _OUT), turned], axis=-1)


def turned_otherwise(goal: Goal, side: str, palms: Array, palm: Array) -> Goal | None:
    """The goal for one hand with those of its palms (n, 7) that are turned otherwise than one (7,), if any are."""
    turned = 2.0 * np.arccos(np.clip(np.abs(palms[:, 3:] @ palm[3:]), 0.0, 1.0))
    kept = palms[turned > _OTHERWISE]
    return replace(goal, palms={side: kept}) if len(kept) else None
