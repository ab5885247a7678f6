"""A Python algorithm that tells about its process in its log, one JSON line, and then stands still."""

import json
import os
import sys

from ahmss.algorithm import HumanTask, run


def tells(task: HumanTask):
    library = task.library
    facts = {
        "pid": os.getpid(),
        "parent": os.getppid(),
        "session": os.getsid(0),
        "descriptors": sorted(int(name) for name in os.listdir("/proc/self/fd")),
        "directory": os.getcwd(),
        "argv": sys.argv,
        "threads": len(os.listdir("/proc/self/task")),
        "clip": task.motion.frames if library is None and task.motion else 0,
        "walk": [key.name for key in library.clips] if library else [],
        "zmq": "zmq" in sys.modules,
        "shapely": "shapely" in sys.modules,
    }
    print(json.dumps(facts), flush=True)
    for k in task.frames():
        if k == 3 and "abort" in sys.argv:
            os.abort()
        while k == 3 and "hang" in sys.argv:
            pass
        yield task.pose({})


run(tells)
