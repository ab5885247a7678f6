"""Drawing a seat on castors back from a desk, so that one can sit down on it.

One stands behind it, takes its back between thumb and fingers, and draws it towards oneself, along its -x; what is
farther than an arm draws is drawn in several pulls, with steps back between them.
"""

from __future__ import annotations

import copy
from collections.abc import Generator, Iterator
from math import ceil

import numpy as np

from ahmss.algorithm import HumanTask, run
from ahmss.body.array import Array
from ahmss.body.quaternion import IDENTITY, rotate
from ahmss.errors import AlgorithmError
from ahmss.skills.begun import begun_at
from ahmss.skills.controls import gone_to
from ahmss.skills.pinching import Part, pinched
from ahmss.skills.reaching import Looking
from ahmss.skills.seat_room import drawn_back
from ahmss.skills.stepping import walk_library
from ahmss.walking.goals import Goal

PULL = 0.26  # metres that an arm draws at a time, at the most
AWAY, ASIDE = 0.54, 0.16  # metres from the back to the middle of who takes it, behind it and beside it
LEAST, A_METRE = 0.5, 2.6  # seconds that a pull takes at least, and for a metre more


def draw_out(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260): the way behind it, and the pulls.

    Raises:
        AlgorithmError: the action names no site, it has no shape, nobody gets behind it.
    """
    thing = task.object
    if task.site is None or thing is None or thing.shape is None:
        raise AlgorithmError("draw_out needs a seat that has a shape, and a site where its back is taken")
    if task.carried:
        raise AlgorithmError("a seat is drawn out standing; walk there first, then draw it out")
    walk_library(task)
    far = task.parameter("far", 0.0) or drawn_back(task, thing)
    if far <= 0.0:
        task.note("there is room to sit down on it already")
        return
    pulls = ceil(far / PULL)
    for _ in range(pulls):
        rows = yield from _pulled(task, far / pulls)
        task = begun_at(task, rows[-1, 4:176].reshape(43, 4), rows[-1, 1:4])
        task.site = thing.site(task.message.site, task.start.root)  # where it has come to meanwhile


def _pulled(task: HumanTask, far: float) -> Generator[Array, None, Array]:
    """Frames (n, 260) of one pull, and the last of them."""
    assert task.site is not None
    assert task.object is not None
    ahead = rotate(task.object.rotation, np.array([1.0, 0.0, 0.0]))
    left = np.array([-ahead[1], ahead[0]])
    heading = float(np.arctan2(ahead[1], ahead[0]))
    sign = -1.0 if (task.hand or "right") == "left" or "right" in task.busy else 1.0
    place = task.site.place[:2] - AWAY * ahead[:2] + sign * ASIDE * left
    task, _ = yield from gone_to(task, Goal(place, heading), Looking(task, task.site.place))
    site = task.site
    assert site is not None
    task = copy.copy(task)
    task.hand, task.library = "right" if sign > 0.0 else "left", None  # one stands well

    def gone(share: Array) -> tuple[Array, Array]:
        return site.place - far * share[:, None] * ahead, np.tile(IDENTITY, (len(share), 1))

    rows = task.start.row[None]
    for rows in pinched(task, Part(site, gone, LEAST + A_METRE * far)):
        yield rows
    return rows


if __name__ == "__main__":
    run(draw_out)
