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
from ahmss.walking.library import WalkClip
from ahmss.walking.mirroring import mirror

__all__ = ["Pose", "close_onto_mirror", "fit_ends", "turned"]

_UP = np.array([0.0, 0.0, 1.0])


class Pose(NamedTuple):
    """A pose of the body without fingers: rotations (15, 4), the hips' against the clip's frame; root (3,) metres."""

    rotations: Array
    root: Array


def turned(pose: Pose, degrees: float) -> Pose:
    """The pose turned as a whole about the origin, to the left: a straight's first pose becomes a start's last."""
    turn = from_axis_angle(_UP, np.radians(degrees))
    rotations = pose.rotations.copy()
    rotations[0] = multiply(turn, pose.rotations[0])
    return Pose(rotations, rotate(turn, pose.root))


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


def _correction(clip: WalkClip, frame: int, wanted: Pose | None) -> tuple[Array, Array]:
    """What turns the joints of a frame to a pose, rotation vectors (15, 3), and by how much the hips must move (3,)."""
    if wanted is None:
        return np.zeros((clip.rotations.shape[1], 3)), np.zeros(3)
    vectors = to_rotation_vector(multiply(conjugate(clip.rotations[frame]), wanted.rotations))  # (A.1), (A.4), (A.5)
    direction = np.radians(clip.key.direction)
    way = np.array([np.cos(direction), np.sin(direction), 0.0])
    shift = wanted.root - clip.root[frame]
    return vectors, shift - (shift @ way) * way
