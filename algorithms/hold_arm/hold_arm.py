"""Keeping the arm's posture: shoulder, elbow and wrist stay at their angles (Ichiguchi 2000, 5.3.4).

For a hand that carries something while the body does something else. What shall not be spilled is kept level: the wrist
gives way as far as it goes, as a person's does who carries a full cup.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanTask, importance_of, run
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import between, conjugate, from_rotation_vector, multiply, rotate, to_rotation_vector
from ahmss.motion.easing import minimum_jerk

ENDLESS = 60  # frames that are given at a time to who does not say how many
MOST, SOFT = np.radians(35.0), np.radians(10.0)  # that the wrist gives way, and the last part of it
LEVELLED_IN = 0.7  # seconds
UP = np.array([0.0, 0.0, 1.0])


def hold_arm(task: HumanTask) -> Iterator[Array]:
    """All frames (N, 260), or endless ones: the present pose, cared for in the arm and the fingers alone."""
    side = task.hand or "right"
    share = task.parameter("importance", 1.0)
    held = {link: share for link in LINKS if link.startswith(f"{side}_") and not link.endswith(("leg", "foot"))}
    if task.parameter("level", False) and task.object is not None:
        yield from _level(task, side, importance_of(held))
        return
    length = task.length or ENDLESS
    rotations = np.repeat(task.start.rotations[None], length, axis=0)
    root = np.repeat(task.start.root[None], length, axis=0)
    rows = task.block(rotations, root, importance_of(held))
    yield rows
    while not task.length:
        yield rows


def _level(task: HumanTask, side: str, importance: Array) -> Iterator[Array]:
    """Frames (1, 260) in which the wrist turns what is in the hand upright, wherever the forearm points."""
    assert task.object is not None
    forearm, hand, begun = INDEX[f"{side}_lower_arm"], INDEX[f"{side}_hand"], task.start
    _, world = forward(begun.rotations, begun.root, task.human.offsets)
    upright = rotate(conjugate(world[hand]), rotate(task.object.rotation, UP))  # the object's z, in the hand
    for k in itertools.count(1) if not task.length else range(1, task.length + 1):
        present = task.present
        _, world = forward(present.rotations, present.root, task.human.offsets)
        held = multiply(world[forearm], begun.rotations[hand])
        wanted = to_rotation_vector(between(rotate(held, upright), UP))
        share = float(minimum_jerk(np.array(k / (LEVELLED_IN * task.rate))))
        rotations = begun.rotations.copy()
        turn = from_rotation_vector(share * _softened(wanted))
        rotations[hand] = multiply(conjugate(world[forearm]), multiply(turn, held))
        yield task.block(rotations[None], begun.root[None], importance)


def _softened(turn: Array) -> Array:
    """A rotation vector (3,), the most of it approached slowly."""
    angle = float(np.linalg.norm(turn))
    start = MOST - SOFT
    if angle <= start:
        return turn
    return turn * (start + SOFT * (1.0 - np.exp(-(angle - start) / SOFT))) / angle


if __name__ == "__main__":
    run(hold_arm)
