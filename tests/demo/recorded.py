"""A recording of one human as arrays, and what there is to measure on it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ahmss.algorithm import Transform
from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import normalize, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.world.recording import Reader
from ahmss.world.view import World


@dataclass(frozen=True)
class Recorded:
    """Frames from the human's first on: root (F, 3), rotations (F, 43, 4), objects' poses (F, 7) and their holders."""

    skeleton: Skeleton
    rate: float
    root: Array
    rotations: Array
    objects: dict[str, Array]
    holders: dict[str, tuple[str, ...]]

    @classmethod
    def read(cls, path: Path, human: str, objects: tuple[str, ...]) -> Recorded:
        world, roots, rotations = World(), [], []
        poses: dict[str, list[Array]] = {name: [] for name in objects}
        holders: dict[str, list[str]] = {name: [] for name in objects}
        with Reader(path) as reader:
            for tick in range(len(reader)):
                reader.show(tick, world)
                if human not in world.humans or not set(objects) <= set(world.objects):
                    continue
                root, turned = world.human(human)
                roots.append(root)
                rotations.append(turned)
                for name in objects:
                    poses[name].append(world.pose(name))
                    holders[name].append(world.objects[name].holder or "")
            skeleton = Skeleton.from_record(reader.skeleton(world.humans[human]))
            rate = reader.rate
        return cls(
            skeleton, rate, np.array(roots), normalize(np.array(rotations)),
            {name: np.array(rows) for name, rows in poses.items()},
            {name: tuple(names) for name, names in holders.items()},
        )  # fmt: skip

    @property
    def links(self) -> tuple[Array, Array]:
        """Places (F, 43, 3) and world rotations (F, 43, 4)."""
        return forward(self.rotations, self.root, self.skeleton.offsets)

    def arm(self, side: int) -> tuple[Array, Array, Array]:
        """The right (0) or left (1) arm at each frame, degrees: the elbow, the upper arm from hanging, the wrist."""
        first = INDEX[f"{('right', 'left')[side]}_upper_arm"]
        upper, fore, hand = np.moveaxis(rotate(self.links[1][:, first : first + 3], np.array([1.0, 0.0, 0.0])), 1, 0)
        elbow, wrist = ((a * b).sum(axis=-1) for a, b in ((upper, fore), (fore, hand)))
        bent = np.degrees(np.arccos(np.clip([elbow, -upper[:, 2], wrist], -1.0, 1.0)))
        return bent[0], bent[1], bent[2]

    def grip(self, side: int) -> Transform:
        """The right (0) or left (1) palm's frame at each frame."""
        return Transform.of(grips(self.skeleton, self.rotations, self.root)[:, side])

    def object(self, name: str) -> Transform:
        """An object's frame at each frame."""
        return Transform.of(self.objects[name])
