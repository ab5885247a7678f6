"""Sitting down on a chair and standing up from it, the feet planted before it.

Times and angles of getting up: seat-off at 30 to 40 % of 1.5 to 2 seconds, the trunk 35 to 45 degrees ahead about then,
the ankles 5 to 10 cm behind the knees. Sitting down takes a little longer, in the order reversed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, from_matrix, multiply, rotate, to_matrix
from ahmss.body.skeleton import Skeleton
from ahmss.capture.subject.score import Move, Score
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.poser import STRAIGHT, Arm, Fingers, Posture, pose

__all__ = ["Seat", "seated_hips", "sit", "stand_up"]

_BEHIND = 0.075  # metres from the knees back to the ankles of one who sits
_BUTTOCKS = 0.0655  # of stature: how far the skin one sits on is below the hips' joint
_ALONG_THIGH, _ON_THIGH = 0.60, 0.036  # shares of the thigh's length and of stature: where the palms rest
_HANDS_IN = 14.0  # degrees that the resting hands point inwards
_LAP = Fingers(knuckle=14.0, middle=22.0, end=12.0)

_STANDING = Posture(stance=STRAIGHT)
_SEATED = replace(
    _STANDING, hips_lean=-7.0, lean=7.0, nod=2.0, right_arm=Arm(18.0, 10.0, 10.0, 62.0, 55.0),
    left_arm=Arm(18.0, 10.0, 10.0, 62.0, 55.0),
)  # fmt: skip


@dataclass(frozen=True)
class Seat:
    """What is sat on: its height, metres. Where it is follows from the feet."""

    height: float = 0.43


def stand_up(skeleton: Skeleton, seat: Seat, time: Array) -> tuple[Array, Array]:
    """Rotations (F, 43, 4) and root (F, 3) of standing up, at times (F,) in seconds from its beginning."""
    x, _, z = _standing_hips(skeleton)
    score = Score(
        replace(_SEATED, hips=seated_hips(skeleton, seat)),
        Move(0.00, 0.85, {"hips_lean": 25.0, "lean": 19.0, "nod": -18.0}),
        Move(0.70, 1.85, {"hips_lean": 0.0, "lean": 0.0, "nod": 0.0}),
        Move(0.40, 1.75, {"hips.0": x}),
        Move(0.52, 1.80, {"hips.2": z}),
        Move(0.20, 0.95, {"arms.forward": 34.0, "arms.elbow": 40.0}),
        Move(0.80, 1.90, {"arms.forward": 3.0, "arms.elbow": 14.0}),
        Move(0.70, 1.60, {"arms.aside": 8.0, "arms.turn_in": 5.0, "arms.pronate": 12.0}),
    )  # fmt: skip
    return _play(skeleton, score, 1.0 - minimum_jerk((time - 0.42) / 0.75), time)


def sit(skeleton: Skeleton, seat: Seat, time: Array) -> tuple[Array, Array]:
    """Rotations (F, 43, 4) and root (F, 3) of sitting down, at times (F,) in seconds from its beginning."""
    x, _, z = _standing_hips(skeleton)
    seated = seated_hips(skeleton, seat)
    score = Score(
        replace(_STANDING, hips=(x, 0.0, z)),
        Move(0.00, 0.55, {"nod": 16.0}),
        Move(0.05, 1.05, {"hips_lean": 26.0, "lean": 18.0}),
        Move(0.55, 1.25, {"nod": -16.0}),
        Move(0.35, 1.65, {"hips.0": seated[0]}),
        Move(0.25, 1.65, {"hips.2": seated[2]}),
        Move(0.20, 1.20, {"arms.forward": 40.0, "arms.elbow": 42.0}),
        Move(0.60, 1.50, {"arms.aside": 10.0, "arms.turn_in": 10.0, "arms.pronate": 55.0}),
        Move(1.25, 2.20, {"hips_lean": -7.0, "lean": 7.0, "nod": 2.0}),
        Move(1.25, 2.15, {"arms.forward": 18.0, "arms.elbow": 62.0}),
    )
    return _play(skeleton, score, minimum_jerk((time - 1.0) / 0.8), time)


def seated_hips(skeleton: Skeleton, seat: Seat) -> tuple[float, float, float]:
    """The place of the hips' joint of one who sits, from the middle of the ankles, metres."""
    thigh = float(skeleton.offsets[INDEX["left_lower_leg"], 0])
    shank = float(skeleton.offsets[INDEX["left_foot"], 0])
    knee = -float(skeleton.soles[:, 2].min()) + np.sqrt(shank**2 - _BEHIND**2)
    hips = seat.height + _BUTTOCKS * skeleton.stature
    return (_BEHIND - float(np.sqrt(thigh**2 - (hips - knee) ** 2)), 0.0, hips)


def _standing_hips(skeleton: Skeleton) -> tuple[float, float, float]:
    x, y, z = pose(skeleton, _STANDING)[1].tolist()
    return (x, y, z)


def _play(skeleton: Skeleton, score: Score, hands: Array, time: Array) -> tuple[Array, Array]:
    """The score's poses with the palms on the thighs, as far as `hands` (F,) says."""
    poses = [_posed(skeleton, score.at(float(t)), float(share)) for t, share in zip(time, hands, strict=True)]
    return np.stack([rotations for rotations, _ in poses]), np.stack([root for _, root in poses])


def _posed(skeleton: Skeleton, posture: Posture, hands: float) -> tuple[Array, Array]:
    rotations, root = pose(skeleton, posture)
    if hands <= 0.0:
        return rotations, root
    places, world = forward(rotations, root, skeleton.offsets)
    grips = {side: _palm_on_thigh(skeleton, places, world, side, hands) for side in ("right", "left")}
    return pose(skeleton, replace(posture, grips=grips))


def _palm_on_thigh(skeleton: Skeleton, places: Array, world: Array, side: str, weight: float) -> Array:
    """A grip target (8): the palm on the thigh, the fingers to the knee and a little inwards."""
    link, inwards = INDEX[f"{side}_upper_leg"], 1.0 if side == "right" else -1.0
    turn = multiply(world[link], from_axis_angle(np.array([0.0, 0.0, 1.0]), inwards * np.radians(_HANDS_IN)))
    _, left, up = np.moveaxis(to_matrix(turn), -1, 0)
    out, thumb = -up, inwards * left
    on_thigh = np.array([_ALONG_THIGH * skeleton.tips[link, 0], 0.0, _ON_THIGH * skeleton.stature])
    place = places[link] + rotate(world[link], on_thigh)
    return np.concatenate([place, from_matrix(np.stack([out, np.cross(thumb, out), thumb], axis=-1)), [weight]])
