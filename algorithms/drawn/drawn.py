"""A seat on castors that rolls level along its own x axis with the hand that holds it, and stays where it is let go."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import ObjectPose, ObjectTask, Transform, run
from ahmss.body.quaternion import rotate
from ahmss.skills.leading import led

MOST = 3.0  # metres that it goes, either way


def drawn(task: ObjectTask) -> Iterator[ObjectPose]:
    """The seat's pose at each frame of the human."""
    site = np.array(task.object.sites[task.message.site].position)
    place, rotation = task.object.place.copy(), task.object.rotation.copy()
    ahead = rotate(rotation, np.array([1.0, 0.0, 0.0])) * (1.0, 1.0, 0.0)
    held: tuple[Transform | None, float] = None, 0.0  # what led it last, and where on its x axis that holds it

    def gone(before: Transform, now: Transform) -> float:
        nonlocal held
        last, at = held
        if before is not last:  # it has just been taken hold of
            at = float(before.place[0])
        held = now, at
        return float(now.place[0]) - at  # the seat has come along so far, and has to make this

    for way in led(task, 0.0, (-MOST, MOST), lambda _: site, gone, lambda way: way):
        yield task.pose(place + way * ahead, rotation)


if __name__ == "__main__":
    run(drawn)
