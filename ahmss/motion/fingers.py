"""How far the fingers bend until they touch a round object (Ichiguchi 2000, 5.3.4), by the skin's radius of each link.

All in the hand's frame: x along the hand, the palm towards `palm` (-y of the right hand, +y of the left), the thumb -z.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import IDENTITY, between, conjugate, cross, from_axis_angle, multiply, rotate
from ahmss.body.skeleton import Skeleton

__all__ = ["Cylinder", "closed", "opened"]

FINGERS = ("index", "middle", "ring", "little")
SEGMENTS = ("proximal", "intermediate", "distal")
CURL = (80.0, 105.0, 70.0)  # degrees at knuckle, middle and end joint of a finger that is curled all the way
MOST = (95.0, 108.0, 80.0)  # degrees that the joints bend at most
SINK = 0.0015  # metres that the pad of a finger gives way
OPEN = (14.0, 20.0, 8.0)
THUMB_LEAST, THUMB_MOST, THUMB_BEND = 25.0, 118.0, 60.0  # degrees from along the hand; the bend back to the fingers
THUMB_RISE = np.radians(22.0)  # the opposed thumb stands out of the palm and a little towards its own side
OPENS_BY = 14.0  # degrees that the thumb goes further out when the hand opens
STEPS = 37
ALONG = np.linspace(0.0, 1.0, 9)[:, None]  # points of a link that are tried for contact
X = np.array([1.0, 0.0, 0.0])


@dataclass(frozen=True)
class Cylinder:
    """A round object as the hand sees it: a point of its axis, the axis' direction (unit), the radius, metres."""

    point: Array
    axis: Array
    radius: float

    def clearance(self, points: Array) -> Array:
        """The distance (...) of points (..., 3) from the wall, negative inside."""
        from_axis = points - self.point
        from_axis = from_axis - (from_axis @ self.axis)[..., None] * self.axis
        return np.sqrt(np.einsum("...c,...c->...", from_axis, from_axis)) - self.radius


def closed(skeleton: Skeleton, side: str, cylinder: Cylinder) -> Array:
    """Rotations (14, 4) of the fingers, in the order of links, each bent until its skin touches the wall.

    A finger curls as a whole, its joints in the proportions of a pull at the tendon, until one of its links touches;
    from there on the links beyond go on by themselves until they touch too.
    """
    rotations = np.tile(IDENTITY, (14, 1))
    first, hinge = fingers(side)[0], _hinge(side)
    for finger in FINGERS:
        links = [INDEX[f"{side}_{finger}_{segment}"] for segment in SEGMENTS]
        flexion = np.radians(np.array(CURL)) * np.linspace(0.0, 1.0, STEPS)[:, None]
        gaps = _gaps(skeleton, links, hinge, flexion, cylinder)
        bent, touching = _first_touch(flexion, gaps)
        for joint in range(touching + 1, 3):
            flexion = np.repeat(bent[None], STEPS, axis=0)
            flexion[:, joint] = np.linspace(bent[joint], np.radians(MOST[joint]), STEPS)
            gaps = _gaps(skeleton, links, hinge, flexion, cylinder)
            bent, _ = _first_touch(flexion, gaps[:, joint:] + SINK)
        rotations[np.array(links) - first] = from_axis_angle(hinge, bent)
    rotations[:2] = _thumb(skeleton, side, cylinder)
    return rotations


def _gaps(skeleton: Skeleton, links: list[int], hinge: Array, flexion: Array, cylinder: Cylinder) -> Array:
    """The least distance (n, 3) of each link's skin from the wall, for flexions (n, 3) of a finger's joints."""
    q_hand_link = np.tile(IDENTITY, (len(flexion), 1))
    place = np.zeros((len(flexion), 3))
    gaps = np.empty((len(flexion), 3))
    for i, link in enumerate(links):
        place = place + rotate(q_hand_link, skeleton.offsets[link])
        q_hand_link = multiply(q_hand_link, from_axis_angle(hinge, flexion[:, i]))
        points = place[:, None] + rotate(q_hand_link[:, None], ALONG * skeleton.tips[link])
        gaps[:, i] = cylinder.clearance(points).min(axis=1) - skeleton.radii[link]
    return gaps


def _first_touch(flexion: Array, gaps: Array) -> tuple[Array, int]:
    """The first of the flexions (n, 3) at which a gap (n, links) is closed, and which; the last where none is."""
    least = gaps.min(axis=1)
    touching = np.flatnonzero(least <= 0.0)
    if not len(touching):
        return flexion[-1] if least[-1] < least[0] else flexion[int(np.argmin(least))], 2
    i = int(touching[0])
    if i == 0:
        return flexion[0], int(gaps[0].argmin())
    share = least[i - 1] / (least[i - 1] - least[i])
    return flexion[i - 1] + share * (flexion[i] - flexion[i - 1]), int(gaps[i].argmin())


def opened(side: str, thumb: Array | None = None) -> Array:
    """Rotations (14, 4) of an open hand; the thumb (2, 4), where given, goes out from there, else stays at ease."""
    rotations = np.tile(IDENTITY, (14, 1))
    first = fingers(side)[0]
    hinge = _hinge(side)
    for finger in FINGERS:
        for segment, degrees in zip(SEGMENTS, OPEN, strict=True):
            rotations[INDEX[f"{side}_{finger}_{segment}"] - first] = from_axis_angle(hinge, np.radians(degrees))
    if thumb is None:
        rotations[0] = _thumb_at(side, np.radians(np.array([75.0])))[0]
        return rotations
    ahead = rotate(thumb[0], X)
    now = np.degrees(np.arctan2(np.hypot(ahead[1], ahead[2]), ahead[0]))
    rotations[0] = _thumb_at(side, np.radians(np.array([min(now + OPENS_BY, THUMB_MOST)])))[0]
    return rotations


def _touch(skeleton: Skeleton, link: int, place: Array, tried: Array, angles: Array, cylinder: Cylinder) -> float:
    """The first of the angles (n) at which a link at `place`, turned as tried (n, 4), touches; else the nearest."""
    points = place + rotate(tried[:, None], ALONG * skeleton.tips[link])
    gap = cylinder.clearance(points).min(axis=1) - skeleton.radii[link]
    touching = np.flatnonzero(gap <= 0.0)
    if not len(touching):
        return float(angles[np.argmin(gap)])
    i = int(touching[0])
    if i == 0:
        return float(angles[0])
    share = gap[i - 1] / (gap[i - 1] - gap[i])
    return float(angles[i - 1] + share * (angles[i] - angles[i - 1]))


def _thumb(skeleton: Skeleton, side: str, cylinder: Cylinder) -> Array:
    """The thumb's rotations (2, 4): it stands on the other side of the object and comes back until it touches."""
    proximal, distal = INDEX[f"{side}_thumb_proximal"], INDEX[f"{side}_thumb_distal"]
    angles = np.radians(np.linspace(THUMB_MOST, THUMB_LEAST, STEPS))
    place = skeleton.offsets[proximal]
    angle = _touch(skeleton, proximal, place, _thumb_at(side, angles), angles, cylinder)
    q_hand_thumb = _thumb_at(side, np.array([angle]))[0]
    place = place + rotate(q_hand_thumb, skeleton.offsets[distal])
    # The end bends about the axis about which the thumb went out, back towards the fingers.
    axis = cross(X, rotate(q_hand_thumb, X))
    axis = rotate(conjugate(q_hand_thumb), axis / np.linalg.norm(axis))
    angles = -np.radians(np.linspace(0.0, THUMB_BEND, STEPS))
    tried = multiply(q_hand_thumb, from_axis_angle(axis, angles))
    return np.stack([q_hand_thumb, from_axis_angle(axis, _touch(skeleton, distal, place, tried, angles, cylinder))])


def _thumb_at(side: str, angles: Array) -> Array:
    """Rotations (n, 4) of a thumb that stands at angles (n) from along the hand, out of the palm."""
    out = np.cos(THUMB_RISE) * _palm(side) + np.sin(THUMB_RISE) * np.array([0.0, 0.0, -1.0])
    return between(X, np.cos(angles)[:, None] * X + np.sin(angles)[:, None] * out)


def _palm(side: str) -> Array:
    return np.array([0.0, 1.0 if side == "left" else -1.0, 0.0])


def _hinge(side: str) -> Array:
    """The axis about which the fingers bend to the palm."""
    return cross(X, _palm(side))
