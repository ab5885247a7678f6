"""The quality of a motion file as it came, on the skeleton of whoever performed it, before a human of ours has it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import between, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.alignment import align, upward
from ahmss.motion.contact import speeds
from ahmss.motion.footing import drifts, found, support
from ahmss.motion.importing import import_clip, read_source
from ahmss.motion.naming import SIDES, Parts, parts_of
from ahmss.motion.quality import Quality, beyond_limits, measure
from ahmss.motion.retarget import leg_length
from ahmss.motion.smoothness import joint_motion, worst_pop
from ahmss.motion.source import SourceMotion
from ahmss.motion.units import guess_unit

__all__ = ["foot_points_of", "measure_file", "measure_source"]

_STILL = 0.3  # metres a second: a point that is slower stands
_UP = np.array([0.0, 0.0, 1.0])
_NO_JOINTS = ".c3d"  # markers alone


def measure_file(path: Path, skeleton: Skeleton) -> Quality:
    """Measure a file of another maker.

    Everything but the limits is measured on the file's own skeleton, at its own rate. Limits are a human's: they are
    those that `skeleton` would exceed with the motion. Markers have no skeleton, so all is measured on `skeleton`.

    Raises:
        DataError: the file is damaged, or no body is known in it; names file and place.
    """
    clip, _ = import_clip(path, skeleton, rate=None)
    if path.suffix.lower() == _NO_JOINTS:
        return measure(clip.rotations, clip.root, clip.rate, skeleton, clip.contacts)
    return replace(measure_source(read_source(path)), excess=beyond_limits(clip.rotations, skeleton))


def measure_source(source: SourceMotion) -> Quality:
    """Measure a motion on its own skeleton, all but limits, which it has none of.

    Raises:
        DataError: no body is known in it.
    """
    parts = parts_of(source)
    points = foot_points_of(source, parts)
    joints = [i for i, name in enumerate(source.names) if not name.endswith("_end")]
    fingers = _below(source, [parts.limbs[f"{side}_hand"] for side in SIDES])
    ordered = [i for i in joints if i not in fingers] + [i for i in joints if i in fingers]
    rotations = source.rotations[:, ordered]
    return Quality(
        joints=joint_motion(rotations, source.rate, sum(i not in fingers for i in joints)),
        support=support(points, source.rate),
        drifts=drifts(points, found(points, source.rate)),
        pop=worst_pop(rotations),
        sunk=max(-float(points[..., 2].min()), 0.0),
        names=tuple(source.names[i] for i in ordered),
    )


def foot_points_of(source: SourceMotion, parts: Parts) -> Array:
    """Ankle, ball and toe tip of right and left foot (F, 2, 3, 3), metres, z up, each at height 0 where it stands.

    A file's joints lie within the feet, so that what stands is known by its low speed, not by the floor. A foot without
    toes has its last point twice.
    """
    body, _ = align(source, parts, 1.0)
    _, metres, _ = guess_unit(leg_length(body))
    places, _ = source.world()
    lift = between(upward(parts, places), _UP)
    points = metres * rotate(lift, places[:, [_joints_of_foot(parts, side) for side in SIDES]])
    speed = speeds(points, source.rate)
    for foot in range(2):
        for point in range(3):
            heights = points[:, foot, point, 2]
            stands = speed[:, foot, point] < _STILL
            heights -= np.median(heights[stands]) if stands.any() else heights.min()
    return points


def _joints_of_foot(parts: Parts, side: str) -> list[int]:
    ankle = parts.limbs[f"{side}_foot"]
    ball = parts.limbs.get(f"{side}_toe", parts.tips.get(f"{side}_foot", ankle))
    return [ankle, ball, parts.tips.get(f"{side}_toe", ball)]


def _below(source: SourceMotion, joints: list[int]) -> set[int]:
    """All joints that hang on some, those left out."""
    below: set[int] = set()
    for joint, parent in enumerate(source.parents):  # parents stand before their children
        if parent in joints or parent in below:
            below.add(joint)
    return below
