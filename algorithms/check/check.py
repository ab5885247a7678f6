"""Checking a gauge: the head turns to it, it is looked at for a second or two, and what it shows is told.

From how far it can be read its property `legible` says. Who is farther away, sees it too much from the side, or would
have to turn the head too far goes before it first, where the action names a walk library.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanTask, run
from ahmss.algorithm.haste import hurried
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.errors import AlgorithmError
from ahmss.reaching.reacher import heading_of
from ahmss.skills.controls import before, front_of, gone_to
from ahmss.skills.keeping import kept_clear
from ahmss.skills.reaching import HEAD, Looking
from ahmss.skills.stands import is_taken, standing
from ahmss.walking.goals import Goal

LEGIBLE, NEARER = 1.2, 0.7  # metres, where its properties do not say; of that, from where one comes to read it
BESIDE = np.radians([0.0, 25.0, -25.0, 38.0, -38.0, 50.0, -50.0])  # about it, from where one reads it beside others
TURNS = 0.35  # seconds in which the head turns
ASIDE, OBLIQUE = np.radians(70.0), np.radians(60.0)  # that the head turns aside; from its axis, that it is read from


def check(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260): steps to where it can be read, if needed; the head turns to it, and stays so a while.

    What is in a hand is kept out of what stands there.

    Raises:
        AlgorithmError: the action names no site; it can't be read while another motion carries the body away.
    """
    return kept_clear(task, _check(task))


def _check(task: HumanTask) -> Iterator[Array]:
    """The frames (n, 260)."""
    if task.site is None or task.object is None:
        raise AlgorithmError("check needs a site: the face of what is read, its x out of it")
    gaze = Looking(task, task.site.place)
    if task.library is not None and not task.carried and not _legible(task):
        task, gaze = yield from gone_to(task, _stand(task), gaze)
    task.arrived()
    length = hurried(task, round((TURNS + task.parameter("seconds", 1.5)) * task.rate))
    frames = gaze.frames + np.arange(1.0, length + 1.0)
    importance = np.zeros(44)
    importance[INDEX["head"]] = HEAD
    rows = task.block(
        np.repeat(task.start.rotations[None], length, axis=0), np.repeat(task.start.root[None], length, axis=0),
        np.repeat(importance[None], length, axis=0), gaze.rows(frames),
    )  # fmt: skip
    seen = max(length - round(0.2 * task.rate), 1)
    yield rows[:seen]
    task.note(_said(task))
    yield rows[seen:]


def _stand(task: HumanTask) -> Goal:
    """Where it is read from, beside those who stand there.

    What is seen from all sides is read from the side where one is, and no nearer than one is.
    """
    assert task.object is not None
    away = NEARER * _far(task)
    if _anywhere(task):
        off = (task.start.root - task.object.place)[:2]
        distance = float(np.linalg.norm(off))
        away, front = min(away, distance), off / max(distance, 1e-6)
    else:
        front = front_of(task.object.frame)
    taken, (x, y) = standing(task), front
    cos, sin = np.cos(BESIDE), np.sin(BESIDE)
    fronts = np.stack([x * cos - y * sin, x * sin + y * cos], axis=-1)
    places = [before(task, away, front=front) for front in fronts]
    return next((place for place in places if not is_taken(place, taken)), places[0])


def _anywhere(task: HumanTask) -> bool:
    assert task.object is not None
    return task.object.sites[task.message.site].free_axis == "z"


def _far(task: HumanTask) -> float:
    assert task.object is not None
    return float(task.object.properties.get("legible", LEGIBLE))


def _legible(task: HumanTask) -> bool:
    """Whether it can be read from where the human stands, the head turned to it."""
    assert task.site is not None
    places, _ = forward(task.start.rotations, task.start.root, task.human.offsets)
    off = task.site.place - places[INDEX["head"]]
    away = float(np.linalg.norm(off))
    out = rotate(task.site.rotation, np.array([1.0, 0.0, 0.0]))
    aside = np.arctan2(off[1], off[0]) - heading_of(task.start.rotations, task.start.root)
    aside = abs((aside + np.pi) % (2.0 * np.pi) - np.pi)
    return bool(away <= _far(task) and aside < ASIDE and (_anywhere(task) or -off @ out > away * np.cos(OBLIQUE)))


def _said(task: HumanTask) -> str:
    """What it shows, in a sentence: main puts in what that is as it is told, not as the motion began."""
    assert task.object is not None
    state = task.parameter("state", "value")
    return f"{state} is {{{state}}}" if state in task.object.states else f"{state} is nothing"


if __name__ == "__main__":
    run(check)
