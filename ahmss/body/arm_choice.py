"""Which of an arm's solutions: the one nearest to the present arm that its joints allow (Ichiguchi 2000, B.1.3)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ahmss.body.arm import Arm, Wrist, angles_of, excess, into_arm, links_of, wrist_of
from ahmss.body.arm_cases import Cases, six_cases
from ahmss.body.arm_swing import allowed, elbow_side, limits_of, nearest_swing, swing_of
from ahmss.body.array import Array
from ahmss.body.quaternion import between, conjugate, rotate
from ahmss.body.skeleton import LINK_ARM

__all__ = ["Chosen", "change", "choose", "present_side", "solutions"]

_ROUNDING = 1e-9  # radians beyond a limit that are none
_TINY = 1e-9  # metres: a wrist so near to the shoulder has no direction


@dataclass(frozen=True, eq=False)
class Chosen:
    """What `choose` found.

    angles (..., 7): radians in [-pi, pi]; the present ones where nothing was found. found (...): bool. missing (...):
    metres by which the wrist is too far (> 0) or too near (< 0) for the arm; 0 and not found: within its length, but
    no swing of the elbow has every joint within its limits. swung (...): bool, true where none of the 24 served.
    """

    angles: Array
    found: Any
    missing: Array
    swung: Any


def solutions(arm: Arm, wrist: Wrist, present: Array) -> Cases:
    """All solutions of wrist poses (...) by the six cases, limits or not: see `arm_cases.six_cases`.

    Args:
        arm: its measures.
        wrist: in the shoulder frame.
        present: (..., 7) the present angles, radians.
    """
    return six_cases(arm.lengths, rotate(conjugate(LINK_ARM), wrist.place), into_arm(wrist.rotation), present)


def change(angles: Array, present: Array) -> Array:
    """The change of arms (..., 7) against the present one (B.37), squared radians, each angle the short way round."""
    turned = angles - present
    turned = turned - 2.0 * np.pi * np.round(turned / (2.0 * np.pi))
    return (turned**2).sum(axis=-1)


def choose(arm: Arm, wrist: Wrist, present: Array) -> Chosen:
    """The solution of wrist poses (...) nearest to the present arm (B.37), all joints within their limits.

    Where all 24 are beyond a limit, the elbow swings from where it is to the nearest place that the limits allow: a
    pose that the arm can reach is never missed.

    Args:
        arm: its measures.
        wrist: in the shoulder frame.
        present: (..., 7) the present angles, radians.
    """
    cases = solutions(arm, wrist, present)
    within = cases.real & (excess(arm, links_of(cases.angles)) <= _ROUNDING)
    best, any_of_24 = _least(cases.angles, within, present)
    swung, possible, missing = _swung(arm, wrist, present)
    straighter = arm.limits[1, 1, 0] < 0.0  # an elbow that is straightened beyond a line has a place of its own
    if straighter and not bool(np.all(any_of_24 | possible)):
        other, also, _ = _swung(arm, wrist, present, beyond=True)
        swung, possible = np.where(possible[..., None], swung, other), possible | also
    angles = np.where(any_of_24[..., None], best, np.where(possible[..., None], swung, present))
    return Chosen(angles, any_of_24 | possible, missing, possible & ~any_of_24)


def _swung(arm: Arm, wrist: Wrist, present: Array, *, beyond: bool = False) -> tuple[Array, Any, Array]:
    """The angles (..., 7) of the nearest swing of the elbow, whether the limits allow it, and metres that are missing.

    beyond: of an elbow that is straightened beyond the line from shoulder to wrist.
    """
    swing = swing_of(arm, wrist, present_side(arm, links_of(present), wrist.place), beyond=beyond)
    phi, possible = nearest_swing(allowed(swing.measures(), limits_of(arm)), np.zeros(swing.bend.shape))
    possible = possible & (np.abs(swing.missing) < _TINY) & (swing.bend >= arm.limits[1, 1, 0] - _ROUNDING)
    # Each rotation of shoulder and wrist has two names, (B.36) and (B.22): again the nearest.
    names = _names(angles_of(swing.links(phi)))
    swung, _ = _least(names, np.full(names.shape[:-1], True), present)
    return swung, possible, swing.missing


def present_side(arm: Arm, links: Array, place: Array) -> Array:
    """Where the elbow of the present arm (..., 3, 4) points (..., 3), carried by the smallest turn to wrists."""
    before = wrist_of(arm, links).place
    none = np.linalg.norm(before, axis=-1)[..., None] < _TINY
    before = np.where(none, rotate(links[..., 0, :], np.array([1.0, 0.0, 0.0])), before)
    before = before / np.linalg.norm(before, axis=-1, keepdims=True)
    after = np.where(np.linalg.norm(place, axis=-1)[..., None] < _TINY, before, place)
    return rotate(between(before, after), elbow_side(before, links[..., 0, :]))


def _least(angles: Array, allowed: Any, present: Array) -> tuple[Array, Any]:
    """Of angles (..., n, 7) the allowed ones of least change (..., 7), and whether any is allowed."""
    cost = np.where(allowed, change(angles, present[..., None, :]), np.inf)
    best = np.argmin(cost, axis=-1)[..., None]
    chosen = np.take_along_axis(angles, best[..., None], axis=-2)[..., 0, :]
    return chosen, np.isfinite(np.take_along_axis(cost, best, axis=-1)[..., 0])


def _names(angles: Array) -> Array:
    """The four sets of angles (..., 4, 7) of the same links."""
    shoulder = angles[..., :3] * (1.0, -1.0, 1.0) + (np.pi, 0.0, np.pi)
    wrist = angles[..., 4:] * (1.0, -1.0, 1.0) + np.pi
    four = np.repeat(angles[..., None, :], 4, axis=-2)
    four[..., 2:, :3] = shoulder[..., None, :]
    four[..., 1::2, 4:] = wrist[..., None, :]
    return four - 2.0 * np.pi * np.round(four / (2.0 * np.pi))
