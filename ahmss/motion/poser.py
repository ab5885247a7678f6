"""A poser: a pose from a few numbers that a person can think in, its feet planted and its weight over them.

Everything is in the stance frame: origin between the ankles on the floor, x ahead, y left, z up; metres, and degrees.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields, replace
from functools import lru_cache
from typing import Any

import numpy as np

from ahmss.body.array import Array
from ahmss.body.inverse import GAZE, LEFT_HAND, RIGHT_HAND, solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, rotate
from ahmss.body.skeleton import Skeleton

__all__ = [
    "STANDING", "STRAIGHT", "Arm", "Fingers", "Posture", "Stance", "between", "centre_of_mass", "foot_frames", "pose",
]  # fmt: skip

_BALANCED = 1e-5  # metres
_GAIN = 1.25  # the weight follows the hips by a fifth less: feet and held hands stay
_SIDES = (("right", 1.0), ("left", -1.0))  # side and the sign of a turn about the links' x and z axes


@dataclass(frozen=True)
class Arm:
    """An arm by its joints, degrees: upper arm forward, aside and turned in; elbow; forearm turned in; wrist.

    `swivel`, for a hand that has a grip to meet: where the elbow is, turned about the line from shoulder to wrist from
    hanging down, to the body's middle where the hand is ahead.
    """

    forward: float = 3.0
    aside: float = 8.0
    turn_in: float = 5.0
    elbow: float = 14.0
    pronate: float = 12.0
    wrist_back: float = 0.0
    wrist_up: float = 0.0
    swivel: float | None = None


@dataclass(frozen=True)
class Fingers:
    """A hand by its fingers, degrees: flexion at the three joints, the thumb's turn to the palm and its bend."""

    knuckle: float = 25.0
    middle: float = 35.0
    end: float = 15.0
    thumb: float = 15.0
    thumb_bend: float = 12.0
    thumb_away: float = 10.0
    spread: float = 3.0


@dataclass(frozen=True)
class Stance:
    """Where the feet are: each ankle's distance from the middle as a share of stature (None: as wide as the hips), and
    how many degrees the toes point out."""

    apart: float | None = 0.056
    toe_out: float = 6.0


STRAIGHT = Stance(apart=None, toe_out=0.0)  # as in the upright pose


@dataclass(frozen=True)
class Posture:
    """A posture. `shift` is where the weight is (ahead, left) of the middle of the ankles; `drop` lowers the hips by a
    share of stature. `hips`, where it is given, is the place of the hips' joint instead: somebody sits.

    The trunk's numbers are degrees: lean ahead, turn to the left, tilt to the left; the head's against the trunk.
    `grips` are wanted hand frames by side (place 3, quaternion 4, and a weight where it is not 1); `gaze` is a place
    looked at, with its weight (4).
    """

    shift: tuple[float, float] = (0.035, 0.0)
    hips: tuple[float, float, float] | None = None
    stance: Stance = Stance()
    drop: float = 0.0007
    hips_lean: float = 0.0
    hips_turn: float = 0.0
    hips_tilt: float = 0.0
    lean: float = 0.0
    turn: float = 0.0
    tilt: float = 0.0
    nod: float = 0.0
    head_turn: float = 0.0
    head_tilt: float = 0.0
    right_arm: Arm = Arm()
    left_arm: Arm = Arm()
    right_fingers: Fingers = Fingers()
    left_fingers: Fingers = Fingers()
    grips: dict[str, Array] = field(default_factory=dict[str, Array])
    gaze: Array | None = None


STANDING = Posture()  # at ease


def between(a: Posture, b: Posture, share: float) -> Posture:
    """The posture on the way from one to another, number by number; stance, grips and gaze stay the first's."""
    return replace(_mixed(a, b, share), stance=a.stance, grips=a.grips, gaze=a.gaze)


def _mixed(a: Any, b: Any, share: float) -> Any:
    """Two of the same kind mixed, deep: numbers, tuples of numbers, postures' parts; what is neither stays."""
    if isinstance(a, float) and isinstance(b, float):
        return a + share * (b - a)
    if isinstance(a, tuple) and isinstance(b, tuple):
        return tuple(_mixed(x, y, share) for x, y in zip(a, b, strict=True))
    if isinstance(a, Posture | Arm | Fingers):
        return replace(a, **{f.name: _mixed(getattr(a, f.name), getattr(b, f.name), share) for f in fields(a)})
    return a


def pose(skeleton: Skeleton, posture: Posture) -> tuple[Array, Array]:
    """The posture as rotations (43, 4) and root (3,), feet on z = 0, weight where `shift` says."""
    rotations, root = skeleton.upright()
    _trunk(rotations, posture)
    for side, sign in _SIDES:
        arm: Arm = getattr(posture, f"{side}_arm")
        fingers: Fingers = getattr(posture, f"{side}_fingers")
        _arm(rotations, side, sign, arm)
        _fingers(rotations, side, sign, fingers)
        _turned(rotations, f"{side}_upper_leg", (0, sign * posture.stance.toe_out))
    if posture.hips is not None:
        root = np.array(posture.hips)
        return _solved(skeleton, rotations, root, posture), root
    return _balance(skeleton, rotations, root - np.array([0.0, 0.0, posture.drop * skeleton.stature]), posture)


def _turned(rotations: Array, link: str, *turns: tuple[int, float]) -> None:
    """Turn a link in place about its own axes (0 x, 1 y, 2 z), degrees, one after the other."""
    for axis, degrees in turns:
        half = 0.5 * math.radians(degrees)
        turn = np.array([math.cos(half), 0.0, 0.0, 0.0])
        turn[1 + axis] = math.sin(half)
        rotations[INDEX[link]] = multiply(rotations[INDEX[link]], turn)


def _trunk(rotations: Array, posture: Posture) -> None:
    """Hips, spine and head; their x is up, y left, z back."""
    _turned(rotations, "hips", (0, posture.hips_turn), (1, posture.hips_lean), (2, posture.hips_tilt))
    _turned(rotations, "spine", (0, posture.turn), (1, posture.lean), (2, posture.tilt))
    _turned(rotations, "head", (0, posture.head_turn), (1, posture.nod), (2, posture.head_tilt))


def _arm(rotations: Array, side: str, sign: float, arm: Arm) -> None:
    """An arm's links; their x is down, y right, z back."""
    _turned(rotations, f"{side}_upper_arm", (1, arm.forward), (2, sign * arm.aside), (0, -sign * arm.turn_in))
    _turned(rotations, f"{side}_lower_arm", (1, arm.elbow), (0, -sign * arm.pronate))
    _turned(rotations, f"{side}_hand", (2, sign * arm.wrist_back), (1, arm.wrist_up))


def _fingers(rotations: Array, side: str, sign: float, fingers: Fingers) -> None:
    """The fingers; flexion is about -z on the right, the spread about y."""
    across = {"index": 1.0, "middle": 0.2, "ring": -0.6, "little": -1.4}
    for i, segment in enumerate(("proximal", "intermediate", "distal")):
        flexion = (fingers.knuckle, fingers.middle, fingers.end)[i]
        for n, (finger, place) in enumerate(across.items()):
            turns = [(1, fingers.spread * place)] if i == 0 else []
            _turned(rotations, f"{side}_{finger}_{segment}", *turns, (2, -sign * flexion * (0.94 + 0.05 * n)))
    _turned(rotations, f"{side}_thumb_proximal", (1, fingers.thumb_away), (2, -sign * fingers.thumb))
    _turned(rotations, f"{side}_thumb_distal", (2, -sign * fingers.thumb_bend))


def _balance(skeleton: Skeleton, rotations: Array, root: Array, posture: Posture) -> tuple[Array, Array]:
    """Move the hips until the weight stands where it should, legs and hands following."""
    wanted = np.array(posture.shift)
    for _ in range(12):
        solved = _solved(skeleton, rotations, root, posture)
        error = wanted - centre_of_mass(skeleton, solved, root)[:2]
        if np.abs(error).max() < _BALANCED:
            return solved, root
        root = root + _GAIN * np.array([*error, 0.0])
    return _solved(skeleton, rotations, root, posture), root


def _solved(skeleton: Skeleton, rotations: Array, root: Array, posture: Posture) -> Array:
    targets = np.zeros((5, 8))
    targets[2:4, :7], targets[2:4, 7] = foot_frames(skeleton, posture.stance), 1.0
    for row, side in ((RIGHT_HAND, "right"), (LEFT_HAND, "left")):
        if side in posture.grips:
            targets[row, 7] = 1.0
            targets[row, : len(posture.grips[side])] = posture.grips[side]
    if posture.gaze is not None:
        targets[GAZE, :3], targets[GAZE, 7] = posture.gaze[:3], posture.gaze[3]
    solved = solve(skeleton, rotations, root, targets)
    for side, sign in _SIDES:
        arm: Arm = getattr(posture, f"{side}_arm")
        if side in posture.grips and arm.swivel is not None:
            _swivel(skeleton, solved, root, side, sign * np.radians(arm.swivel))
            solved = solve(skeleton, solved, root, targets)
    return solved


def _swivel(skeleton: Skeleton, rotations: Array, root: Array, side: str, angle: float) -> None:
    """Turn an arm about the line from shoulder to wrist until the elbow is at an angle from hanging down."""
    shoulder, elbow, wrist = (INDEX[f"{side}_{link}"] for link in ("upper_arm", "lower_arm", "hand"))
    places, world = forward(rotations, root, skeleton.offsets)
    line = places[wrist] - places[shoulder]
    line = line / np.linalg.norm(line)
    down = np.array([0.0, 0.0, -1.0]) + line[2] * line
    across = np.cross(line, down)
    bone = places[elbow] - places[shoulder]
    turn = from_axis_angle(line, angle - float(np.arctan2(bone @ across, bone @ down)))
    q_spine = world[INDEX["spine"]]
    local = multiply(conjugate(q_spine), multiply(turn, q_spine))
    rotations[shoulder] = multiply(local, rotations[shoulder])


@lru_cache(maxsize=64)
def foot_frames(skeleton: Skeleton, stance: Stance) -> Array:
    """The feet (2, 7), right and left, on the floor."""
    hips = float(skeleton.offsets[INDEX["left_upper_leg"], 1])
    apart = hips if stance.apart is None else stance.apart * skeleton.stature
    frames = np.zeros((2, 7))
    for row, (_, sign) in enumerate(_SIDES):
        frames[row, :3] = 0.0, -sign * apart, -float(skeleton.soles[:, 2].min())
        frames[row, 3:] = from_axis_angle(np.array([0.0, 0.0, 1.0]), np.radians(-sign * stance.toe_out))
    return frames


def centre_of_mass(skeleton: Skeleton, rotations: Array, root: Array) -> Array:
    """The body's centre of mass (..., 3): each link's mass half way along it."""
    places, world = forward(rotations, root, skeleton.offsets)
    middles = places + rotate(world, 0.5 * skeleton.tips)
    return np.einsum("l,...lc->...c", skeleton.mass / skeleton.mass.sum(), middles)
