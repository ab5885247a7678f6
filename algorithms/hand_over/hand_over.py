"""Giving: one comes to stand before somebody, holds the thing out between both, and lets go when their hand holds it.

Who sits waits for them to come instead, and holds it out as low as both have their eyes.

That it does is seen, as people see it: the palm is at the thing, the fingers have closed since it came, and both are
still. Two people who hand something over stand a little more than a metre apart, and meet about half-way, the thing at
the height of the belly (Basili et al. 2009: 1.16 m, from memory; the height judged).
"""

from __future__ import annotations

import contextlib
from collections import deque
from collections.abc import Generator, Iterator

import numpy as np

from ahmss.algorithm import HumanPose, HumanTask, Transform, run
from ahmss.algorithm.place import WorldObject
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE
from ahmss.body.links import fingers
from ahmss.body.quaternion import from_axis_angle, multiply, rotate, slerp
from ahmss.errors import AlgorithmError
from ahmss.grasping.coming_off import coming_off
from ahmss.grasping.hand import Hand
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.edit import floor_frame
from ahmss.reaching.goal import Goal
from ahmss.reaching.plan import Plan, Reaching
from ahmss.skills.at_ease import at_ease
from ahmss.skills.company import Watching, settled
from ahmss.skills.meeting import HANDING, again, come_to, go_to
from ahmss.skills.on_thigh import at_rest
from ahmss.skills.out_of_reach import tell_missed
from ahmss.skills.planning import planned
from ahmss.skills.reaching import Looking, performed, prisms_of
from ahmss.skills.who_sits import height_of_both

SHARE = 0.47  # of the way to the other at which the thing is held out
HEIGHT = 0.63  # of the stature of who has the eyes as high as both in the mean
BEHIND = np.radians([40.0, 55.0, 75.0])  # from straight towards them, that a palm behind the thing looks
TURNS = np.radians(np.arange(-180.0, 180.0, 15.0))  # of the thing about the vertical
NEAR, CLOSED = 0.13, 0.006  # metres: a palm at the thing, and how far its fingers have closed since it came
WIDE = 0.1  # metres from its middle to a corner: what is wider is taken at its margin
STILL, FRAMES = 0.002, 9  # metres in so many frames
TELLS = 0.5  # seconds after which it is told that one waits
LOOKS = 0.4  # seconds, from where one looked to the other's eyes
OPENS, BACK, AWAY, HOME = 0.35, 0.12, 0.45, 0.9  # seconds, metres, seconds, seconds
UP = np.array([0.0, 0.0, 1.0])


def hand_over(task: HumanTask) -> Iterator[Array | HumanPose]:
    """Frames (n, 260) until the hand is back at the side."""
    whom, side = task.goal_object, task.hand or "right"
    if whom is None or task.object is None:
        raise AlgorithmError("hand over what, and to whom?")
    yield from come_to(task, whom, HANDING, courteous=False)
    task.arrived()
    begun = again(task)
    watching = Watching.of(begun)
    assert watching is not None
    reaching = Reaching(begun.human, begun.start.rotations, begun.start.root)
    gaze = Looking(begun, watching.eyes)
    plan = yield from _easiest(begun, _held_out(begun, whom, side), gaze, reaching)
    made = yield from performed(begun, reaching, plan, gaze, ([], np.zeros((0, 4))))
    tell_missed(task, plan)
    rows = at_ease(begun, begun.block(made.rotations, made.root, made.importance, made.targets))
    yield rows
    last = rows[-1:]
    taken = yield from _until_taken(task, whom, last)
    if not taken:
        yield from _back(task, side, last, begun, opens=False)
        seconds = task.parameter("patience", 10.0)
        raise AlgorithmError(f"{whom.name} did not take {task.object.name} within {seconds:g} s; it stays in the hand")
    pose = HumanPose.of(last[0])
    yield task.pose(pose.rotations, pose.root, pose.importance, pose.targets, {"held": taken})
    yield from _back(task, side, last, begun, opens=True)


def _easiest(task: HumanTask, goals: list[Goal], gaze: Looking, reaching: Reaching) -> Generator[Array, None, Plan]:
    """The plan of a reach to the first goal that the arm comes to as it should, or to the last."""
    for goal in goals[:-1]:
        with contextlib.suppress(AlgorithmError):  # the last says what is in the way of all
            plan = yield from planned(task, reaching, goal, gaze, prisms_of(task))
            if plan.arm.found:
                return plan
        yield gaze.alone()
    return (yield from planned(task, reaching, goals[-1], gaze, prisms_of(task)))


def _held_out(task: HumanTask, whom: WorldObject, side: str) -> list[Goal]:
    """The thing upright between both, turned about the vertical as the wrist likes it.

    First those ways in which the palm is behind it, as they see it: so either of their hands has room before it.
    """
    assert task.object is not None
    here, _ = floor_frame(task.start.rotations, task.start.root)
    middle = here + SHARE * (whom.place - here)
    middle[2] = HEIGHT * height_of_both(task, float(whom.site("eyes", here).place[2]))
    grip = task.start.grip(side)
    in_palm = grip.inverse().then(task.object.frame)
    upright = Transform(middle, multiply(from_axis_angle(UP, TURNS), _level(task.object.rotation)))
    palms = upright.then(in_palm.inverse())
    rows, way = palms.row(), (whom.place - here) / np.linalg.norm(whom.place - here)
    ahead = rotate(rows[:, 3:], np.array([1.0, 0.0, 0.0])) @ way
    sets = [rows[ahead > least] for least in np.cos(BEHIND)]
    return [Goal(middle, palms={side: some}) for some in (*sets, rows) if len(some)]


def _level(rotation: Array) -> Array:
    """A thing's rotation (4,) without its tilt."""
    level = rotation * np.array([1.0, 0.0, 0.0, 1.0])
    length = float(np.linalg.norm(level))
    return level / length if length > 1e-6 else np.array([1.0, 0.0, 0.0, 0.0])


def _until_taken(task: HumanTask, whom: WorldObject, row: Array) -> Generator[Array, None, str]:
    """One stands still, looks at the other's face, and sees which hand has closed; "": none has.

    The row (1, 260) is as it was shown last.
    """
    watching = Watching(task, whom)
    seen: dict[str, deque[Array]] = {hand: deque(maxlen=FRAMES) for hand in ("right", "left")}
    flattest: dict[str, Array] = {}
    gaze = row[0, 220:260].reshape(5, 8)[GAZE]
    before = gaze[:3].copy()
    for k in range(1, round(task.parameter("patience", 10.0) * task.rate) + 1):
        gaze[:] = watching.gaze()
        gaze[:3] = before + minimum_jerk(np.array(k / (LOOKS * task.rate))) * (gaze[:3] - before)
        yield row.copy()
        if k == round(TELLS * task.rate):
            assert task.object is not None
            task.note(f"waits for {whom.name} to take {task.object.name}")
        for hand, track in seen.items():
            if _has_closed(task, whom, hand, track, flattest):
                return hand
    return ""


def _has_closed(task: HumanTask, whom: WorldObject, hand: str, track: deque[Array], flattest: dict[str, Array]) -> bool:
    assert task.object is not None
    palm = whom.site(f"{hand}_hand", task.start.root)
    tip = palm.inverse().apply(whom.site(f"{hand}_fingers", task.start.root).place)
    at = task.object.frame.apply(np.array(task.object.sites[task.message.site].position)) if task.message.site else None
    at = task.object.place if at is None else at
    half = 0.5 * float(np.linalg.norm(task.object.properties.get("size", (0.0, 0.0))[:2]))
    if float(np.linalg.norm(palm.place - at)) > NEAR + (half if half > WIDE else 0.0):
        track.clear()
        flattest.pop(hand, None)
        return False
    # Out of the palm, and along it and near: a hand that only opens is not closed, whatever is between its fingers.
    bent = np.array([tip[0], -np.linalg.norm(tip)])
    flattest[hand] = np.minimum(bent, flattest.get(hand, bent))
    track.append(np.concatenate([palm.place, tip]))
    return settled(track, FRAMES, STILL) and float((bent - flattest[hand]).max()) > CLOSED


def _back(task: HumanTask, side: str, row: Array, begun: HumanTask, *, opens: bool) -> Iterator[Array]:
    """The hand comes off and back, and the arm comes to rest; or, with the thing in it, back to where it was."""
    pose = HumanPose.of(row[0])
    grip = task.present.grip(side)
    hand = list(fingers(side))
    if opens:
        n = round((OPENS + AWAY) * task.rate)
        time = np.arange(1, n + 1) / task.rate
        rotations = np.repeat(pose.rotations[None], n, axis=0)
        present = pose.rotations[hand]
        off = coming_off(Hand.of(task.human, side), present)
        rotations[:, hand] = slerp(present, off, minimum_jerk(time / OPENS)[:, None])
        targets = np.repeat(pose.targets[None], n, axis=0)
        away = minimum_jerk((time - 0.8 * OPENS) / (n / task.rate - 0.8 * OPENS))
        out = rotate(grip.rotation, np.array([-1.0, 0.0, 0.0]))
        targets[:, 0 if side == "right" else 1, :3] += away[:, None] * BACK * out
        importance = pose.importance.copy()
        importance[hand] = 1.0
        yield task.block(rotations, np.repeat(pose.root[None], n, axis=0), importance, targets)
    rotations, root = begun.start.rotations, begun.start.root
    yield from go_to(task, at_rest(begun, rotations, root, side) if opens else rotations, root, HOME)


if __name__ == "__main__":
    run(hand_over)
