"""A Python algorithm that raises at frame 30."""

from ahmss.algorithm import HumanTask, run


def raises(task: HumanTask):
    for k in task.frames():
        yield task.pose({"head": [1.0, 0.0, 0.0, 0.0]} if k < 30 else {"haed": [1.0, 0.0, 0.0, 0.0]})


run(raises)
