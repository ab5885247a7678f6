"""A hand's turn about the forearm that another motion has left in the wrist, handed back to the forearm in frames.

Our arms turn a hand by the forearm alone and the wrist only bends (`body.arm`); who came from elsewhere may have some
of the turn in the wrist. The hand is where it is for any share of it, so it is handed back without moving the hand.
"""

from __future__ import annotations

import numpy as np

from ahmss.body.arm import split_wrist
from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply
from ahmss.motion.easing import minimum_jerk

__all__ = ["handed_back", "twist_of", "twisted", "untwisted"]

_ALONG = np.array([1.0, 0.0, 0.0])  # of our links
_FASTEST = np.radians(1.5)  # a frame: little beside what the joints turn otherwise
_LEAST = 15.0  # frames
_PEAK = 1.875  # of a minimum jerk's mean speed


def untwisted(links: Array) -> tuple[Array, float]:
    """An arm (3, 4) with the same wrist pose whose wrist only bends, and the turn, radians, that the wrist had."""
    turn, bend = split_wrist(links[2])
    return np.stack([links[0], multiply(links[1], turn), bend]), float(twist_of(links))


def handed_back(links: Array, twist: float) -> Array:
    """Arms (F, 3, 4) that follow one of such a twist: the wrist begins with it, and the forearm takes it over.

    Args:
        links: whose wrists only bend.
        twist: radians, what `untwisted` told of the frame before the first.
    """
    frames = max(float(np.ceil(_PEAK * abs(twist) / _FASTEST)), _LEAST)
    left = twist * (1.0 - minimum_jerk(np.arange(1.0, len(links) + 1.0) / min(frames, len(links))))
    return twisted(links, left)


def twist_of(links: Array) -> Array:
    """The turn (...), radians, that the wrists of arms (..., 3, 4) have."""
    turn, _ = split_wrist(links[..., 2, :])
    return 2.0 * np.arctan2(turn[..., 1], turn[..., 0])


def twisted(links: Array, twist: Array) -> Array:
    """Arms (..., 3, 4) whose wrists only bend, given so much (...) of the forearm's turn, radians; the hand stays."""
    out = links.copy()
    out[..., 1, :] = multiply(links[..., 1, :], from_axis_angle(_ALONG, -twist))
    out[..., 2, :] = multiply(from_axis_angle(_ALONG, twist), links[..., 2, :])
    return out
