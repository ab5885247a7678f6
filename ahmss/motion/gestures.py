"""Gestures by how long they take, where the palms go, what the fingers do and how the head turns.

Palms are placed against the trunk of somebody upright, so they go with it; sizes are those of 1.72 m, in proportion
for others. Timing and amplitudes: bows of 15, 30 and 45 degrees are those of Japanese etiquette (eshaku, keirei,
saikeirei), down in a breath, held, up more slowly; all else is judged by eye.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from ahmss.body.array import Array
from ahmss.body.inverse import solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import IDENTITY, align, from_axis_angle, from_matrix, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.fingers import opened

__all__ = ["GESTURES", "Gesture", "Palm", "arm_to", "fingers_of", "head_at", "swung"]

_STATURE = 1.72
_SIDES = ("right", "left")
_BENT = np.radians(60.0)  # the elbow from which an arm is solved, so that it goes down and back
_FINGERS = ("index", "middle", "ring", "little")
_SEGMENTS = ("proximal", "intermediate", "distal")
_SHAPES: Mapping[str, tuple[float, float, float]] = {  # degrees at knuckle, middle and end joint
    "fist": (78.0, 98.0, 60.0),
    "loose": (35.0, 45.0, 20.0),
    "curled": (62.0, 75.0, 40.0),
}
_THUMB_UP = np.radians(82.0)  # from along the hand
Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Palm:
    """Where a palm goes: place ahead, to its own side, and height, metres of somebody of 1.72 m.

    out: the palm's direction; along: the fingers'; both ahead, to the own side, up, of any length.
    fingers: as `fingers_of` names them. elbow: degrees by which the elbow is out to the side.
    """

    place: Vector
    out: Vector
    along: Vector
    fingers: str = "open"
    elbow: float = 0.0


@dataclass(frozen=True)
class Gesture:
    """One gesture.

    raising, holding, lowering: seconds until it is there, that it lasts, and until it is over.
    main: the palm of the hand that gestures; other: of the other one; None: the arm stays.
    swing: the forearm's, degrees to either side and times a second, while it lasts.
    yaw, pitch, roll: of the head, each as amplitude in degrees and swings a second; at 0 a second it is held. Left,
    down and towards the right shoulder are positive. fades: how much of the amplitude is gone at the end.
    bends: the trunk bows.
    """

    raising: float
    holding: float
    lowering: float
    main: Palm | None = None
    other: Palm | None = None
    swing: tuple[float, float] = (0.0, 0.0)
    yaw: tuple[float, float] = (0.0, 0.0)
    pitch: tuple[float, float] = (0.0, 0.0)
    roll: tuple[float, float] = (0.0, 0.0)
    fades: float = 0.0
    bends: bool = field(default=False)

    @property
    def seconds(self) -> float:
        """All of it."""
        return self.raising + self.holding + self.lowering

    def there(self, time: Array) -> Array:
        """How far (n) it is made, 0 to 1, at seconds (n)."""
        up = minimum_jerk(time / max(self.raising, 1e-9))
        down = minimum_jerk((time - self.raising - self.holding) / max(self.lowering, 1e-9))
        return up * (1.0 - down)


_RAISED = Palm((0.24, 0.36, 1.53), (1.0, 0.1, 0.0), (0.0, 0.12, 1.0))
_THUMB = Palm((0.37, 0.14, 1.20), (0.0, -1.0, 0.0), (1.0, -0.15, 0.1), "thumb")
_PALM_UP = Palm((0.25, 0.40, 1.06), (0.25, 0.1, 1.0), (1.0, 0.75, 0.1))
_CHIN = Palm((0.145, 0.025, 1.45), (-0.75, -0.6, 0.2), (-0.1, -0.4, 0.9), "curled", 55.0)
_BELLY = Palm((0.23, -0.10, 1.10), (-0.9, 0.1, 0.45), (0.1, -1.0, 0.1), "loose", 80.0)

GESTURES: Mapping[str, Gesture] = {
    "nod": Gesture(0.12, 0.76, 0.22, pitch=(17.0, 2.0), fades=0.45),
    "shake_head": Gesture(0.15, 1.2, 0.25, yaw=(20.0, 1.6), fades=0.5),
    "bow": Gesture(0.95, 0.5, 1.15, bends=True),
    "wave": Gesture(0.6, 1.8, 0.7, _RAISED, swing=(19.0, 1.7), roll=(5.0, 0.0)),
    "shrug": Gesture(0.42, 0.6, 0.65, _PALM_UP, _PALM_UP, roll=(9.0, 0.0), pitch=(-4.0, 0.0)),
    "thumbs_up": Gesture(0.5, 1.0, 0.65, _THUMB, pitch=(5.0, 0.0)),
    "think": Gesture(0.8, 2.4, 0.9, _CHIN, _BELLY, yaw=(13.0, 0.0), pitch=(-6.0, 0.0), roll=(5.0, 0.0)),
}


def head_at(gesture: Gesture, time: Array) -> Array:
    """Yaw, pitch and roll (n, 3) of the head, radians, beside where it looks, at seconds (n)."""
    there = gesture.there(time)
    left = 1.0 - gesture.fades * np.clip(time / gesture.seconds, 0.0, 1.0)
    columns: list[Array] = []
    for i, (degrees, swings) in enumerate((gesture.yaw, gesture.pitch, gesture.roll)):
        way = np.ones(len(time))
        if swings and i == 1:  # a nod goes down and back up, not above
            way = 0.5 - 0.5 * np.cos(2.0 * np.pi * swings * time)
        elif swings:
            way = np.sin(2.0 * np.pi * swings * time)
        columns.append(np.radians(degrees) * way * left * there)
    return np.stack(columns, axis=-1)


@lru_cache(maxsize=64)
def arm_to(skeleton: Skeleton, side: str, palm: Palm) -> Array:
    """Rotations (3, 4) of upper arm, forearm and hand that bring the palm there, parent <- child."""
    rotations, root, target = _upright(skeleton, side, palm)
    first = INDEX[f"{side}_upper_arm"]
    return solve(skeleton, rotations, root, target)[first : first + 3]


def swung(skeleton: Skeleton, side: str, palm: Palm, angles: Array) -> Array:
    """The same (n, 3, 4) with the forearm swung about ahead through the elbow, to the own side, radians (n)."""
    rotations, root, target = _upright(skeleton, side, palm)
    first, row = INDEX[f"{side}_upper_arm"], _SIDES.index(side)
    rotations = solve(skeleton, rotations, root, target)
    elbow = forward(rotations, root, skeleton.offsets)[0][first + 1]
    turn = from_axis_angle(np.array([1.0, 0.0, 0.0]), angles * (1.0 if row == 0 else -1.0))
    n = len(angles)
    targets = np.repeat(target[None], n, axis=0)
    targets[:, row, :3] = elbow + rotate(turn, target[row, :3] - elbow)
    targets[:, row, 3:7] = multiply(turn, target[row, 3:7])
    given = np.repeat(rotations[None], n, axis=0)
    return solve(skeleton, given, np.repeat(root[None], n, axis=0), targets)[:, first : first + 3]


def fingers_of(side: str, shape: str) -> Array:
    """Rotations (14, 4) of the fingers: "open", "loose", "curled", "fist", or "thumb", a fist with the thumb up."""
    if shape == "open":
        return opened(side)
    rotations = opened(side)
    first = fingers(side)[0]
    hinge = np.array([0.0, 0.0, 1.0 if side == "left" else -1.0])
    for finger in _FINGERS:
        for segment, degrees in zip(_SEGMENTS, _SHAPES["fist" if shape == "thumb" else shape], strict=True):
            rotations[INDEX[f"{side}_{finger}_{segment}"] - first] = from_axis_angle(hinge, np.radians(degrees))
    if shape == "thumb":
        rotations[0] = from_axis_angle(np.array([0.0, 1.0, 0.0]), _THUMB_UP)
        rotations[1] = IDENTITY
    return rotations


def _upright(skeleton: Skeleton, side: str, palm: Palm) -> tuple[Array, Array, Array]:
    """Somebody upright at heading 0, that arm a little bent, and the targets (5, 8) of the palm."""
    rotations, root = skeleton.upright()
    row, own = _SIDES.index(side), np.array([1.0, -1.0 if side == "right" else 1.0, 1.0])
    lower = INDEX[f"{side}_lower_arm"]
    rotations[lower] = multiply(rotations[lower], from_axis_angle(np.array([0.0, 1.0, 0.0]), _BENT))
    aside = from_axis_angle(np.array([0.0, 0.0, 1.0 if side == "right" else -1.0]), np.radians(palm.elbow))
    rotations[lower - 1] = multiply(rotations[lower - 1], aside)
    out = np.array(palm.out) * own
    out /= np.linalg.norm(out)
    along = np.array(palm.along) * own
    along -= (along @ out) * out
    along /= np.linalg.norm(along)
    y = along if side == "left" else -along  # the grip's: away from the fingers of the right hand
    grip = from_matrix(np.stack([out, y, np.cross(out, y)], axis=-1))
    target = np.zeros((5, 8))
    target[row, :3] = np.array(palm.place) * own * skeleton.stature / _STATURE
    target[row, 3:7], target[row, 7] = align(grip, IDENTITY), 1.0
    return rotations, root, target
