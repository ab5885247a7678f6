"""What the humans of a recording did, and how it measures beside real capture."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import normalize
from ahmss.body.skeleton import Skeleton
from ahmss.errors import DataError
from ahmss.motion.quality import measure
from ahmss.world.recording import Reader
from ahmss.world.view import World

__all__ = ["judge", "motion_of", "posed"]


def posed(reader: Reader) -> list[str]:
    """The names of all humans that ever have a pose, in alphabetical order."""
    world, names = World(), set[str]()
    for tick in range(len(reader)):
        reader.show(tick, world)
        shown = set(world.human_ids.tolist())
        names |= {record.name for record in world.humans.values() if record.id in shown}
    return sorted(names)


def motion_of(reader: Reader, human: str) -> tuple[Array, Array, Skeleton]:
    """A human's rotations (frames, 43, 4) and root (frames, 3) over all ticks in which its frame is a new one.

    Raises:
        DataError: it never has a pose.
    """
    world = World()
    rotations: list[Array] = []
    roots: list[Array] = []
    last = -1
    skeleton: Skeleton | None = None
    for tick in range(len(reader)):
        reader.show(tick, world)
        record = world.humans.get(human)
        row = np.flatnonzero(world.human_ids == record.id) if record is not None else []
        if record is None or not len(row) or int(world.human_frames[row[0]]) == last:
            continue
        last = int(world.human_frames[row[0]])
        skeleton = skeleton or Skeleton.from_record(reader.skeleton(record))
        root, turned = world.human(human)
        roots.append(root)
        rotations.append(turned)
    if skeleton is None:
        raise DataError(reader.path, human, "there is no pose of this human in the recording")
    return normalize(np.array(rotations)), np.array(roots), skeleton


def judge(path: Path) -> list[str]:
    """One line for each human of a recording."""
    lines: list[str] = []
    with Reader(path) as reader:
        for name in posed(reader):
            rotations, root, skeleton = motion_of(reader, name)
            if len(root) < 3:
                continue
            quality = measure(rotations, root, reader.rate, skeleton)
            lines.append(
                f"{name}: {len(root)} frames; joint acceleration p99 {quality.joints.acceleration_p99:.0f}, max "
                f"{quality.joints.acceleration_max:.0f} rad/s2; largest pop {quality.pop.degrees:.2f} degrees "
                f"({quality.names[quality.pop.joint]}, frame {quality.pop.frame})"
            )
    return lines
