"""Pressing a button: the extended index finger comes along the -x of the site, pushes by the travel, and draws back.

The reach is that of `reach`, to a place a little before the face, of the palms that do so those that leave the controls
beside it alone. Who stands where it can't be pressed steps there first, where the action names a walk library. A button
with a travel takes 150 to 300 ms to press.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from ahmss.algorithm import HumanTask, run
from ahmss.algorithm.haste import least
from ahmss.body.array import Array
from ahmss.body.links import fingers
from ahmss.body.quaternion import rotate, slerp
from ahmss.errors import AlgorithmError
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.goal import Goal
from ahmss.reaching.handpoints import hand_points
from ahmss.reaching.pointing import palms_pointing, pointing
from ahmss.skills.at_ease import at_ease
from ahmss.skills.box import Box
from ahmss.skills.by_fingertip import Touching, by_fingertip
from ahmss.skills.controls import beside, clear_of, front_of, in_the_way
from ahmss.skills.going_back import gone_back, rows_made
from ahmss.skills.keeping import kept_clear
from ahmss.skills.reaching import sides_of

TRAVEL = 0.004  # metres, where neither parameter nor property says
BEFORE, BACK = 0.035, 0.06  # metres before the face at which the finger is set, and to which it is drawn back
OVER = 0.0003  # metres beyond the travel, so that it is pushed all the way
COMES, PUSHES, STAYS, LEAVES, RESTS = 0.16, 0.12, 0.07, 0.3, 0.4  # seconds; the last of the fingers


def press(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260) of it, what the other hand holds kept out of the way."""
    return kept_clear(task, _press(task))


def _press(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260): the hand comes, presses, and is drawn back."""
    site = task.site
    if site is None or task.object is None:
        raise AlgorithmError("press needs a site: the button's face, its x out of it")
    if task.carried:
        raise AlgorithmError("a button is pressed standing; walk there first, then press it")
    out = rotate(site.rotation, np.array([1.0, 0.0, 0.0]))
    boxes = beside(task)
    palms = {side: _palms(task, side, out, boxes) for side in sides_of(task)}
    goal = Goal(site.place, palms=palms)
    touching = Touching(goal, BEFORE * out, out, site.place, lambda palm: _pushed(task, palm, out), in_the_way(task))
    task, plan, made = yield from by_fingertip(task, touching)
    rows = rows_made(task, made)
    pushes = len(_pushed(task, plan.palm, out))
    if task.parameter("returns", False):
        length = len(made.root) - pushes
        rows = np.concatenate([rows, gone_back(task, made, length, plan.reacher.links)])
    else:
        rows = _relaxed(task, rows, plan.reacher.side, pushes)
    yield at_ease(task, rows)


def _relaxed(task: HumanTask, rows: Array, side: str, pushes: int) -> Array:
    """The frames (n, 260), and some more of a hand that is drawn back, whose fingers come to rest in the last of them.

    Where so many were asked for there are no more: they rest in the last of those, `pushes` of all, that push.
    """
    n, links = round(RESTS * task.rate), list(fingers(side))
    if task.length:
        n = min(n, max(pushes // 3, 1))
    else:
        rows = np.concatenate([rows, np.repeat(rows[-1:], n - round(0.5 * LEAVES * task.rate), axis=0)])
    rotations = rows[-n:, 4:176].reshape(n, 43, 4)  # of a POSE
    rest = task.human.relaxed()[0][links]
    rotations[:, links] = slerp(rotations[:, links], rest, minimum_jerk(np.arange(1, n + 1) / n)[:, None])
    return rows


def _palms(task: HumanTask, side: str, out: Array, boxes: Sequence[Box]) -> Array:
    """Palms (n, 7) whose index fingertip is at the face: those that are clear of the neighbours, if any are."""
    assert task.site is not None
    ahead = -np.append(front_of(task.site), 0.0)
    palms = palms_pointing(task.human, side, task.site.place, -out, ahead)
    return clear_of(boxes, palms, hand_points(task.human, side, palms, pointing(side), spared="index"))


def _pushed(task: HumanTask, palm: Array, out: Array) -> Array:
    """Palms (n, 7) from before the face into it, by the travel, and back again."""
    assert task.object is not None
    travel = task.parameter("travel", 0.0) or float(task.object.properties.get("travel", TRAVEL))
    way = [(0.0, COMES), (BEFORE, COMES), (BEFORE + travel + OVER, PUSHES), (BEFORE + travel + OVER, STAYS)]
    way.append((BEFORE - BACK, LEAVES))
    depth: list[Array] = []
    for (before, _), (after, seconds) in itertools.pairwise(way):
        time = np.arange(1, round(seconds * task.rate) + 1) / round(seconds * task.rate)
        depth.append(before + minimum_jerk(time) * (after - before))
    palms = np.repeat(palm[None], sum(map(len, depth)), axis=0)
    palms[:, :3] -= np.concatenate(depth)[:, None] * out
    if task.length:  # a short motion has few frames for it
        count = min(len(palms), max(task.length // 2, least(task, len(palms))))
        palms = palms[np.linspace(0, len(palms) - 1, count).round().astype(int)]
    return palms


if __name__ == "__main__":
    run(press)
