"""The figures of gait, step by step, that are known of how people walk."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate
from ahmss.motion.contact import foot_points
from ahmss.walking.library import RATE

from .measures import FEET, Walk, knee_flexion

_X, _Y, _Z = np.eye(3)
_PARTS = 100  # of a gait cycle


@dataclass(frozen=True)
class Figures:
    """Of steady straight walking, means over its cycles; a cycle is from a foot's touchdown to its next.

    Angles in degrees, lengths in metres, "per leg" by the hips' height in standing. Shares of a cycle in percent.
    curves: of the right leg's cycle, 100 values each.
    """

    cadence: float  # steps a minute
    speed: float
    step_per_leg: float
    width: float
    stance: float
    double: float  # one of the two
    strike: float  # the foot's pitch as it lands, toes up
    toe_off: float  # its pitch as it leaves
    clearance: float  # of the toe, least in the second half of the swing
    rotation: float  # peak to peak, as are the next
    list: float
    tilt: float
    vertical_per_leg: float
    lateral_per_leg: float
    below_standing: float
    thorax: float
    arm: float
    knee_swing: float
    knee_loading: float
    knee_landing: float
    curves: dict[str, Array]


def landings(walk: Walk, foot: int) -> NDArray[np.intp]:
    """The frames at which a foot lands."""
    bears = walk.bearing[:, foot].any(axis=-1)
    return np.flatnonzero(~bears[:-1] & bears[1:]) + 1


def liftings(walk: Walk, foot: int) -> NDArray[np.intp]:
    """The last frames in which a foot bears before it swings."""
    bears = walk.bearing[:, foot].any(axis=-1)
    return np.flatnonzero(bears[:-1] & ~bears[1:])


def figures(walk: Walk, heading: float, upright: Array, height: float) -> Figures:
    """Of a straight walk's middle.

    Args:
        walk: with 3 steps or more before what is measured and after it.
        heading: the way's, radians.
        upright: (43, 4) how the human stands, heading 0.
        height: of its hips in standing.
    """
    right, left = landings(walk, 0), landings(walk, 1)
    both = np.sort(np.concatenate([right, left]))[3:-3]
    right, left = right[(right >= both[0]) & (right <= both[-1])], left[(left >= both[0]) & (left <= both[-1])]
    steps = np.diff(both)
    curves, ankles = _curves(walk, heading, upright), walk.places[:, FEET]
    cycles = {name: _cycled(values, right) for name, values in curves.items()}
    along = ankles[:, :, :2] @ np.array([np.cos(heading), np.sin(heading)])
    across = ankles[:, :, :2] @ np.array([-np.sin(heading), np.cos(heading)])
    ahead = np.abs(along[both, 0] - along[both, 1])
    rises = [lift for lift in liftings(walk, 0) if right[0] <= lift < right[-1]]
    cycle = float(np.diff(right).mean())
    stance = float(np.mean([lift - right[right <= lift][-1] for lift in rises]))
    other = liftings(walk, 1)
    double = float(np.mean([other[other >= land][0] - land for land in right[:-1]]))
    toe = foot_points(walk.skeleton, walk.rotations, walk.root)[:, 0, 2, 2]
    swings = [toe[lift + round(0.6 * (land - lift)) : land] for lift, land in _swings(rises, right)]
    return Figures(
        cadence=60.0 * RATE / float(steps.mean()),
        speed=float(ahead.mean()) * RATE / float(steps.mean()),
        step_per_leg=float(ahead.mean()) / height,
        width=float(np.abs(across[both, 0] - across[both, 1]).mean()),
        stance=100.0 * stance / cycle, double=100.0 * double / cycle,
        strike=float(curves["foot"][right].mean()),
        toe_off=float(curves["foot"][rises].mean()),
        clearance=float(np.mean([swing.min() for swing in swings])),
        rotation=_pp(cycles["rotation"]), list=_pp(cycles["list"]), tilt=_pp(cycles["tilt"]),
        vertical_per_leg=_pp(cycles["vertical"]) / height, lateral_per_leg=_pp(cycles["lateral"]) / height,
        below_standing=height - float(cycles["vertical"].mean()),
        thorax=_pp(cycles["thorax"]), arm=_pp(cycles["arm"]),
        knee_swing=float(cycles["knee"][60:].max()), knee_loading=float(cycles["knee"][5:30].max()),
        knee_landing=float(cycles["knee"][0]), curves=cycles,
    )  # fmt: skip


def _swings(rises: list[int], landed: NDArray[np.intp]) -> list[tuple[int, int]]:
    return [(lift, int(landed[landed > lift][0])) for lift in rises]


def _pp(curve: Array) -> float:
    return float(np.ptp(curve))


def _cycled(values: Array, starts: NDArray[np.intp]) -> Array:
    """The mean cycle (100,) of values (F,)."""
    share = np.linspace(0.0, 1.0, _PARTS, endpoint=False)
    frames = np.arange(len(values))
    return np.mean([np.interp(a + share * (b - a), frames, values) for a, b in pairwise(starts.tolist())], axis=0)


def _curves(walk: Walk, heading: float, upright: Array) -> dict[str, Array]:
    """Angles in degrees and places in metres (F,), as a person that looks along the way sees the right side.

    rotation: the right side of the pelvis ahead; list: its right side up; tilt: forward; thorax: its right side ahead;
    arm: the right upper arm ahead of hanging as it does in standing; foot: the right toes up; vertical: the hips'
    height; lateral: the hips to the right.
    """
    _, world = forward(upright, np.zeros(3), walk.skeleton.offsets)
    level = np.array([np.cos(-heading / 2.0), 0.0, 0.0, np.sin(-heading / 2.0)])
    turned = multiply(multiply(level, walk.world), conjugate(world))

    def axis(link: str, of: Array) -> Array:
        return rotate(turned[:, INDEX[link]], of)

    def angle(v: Array, up: int, over: int) -> Array:
        return np.degrees(np.arctan2(v[:, up], v[:, over]))

    def ahead(link: str) -> Array:
        right = axis(link, -_Y)
        return angle(right * (1.0, -1.0, 1.0), 0, 1)

    hanging = axis("right_upper_arm", -_Z) * (1.0, 1.0, -1.0)
    pelvis, right_foot = axis("hips", -_Y), axis("right_foot", _X)
    return {
        "rotation": ahead("hips"),
        "list": np.degrees(np.arcsin(pelvis[:, 2])),
        "tilt": -np.degrees(np.arcsin(axis("hips", _X)[:, 2])),
        "thorax": ahead("spine"),
        "arm": angle(hanging, 0, 2),
        "foot": np.degrees(np.arcsin(right_foot[:, 2])),
        "knee": knee_flexion(walk)[:, 0],
        "vertical": walk.root[:, 2],
        "lateral": walk.root[:, :2] @ np.array([np.sin(heading), -np.cos(heading)]),
        "head": -ahead("head"),
        "nod": -np.degrees(np.arcsin(axis("head", _X)[:, 2])),
    }
