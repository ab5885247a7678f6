"""Looking at a thing: the head turned to its site and kept there; who has it behind their back turns around first."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanTask, importance_of, run
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE
from ahmss.errors import AlgorithmError
from ahmss.skills.company import aside_of
from ahmss.skills.facing import BEHIND, faced

TURNING = 4.0  # seconds, at the most, in which one turns around
NOT_SEEN = "it is not seen from here; look once one faces it (`then`, or `after N`)"


def look(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260): steps around on the spot if it is behind; then the gaze on it, as fast as a head turns.

    Raises:
        AlgorithmError: the action names no site; it is behind, and one can't turn around in so few frames, or sits.
    """
    if task.site is None or task.object is None:
        raise AlgorithmError("look needs a site: the place that is looked at")
    place, name = task.site.place, task.object.name
    if not task.led:  # who reaches for something meanwhile stays as they stand
        _check_time(task, place, name)
        task = yield from faced(task, place, BEHIND, name)
    task.arrived()
    length = task.length or round(task.rate)
    targets = np.zeros((length, 5, 8))
    targets[:, GAZE, :3], targets[:, GAZE, 7] = place, 1.0
    rows = task.block(
        np.repeat(task.start.rotations[None], length, axis=0), np.repeat(task.start.root[None], length, axis=0),
        np.repeat(importance_of({"head": 1.0})[None], length, axis=0), targets,
    )  # fmt: skip
    yield rows[:-1]
    aside = abs(aside_of(task, place))
    if aside > BEHIND:  # who is carried, or reaches for something, does not turn around
        task.note(f"{name} is {np.degrees(aside):.0f} degrees aside, behind the back: {NOT_SEEN}")
    yield rows[-1:]


def _check_time(task: HumanTask, place: Array, name: str) -> None:
    """Refuse to turn around in fewer frames than that takes: the motion would end in the midst of it."""
    aside, needed = abs(aside_of(task, place)), round(TURNING * task.rate)
    if not task.carried and aside > BEHIND and 0 < task.length < needed and not task.message.wish:
        raise AlgorithmError(
            f"{name} is {np.degrees(aside):.0f} degrees aside, behind the back, and {task.length} frames are too few "
            f"to turn around; leave `frames` out, or ask for {needed}"
        )


if __name__ == "__main__":
    run(look)
