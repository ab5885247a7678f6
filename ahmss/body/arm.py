"""One arm as appendix B sees it, seven angles, and as our skeleton does, three links (Ichiguchi 2000, B.1).

The shoulder frame is the upper arm's link frame as it hangs in the upright pose, fixed to the spine. A wrist pose is
the hand link's place and rotation in that frame. `links` are the rotations of upper arm, forearm and hand, each
parent <- child, the first against the shoulder frame: the identity in the upright arm, whose seven angles are 0.

Appendix B gives the forearm no turn of its own. Ours takes all of the hand's turn about the forearm, and the hand only
bends: the same wrist pose, and joints that a person has.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.body.arm_cases import shoulder_angles, wrist_angles
from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, norm, normalize, rotate, to_matrix
from ahmss.body.skeleton import LINK_ARM, Skeleton
from ahmss.errors import DataError

__all__ = [
    "Arm",
    "Wrist",
    "angles_of",
    "excess",
    "hand_angles",
    "into_arm",
    "links_of",
    "split_wrist",
    "with_hand",
    "wrist_of",
]

_ABOUT_X, _ABOUT_Y, _ABOUT_Z = rotate(LINK_ARM, np.eye(3))  # the arm's axes in our links
_AXES = (_ABOUT_Z, _ABOUT_X, _ABOUT_Z, _ABOUT_Y, _ABOUT_Y, _ABOUT_X, _ABOUT_Z)  # of the seven joints
_ALONG = np.array([1.0, 0.0, 0.0])  # of our links


@dataclass(frozen=True, eq=False)  # arrays have no one truth value: an arm is itself
class Arm:
    """One arm's fixed measures, in metres and radians.

    lengths (2,): L1 and L2, upper arm and forearm. limits (3, 3, 2): upper arm, forearm and hand; lowest and highest
    angle about the link's x, y, z. Each holds 0. place (3,) and rotation (4,): the shoulder frame in the spine's.
    """

    lengths: Array
    limits: Array
    place: Array
    rotation: Array

    @classmethod
    def of(cls, skeleton: Skeleton, side: str) -> Arm:
        """The "right" or "left" arm of a skeleton.

        Raises:
            DataError: elbow or wrist does not lie on the x axis of the link before it.
        """
        first = INDEX[f"{side}_upper_arm"]
        bones = skeleton.offsets[first + 1 : first + 3]
        for name, bone in zip(("lower_arm", "hand"), bones, strict=True):
            if bone[0] <= 0.0 or np.abs(bone[1:]).max() > 1e-9:
                offset = bone.tolist()
                raise DataError(skeleton.name, f"links.{side}_{name}.offset", f"{offset}; an arm's is [length, 0, 0]")
        upright, _ = skeleton.upright()
        limits = skeleton.limits[first : first + 3]
        return cls(bones[:, 0].copy(), np.array(limits), skeleton.offsets[first].copy(), upright[first])

    def seen(self, place: Array, rotation: Array, spine: tuple[Array, Array]) -> Wrist:
        """A hand link's pose in the world, (..., 3) and (..., 4), as the wrist pose of a human whose spine is there.

        Args:
            place: metres, world.
            rotation: world <- hand.
            spine: the spine link's place (..., 3) and rotation (..., 4) in the world.
        """
        q_world_shoulder = multiply(spine[1], self.rotation)
        shoulder = spine[0] + rotate(spine[1], self.place)
        q = conjugate(q_world_shoulder)
        return Wrist(rotate(q, place - shoulder), multiply(q, rotation))

    def from_pose(self, rows: Array) -> Array:
        """The links (..., 3, 4) of a pose's rows for upper arm, forearm and hand (..., 3, 4)."""
        links = rows.copy()
        links[..., 0, :] = multiply(conjugate(self.rotation), rows[..., 0, :])
        return links

    def into_pose(self, links: Array) -> Array:
        """A pose's rows, parent <- child, for upper arm, forearm and hand (..., 3, 4): the inverse of `from_pose`."""
        rows = links.copy()
        rows[..., 0, :] = multiply(self.rotation, links[..., 0, :])
        return rows


@dataclass(frozen=True, eq=False)
class Wrist:
    """Wrist poses: the hand link's place (..., 3), metres, and rotation (..., 4), in the shoulder frame."""

    place: Array
    rotation: Array


def links_of(angles: Array) -> Array:
    """The links (..., 3, 4) of the seven angles (..., 7), radians: (B.1) to (B.7) in our axes."""
    q = [from_axis_angle(axis, angles[..., i]) for i, axis in enumerate(_AXES)]
    upper = multiply(multiply(q[0], q[1]), q[2])
    turn, hand = split_wrist(multiply(multiply(q[4], q[5]), q[6]))
    return np.stack([upper, multiply(q[3], turn), hand], axis=-2)


def angles_of(links: Array) -> Array:
    """The seven angles (..., 7), radians, of links (..., 3, 4), theta_2 >= 0 and theta_6 within a right angle.

    What an elbow bends sideways counts as the wrist's: the hand keeps its rotation.
    """
    upper, lower, hand = (links[..., i, :] for i in range(3))
    forearm = rotate(lower, _ALONG)
    theta_4 = np.arctan2(-forearm[..., 2], forearm[..., 0])
    wrist = multiply(multiply(from_axis_angle(_ABOUT_Y, -theta_4), lower), hand)
    shoulder = [theta[..., 0] for theta in shoulder_angles(into_arm(upper))]
    return np.stack([*shoulder, theta_4, *(theta[..., 0] for theta in wrist_angles(into_arm(wrist)))], axis=-1)


def into_arm(rotation: Array) -> Array:
    """Rotations (..., 4) between our axes as matrices (..., 3, 3) between appendix B's."""
    return to_matrix(multiply(multiply(conjugate(LINK_ARM), rotation), LINK_ARM))


def wrist_of(arm: Arm, links: Array) -> Wrist:
    """Where links (..., 3, 4) bring the wrist: (B.8)."""
    upper, lower, hand = (links[..., i, :] for i in range(3))
    forearm = multiply(upper, lower)
    L1, L2 = arm.lengths
    place = L1 * rotate(upper, _ALONG) + L2 * rotate(forearm, _ALONG)
    return Wrist(place, multiply(forearm, hand))


def split_wrist(rotation: Array) -> tuple[Array, Array]:
    """Rotations (..., 4) of the hand against the forearm's bone as the forearm's turn, then the hand's bend."""
    turn = rotation * np.array([1.0, 1.0, 0.0, 0.0])
    turn = np.where(turn[..., :1] < 0.0, -turn, turn)
    size = np.sqrt(norm(turn))[..., None]
    turn = np.where(size < 1e-12, np.array([1.0, 0.0, 0.0, 0.0]), turn / np.maximum(size, 1e-12))
    return turn, multiply(conjugate(turn), rotation)


def excess(arm: Arm, links: Array) -> Array:
    """By how many radians links (..., 3, 4) are turned beyond the limits at the most; 0 within them.

    Upper arm and hand are measured, axis by axis, by `2 arctan(q_i / q_w)`, the forearm by its bend and then its turn.
    The rotation vector's components, in which a skeleton states its limits, are never larger: who is within these
    limits is within those. About one axis alone both are the same; where several are far turned at once these are
    narrower, as a joint is.
    """
    q = np.where(links[..., :1] < 0.0, -links, links)
    measured = 2.0 * np.arctan2(q[..., 1:], q[..., :1])
    lower = links[..., 1, :]
    forearm = rotate(lower, _ALONG)
    measured[..., 1, 1] = np.arctan2(-forearm[..., 2], forearm[..., 0])
    measured[..., 1, 2] = np.arcsin(np.clip(forearm[..., 1], -1.0, 1.0))
    turn, _ = split_wrist(lower)
    measured[..., 1, 0] = 2.0 * np.arctan2(turn[..., 1], turn[..., 0])
    low, high = arm.limits[..., 0], arm.limits[..., 1]
    return np.maximum(np.maximum(low - measured, measured - high), 0.0).max(axis=(-2, -1))


def hand_angles(links: Array) -> Array:
    """The forearm's turn and the hand's bend about y and z (..., 3) of links (..., 3, 4), radians, as in `excess`."""
    turn, _ = split_wrist(links[..., 1, :])
    hand = np.where(links[..., 2, :1] < 0.0, -links[..., 2, :], links[..., 2, :])
    bent = np.arctan2(hand[..., 2:], hand[..., :1])
    return 2.0 * np.concatenate([np.arctan2(turn[..., 1:2], turn[..., :1]), bent], axis=-1)


def with_hand(links: Array, angles: Array) -> Array:
    """Links (..., 3, 4) with these `hand_angles` (..., 3), within half a turn; shoulder, elbow and wrist stay."""
    out = links.copy()
    turn, _ = split_wrist(links[..., 1, :])
    bend = multiply(links[..., 1, :], conjugate(turn))
    out[..., 1, :] = multiply(bend, from_axis_angle(_ALONG, angles[..., 0]))
    hand = np.zeros_like(out[..., 2, :])
    hand[..., 0] = 1.0
    hand[..., 2:] = np.tan(0.5 * angles[..., 1:])
    out[..., 2, :] = normalize(hand)
    return out
