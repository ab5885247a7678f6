"""A door, where one stands to have its lever in hand at each angle, and how the palm is on it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.algorithm import HumanTask, Transform
from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.errors import AlgorithmError
from ahmss.walking.goals import Goal

UPWARD = np.array([0.0, 0.0, 1.0])
WIDE = 1.3  # radians: the angle that the second of the places below is for
ARM = 0.68  # metres from the hinge to the lever that they are for
# Where one stands, in the closed leaf's frame: x, y in metres and the heading in degrees, with the leaf closed and wide
# open; and how the palm is on the lever, degrees by which it looks down and by which it is turned to the left. By the
# side of the leaf, -1 before it and 1 where it opens to, and the hand. Found by a search for what both shipped bodies
# do with the least bent wrist and the arm not stretched, clear of the leaf and the frame.
STANDS = {
    (-1, "right"): ((0.43, -0.42, 125.0), (0.49, 0.12, 152.0), (50.0, -10.0)),
    (-1, "left"): ((0.61, -0.50, 6.0), (0.47, 0.03, 20.0), (85.0, -26.0)),
    (1, "right"): ((0.84, 0.64, -43.0), (0.08, 1.25, -26.0), (50.0, -12.0)),
    (1, "left"): ((0.34, 0.51, -101.0), (-0.33, 0.61, -58.0), (50.0, 0.0)),
}
THERE = 0.15  # metres from where one stands to have the lever in hand
LEVEL = 0.1  # of a lever's direction, its z at the most
TURNS_ALONG = 0.5  # of the leaf's turn that the palm makes on the lever, even at half the way


@dataclass(frozen=True, eq=False)
class Door:
    """A door, and from which side it is taken.

    closed: its frame when it is closed. angle, wanted: radians, now and then. side: on which one is, -1 or 1. lever:
    (3,) on that side, in the leaf's frame. end: (3,) the way along it from its spindle to its end, in the leaf's frame;
    0 of a knob. width: of the leaf, metres. hand: that takes it, so many metres farther to its end than `lever`.
    """

    name: str
    closed: Transform
    angle: float
    wanted: float
    side: int
    lever: Array
    end: Array
    width: float
    hand: str
    farther: float = 0.0

    def stand(self, angle: float) -> Goal:
        """Where one stands to have the lever in hand at an angle."""
        first, last = (np.array(place) for place in STANDS[self.side, self.hand][:2])
        x, y, heading = first + np.clip(angle / WIDE, 0.0, 1.0) * (last - first)
        place = self.closed.apply(np.array([x + self.lever[0] - ARM, y, 0.0]))
        ahead = rotate(self.closed.rotation, np.array([np.cos(np.radians(heading)), np.sin(np.radians(heading)), 0.0]))
        return Goal(place[:2], float(np.arctan2(ahead[1], ahead[0])))

    def leaf(self, angle: float) -> Transform:
        """Its frame at an angle."""
        return self.closed.then(Transform(np.zeros(3), from_axis_angle(UPWARD, np.array(angle))))

    def yaw(self, angle: Array) -> Array:
        """Radians (n) by which the palm is turned to the left from how it is squarely on the closed leaf, at angles."""
        return TURNS_ALONG * angle + (1.0 - TURNS_ALONG) * 0.5 * WIDE + np.radians(STANDS[self.side, self.hand][2][1])

    def palms(self, palm: Transform, angle: Array, before: Array) -> Array:
        """The palm (n, 7) on the lever at angles (n), drawn back by metres (n); `palm` is on the closed leaf's."""
        leaf = from_axis_angle(np.broadcast_to(UPWARD, (*angle.shape, 3)), angle)
        yaw = self.yaw(angle)
        own = from_axis_angle(np.broadcast_to(UPWARD, (*angle.shape, 3)), yaw)
        turned = multiply(own, palm.rotation)
        held = self.lever + self.farther * self.end
        around = rotate(leaf, held) + rotate(own, palm.place - self.lever)
        places = around - before[:, None] * rotate(turned, np.array([1.0, 0.0, 0.0]))
        inner = Transform(places, turned)
        return Transform(
            np.broadcast_to(self.closed.place, places.shape), np.broadcast_to(self.closed.rotation, turned.shape)
        ).then(inner).row()  # fmt: skip


def door_of(task: HumanTask) -> Door:
    """The door that is to be swung, and from where.

    Raises:
        AlgorithmError: it is none, or both hands hold something.
    """
    thing = task.object
    if thing is None or task.site is None or not thing.sites:
        raise AlgorithmError("swing needs a door and the site of its lever")
    angle = float(thing.states.get("angle", 0.0))
    closed = Transform(thing.place.copy(), multiply(thing.rotation, from_axis_angle(UPWARD, -angle)))
    names = [name for name in (task.message.site, f"{task.message.site}_back") if name in thing.sites]
    size = thing.properties.get("size")
    width = float(size[0]) if isinstance(size, (list, tuple)) else float(thing.sites[names[0]].position[0])

    def taken_from(side: int) -> Door:
        site = thing.sites[max(names, key=lambda name: side * thing.sites[name].position[1])]
        wanted, hand = task.parameter("to", 0.0), _hand(task)
        end = rotate(np.array(site.rotation), np.array([0.0, 0.0, -1.0]))  # of a lever's frame z leads to the spindle
        end = end if abs(float(end @ UPWARD)) < LEVEL else np.zeros(3)
        return Door(thing.name, closed, angle, wanted, side, np.array(site.position), end, width, hand)

    # Who has pushed it open stands where its leaf was, and is still before it.
    before, root = taken_from(-1), task.start.root
    if np.linalg.norm(root[:2] - before.stand(angle).place) < THERE or closed.inverse().apply(root)[1] <= 0.0:
        return before
    return taken_from(1)


def _hand(task: HumanTask) -> str:
    """Raises: AlgorithmError: both hands hold something."""
    free = [side for side in ("right", "left") if side not in task.busy]
    if task.hand:
        return task.hand
    if not free:
        raise AlgorithmError("both hands hold something; let go of it first")
    return free[0]
