"""Another human as an algorithm sees them: where their eyes are, how far they stand, and whether one faces them."""

from __future__ import annotations

from collections import deque
from collections.abc import Generator
from dataclasses import dataclass

import numpy as np

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.edit import floor_frame
from ahmss.skills.facing import BEHIND, faced

__all__ = ["Watching", "aside_of", "eye_of", "settled"]

_EYES = "eyes"
_SECONDS = 0.3  # in which the gaze comes and goes
_FASTEST = np.radians(240.0)  # a second, that the head turns at the most: who is farther aside is looked at more slowly
_PEAK = 1.875  # of a minimum-jerk way, against its mean speed
_SHARE = 0.9  # of the angle to a place that the head makes, the rest is the eyes'
_HEAD = INDEX["head"]
_FACES = np.array([0.0, 0.0, -1.0])  # in the head: where it looks


def eye_of(task: HumanTask) -> Array:
    """The point between one's own eyes now (3,), in the world."""
    places, turned = forward(task.present.rotations, task.present.root, task.human.offsets)
    return places[_HEAD] + rotate(turned[_HEAD], task.human.eye)


def aside_of(task: HumanTask, place: Array) -> float:
    """How far a place (3,) is to the left of where one's hips face now, radians."""
    at, turn = floor_frame(task.present.rotations, task.present.root)
    x, y, _ = rotate(turn * np.array([1.0, -1.0, -1.0, -1.0]), place - at)
    return float(np.arctan2(y, x))


def settled(track: deque[Array], frames: int, most: float) -> bool:
    """Whether places (n,) of so many frames are there, and none has moved by more than so many metres."""
    return len(track) >= frames and bool(np.ptp(np.array(track), axis=0).max() <= most)


@dataclass(frozen=True)
class Watching:
    """One looks at somebody's eyes, wherever they and oneself go."""

    task: HumanTask
    whom: WorldObject

    @classmethod
    def of(cls, task: HumanTask) -> Watching | None:
        """The human that a motion is made to; None where it is made to nobody, or is oneself."""
        whom = task.goal_object if task.object is not None and task.object.kind != "human" else task.object
        if whom is None or _EYES not in whom.sites or whom.states.get("oneself") == "yes":
            return None
        return cls(task, whom)

    @classmethod
    def faced(cls, task: HumanTask) -> Generator[Array, None, tuple[HumanTask, Watching | None]]:
        """The task of who faces whom it is made to, after turning around (n, 272) to who is behind; and the gaze.

        Raises:
            AlgorithmError: they are behind one's back, and one can't turn; says why.
        """
        watching = cls.of(task)
        if watching is None:
            return task, None
        task = yield from faced(task, watching.eyes, BEHIND, watching.whom.name)
        return task, cls(task, watching.whom)

    @property
    def eyes(self) -> Array:
        """The point between their eyes now (3,)."""
        return self.whom.site(_EYES, self.task.start.root).place

    def gaze(self, yaw: float = 0.0, pitch: float = 0.0, frame: float = 1e9, length: float = 0.0) -> Array:
        """The gaze's target (8): their eyes, or beside them by angles to the left and down, radians.

        frame, length: it comes in the first 0.3 seconds, longer where the head has far to turn, and goes in as many at
        the end of so many frames; 0: it stays.
        """
        eye = eye_of(self.task)
        way = self.eyes - eye
        level = float(np.hypot(way[0], way[1]))
        bearing = np.arctan2(way[1], way[0]) + yaw / _SHARE
        down = np.arctan2(-way[2], level) + pitch / _SHARE
        ahead = np.array([np.cos(down) * np.cos(bearing), np.cos(down) * np.sin(bearing), -np.sin(down)])
        _, turned = forward(self.task.start.rotations, self.task.start.root, self.task.human.offsets)
        faced = rotate(turned[_HEAD], _FACES)
        angle = float(np.arccos(np.clip(faced @ ahead, -1.0, 1.0)))
        steepest = 4.0 * np.tan(0.25 * angle)  # along the chord, on which weights are met, the middle goes faster
        frames = max(_SECONDS, _PEAK * steepest / _FASTEST) * self.task.rate
        weight = minimum_jerk(np.array(frame / frames))
        if length:
            weight = weight * minimum_jerk(np.array((length - frame) / frames))
        return np.array([*(eye + np.linalg.norm(way) * ahead), 0.0, 0.0, 0.0, 0.0, float(weight)])
