"""A motion as its file has it: joints of any number and naming, before it is given to one of our humans."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import IDENTITY, conjugate, multiply, rotate, to_rotation_vector

__all__ = ["SourceMotion"]

_AWAY, _SEVERAL = 15.0, 4  # degrees of a step; joints that make it


@dataclass(frozen=True, eq=False)
class SourceMotion:
    """Joints and what they do, in the file's own units, axes and zero pose.

    names (J,) and parents (J,), -1 for a root; parents stand before their children. Ends of chains are joints too, with
    their parent's name and "_end". offsets (J, 3): each joint in its parent's frame when nothing moves. rotations
    (F, J, 4) unit quaternions, parent <- child. translations (F, J, 3): the offsets, or what the file has instead.
    """

    file: Path
    format: str
    names: tuple[str, ...]
    parents: tuple[int, ...]
    offsets: Array
    rotations: Array
    translations: Array
    rate: float

    @property
    def frames(self) -> int:
        """How many frames there are."""
        return int(self.rotations.shape[0])

    def world(self) -> tuple[Array, Array]:
        """Places (F, J, 3) and rotations (F, J, 4), world <- joint, of all joints."""
        return _chain(self.parents, self.rotations, self.translations)

    def since(self, frame: int) -> SourceMotion:
        """The motion from a frame on."""
        return replace(self, rotations=self.rotations[frame:], translations=self.translations[frame:])

    def begins_apart(self) -> bool:
        """Whether frame 0 is a pose by itself, far from a frame 1 that goes on smoothly, as CMU's BVH files begin."""
        if self.frames < 3:
            return False
        steps = multiply(conjugate(self.rotations[:2]), self.rotations[1:3])
        turned = np.degrees(np.linalg.norm(to_rotation_vector(steps), axis=-1))
        return bool((turned[0] > _AWAY).sum() >= _SEVERAL and turned[1].max() < 0.25 * _AWAY)

    def zero_pose(self) -> Array:
        """Places (J, 3) of the joints when every rotation is zero, the root at the origin."""
        rotations = np.tile(IDENTITY, (1, len(self.names), 1))
        translations = self.offsets[None].copy()
        translations[:, [parent < 0 for parent in self.parents]] = 0.0
        return _chain(self.parents, rotations, translations)[0][0]


def _chain(parents: tuple[int, ...], rotations: Array, translations: Array) -> tuple[Array, Array]:
    """Forward kinematics of any tree of joints."""
    places, world = translations.copy(), rotations.copy()
    for joint, parent in enumerate(parents):
        if parent >= 0:
            places[:, joint] = places[:, parent] + rotate(world[:, parent], translations[:, joint])
            world[:, joint] = multiply(world[:, parent], rotations[:, joint])
    return places, world
