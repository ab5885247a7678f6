"""How smooth the motion of a recording is, by the measures of real capture."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.motion.quality import measure
from ahmss.world.recording import Reader
from ahmss.world.view import World

__all__ = ["judge", "motion_of"]


def motion_of(reader: Reader, human: str) -> tuple[Array, Array, Skeleton]:
    """A human's rotations (frames, 43, 4) and root (frames, 3) over all ticks in which its frame is a new one."""
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
    assert skeleton is not None
    return np.array(rotations), np.array(roots), skeleton


def judge(path: Path) -> list[str]:
    """One line for each human of a recording."""
    lines: list[str] = []
    with Reader(path) as reader:
        names = {human.name for tick in range(len(reader)) for human in reader.scene(tick).humans}
        for name in sorted(names):
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
