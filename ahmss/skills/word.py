"""The word of a motion that its hand has closed: from that frame on what it takes goes with the hand."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

from ahmss.algorithm.pose import HumanPose
from ahmss.body.array import Array

__all__ = ["closed_at_last"]


def closed_at_last(rows: Array) -> Iterator[Array | HumanPose]:
    """POSE rows (n, 260); with the last of them it is said that the hand has closed on the motion's object."""
    if len(rows) > 1:
        yield rows[:-1]
    yield replace(HumanPose.of(rows[-1]), states={"held": "here"})
