"""Who crouches, as after something was taken from the floor, stands up before going anywhere; hands are drawn in.

What the shipped algorithms that take the body somewhere share, and an author may use.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence

import numpy as np

from ahmss.algorithm.haste import least
from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import LEFT_FOOT, RIGHT_FOOT, grips, solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import about_z, align, multiply, slerp
from ahmss.errors import AlgorithmError
from ahmss.motion.contact import foot_points
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.planting import feet, plant
from ahmss.motion.way import staying
from ahmss.reaching.prism import in_the_way
from ahmss.reaching.reacher import SIDES
from ahmss.reaching.standing import Posture, Standing
from ahmss.reaching.trunk_way import between, drawn_towards
from ahmss.skills.begun import begun_at
from ahmss.skills.hands_aside import hands_aside
from ahmss.skills.reaching import prisms_of
from ahmss.skills.sitting import seat_of, stands
from ahmss.walking.library import BODY

__all__ = ["at_ease_at", "at_ease_on", "crouches", "drawn_in", "risen"]

_UP, _IN = 1.3, 0.9  # seconds
_ELSEWHERE = 0.25  # metres from where a hand hangs at ease, from which on it is drawn in
_LAST = 0.4  # share of the time in which hands that were moved aside come to hang all the same
_TRUNK = [INDEX["hips"], INDEX["spine"]]


def crouches(task: HumanTask) -> bool:
    """Whether the human is low over its feet, which bear it, and sits on nothing."""
    if stands(task) or task.carried or seat_of(task) is not None:
        return False
    soles = feet(task.human, task.start.rotations, task.start.root)[:, 2]
    on_floor = float(soles.min()) > 0.0
    return on_floor and Standing.of(task.human, task.start.rotations, task.start.root) is not None


def at_ease_on(task: HumanTask, rotations: Array, root: Array) -> Posture:
    """Standing at ease on the feet of a pose (43, 4), (3,) where they are.

    Raises:
        AlgorithmError: the action names no walk library, which says how.
    """
    own = rotations.copy()
    own[:BODY] = _ease(task)
    own, above = plant(task.human, own, feet(task.human, rotations, root))
    return Posture(align(own, rotations), above)


def at_ease_at(task: HumanTask, stand: Transform) -> Posture:
    """Standing at ease at a place on the floor, looking along its x; the fingers as they are.

    Raises:
        AlgorithmError: the action names no walk library, which says how.
    """
    own = task.start.rotations.copy()
    own[:BODY] = _ease(task)
    own[0] = multiply(about_z(stand.rotation), own[0])
    soles = foot_points(task.human, own, np.zeros(3))[..., 2]
    return Posture(align(own, task.start.rotations), np.append(stand.place[:2], -float(soles.min())))


def _ease(task: HumanTask) -> Array:
    """How one stands at ease, rotations (15, 4).

    Raises:
        AlgorithmError: the action names no walk library, which says how.
    """
    if task.library is None:
        raise AlgorithmError("standing up needs a walk library as the action's motion, for how one stands at ease")
    clip = next(clip for key, clip in task.library.clips.items() if key.kind == "start")
    return clip.rotations[0][:BODY]


def risen(task: HumanTask, importance: Array, keeps: Sequence[str] = ()) -> Generator[Array, None, HumanTask]:
    """The task from standing, after frames (n, 272) of rising, beside what stands about; as it is who does not crouch.

    Args:
        task: with a walk library. importance: (44,) of these frames.
        keeps: the sides whose hands go with the shoulder, not tipped, for what they hold; others come to hang.
    """
    return (yield from _eased(task, importance, keeps, _UP)) if crouches(task) else task


def drawn_in(task: HumanTask, importance: Array, keeps: Sequence[str] = ()) -> Generator[Array, None, HumanTask]:
    """The task from standing at ease, after frames (n, 272), where a hand that is to hang is over a table, say, and
    not near the hip; else as it is. The rest as of `risen`.
    """
    start = task.start
    ease = at_ease_on(task, start.rotations, start.root)
    here, there = (grips(task.human, pose.rotations, pose.root)[:, :3] for pose in (start, ease))
    free = [row for row, side in enumerate(SIDES) if side not in keeps]
    off = np.linalg.norm(here - there, axis=-1)[free].max(initial=0.0)
    return (yield from _eased(task, importance, keeps, _IN)) if off > _ELSEWHERE else task


def _eased(
    task: HumanTask, importance: Array, keeps: Sequence[str], seconds: float
) -> Generator[Array, None, HumanTask]:
    """The task from standing at ease, after frames (n, 272); as it is where the feet don't bear the body."""
    skeleton, start = task.human, Posture(task.start.rotations, task.start.root)
    standing = Standing.of(skeleton, start.rotations, start.root)
    if standing is None:
        return task
    end = at_ease_on(task, start.rotations, start.root)
    targets = np.zeros((1, 5, 8))
    targets[0, RIGHT_FOOT : LEFT_FOOT + 1, :7], targets[0, RIGHT_FOOT : LEFT_FOOT + 1, 7] = standing.feet, 1.0
    still = task.block(start.rotations[None], start.root[None], importance[None], targets, staying(start.root[:2]))
    work = drawn_towards(standing, start, end, None, in_the_way(prisms_of(task), start.root, start.root))
    thought = 0
    while True:
        try:
            next(work)
        except StopIteration as found:
            towards = found.value
            break
        thought += 1
        yield still
    frames = round(seconds * task.rate)
    if task.length:
        frames = max(least(task, frames), min(frames, task.length // 3))
    trunk = between(start, end, towards, minimum_jerk(np.arange(1, frames + 1) / frames))
    poses = _poses(task, standing, trunk, end, keeps)
    rows = np.repeat(importance[None], frames, axis=0)
    often = np.repeat(targets, frames, axis=0)
    yield task.block(
        poses.rotations, poses.root, rows, often, np.repeat(staying(poses.root[-1, :2])[None], frames, axis=0)
    )
    moved = begun_at(task, poses.rotations[-1], poses.root[-1])
    moved.length = max(task.length - thought - frames, 1) if task.length else 0
    return moved


def _poses(task: HumanTask, standing: Standing, trunk: Posture, end: Posture, keeps: Sequence[str]) -> Posture:
    """The poses (n, 43, 4), (n, 3) of who rises: head and arms come to be at ease, legs stand, hands keep out."""
    skeleton, root, n = task.human, trunk.root, len(trunk.root)
    rotations = slerp(task.start.rotations, end.rotations, minimum_jerk(np.arange(1, n + 1) / n)[:, None])
    rotations[:, _TRUNK] = trunk.rotations[:, _TRUNK]
    rotations = standing.on_feet(rotations, root)
    shoulders = [INDEX[f"{side}_upper_arm"] for side in SIDES]
    was = grips(skeleton, task.start.rotations, task.start.root)
    before, _ = forward(task.start.rotations, task.start.root, skeleton.offsets)
    places, _ = forward(rotations, root, skeleton.offsets)
    hands = np.zeros((n, 5, 8))
    hands[:, :2, :7], hands[:, :2, 7] = grips(skeleton, rotations, root), 1.0
    for row, side in enumerate(SIDES):
        if side in keeps:
            hands[:, row, :7] = was[row]
            hands[:, row, :3] += places[:, shoulders[row]] - before[shoulders[row]]
    rotations = solve(skeleton, rotations, root, hands)
    moved = hands_aside(task, rotations, root)
    moved *= minimum_jerk((n - np.arange(1.0, n + 1.0)) / (_LAST * n))[:, None, None]  # what follows begins at ease
    if moved.any():
        hands[:, :2, :3] += moved
        rotations = solve(skeleton, rotations, root, hands)
    return Posture(rotations, root)
