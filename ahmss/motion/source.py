"""A motion as its file has it: joints of any number and naming, before it is given to one of our humans."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import IDENTITY, multiply, rotate, to_rotation_vector

__all__ = ["SourceMotion"]

_ZERO, _AWAY = 0.01, 15.0  # degrees of any joint


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

    def starts_in_zero_pose(self) -> bool:
        """Whether frame 0 is the zero pose and frame 1 far from it: a calibration, as CMU's BVH files begin with."""
        if self.frames < 2:
            return False
        turned = np.degrees(np.linalg.norm(to_rotation_vector(self.rotations[:2]), axis=-1))
        return bool(turned[0].max() < _ZERO and turned[1].max() > _AWAY)

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
