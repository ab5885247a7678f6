"""One human's skeleton: lengths, masses, limits, grips, and the upright pose (Ichiguchi 2000, table 5.3).

Link frames have x along the link to the next joint. Table 5.3, read literally, points every link but the feet
backwards against appendix A; the printed quaternion times (0, 0, 1, 0), half a turn about the link's own y, mends all.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS, PARENTS
from ahmss.body.quaternion import conjugate, from_rotation_vector, multiply, normalize, rotate

__all__ = ["LINK_ARM", "UPRIGHT_WORLD", "Skeleton", "mirror"]

_H = np.sqrt(0.5)
_HALF_TURN_Y = np.array([0.0, 0.0, 1.0, 0.0])
_PRINTED = {  # table 5.3, world -> link
    "torso": np.array([_H, 0.0, _H, 0.0]),
    "right_arm": np.array([0.0, _H, 0.0, _H]),
    "left_arm": np.array([0.0, -_H, 0.0, -_H]),
    "leg": np.array([_H, 0.0, -_H, 0.0]),
}


def _upright_world() -> Array:
    """World rotations (43, 4) of the upright pose, heading 0; the fingers lie straight along the hand."""
    world = np.empty((len(LINKS), 4))
    for i, name in enumerate(LINKS):
        if name in ("hips", "spine", "head"):
            world[i] = multiply(_PRINTED["torso"], _HALF_TURN_Y)
        elif name.endswith("_foot"):
            world[i] = (1.0, 0.0, 0.0, 0.0)
        elif name.endswith("_leg"):
            world[i] = multiply(_PRINTED["leg"], _HALF_TURN_Y)
        else:
            world[i] = multiply(_PRINTED["right_arm" if name.startswith("right") else "left_arm"], _HALF_TURN_Y)
    # One sign for all: w >= 0 where it is not 0, else x > 0 (the table's left arm is the right arm's negative).
    negative = (world[:, 0] < -1e-9) | ((np.abs(world[:, 0]) < 1e-9) & (world[:, 1] < 0.0))
    world[negative] *= -1.0
    return world


UPRIGHT_WORLD: Array = _upright_world()

LINK_ARM: Array = np.array([_H, 0.0, _H, 0.0])
"""The turn, link <- arm, between appendix B's arm, which lies along z and bends about y, and our links, along x."""


def _relaxed() -> dict[str, tuple[float, float, float]]:
    """What turns the right side from upright to relaxed, rotation vectors in degrees; x and z mirror to the left."""
    curl = {"proximal": 20.0, "intermediate": 28.0, "distal": 14.0}
    pose = {"upper_arm": (-4.0, 0.0, 6.0), "lower_arm": (0.0, 14.0, 0.0), "hand": (0.0, 0.0, -4.0)}
    for i, finger in enumerate(("index", "middle", "ring", "little")):
        pose |= {f"{finger}_{segment}": (0.0, 0.0, -(angle + 3.0 * i)) for segment, angle in curl.items()}
    return pose | {"thumb_proximal": (-45.0, 28.0, -20.0), "thumb_distal": (0.0, 0.0, -12.0)}


_RELAXED = _relaxed()


@dataclass(frozen=True, eq=False)  # arrays have no one truth value: a skeleton is itself
class Skeleton:
    """One human's fixed measures, in metres, kilograms and radians.

    offsets (43, 3): each joint in its parent's frame. tips (43, 3): the end of each link in its own frame.
    mass (43,). radii (43,): the skin's mean radius around each link. limits (43, 3, 2): lowest and highest
    rotation-vector component about the link's x, y, z, from upright. grips (2, 7): right and left palm frame in the
    hand's frame, place and rotation (x out of the palm, z to the thumb). soles (3, 3): heel, ball and toe tip in the
    right foot's frame (the left's have y negated). eye (3,): in the head's frame, between the eyes.
    """

    name: str
    stature: float
    sex: str
    offsets: Array
    tips: Array
    mass: Array
    radii: Array
    limits: Array
    grips: Array
    soles: Array
    eye: Array

    @classmethod
    def of(cls, stature: float = 1.70, sex: str = "male", name: str = "human") -> Skeleton:
        """A skeleton of usual proportions for a stature in metres (Drillis & Contini; masses of de Leva 1996)."""
        from ahmss.body.proportions import measure

        return measure(stature, sex, name)

    def upright(self) -> tuple[Array, Array]:
        """The upright pose, heading 0, soles on z = 0 under the origin: rotations (43, 4) and root (3,)."""
        parents = np.array(PARENTS[1:])
        rotations = UPRIGHT_WORLD.copy()
        rotations[1:] = normalize(multiply(conjugate(UPRIGHT_WORLD[parents]), UPRIGHT_WORLD[1:]))
        places, world = forward(rotations, np.zeros(3), self.offsets)
        foot = INDEX["right_foot"]
        sole = places[foot] + rotate(world[foot], self.soles)
        return rotations, np.array([0.0, 0.0, -float(sole[:, 2].min())])

    def relaxed(self) -> tuple[Array, Array]:
        """A person who just stands, heading 0: upright, the arms hanging a little open and bent, the fingers curled."""
        rotations, root = self.upright()
        for name, degrees in _RELAXED.items():
            vector = np.radians(degrees)
            right, left = INDEX[f"right_{name}"], INDEX[f"left_{name}"]
            rotations[right] = multiply(rotations[right], from_rotation_vector(vector))
            rotations[left] = multiply(rotations[left], from_rotation_vector(vector * (-1.0, 1.0, -1.0)))
        return rotations, root

    def to_record(self) -> dict[str, Any]:
        """Plain JSON types, for START and for the world."""
        arrays = ("offsets", "tips", "mass", "radii", "limits", "grips", "soles", "eye")
        record: dict[str, Any] = {"name": self.name, "stature": self.stature, "sex": self.sex}
        return record | {key: getattr(self, key).tolist() for key in arrays}

    @classmethod
    def from_record(cls, record: dict[str, Any]) -> Skeleton:
        """The inverse of `to_record`."""
        arrays = ("offsets", "tips", "mass", "radii", "limits", "grips", "soles", "eye")
        return cls(
            name=record["name"],
            stature=record["stature"],
            sex=record["sex"],
            **{key: np.array(record[key], float) for key in arrays},
        )


def mirror(rotations: Array, root: Array) -> tuple[Array, Array]:
    """The pose seen in a mirror at the plane y = 0: right becomes left. Rotations (..., 43, 4), root (..., 3)."""
    swap = [INDEX[_other_side(name)] for name in LINKS]
    mirrored = rotations[..., swap, :] * np.array([1.0, -1.0, 1.0, -1.0])
    return mirrored, root * np.array([1.0, -1.0, 1.0])


def _other_side(name: str) -> str:
    """The name of the same link on the other side."""
    if name.startswith("right"):
        return name.replace("right", "left", 1)
    return name.replace("left", "right", 1)
