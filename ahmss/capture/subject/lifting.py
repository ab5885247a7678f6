"""Bending to lift a box from the floor: trunk and hips first, knees last; up again with the legs first.

Measured on a real low lift: down in 1.4 s, up in 1.0 s; the head pitches first, the trunk is more than 60 degrees ahead
at the bottom, and the pelvis drops about three quarters of what the hands do.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ahmss.body.array import Array
from ahmss.body.inverse import grips as grip_frames
from ahmss.body.quaternion import from_matrix, slerp
from ahmss.body.skeleton import Skeleton
from ahmss.capture.subject.score import Move, Score
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.poser import STRAIGHT, Arm, Fingers, Posture, pose

__all__ = ["Box", "lift"]

_DOWN, _HELD, _UP = 1.40, 1.62, 2.80  # seconds: hands at the box, hold it, have it before the belly
_CARRIED = (0.30, 0.12)  # metres ahead of the ankles, and above the hips' joint: where the hands hold the box
_FROM_ASIDE = 0.07  # metres by which the hands come from the sides
_FINGERS_AHEAD, _CARRIED_AHEAD = (
    22.0,
    75.0,
)  # degrees from straight down that the fingers point, at the box and at the end

_ARM = Arm(forward=45.0, aside=14.0, turn_in=0.0, elbow=40.0, pronate=12.0)
_FLAT = Fingers(knuckle=16.0, middle=20.0, end=10.0)
_STANDING = Posture(stance=STRAIGHT, right_fingers=_FLAT, left_fingers=_FLAT)


@dataclass(frozen=True)
class Box:
    """What is lifted, between both hands: its middle's distance ahead of the ankles, how wide it is, and how high above
    the floor it is taken; metres."""

    ahead: float = 0.38
    width: float = 0.36
    grasp: float = 0.20


def lift(skeleton: Skeleton, box: Box, time: Array) -> tuple[Array, Array]:
    """Rotations (F, 43, 4) and root (F, 3) of lifting the box, at times (F,) in seconds from its beginning."""
    score = Score(
        _STANDING,
        Move(0.10, 1.20, {"hips_lean": 41.0, "lean": 27.0}),
        Move(0.40, 1.40, {"drop": 0.222}),
        Move(0.20, 1.40, {"shift.0": 0.055}),
        Move(_HELD, 2.60, {"drop": 0.004}),
        Move(1.85, 2.95, {"hips_lean": -2.0, "lean": -3.0}),
        Move(1.70, 2.80, {"shift.0": 0.012}),
    )
    free = grip_frames(skeleton, *pose(skeleton, _STANDING))
    end = pose(skeleton, score.at(_UP + 1.0))[1][2] + _CARRIED[1]
    poses = [_posed(skeleton, score.at(float(t)), box, free, float(end), float(t)) for t in time]
    return np.stack([rotations for rotations, _ in poses]), np.stack([root for _, root in poses])


_JOINTS = ("forward", "aside", "turn_in", "elbow", "pronate")


def _posed(skeleton: Skeleton, posture: Posture, box: Box, free: Array, end: float, t: float) -> tuple[Array, Array]:
    """The posture at time t with the hands on their way and the gaze, ahead of them, on the box."""
    down = float(minimum_jerk(np.array((t - 0.30) / (_DOWN - 0.30))))
    up = float(minimum_jerk(np.array((t - _HELD) / (_UP - _HELD))))
    places = {side: _hand(box, side, free[row], end, down, up) for row, side in enumerate(("right", "left"))}
    middle = 0.5 * (places["right"][:3] + places["left"][:3]) if up > 0.0 else np.array([box.ahead, 0.0, box.grasp])
    looking = minimum_jerk(np.array(t / 0.6)) * (1.0 - minimum_jerk(np.array((t - 2.0) / 0.8)))
    arm = replace(_ARM, forward=_ARM.forward + 10.0 * up, elbow=_ARM.elbow + 40.0 * up)
    rest = posture.right_arm
    mixed = replace(rest, **{n: (1 - down) * getattr(rest, n) + down * getattr(arm, n) for n in _JOINTS})
    return pose(
        skeleton,
        replace(posture, right_arm=mixed, left_arm=mixed, grips=places, gaze=np.array([*middle, float(looking)])),
    )


def _hand(box: Box, side: str, free: Array, end: float, down: float, up: float) -> Array:
    """A hand's grip frame (7): from hanging free to the side of the box, and with it to before the belly."""
    inwards = 1.0 if side == "right" else -1.0
    aside = -inwards * (0.5 * box.width)
    at_box = np.array([box.ahead, aside, box.grasp])
    carried = np.array([_CARRIED[0], aside, end])
    place = free[:3] + down * (at_box - free[:3]) + up * (carried - at_box)
    place[1] -= inwards * _FROM_ASIDE * 4.0 * down * (1.0 - down)
    turned = slerp(_level(inwards, _FINGERS_AHEAD), _level(inwards, _CARRIED_AHEAD), up)
    return np.concatenate([place, slerp(free[3:], turned, float(minimum_jerk(np.array(down / 0.8)))), [1.0]])


def _level(inwards: float, ahead: float) -> Array:
    """A palm that faces inwards, the fingers so many degrees ahead of straight down."""
    angle = np.radians(ahead)
    out, thumb = np.array([0.0, inwards, 0.0]), np.array([np.cos(angle), 0.0, np.sin(angle)])
    return from_matrix(np.stack([out, np.cross(thumb, out), thumb], axis=-1))
