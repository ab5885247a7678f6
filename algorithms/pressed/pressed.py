"""A button that a fingertip pushes in along its axis, the -x of the site that the action names.

It goes in as far as the pad of the acting hand's index finger is behind its face, at most by its travel. Where
it is all the way in it clicks, once for each push: a latching button that was out is in from then on, and the other way
round. States, where the kind has them: `depth` (of its travel, 0 to 1) and `position` ("out" or "in").
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ahmss.algorithm import ObjectPose, ObjectTask, Transform, run
from ahmss.body.array import Array
from ahmss.body.quaternion import rotate

TRAVEL, RADIUS = 0.004, 0.01  # metres, where its properties do not say
CLICK, BACK = 0.95, 0.5  # of the travel: where it clicks, and from where it can click again
DEEPEST = 0.03  # metres behind the face from which on the finger is somewhere else, not on the button


@dataclass
class Button:
    """What a button knows of itself. `rest`: of its travel, where it stays when nothing pushes."""

    inside: bool
    latching: bool
    latched: float
    armed: bool = True

    @property
    def rest(self) -> float:
        """Of its travel, where it stays when nothing pushes it."""
        return self.latched if self.inside and self.latching else 0.0

    def push(self, share: float) -> float:
        """Push it in by a share of its travel; how deep it is then."""
        if share >= CLICK and self.armed:
            self.armed, self.inside = False, not self.inside if self.latching else True
        elif share < BACK:
            self.armed = True
            self.inside = self.inside and self.latching
        return max(share, self.rest)


def pressed(task: ObjectTask) -> Iterator[ObjectPose]:
    """The button's states at each frame of the human; the object itself stays where it is."""
    travel = float(task.object.properties.get("travel", TRAVEL))
    radius = float(task.object.properties.get("radius", RADIUS)) + task.parameter("margin", 0.006)
    states = task.object.states
    button = Button(states.get("position") == "in", task.parameter("latching", True), task.parameter("latched", 0.5))
    depth = float(states.get("depth", 0.0))
    came = False  # from outside: a hand that begins behind the panel pushes nothing
    for _ in task.frames():
        pad = _pad(task)
        beside, out = float(np.hypot(pad[1], pad[2])), float(pad[0])
        came = came or out > 0.0
        touches = came and beside <= radius and out > -DEEPEST
        depth = button.push(float(np.clip(-out / travel, 0.0, 1.0)) if touches else 0.0)
        yield task.pose(None, None, _told(task, button, depth))


def _pad(task: ObjectTask) -> Array:
    """The pad (3,) of the index finger, in the frame of the button's face: x is how far it is from being pushed."""
    site = task.object.sites[task.message.site]
    face = task.object.frame.then(Transform(np.array(site.position), np.array(site.rotation)))
    into = -rotate(face.rotation, np.array([1.0, 0.0, 0.0]))
    hands = (task.hand,) if task.hand else ("right", "left")
    pads = [face.inverse().apply(task.fingerpad(hand, into)) for hand in hands]
    return min(pads, key=lambda pad: float(pad @ pad))


def _told(task: ObjectTask, button: Button, depth: float) -> dict[str, float | str]:
    """Those of its states that the kind has."""
    states = {"position": "in" if button.inside else "out", "depth": round(depth, 2)}
    return {name: value for name, value in states.items() if name in task.object.states}


if __name__ == "__main__":
    run(pressed)
