"""Keeping the arm's posture: shoulder, elbow and wrist stay at their angles (Ichiguchi 2000, 5.3.4).

For a hand that carries something while the body does something else. What shall not be spilled is kept level: the wrist
gives way as far as it goes, as a person's does who carries a full cup. Where the hand would be in a thing it goes
aside. The head does not turn into what the hand has at it.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanTask, importance_of, run
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import between, conjugate, from_rotation_vector, multiply, rotate, to_rotation_vector
from ahmss.motion.easing import minimum_jerk
from ahmss.skills.giving_way import GivingWay
from ahmss.skills.steady_head import SteadyHead

ENDLESS = 60  # frames that are given at a time to who does not say how many
MOST, SOFT = np.radians(35.0), np.radians(10.0)  # that the wrist gives way, and the last part of it
LEVELLED_IN = 0.7  # seconds
STEADY = 10.0  # how much it cares for the head that it has something at: a look at something is at 0.5
CARES = 20.0  # times as much an arm is cared for that is aside: of a walk's, which hangs, even a little is much
UP = np.array([0.0, 0.0, 1.0])


def hold_arm(task: HumanTask) -> Iterator[Array]:
    """All frames (N, 260), or endless ones: the present pose, cared for in the arm and the fingers alone."""
    side = task.hand or "right"
    share = task.parameter("importance", 1.0)
    held = {link: share for link in LINKS if link.startswith(f"{side}_") and not link.endswith(("leg", "foot"))}
    if task.object is not None:
        yield from _carrying(task, side, importance_of(held))
        return
    length = task.length or ENDLESS
    rotations = np.repeat(task.start.rotations[None], length, axis=0)
    root = np.repeat(task.start.root[None], length, axis=0)
    rows = task.block(rotations, root, importance_of(held))
    yield rows
    while not task.length:
        yield rows


def _carrying(task: HumanTask, side: str, importance: Array) -> Iterator[Array]:
    """Frames (1, 260) of a hand that is out of things, what is in it upright if it is to be level."""
    arm = slice(INDEX[f"{side}_upper_arm"], INDEX[f"{side}_hand"] + 1)
    giving_way, begun = GivingWay(task, side), task.start
    level = _Level(task, side) if task.parameter("level", False) else None
    steady, targets = SteadyHead.of(task, side), np.zeros((1, 5, 8))
    if steady is not None:
        importance[INDEX["head"]] = STEADY
    for k in itertools.count(1) if not task.length else range(1, task.length + 1):
        rotations = task.present.rotations.copy()
        rotations[arm] = begun.rotations[arm]
        arms = giving_way.over(rotations, task.present.root).copy()
        if level is not None:
            arms[-1] = level.hand(k, arms[-1])
        rotations = begun.rotations.copy()
        rotations[arm] = arms
        cares = importance.copy()
        cares[arm] *= 1.0 + CARES * giving_way.share
        if steady is not None:
            targets[0, GAZE] = steady.target()
        yield task.block(rotations[None], begun.root[None], cares, targets)


class _Level:
    """How a hand is turned so that what is in it is upright, wherever the forearm points."""

    def __init__(self, task: HumanTask, side: str) -> None:
        assert task.object is not None
        self._task, self._forearm = task, INDEX[f"{side}_lower_arm"]
        _, world = forward(task.start.rotations, task.start.root, task.human.offsets)
        hand = world[INDEX[f"{side}_hand"]]
        self._upright = rotate(conjugate(hand), rotate(task.object.rotation, UP))  # what is held's z, in the hand

    def hand(self, k: int, hand: Array) -> Array:
        """The rotation (4,) against the forearm in frame k of a hand that would be turned so (4,)."""
        present = self._task.present
        _, world = forward(present.rotations, present.root, self._task.human.offsets)
        held = multiply(world[self._forearm], hand)
        wanted = to_rotation_vector(between(rotate(held, self._upright), UP))
        share = float(minimum_jerk(np.array(k / (LEVELLED_IN * self._task.rate))))
        turn = from_rotation_vector(share * _softened(wanted))
        return multiply(conjugate(world[self._forearm]), multiply(turn, held))


def _softened(turn: Array) -> Array:
    """A rotation vector (3,), the most of it approached slowly."""
    angle = float(np.linalg.norm(turn))
    start = MOST - SOFT
    if angle <= start:
        return turn
    return turn * (start + SOFT * (1.0 - np.exp(-(angle - start) / SOFT))) / angle


if __name__ == "__main__":
    run(hold_arm)
