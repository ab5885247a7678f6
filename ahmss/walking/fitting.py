"""Cut motion made to fit: a straight step onto its own mirror image, starts and ends onto what they join (A.1 to A.7).

The thesis's yaw, pitch and roll are an artefact of the older work that it builds on: here a rotation vector takes their
part. Its x runs from 0 to N, so N counts intervals. The hips' place is handled like a joint but along the way, where
nothing is changed: how far a clip gets is its own. Feet slide a little in a fitted clip: legs are to be solved again.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, from_axis_angle, from_rotation_vector, multiply, rotate, to_rotation_vector
from ahmss.walking.catalogue import Key
from ahmss.walking.library import BODY, RATE, WalkClip
from ahmss.walking.mirroring import mirror

__all__ = [
    "STILL", "Pose", "Speeds", "close_onto_mirror", "close_speeds", "fit_ends", "fit_speeds", "turned", "wanted_ends",
    "wanted_speeds",
]  # fmt: skip

_UP = np.array([0.0, 0.0, 1.0])
_BUMP = 0.25  # seconds in which a change of speed at an end is over


class Pose(NamedTuple):
    """A pose of the body without fingers: rotations (15, 4), the hips' against the clip's frame; root (3,) metres."""

    rotations: Array
    root: Array


class Speeds(NamedTuple):
    """How a pose changes to the next frame's: joints (15, 3), rotation vectors in the links' frames; root (3,), m."""

    joints: Array
    root: Array

    @classmethod
    def between(cls, pose: Pose, following: Pose) -> Speeds:
        """Those that lead from a pose to the one a frame later."""
        return cls(_turns(pose.rotations, following.rotations), following.root - pose.root)

    def turned(self, degrees: float) -> Speeds:
        """Of the pose turned as a whole, degrees to the left."""
        return self._replace(root=rotate(from_axis_angle(_UP, np.radians(degrees)), self.root))

    def mirrored(self) -> Speeds:
        """Of the pose in a mirror."""
        seen, root = mirror(from_rotation_vector(self.joints), self.root)
        return Speeds(to_rotation_vector(seen), root)


STILL = Speeds(np.zeros((BODY, 3)), np.zeros(3))


def turned(pose: Pose, degrees: float) -> Pose:
    """The pose turned about the origin, degrees to the left: a straight's first pose becomes a start's last."""
    turn = from_axis_angle(_UP, np.radians(degrees))
    rotations = pose.rotations.copy()
    rotations[0] = multiply(turn, pose.rotations[0])
    return Pose(rotations, rotate(turn, pose.root))


def wanted_ends(key: Key, straight: WalkClip, standing: Pose) -> tuple[Pose, Pose]:
    """What any clip but the straight step must begin and end with.

    Args:
        key: of the clip.
        straight: closed onto its mirror image.
        standing: heading 0, the hips over the origin.
    """
    landing = Pose(straight.rotations[0], straight.root[0])
    match key.kind:
        case "start":
            return standing, turned(landing, key.direction)
        case "end":
            begin = landing if key.last == "right" else Pose(*mirror(*landing))
            return begin, turned(standing, key.facing)
        case _:
            return standing, turned(standing, key.direction + key.facing)


def wanted_speeds(key: Key, straight: WalkClip) -> tuple[Speeds, Speeds]:
    """What speeds any clip but the straight step must begin and end with, so that it goes on smoothly."""
    walking = Speeds.between(_pose(straight, 0), _pose(straight, 1))
    match key.kind:
        case "start":  # as a straight step comes to where the next one begins
            landing = Speeds.between(_pose(straight, straight.frames - 1), _pose(straight, straight.frames))
            return STILL, landing.mirrored().turned(key.direction)
        case "end":
            return walking if key.last == "right" else walking.mirrored(), STILL
        case _:
            return STILL, STILL


def close_onto_mirror(clip: WalkClip) -> WalkClip:
    """The straight step whose last pose is the mirror image of its first, all 15 joints (A.1 to A.3).

    (A.2) is (A.7) with its second term alone and d2 = 1.
    """
    return fit_ends(clip, None, Pose(*mirror(clip.rotations[0], clip.root[0])), d2=1)


def fit_ends(clip: WalkClip, first: Pose | None, last: Pose | None, d1: int = 2, d2: int = 2) -> WalkClip:
    """The clip that begins with one pose and ends with another (A.4 to A.7).

    Args:
        clip: N + 1 poses, its way in the direction of its key.
        first: what it is to begin with, or None: it begins as it does. The caller turns it as the clip needs it. Of the
            root only what is up and across the way counts.
        last: what it is to end with, or None, likewise.
        d1: a whole number >= 1: the greater, the sooner the correction at the beginning fades.
        d2: the same for the correction at the end.

    Raises:
        ValueError: d1 or d2 is none of these.
    """
    for name, exponent in (("d1", d1), ("d2", d2)):
        if exponent < 1 or exponent != int(exponent):
            raise ValueError(f"{name}: {exponent}; it must be a whole number, 1 or more")
    N = clip.frames
    x = np.arange(N + 1)
    fading, growing = ((N - x) / N) ** d1, (x / N) ** d2
    M_F, shift_F = _correction(clip, 0, first)
    M_L, shift_L = _correction(clip, N, last)
    M = from_rotation_vector(M_F * fading[:, None, None] + M_L * growing[:, None, None])  # (A.7)
    return replace(
        clip,
        rotations=multiply(clip.rotations, M),  # (A.2), (A.6)
        root=clip.root + shift_F * fading[:, None] + shift_L * growing[:, None],
    )


def close_speeds(clip: WalkClip) -> WalkClip:
    """The straight step, closed onto its mirror image, that goes on as that without a jerk: by the mean of speeds."""
    begin = Speeds.between(_pose(clip, 0), _pose(clip, 1))
    end = Speeds.between(_pose(clip, clip.frames - 1), _pose(clip, clip.frames)).mirrored()
    mean = Speeds(0.5 * (begin.joints + end.joints), 0.5 * (begin.root + end.root))
    return fit_speeds(clip, mean, mean.mirrored())


def fit_speeds(clip: WalkClip, first: Speeds | None, last: Speeds | None) -> WalkClip:
    """The clip with other speeds at its ends, its first and last pose as they are. (Beyond the thesis.)

    (A.7) makes poses meet, not speeds; where both clips are cut from captures, a seam shows in their jerk.

    Args:
        clip: 7 poses or more.
        first: what leads from its first pose to its second, or None: what does.
        last: what leads from the last pose but one to the last, likewise.
    """
    N = clip.frames
    x = np.arange(N + 1)
    m = min(_BUMP * RATE, 0.5 * N)
    bump = x * np.maximum(1.0 - x / m, 0.0) ** 2 / (1.0 - 1.0 / m) ** 2  # 0 at 0, 1 at 1, soon 0 again
    own_first = Speeds.between(_pose(clip, 0), _pose(clip, 1))
    own_last = Speeds.between(_pose(clip, N - 1), _pose(clip, N))
    if first is not None:
        turn = _turns(from_rotation_vector(own_first.joints), from_rotation_vector(first.joints))
        clip = _bent(clip, bump, turn, first.root - own_first.root)
    if last is not None:  # the pose before the last is moved, so the other way round
        turn = multiply(from_rotation_vector(own_last.joints), from_rotation_vector(-last.joints))
        clip = _bent(clip, bump[::-1], to_rotation_vector(turn), own_last.root - last.root)
    return clip


def _pose(clip: WalkClip, frame: int) -> Pose:
    return Pose(clip.rotations[frame], clip.root[frame])


def _bent(clip: WalkClip, share: Array, turn: Array, shift: Array) -> WalkClip:
    rotations = multiply(clip.rotations, from_rotation_vector(share[:, None, None] * turn))
    return replace(clip, rotations=rotations, root=clip.root + share[:, None] * shift)


def _turns(rotations: Array, wanted: Array) -> Array:
    """What turns joints to others, rotation vectors (..., 3) in their own frames."""
    return to_rotation_vector(multiply(conjugate(rotations), wanted))


def _correction(clip: WalkClip, frame: int, wanted: Pose | None) -> tuple[Array, Array]:
    """What turns the joints of a frame to a pose, rotation vectors (15, 3), and by how much the hips must move (3,)."""
    if wanted is None:
        return np.zeros((clip.rotations.shape[1], 3)), np.zeros(3)
    vectors = _turns(clip.rotations[frame], wanted.rotations)  # (A.1), (A.4), (A.5)
    direction = np.radians(clip.key.direction)
    way = np.array([np.cos(direction), np.sin(direction), 0.0])
    shift = wanted.root - clip.root[frame]
    return vectors, shift - (shift @ way) * way
