"""A Python algorithm that prints at every turn; it does no harm."""

import subprocess

from ahmss.algorithm import HumanTask, run

print("printed before run")


def prints(task: HumanTask):
    print("printed at the start")
    subprocess.run(["echo", "printed by a child"], check=True)
    for k in task.frames():
        print(f"printed at frame {k}")
        yield task.pose({})


run(prints)
