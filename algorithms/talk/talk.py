"""Talking: one stands with somebody, looks at them and now and then away, and nods a little.

People who talk face to face stand about 1.2 m apart (Hall 1966: personal distance, 0.75 to 1.2 m); side by side they
are nearer, and turned to each other a little. Who listens looks at the other most of the time, in glances of some
seconds with shorter ones away (Argyle & Cook 1976, both from memory); the small nods are judged.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanPose, HumanTask, run
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE
from ahmss.body.links import INDEX
from ahmss.errors import AlgorithmError
from ahmss.motion.easing import minimum_jerk
from ahmss.skills.company import Watching
from ahmss.skills.meeting import come_to

FACE_TO_FACE = (0.9, 1.1, 1.25)  # metres: the least, what is aimed at, the most
BESIDE = (0.6, 0.75, 0.95)
LOOKS, AWAY, MOVES = (2.5, 5.0), (0.6, 1.2), 0.35  # seconds
ASIDE = np.radians(16.0)
NODS, NOD = (1.5, 4.0), 0.55  # seconds between, and of each
DEPTH = np.radians(6.0)


def talk(task: HumanTask) -> Iterator[Array | HumanPose]:
    """Frames until the seconds are over."""
    whom = task.object
    if whom is None or whom.kind != "human":
        raise AlgorithmError("talk to whom? name another human")
    beside = task.parameter("beside", False)
    yield from come_to(task, whom, BESIDE if beside else FACE_TO_FACE, beside=beside)
    task.arrived()
    watching = Watching(task, whom)
    n = round(task.parameter("seconds", 6.0) * task.rate)
    yaw, pitch = _glances(task, n), _nods(task, n)
    importance = np.zeros(44)
    importance[INDEX["head"]] = 1.0
    for k in range(n):
        targets = np.zeros((5, 8))
        targets[GAZE] = watching.gaze(yaw[k], pitch[k], k + 1, n)
        yield task.pose({}, None, importance, targets)


def _glances(task: HumanTask, n: int) -> Array:
    """How far aside of the other's eyes one looks (n), radians."""
    time, out, now = np.arange(n) / task.rate, np.zeros(n), 0.0
    while now < n / task.rate:
        now += task.random.uniform(*LOOKS)
        last = now + task.random.uniform(*AWAY)
        way = minimum_jerk((time - now) / MOVES) - minimum_jerk((time - last) / MOVES)
        out += ASIDE * task.random.choice([-1.0, 1.0]) * way
        now = last
    return out


def _nods(task: HumanTask, n: int) -> Array:
    """How far the head nods (n), radians."""
    time, out, now = np.arange(n) / task.rate, np.zeros(n), 0.0
    while now < n / task.rate:
        now += task.random.uniform(*NODS)
        share = np.clip((time - now) / NOD, 0.0, 1.0)
        out += DEPTH * task.random.uniform(0.5, 1.0) * np.sin(np.pi * share) ** 2
        now += NOD
    return out


if __name__ == "__main__":
    run(talk)
