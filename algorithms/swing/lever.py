"""How a hand is on a door's lever: the palm, and the fingers closed about it while it turns in the hand."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from doors import STANDS, UPWARD, Door

from ahmss.algorithm import HumanTask, Transform
from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, from_matrix, multiply, rotate, slerp
from ahmss.grasping.hand import Hand
from ahmss.grasping.rolling import wrapped_at
from ahmss.motion.fingers import Cylinder, closed
from ahmss.motion.steps import Steps
from ahmss.reaching.reacher import Reacher

DIAMETER, INTO_FINGERS = 0.022, 0.0165  # metres: of a lever that does not say; how far it lies towards the fingers
PALM, SKIN = 0.0065, 0.003  # metres that palm and fingers are thicker than they are told to be
FISTS = 17  # angles of the leaf at which the fingers are closed about the lever
FARTHER, DEEP = (0.0, 0.015, 0.03), 0.0015  # metres along the lever that are tried; that fingers may be in the door
EVERY = 4  # of them: at those between, the fingers are taken to be between before they close onto the lever's own shape


@dataclass(frozen=True, eq=False)
class Grip:
    """How a hand is on a door's lever.

    door: with the place on the lever. palm: squarely on it, in the closed leaf's frame, from before and above. fists:
    (m, 14, 4) the fingers closed about it at even shares of the leaf's way.
    """

    door: Door
    palm: Transform
    fists: Array

    def palms(self, angle: Array, before: Array) -> Array:
        """The palm (n, 7) on the lever at angles (n), drawn back by metres (n)."""
        return self.door.palms(self.palm, angle, before)


def grip(task: HumanTask, door: Door) -> Steps[Grip]:
    """The grip on the middle of the lever; farther to its end where fingers would be in its plate or in the leaf."""
    best: tuple[float, Grip] | None = None
    for farther in FARTHER if door.end.any() else FARTHER[:1]:
        made = yield from _grip(task, replace(door, farther=farther))
        deep = _deep(task, made)
        if best is None or deep < best[0]:
            best = deep, made
        if deep < DEEP:
            break
        yield
    assert best is not None
    return best[1]


def _deep(task: HumanTask, made: Grip) -> float:
    """Metres by which the closed fingers are in the door at some of the angles, where its shape is known."""
    thing, door = task.object, made.door
    if thing is None or thing.shape is None:
        return 0.0
    palms = _on_leaf(door, made.palm, np.linspace(door.angle, door.wanted, len(made.fists)))
    return Hand.of(task.human, door.hand).depth(thing.shape.field(door.lever), palms, made.fists)


def _grip(task: HumanTask, door: Door) -> Steps[Grip]:
    """The grip at a place of the lever."""
    assert task.object is not None
    side, into = door.hand, np.array([0.0, -float(door.side), 0.0])
    thumb = np.cross(into, UPWARD) * (1.0 if side == "left" else -1.0)
    pitch = np.radians(STANDS[door.side, side][2][0])
    out = np.cos(pitch) * into - np.sin(pitch) * UPWARD
    rotation = from_matrix(np.stack([out, np.cross(thumb, out), thumb], axis=1))
    radius = 0.5 * float(task.object.properties.get("knob_diameter", DIAMETER))
    to_fingers = np.cos(pitch) * UPWARD + np.sin(pitch) * into
    palm = Transform(door.lever - (radius + PALM) * out - INTO_FINGERS * to_fingers, rotation)
    angle = np.linspace(door.angle, door.wanted, FISTS)
    palm = Transform(palm.place - _too_deep(task, door, palm, angle) * out, rotation)
    row = Reacher.of(task.human, side).row
    seen = palm.then(Transform.of(task.human.grips[row]).inverse()).inverse()  # the leaf as the hand sees it
    some: list[Array] = []
    for slant in (door.yaw(angle) - angle)[::EVERY].tolist():
        along = rotate(from_axis_angle(UPWARD, np.array(-slant)), thumb)
        bar = Cylinder(seen.apply(door.lever), rotate(seen.rotation, along), radius + SKIN)
        some.append(closed(task.human, side, bar))
        yield
    at = np.arange(FISTS) / EVERY
    first = np.minimum(at.astype(np.intp), len(some) - 2)
    fists = slerp(np.stack(some)[first], np.stack(some)[first + 1], (at - first)[:, None])
    return Grip(door, palm, (yield from _by_shape(task, door, palm, angle, fists)))


def _too_deep(task: HumanTask, door: Door, palm: Transform, angle: Array) -> float:
    """Metres by which the palm is in the lever at some of the angles (m) of the leaf, where its shape is known."""
    thing = task.object
    if thing is None or thing.shape is None:
        return 0.0
    palms = _on_leaf(door, palm, angle)
    return float(Hand.of(task.human, door.hand).palm_depth(thing.shape.field(door.lever), palms).max(initial=0.0))


def _by_shape(task: HumanTask, door: Door, palm: Transform, angle: Array, fists: Array) -> Steps[Array]:
    """The fists (m, 14, 4) closed onto the leaf's own shape at angles (m) of it, where that is known."""
    thing = task.object
    if thing is None or thing.shape is None:
        return fists
    palms = _on_leaf(door, palm, angle)
    return (yield from wrapped_at(Hand.of(task.human, door.hand), thing.shape.field(door.lever), palms, fists))


def _on_leaf(door: Door, palm: Transform, angle: Array) -> Array:
    """The palm (m, 7) as the leaf has it at angles (m)."""
    palms = Transform.of(door.palms(palm, angle, np.zeros(len(angle))))
    turned = multiply(door.closed.rotation, from_axis_angle(np.broadcast_to(UPWARD, (len(angle), 3)), angle))
    return Transform(np.broadcast_to(door.closed.place, (len(angle), 3)), turned).inverse().then(palms).row()
