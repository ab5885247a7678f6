"""One human to model: skeleton, bind pose, and the choices of build, clothes and colours."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_rotation_vector, multiply, rotate, to_matrix
from ahmss.body.skeleton import Skeleton

__all__ = ["Bind", "Figure"]

_ARM_OUT, _ELBOW, _LEG_OUT = 31.0, 12.0, 4.5  # degrees away from upright
_SPREAD = {"index": 6.0, "middle": 0.5, "ring": -5.5, "little": -12.0}  # towards the thumb
_FLEX = (12.0, 16.0, 10.0)


@dataclass(frozen=True)
class Bind:
    """The pose in which a body is modelled: places (43, 3) and world rotations (43, 4) of its links."""

    places: Array
    rotations: Array

    @classmethod
    def of(cls, skeleton: Skeleton) -> Bind:
        """Upright with arms and legs held out a little and the fingers apart, so that nothing grows together."""
        rotations, root = skeleton.upright()
        for side, sign in (("right", -1.0), ("left", 1.0)):
            for link, turn in _turns(side, sign).items():
                rotations[INDEX[link]] = multiply(rotations[INDEX[link]], turn)
        places, world = forward(rotations, root, skeleton.offsets)
        places[:, 2] += root[2] - _standing(skeleton, places, world)
        return cls(places, world)

    def place(self, link: str) -> Array:
        """Where a link's joint is (3,)."""
        return self.places[INDEX[link]]

    def matrix(self, link: str) -> Array:
        """A link's axes as columns (3, 3)."""
        return to_matrix(self.rotations[INDEX[link]])

    def at(self, link: str, local: Array) -> Array:
        """A point (3,) of a link's frame in the bind pose."""
        return self.places[INDEX[link]] + rotate(self.rotations[INDEX[link]], np.asarray(local, float))

    def frames(self) -> Array:
        """World link frames as 4x4 matrices (43, 4, 4)."""
        out = np.tile(np.eye(4), (len(self.places), 1, 1))
        out[:, :3, :3] = to_matrix(self.rotations)
        out[:, :3, 3] = self.places
        return out


def _standing(skeleton: Skeleton, places: Array, world: Array) -> float:
    """How high the hips would be with the lowest of the soles on the floor, less the root given."""
    foot = INDEX["right_foot"]
    lowest = float((places[foot] + rotate(world[foot], skeleton.soles))[:, 2].min())
    return float(places[0, 2]) + lowest


def _degrees(x: float, y: float, z: float, sign: float) -> Array:
    """A turn by a rotation vector in degrees as for the right side; mirrored for the left."""
    return from_rotation_vector(np.radians([-sign * x, y, -sign * z]))


def _turns(side: str, sign: float) -> dict[str, Array]:
    """What the bind pose adds to upright on one side."""
    turns = {
        f"{side}_lower_arm": _degrees(0, _ELBOW, 0, sign),
    }
    # Arms and legs turn about the front-back axis: z of an arm points back, z of a leg points forward.
    turns[f"{side}_upper_arm"] = from_rotation_vector(np.radians([0.0, 0.0, -sign * _ARM_OUT]))
    turns[f"{side}_upper_leg"] = from_rotation_vector(np.radians([0.0, 0.0, sign * _LEG_OUT]))
    turns[f"{side}_foot"] = from_rotation_vector(np.radians([-sign * _LEG_OUT, 0.0, 0.0]))
    for finger, spread in _SPREAD.items():
        for i, segment in enumerate(("proximal", "intermediate", "distal")):
            flex = _degrees(0, 0, -_FLEX[i], sign)
            turns[f"{side}_{finger}_{segment}"] = multiply(_degrees(0, spread, 0, sign), flex) if i == 0 else flex
    thumb = multiply(_degrees(0, 40, 0, sign), _degrees(0, 0, -16, sign))
    turns[f"{side}_thumb_proximal"] = multiply(thumb, _degrees(-52, 0, 0, sign))
    turns[f"{side}_thumb_distal"] = _degrees(0, 0, -14, sign)
    return turns


@dataclass(frozen=True)
class Figure:
    """What one human looks like; every part of the model reads it."""

    skeleton: Skeleton
    trunk: Array  # (n, 4) height, half width, front, back in shares of stature
    limb: float  # girth of the limbs against ken's
    neck: tuple[float, float]  # radii under the jaw and at the collar, metres
    colours: dict[str, tuple[int, int, int]]
    long_sleeves: bool
    sentence: str
    bind: Bind = field(init=False)

    def __post_init__(self) -> None:
        """Pose the skeleton."""
        object.__setattr__(self, "bind", Bind.of(self.skeleton))

    @property
    def height(self) -> float:
        """Stature in metres."""
        return self.skeleton.stature

    @property
    def female(self) -> bool:
        """Whether the build is a woman's."""
        return self.skeleton.sex == "female"
