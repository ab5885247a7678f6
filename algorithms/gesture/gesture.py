"""Gestures of feeling and intent, by oneself or to somebody, whose eyes are looked at meanwhile.

Where the arms go is known against the trunk, so a gesture can be made while the body is carried elsewhere. Who stands
beside things keeps the arms out of them, and steps back first where arms, trunk or head would be far in.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanTask, run
from ahmss.algorithm.haste import hurried
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE, LEFT_FOOT, RIGHT_FOOT
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import from_axis_angle, multiply, slerp
from ahmss.errors import AlgorithmError
from ahmss.motion.gestures import GESTURES, Gesture, Palm, arm_to, fingers_of, head_at, swung
from ahmss.reaching.reacher import heading_of
from ahmss.reaching.standing import Standing
from ahmss.skills.company import Watching
from ahmss.skills.free_arm import arm_kept_out
from ahmss.skills.meanwhile import waited
from ahmss.skills.stepping_back import deep_in, stepped_back

CARES, HEAD = 3.0, 3.0  # importance of arms and head: a walk's are a tenth of it
HANGS = 0.75  # of a bow's angle, by which the arms hang back to the vertical
NODS = 0.25  # of a bow's angle, by which the head goes further
BY_SPINE = 0.6  # of a bow, of who can't bend at the hips because they walk
SPINE = 3.0
MOST_IN = 0.01  # metres that one may be in things as the arms are not yet moved out of them: beyond, one steps back
_X, _Y, _Z = np.eye(3)


def gesture(task: HumanTask) -> Iterator[Array]:
    """Frames (1, 260): as many as the gesture takes, or as were asked for; who is behind is turned to first."""
    which = task.parameter("which", "nod")
    made = GESTURES.get(which)
    if made is None:
        raise AlgorithmError(f'no gesture "{which}"; there are: {", ".join(GESTURES)}')
    task, watching = yield from Watching.faced(task)
    sides = [side for side, _ in _palms(task, made)]
    if made.bends:  # arms go along
        sides = [side for side in ("right", "left") if side not in task.busy]
    time = _time(task, made)
    rows = _bowed(task, made, time) if made.bends else _gestured(task, made, time, watching)
    if not task.length and deep_in(task, rows) > MOST_IN:
        back = yield from stepped_back(task, rows)
        if back is not task:
            task, watching = back, Watching.of(back)
            rows = _bowed(task, made, time) if made.bends else _gestured(task, made, time, watching)
    task.arrived()
    still = task.block(task.start.rotations[None], task.start.root[None], np.zeros(44))
    for side in sides:
        rows, _ = yield from waited(arm_kept_out(task, side, rows), still, 0 if task.length else None)
    if watching is None:
        yield rows
        return
    turns = head_at(made, time) * task.parameter("amount", 1.0)
    for i in range(len(time)):
        row = rows[i : i + 1].copy()
        if not made.bends:
            row[0, 220:260].reshape(5, 8)[GAZE] = watching.gaze(turns[i, 0], turns[i, 1], i + 1, len(time))
        yield row


def _time(task: HumanTask, made: Gesture) -> Array:
    """The seconds (n) of its frames, from when it begins."""
    length = hurried(task, max(round(made.seconds * task.rate), 1))
    return np.arange(1, length + 1) / length * made.seconds


def _gestured(task: HumanTask, made: Gesture, time: Array, watching: Watching | None) -> Array:
    """POSE rows (n, 260) of arms, fingers and, where nobody is looked at, the head."""
    n, start, skeleton = len(time), task.start.rotations, task.human
    there = made.there(time)
    rotations = np.repeat(start[None], n, axis=0)
    importance = np.zeros(44)
    amount = task.parameter("amount", 1.0)
    for side, palm in _palms(task, made):
        first, hand = INDEX[f"{side}_upper_arm"], list(fingers(side))
        arms = np.repeat(arm_to(skeleton, side, palm)[None], n, axis=0)
        degrees, often = made.swing
        if degrees:
            angles = amount * np.radians(degrees) * np.sin(2.0 * np.pi * often * (time - 0.5 * made.raising)) * there
            arms = swung(skeleton, side, palm, angles)
        share = there[:, None]
        rotations[:, first : first + 3] = slerp(start[first : first + 3], arms, share)
        rotations[:, hand] = slerp(start[hand], fingers_of(side, palm.fingers), share)
        importance[first : first + 3] = CARES
        importance[hand] = 1.0
    head, turns = INDEX["head"], head_at(made, time) * amount
    if turns.any() or watching is not None:
        importance[head] = HEAD
        yaw, pitch, roll = (from_axis_angle(axis, turns[:, i]) for i, axis in enumerate((_X, _Y, _Z)))
        rotations[:, head] = multiply(multiply(start[head], yaw), multiply(pitch, roll))
    root = np.repeat(task.start.root[None], n, axis=0)
    return task.block(rotations, root, importance)


def _palms(task: HumanTask, made: Gesture) -> Iterator[tuple[str, Palm]]:
    """The sides that gesture, and where their palms go: the hand that is meant, else a free one, the right first."""
    if made.main is None:
        return
    free = [side for side in ("right", "left") if side not in task.busy]
    side = task.hand or (free or ["right"])[0]
    if side in task.busy:
        raise AlgorithmError(f"the {side} hand holds something; let go of it first, or say the other hand")
    yield side, made.main
    if made.other is not None:
        other = "left" if side == "right" else "right"
        if other in task.busy:
            raise AlgorithmError(f"the {other} hand holds something, and this takes both; let go of it first")
        yield other, made.other


def _bowed(task: HumanTask, made: Gesture, time: Array) -> Array:
    """POSE rows (n, 260): the trunk leans from the hips, these go back, the arms hang and the head goes along."""
    n, start = len(time), task.start
    depth = np.radians(task.parameter("degrees", 30.0)) * made.there(time)
    standing = None if task.carried else Standing.of(task.human, start.rotations, start.root)
    rotations, root = np.repeat(start.rotations[None], n, axis=0), np.repeat(start.root[None], n, axis=0)
    importance, targets = np.zeros(44), np.zeros((n, 5, 8))
    importance[[INDEX["spine"], INDEX["head"]]] = SPINE, HEAD
    if standing is None:
        turn = from_axis_angle(_Y, BY_SPINE * depth)
        rotations[:, INDEX["spine"]] = multiply(start.rotations[INDEX["spine"]], turn)
    else:
        toward, nothing = np.full(n, heading_of(start.rotations, start.root)), np.zeros(n)
        posture = standing.postures(nothing, depth, toward, nothing, np.zeros(3))
        begun = standing.postures(nothing, 0.0 * depth, toward, nothing, np.zeros(3))
        rotations = slerp(start.rotations, posture.rotations, np.minimum(4.0 * made.there(time)[:, None], 1.0))
        root = start.root + posture.root - begun.root
        targets[:, RIGHT_FOOT : LEFT_FOOT + 1, :7], targets[:, RIGHT_FOOT : LEFT_FOOT + 1, 7] = standing.feet, 1.0
        importance[: INDEX["left_foot"] + 1] = 1.0
        importance[43] = 1.0
    head = INDEX["head"]
    rotations[:, head] = multiply(start.rotations[head], from_axis_angle(_Y, NODS * depth))
    for side in ("right", "left"):
        if side in task.busy:
            continue
        arm = INDEX[f"{side}_upper_arm"]
        importance[arm : arm + 3] = 1.0
        # In the trunk's frame the arm swings forward, so that it hangs: about the trunk's own left.
        rotations[:, arm] = multiply(from_axis_angle(-_Y, HANGS * depth), start.rotations[arm])
    return task.block(rotations, root, importance, targets)


if __name__ == "__main__":
    run(gesture)
