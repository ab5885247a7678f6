"""Algorithms: what an author imports, the protocol, and the launcher that main drives them by.

    from ahmss.algorithm import HumanTask, run

    def nod(task: HumanTask):
        for k in task.frames():
            yield task.pose({"head": ...})

    if __name__ == "__main__":
        run(nod)

docs/writing-an-algorithm.md tells the rest. Main imports `ahmss.processes.launcher` and `ahmss.algorithm.messages`.
"""

from ahmss.algorithm.author import run
from ahmss.algorithm.performance import frames
from ahmss.algorithm.place import Transform, WorldObject, resolve_site
from ahmss.algorithm.pose import HumanPose, ObjectPose, importance_of, target_rows
from ahmss.algorithm.task import HumanFrame, HumanTask, ObjectTask

__all__ = [
    "HumanFrame",
    "HumanPose",
    "HumanTask",
    "ObjectPose",
    "ObjectTask",
    "Transform",
    "WorldObject",
    "frames",
    "importance_of",
    "resolve_site",
    "run",
    "target_rows",
]
