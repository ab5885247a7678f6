"""How a human stands, and how trunk and hips move over planted feet: turned, leant and lowered, the weight kept.

Leaning is shared by hips and waist, a turn goes more to the waist; the hips go back as the trunk goes forward, so that
the weight stays over the feet, and the knees give what is lowered.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.inverse import LEFT_FOOT, RIGHT_FOOT, solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import align, conjugate, from_axis_angle, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.planting import feet, plant, stance

__all__ = ["Posture", "Standing", "centre_of_mass", "support"]

_SPINE = INDEX["spine"]
_UP = np.array([0.0, 0.0, 1.0])
_NEARLY_UPRIGHT = np.radians(6.0), 0.06  # radians, metres: who stands so is not straightened
_TURN_OF_HIPS, _LEAN_OF_HIPS = 0.35, 0.5  # shares of the trunk's turn and lean
_STRETCHED = 0.997  # of the leg's length at the most
_HEEL, _BALL = 0.3, 0.85  # of the way from heel to ball, where the weight may be
_ASIDE = 0.55  # of half the way between the feet
_PASSES = 2


@dataclass(frozen=True, eq=False)
class Posture:
    """Whole poses: rotations (..., 43, 4) and root (..., 3)."""

    rotations: Array
    root: Array


@dataclass(frozen=True, eq=False)
class Standing:
    """A human on both feet.

    feet (2, 7): where they are planted, world. heading: radians. base: the posture from which it leans.
    """

    skeleton: Skeleton
    feet: Array
    heading: float
    base: Posture

    @classmethod
    def of(cls, skeleton: Skeleton, rotations: Array, root: Array) -> Standing | None:
        """From a pose (43, 4), (3,); None where the weight is not over the feet, or these are not on the floor."""
        planted = feet(skeleton, rotations, root)
        ankle = float(-skeleton.soles[0, 2])
        if planted[:, 2].max() > 2.0 * ankle:
            return None
        heading = float(stance(planted)[1])
        centre = centre_of_mass(skeleton, rotations, root)
        lows, highs = support(skeleton, planted, heading, (0.0, 1.0), 1.0)
        place = _level(centre, heading)
        if (place < lows - 0.02).any() or (place > highs + 0.02).any():
            return None
        return cls(skeleton, planted, heading, _base(skeleton, planted, rotations, root))

    def postures(self, turn: Array, lean: Array, toward: Array, drop: Array, load: Array) -> Posture:
        """Postures (n): the trunk turned to the left, then leant towards a direction, the hips lowered.

        Args:
            turn: (n,) radians. lean: (n,) radians from upright. toward: (n,) direction of the lean in the world,
                radians. drop: (n,) metres by which the knees give.
            load: (3,) kilograms times metres by which a reaching arm's weight lies elsewhere than in the base pose.
        """
        made = self.sketched(turn, lean, toward, drop, load)
        return Posture(self.on_feet(made.rotations, made.root), made.root)

    def sketched(self, turn: Array, lean: Array, toward: Array, drop: Array, load: Array) -> Posture:
        """The same sooner, the legs a little off the planted feet: by what the hips were last moved."""
        n = len(turn)
        rotations = np.repeat(self.base.rotations[None], n, axis=0)
        axis = np.stack([-np.sin(toward), np.cos(toward), np.zeros(n)], axis=-1)
        hips, spine = rotations[:, 0], rotations[:, _SPINE]
        pelvis = _leant(axis, _LEAN_OF_HIPS * lean, _TURN_OF_HIPS * turn, hips)
        trunk = multiply(_leant(axis, lean, turn, hips), spine)
        rotations[:, _SPINE] = align(multiply(conjugate(pelvis), trunk), spine)
        rotations[:, 0] = align(pelvis, hips)
        root = np.repeat(self.base.root[None], n, axis=0)
        root[:, 2] -= drop
        lows, highs = support(self.skeleton, self.feet, self.heading, (_HEEL, _BALL), _ASIDE)
        ahead = np.array([np.cos(self.heading), np.sin(self.heading)])
        for _ in range(_PASSES):
            root[:, 2] = np.minimum(root[:, 2], self._highest(rotations, root) - drop)
            rotations = self.on_feet(rotations, root)
            centre = centre_of_mass(self.skeleton, rotations, root) + load / self.skeleton.mass.sum()
            place = _level(centre, self.heading)
            off = np.clip(place, lows, highs) - place
            root[:, :2] += 1.15 * (off[:, :1] * ahead + off[:, 1:] * np.array([-ahead[1], ahead[0]]))
        root[:, 2] = np.minimum(root[:, 2], self._highest(rotations, root) - drop)
        return Posture(rotations, root)

    def on_feet(self, rotations: Array, root: Array) -> Array:
        """Poses (..., 43, 4) whose legs come to the planted feet."""
        targets = np.zeros((*root.shape[:-1], 5, 8))
        targets[..., RIGHT_FOOT : LEFT_FOOT + 1, :7] = self.feet
        targets[..., RIGHT_FOOT : LEFT_FOOT + 1, 7] = 1.0
        return solve(self.skeleton, rotations, root, targets)

    def _highest(self, rotations: Array, root: Array) -> Array:
        """How high (n,) the root may be for both legs to reach the floor; not above the base's height."""
        highest = np.full(len(root), self.base.root[2])
        for row, side in enumerate(("right", "left")):
            first = INDEX[f"{side}_upper_leg"]
            hip = rotate(rotations[:, 0], self.skeleton.offsets[first])
            leg = np.linalg.norm(self.skeleton.offsets[first + 1 : first + 3], axis=-1).sum()
            off = root[:, :2] + hip[:, :2] - self.feet[row, :2]
            upright = np.sqrt(np.maximum((_STRETCHED * leg) ** 2 - (off**2).sum(axis=-1), 0.0))
            highest = np.minimum(highest, self.feet[row, 2] + upright - hip[:, 2])
        return highest


def centre_of_mass(skeleton: Skeleton, rotations: Array, root: Array) -> Array:
    """The centre of mass (..., 3) of poses (..., 43, 4), each link's mass in its middle, metres."""
    places, turned = forward(rotations, root, skeleton.offsets)
    middles = places + rotate(turned, 0.5 * skeleton.tips)
    return np.einsum("l,...lc->...c", skeleton.mass / skeleton.mass.sum(), middles)


def support(
    skeleton: Skeleton, planted: Array, heading: float, along: tuple[float, float], aside: float
) -> tuple[Array, Array]:
    """The lowest and highest place (2,), ahead and to the left, where the weight may be over the feet (2, 7).

    Args:
        skeleton: whose feet. planted: where. heading: the stance's, radians.
        along: shares of the way from heel to ball. aside: share of half the way between the feet.
    """
    soles = skeleton.soles * np.array([1.0, 0.0, 1.0])  # the middle of either foot
    points = planted[:, None, :3] + rotate(planted[:, None, 3:7], soles[None])
    level = _level(points, heading)
    heel, ball = level[:, 0, 0].mean(), level[:, 1, 0].mean()
    low, high = level[:, 0, 1].min(), level[:, 0, 1].max()
    middle, half = 0.5 * (low + high), 0.5 * (high - low)
    return (
        np.array([heel + along[0] * (ball - heel), middle - aside * half]),
        np.array([heel + along[1] * (ball - heel), middle + aside * half]),
    )


def _base(skeleton: Skeleton, planted: Array, rotations: Array, root: Array) -> Posture:
    """The present posture where it is nearly upright, else the trunk straightened over the feet."""
    upright, _ = skeleton.upright()
    own = rotations.copy()
    own[0], own[_SPINE] = upright[0], upright[_SPINE]
    own[_LEGS] = upright[_LEGS]
    straight, above = plant(skeleton, own, planted)
    tilts = [_tilt(rotations[0]), _tilt(multiply(rotations[0], rotations[_SPINE]))]
    if max(tilts) < _NEARLY_UPRIGHT[0] and np.linalg.norm(above - root) < _NEARLY_UPRIGHT[1]:
        return Posture(rotations, root)
    straight[_LEGS] = rotations[_LEGS]
    straight[0] = align(straight[0], rotations[0])
    straight[_SPINE] = align(straight[_SPINE], rotations[_SPINE])
    return Posture(straight, above)


_LEGS = list(range(INDEX["right_upper_leg"], INDEX["right_foot"] + 1)) + list(
    range(INDEX["left_upper_leg"], INDEX["left_foot"] + 1)
)


def _tilt(q_world_link: Array) -> float:
    """How far a trunk link's x axis is from upright, radians."""
    return float(np.arccos(np.clip(rotate(q_world_link, np.array([1.0, 0.0, 0.0]))[2], -1.0, 1.0)))


def _leant(axis: Array, lean: Array, turn: Array, q_world_link: Array) -> Array:
    return multiply(from_axis_angle(axis, lean), multiply(from_axis_angle(_UP, turn), q_world_link))


def _level(points: Array, heading: float) -> Array:
    """Places (..., 3) as ahead and to the left (..., 2) of a heading."""
    cos, sin = np.cos(heading), np.sin(heading)
    return np.stack([points[..., 0] * cos + points[..., 1] * sin, points[..., 1] * cos - points[..., 0] * sin], -1)
