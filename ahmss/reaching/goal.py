"""Where a palm shall come to, and the palms that fulfil it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import rotate
from ahmss.reaching.comfort import around_axis, palms_at
from ahmss.reaching.reacher import Reacher

__all__ = ["Goal", "palms_of", "turned_otherwise"]

_OTHERWISE = np.radians(25.0)  # that palms differ by, which come by another way


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
    places = goal.place - goal.before * rotate(turned, np.array([1.0, 0.0, 0.0]))
    return np.concatenate([places, turned], axis=-1)


def turned_otherwise(goal: Goal, side: str, palms: Array, palm: Array) -> Goal | None:
    """The goal for one hand with those of its palms (n, 7) that are turned otherwise than one (7,), if any are."""
    turned = 2.0 * np.arccos(np.clip(np.abs(palms[:, 3:] @ palm[3:]), 0.0, 1.0))
    kept = palms[turned > _OTHERWISE]
    return replace(goal, palms={side: kept}) if len(kept) else None
