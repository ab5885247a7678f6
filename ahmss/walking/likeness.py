"""How like poses are to those that they shall join: what tells which of several cuts is best."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, to_rotation_vector
from ahmss.walking.library import RATE, WalkClip
from ahmss.walking.mirroring import mirror

__all__ = ["closing", "unlike"]

_SOON = 0.1  # seconds in which a wrong speed leads as far away as counts


def closing(clip: WalkClip) -> float:
    """How far a straight step is from going on as its own mirror image, degrees: its joints' turns and their speeds."""
    first, _ = mirror(clip.rotations[:2], clip.root[:2])
    speed, wanted = (_turns(q[0], q[1]) for q in (clip.rotations[-2:], first))
    return float(np.hypot(unlike(clip.rotations[-1], first[0]), _SOON * RATE * np.degrees(_rms(speed - wanted))))


def unlike(rotations: Array, wanted: Array) -> float:
    """By how much the joints of two poses (15, 4) differ: the root of the mean square, degrees."""
    return float(np.degrees(_rms(_turns(rotations, wanted))))


def _turns(rotations: Array, wanted: Array) -> Array:
    return to_rotation_vector(multiply(conjugate(rotations), wanted))


def _rms(vectors: Array) -> float:
    return float(np.sqrt((vectors * vectors).sum(axis=-1).mean()))
