"""Hands that leave the neighbours of what they use alone: how a part is come to and left, and what a motion touches."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import from_axis_angle, rotate
from ahmss.errors import AlgorithmError
from ahmss.reaching.reacher import SIDES
from ahmss.skills.box import Box, boxes_of, nearest
from ahmss.skills.neighbours import neighbours

__all__ = ["KEEPS", "WITHIN", "gap_of", "offs", "refuse_touching"]

KEEPS = 0.012
"""Metres that the bones of a hand keep from what is beside a control."""

WITHIN = 0.002
"""Metres that they may be in it, where there is no other way."""

_EACH, _BETWEEN = 3, 0.004  # frames: every so many are looked at; metres that a hand may be deeper between these
_FAR = 0.1  # metres from a hand: what is farther is not looked at
_TILTS, _AWAY = np.radians([0.0, 30.0, -30.0]), (0.07, 0.12)
_X, _Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


def offs(site: Transform) -> list[Array]:
    """Where an open hand is set before a part, (3,) metres from where it is on it, and where it goes when it lets go.

    The nearest straight before it first; then farther, and aslant, thumb and fingers going along the part's sides.

    Args:
        site: of the part in the world: along its x one comes to it, along its z thumb and fingers close.
    """
    found: list[Array] = []
    for tilt in _TILTS:
        turned = rotate(site.rotation, rotate(from_axis_angle(_Z, np.array(tilt)), -_X))
        found += [away * turned for away in _AWAY]
    return found


def gap_of(task: HumanTask, side: str, rotations: Array, root: Array, boxes: Sequence[Box]) -> float:
    """Metres between the bones of a hand in frames (n, 43, 4), (n, 3) and boxes; negative within, at most `_FAR`."""
    points = _points(task, side, rotations[::_EACH], root[::_EACH])
    return float(nearest(boxes, points, _FAR).min())


def refuse_touching(task: HumanTask, side: str, rotations: Array, root: Array, boxes: Sequence[Box]) -> None:
    """Refuse frames (n, 43, 4), (n, 3) in which a hand is in what is beside.

    Raises:
        AlgorithmError: it is; says which neighbour, how deep, and what to do.
    """
    if gap_of(task, side, rotations, root, boxes) > _BETWEEN - WITHIN:
        return
    assert task.object is not None
    points = _points(task, side, rotations, root)
    depth = {thing.name: -float(nearest(boxes_of(thing), points, _FAR).min()) for thing in neighbours(task)}
    name = max(depth, key=lambda name: depth[name], default="")
    if name and depth[name] > WITHIN:
        raise AlgorithmError(
            f"{name} is in the way of a hand at {task.object.name}, which would be {1000.0 * depth[name]:.0f} mm in it "
            "however it comes; move one of the two, or use it with the other hand"
        )


def _points(task: HumanTask, side: str, rotations: Array, root: Array) -> Array:
    """The wrist, and each finger's joints, middles and tips (n, m, 3) in frames."""
    places, turned = forward(rotations, root, task.human.offsets)
    links = [INDEX[f"{side}_hand"], *fingers(side)]
    assert side in SIDES
    ends = places[:, links] + rotate(turned[:, links], task.human.tips[links])
    return np.concatenate([places[:, links], 0.5 * (places[:, links] + ends), ends], axis=1)
