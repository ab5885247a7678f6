"""An arm along a path of wrist poses: one swing of the elbow a frame, chosen for all frames at once, so that it jumps
only where its limits leave no other way (for what it does instead there see `arm_yielding`).

Along the path the elbow's side is carried on by the smallest turn from frame to frame, so that a swing that stays the
same is an elbow that moves no more than it must. In each frame the limits allow some arcs of it. A swing may change by
so much from one frame to the next; which swings can be reached, and which of these lead on to the end, makes a corridor
through the frames, and within it the swing goes as a taut string does. Of all ways through the corridor that one turns
the elbow least, and its fastest turn is the slowest possible. So where any way without a jump exists, this is one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ahmss.body import components
from ahmss.body.arm import Arm, Wrist, angles_of, excess, hand_angles, with_hand, wrist_of
from ahmss.body.arm_choice import present_side
from ahmss.body.arm_swing import HAND, SHOULDER, Swing, allowed, limits_of, swing_of
from ahmss.body.array import Array
from ahmss.body.quaternion import between, conjugate, multiply, rotate, to_rotation_vector
from ahmss.body.taut import corridor, taut_string

__all__ = ["SWINGS", "Way", "begun_at", "carried_sides", "continuous", "ease_hand", "follow"]

SWINGS = np.radians(np.arange(-180.0, 180.0, 7.5))
"""The swings of the elbow of which one may ask whether they serve, radians."""

STEP = np.radians(6.0)
"""The usual most that the elbow swings from one frame to the next: a turn a second at 60 frames."""

_BACK = np.radians(2.0)  # a frame, by which an arm comes back that begins beyond a limit
_TINY = 1e-9  # metres
_ANY = np.array([1.0, 0.0, 0.0])


@dataclass(frozen=True, eq=False)
class Way:
    """An arm along a path of F frames.

    links (F, ..., 3, 4): upper arm, forearm and hand, each on the hemisphere of the frame before.
    missing (F, ...): metres by which the wrist is too far (> 0) or too near (< 0); there the arm stretches or bends as
    far as it can towards it. turned (F, ...): radians that the hand is turned away from what was asked, where no swing
    has all joints within their limits. beyond (F, ...): radians by which the shoulder is beyond its limits, where no
    swing serves it; all else is always within. jumps (F, ...): bool, where the elbow's swing, or a hand that can't be
    turned as asked, changes by more than a step: no other way was left.
    """

    links: Array
    missing: Array
    turned: Array
    beyond: Array
    jumps: Any

    @property
    def angles(self) -> Array:
        """The seven angles (F, ..., 7), radians, each near that of the frame before."""
        angles = angles_of(self.links)
        return np.unwrap(angles, axis=0)


def follow(
    arm: Arm,
    wrist: Wrist,
    present: Array,
    step: float = STEP,
    softly: int = 0,
    serves: NDArray[np.bool_] | None = None,
) -> Way:
    """The arm along a path of wrist poses that begins at the present arm, without jumps wherever that is possible.

    Args:
        arm: its measures.
        wrist: places (F, ..., 3) and rotations (F, ..., 4) in the shoulder frame, F >= 1.
        present: (..., 3, 4) the links of the frame before the path's first.
        step: the most that the elbow swings from frame to frame, radians; also how fast a hand comes back that could
            not be turned as asked.
        softly: how many frames it takes until the elbow may swing so fast, and a limit is come back to so fast.
        serves: of a single arm which of the `SWINGS` serve (F, 48), as they are out of things: where any within the
            limits does, the elbow keeps to those.
    """
    frames = len(wrist.place)
    paces = np.minimum(np.arange(1.0, frames + 1.0) / (softly + 1.0), 1.0)
    swing = swing_of(arm, wrist, carried_sides(arm, wrist.place, present))
    limits = begun_at(limits_of(arm), present, np.cumsum(paces) - paces[0])
    arcs, whole_hand = _arcs(swing, limits)
    if serves is not None:
        arcs = _kept_to(arcs, serves)
    batch = swing.bend.shape[1:]
    phi, jumps = np.empty((frames, *batch)), np.zeros((frames, *batch), bool)
    for item in np.ndindex(batch):
        every = (slice(None), *item)
        phi[every], jumps[every] = _string(arcs[every], step, paces.tolist())
    links = swing.links(phi)
    if not whole_hand.all():
        angles, leaps = ease_hand(hand_angles(links), whole_hand, hand_angles(present), limits[..., HAND, :], step)
        links = np.where(whole_hand[..., None, None], links, with_hand(links, angles))
        jumps |= leaps
    off = to_rotation_vector(multiply(conjugate(wrist_of(arm, links).rotation), wrist.rotation))
    turned = np.where(whole_hand, 0.0, np.linalg.norm(off, axis=-1))
    return Way(continuous(links, present), swing.missing, turned, excess(arm, links), jumps)


def begun_at(limits: Array, present: Array, frames: Array) -> Array:
    """Limits (F, ..., 6, 2), radians: those (6, 2) of an arm, and where its present links (..., 3, 4) are beyond them.

    An arm that is beyond a limit comes back within it by so much a frame: it does not leap. The frames (F,) are counted
    from the first, which may take less than one each.
    """
    upper = np.where(present[..., 0, :1] < 0.0, -present[..., 0, :], present[..., 0, :])
    angles = np.concatenate([2.0 * np.arctan2(upper[..., 1:], upper[..., :1]), hand_angles(present)], axis=-1)
    back = (_BACK * frames).reshape(-1, *[1] * angles.ndim)
    low = np.minimum(limits[:, 0], angles + back)
    high = np.maximum(limits[:, 1], angles - back)
    return np.stack([low, high], axis=-1)


def carried_sides(arm: Arm, places: Array, present: Array) -> Array:
    """The present elbow's side carried along the path (F, ..., 3)."""
    sides = np.empty_like(places)
    sides[0] = present_side(arm, present, places[0])
    held, somewhere = places.copy(), np.linalg.norm(places, axis=-1, keepdims=True) > _TINY
    for frame in range(1, len(places) if not somewhere.all() else 0):
        held[frame] = np.where(somewhere[frame], places[frame], held[frame - 1])
    known = np.linalg.norm(held[:-1], axis=-1)[..., None] > _TINY  # a wrist on the shoulder itself has no direction
    turns = between(np.where(known, held[:-1], _ANY), np.where(known, held[1:], _ANY))
    if places.ndim == 2:  # of a single arm: Python's floats are faster than arrays of one
        side: Any = sides[0].tolist()
        for frame, turn in enumerate(turns.tolist(), 1):
            sides[frame] = side = components.rotate(turn, side)
        return sides
    for frame in range(1, len(places)):
        sides[frame] = rotate(turns[frame - 1], sides[frame - 1])
    return sides


def _arcs(swing: Swing, limits: Array) -> tuple[Array, Any]:
    """The arcs (F, ..., n, 2) within limits (F, ..., 6, 2), and where they allow for the hand; else the shoulder's."""
    measures = swing.measures()
    arcs = allowed(measures, limits)
    whole_hand: Any = ~np.isnan(arcs[..., 0, 0])
    rest = ~whole_hand
    if rest.any():
        of_shoulder = allowed(measures[rest][..., SHOULDER, :, :], limits[rest][..., SHOULDER, :])
        of_shoulder[np.isnan(of_shoulder[..., 0, 0]), 0] = (-np.pi, np.pi)  # nothing serves: any
        arcs[rest] = np.nan
        arcs[rest, : of_shoulder.shape[-2]] = of_shoulder
    return arcs, whole_hand


def _kept_to(arcs: Array, serve: NDArray[np.bool_]) -> Array:
    """Of arcs (F, n, 2) what lies between neighbours of `SWINGS` that serve (F, 48); all where none does."""
    begin, end = arcs[..., :1], arcs[..., 1:]
    off = np.mod(SWINGS - begin, 2.0 * np.pi)
    good = serve & (off <= end - begin).any(axis=1)  # nan: no arc
    kept: list[list[tuple[float, float]]] = []
    for frame, row in enumerate(good):
        if row.all() or not row.any():
            kept.append([(float(a), float(b)) for a, b in arcs[frame] if not np.isnan(a)])
            continue
        first = int(np.flatnonzero(~row)[0])  # from where no run is cut in two
        turned, swings = np.roll(row, -first), np.unwrap(np.roll(SWINGS, -first))
        edges = np.flatnonzero(np.diff(turned.astype(int), prepend=0, append=0))
        kept.append([(float(swings[a]), float(swings[b - 1])) for a, b in edges.reshape(-1, 2)])
    out = np.full((len(arcs), max(map(len, kept)), 2), np.nan)
    for frame, runs in enumerate(kept):
        out[frame, : len(runs)] = runs
    return out


def _string(arcs: Array, step: float, paces: Sequence[float]) -> tuple[Array, Any]:
    """Swings (F,) along arcs (F, n, 2), and where they jump; the swing before the first frame is 0."""
    phi, jumps = np.empty(len(arcs)), np.zeros(len(arcs), bool)
    arcs = arcs[:, : max(int(np.isfinite(arcs[..., 0]).sum(axis=1).max()), 1)]
    steps = [step * pace for pace in paces]
    frame, before = 0, 0.0
    while frame < len(arcs):
        gates = corridor(arcs[frame:], before, steps[frame:])
        if len(gates) == 0:  # no swing near enough: a jump, to the nearest
            jumps[frame] = True
            (nearest,) = corridor(arcs[frame : frame + 1], before, [2.0 * np.pi])
            before = min(max(before, nearest[0]), nearest[1])
            gates = corridor(arcs[frame:], before, steps[frame:])
        end = frame + len(gates)
        phi[frame:end] = taut_string(gates, before, paces[frame:end])
        frame, before = end, float(phi[end - 1])
    return phi, jumps


def ease_hand(angles: Array, exact: Any, before: Array, limits: Array, step: float) -> tuple[Array, Any]:
    """Hand angles (F, ..., 3) drawn within limits (F, ..., 3, 2) where not exact (F, ...), and where they still leap.

    What is beyond a limit on one side may come back on the other: the hand is on its way there before, by a step a
    frame.
    """
    if angles.ndim == 2:  # of a single arm: Python's floats are faster than arrays of one
        return _eased(angles, ~exact, before, limits, step)
    free = ~exact[..., None]
    low = np.where(free, limits[..., 0], angles)
    high = np.where(free, limits[..., 1], angles)
    for frame in np.flatnonzero(free.reshape(len(free), -1)[:-1].any(axis=-1))[::-1]:
        low[frame] = np.where(free[frame], np.maximum(low[frame], low[frame + 1] - step), low[frame])
        high[frame] = np.where(free[frame], np.minimum(high[frame], high[frame + 1] + step), high[frame])
    out, leaps = angles.copy(), np.zeros(exact.shape, bool)
    for frame in range(len(angles)):
        nearest = np.clip(before, low[frame], high[frame])  # where even this is a leap, it is taken at once
        drawn = np.clip(angles[frame], np.maximum(low[frame], before - step), np.minimum(high[frame], before + step))
        far: Any = np.abs(nearest - before) > step * (1.0 + 1e-9)
        out[frame] = np.where(free[frame], np.where(far, nearest, drawn), angles[frame])
        leaps[frame] = np.any(far & free[frame], axis=-1)
        before = out[frame]
    return out, leaps


def _eased(angles: Array, free: Any, before: Array, limits: Array, step: float) -> tuple[Array, Any]:
    """The same for one arm's angles (F, 3), free (F,), within limits (F, 3, 2)."""
    lows = np.where(free[:, None], limits[..., 0], angles).tolist()
    highs = np.where(free[:, None], limits[..., 1], angles).tolist()
    for frame in np.flatnonzero(free[:-1])[::-1].tolist():
        lows[frame] = [max(low, then - step) for low, then in zip(lows[frame], lows[frame + 1], strict=True)]
        highs[frame] = [min(high, then + step) for high, then in zip(highs[frame], highs[frame + 1], strict=True)]
    out, leaps, first = angles.tolist(), np.zeros(len(angles), bool), before.tolist()
    for frame in np.flatnonzero(free).tolist():
        row, last = out[frame], out[frame - 1] if frame else first
        for i, (angle, low, high, was) in enumerate(zip(row, lows[frame], highs[frame], last, strict=True)):
            nearest = min(max(was, low), high)
            if abs(nearest - was) > step * (1.0 + 1e-9):
                row[i], leaps[frame] = nearest, True
            else:
                row[i] = min(max(angle, max(low, was - step)), min(high, was + step))
    return np.array(out), leaps


def continuous(links: Array, present: Array) -> Array:
    """Links (F, ..., 3, 4) with each quaternion on the hemisphere of the frame before."""
    before = np.concatenate([present[None], links[:-1]])
    same = (links * before).sum(axis=-1) >= 0.0
    return np.cumprod(np.where(same, 1.0, -1.0), axis=0)[..., None] * links
