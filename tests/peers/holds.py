"""A Python object algorithm that holds on: it computes for ever at frame 3 and hears nothing."""

from ahmss.algorithm import ObjectTask, run


def holds(task: ObjectTask):
    for human in task.frames():
        while human.k == 3:
            pass
        yield task.pose()


run(holds)
