"""An object that stays where it is while a human has it: nobody else can take it meanwhile."""

from __future__ import annotations

from collections.abc import Iterator

from ahmss.algorithm import ObjectPose, ObjectTask, run


def stay(task: ObjectTask) -> Iterator[ObjectPose]:
    """The object's pose at each frame of the human: the one it has."""
    for _ in task.frames():
        yield task.pose()


if __name__ == "__main__":
    run(stay)
