"""A small workspace of its own, servers, and mains that run in this process or in processes of their own."""

from __future__ import annotations

import os
import shutil
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from ahmss.main import process
from ahmss.main.process import MainProcess, Setup
from ahmss.processes.hire import Pool
from ahmss.processes.launcher import Launcher
from ahmss.world.process import ServerProcess

ROOT = Path(__file__).parents[2]
PEER = Path(__file__).parents[1] / "peers" / "peer.py"
WRITTEN = 1e9  # when the small algorithms were, seconds since 1970: a program that a test changes is another one

OBJECT = """
name = "box"
sentence = "A box to be acted on."
shape = "box.obj"

[sites.top]
position = [0.0, 0.0, 0.05]

[states.lid]
values = ["shut", "open"]

[affordances.wave]
human_algorithm = "swing"
parameters = { link = "right_upper_arm" }
frames = 20

[affordances.bow]
human_algorithm = "swing"
parameters = { link = "spine" }

[affordances.step]
human_algorithm = "glide"
asks = ["goal_position"]

[affordances.stroll]
human_algorithm = "stroll"
asks = ["goal_position"]
frames = 0

[affordances.touch]
human_algorithm = "touch"
site = "top"
asks = ["hand"]

[affordances.take]
human_algorithm = "swing"
object_algorithm = "carry"
parameters = { link = "right_upper_arm" }
hold = "take"

[affordances.shake]
human_algorithm = "swing"
parameters = { link = "right_upper_arm" }
hold = "keep"

[affordances.drop]
human_algorithm = "swing"
parameters = { link = "left_upper_arm" }
hold = "release"

[affordances.grip_and_die]
human_algorithm = "swing"
object_algorithm = "carry"
parameters = { link = "right_upper_arm", dies = 10 }
hold = "take"

[affordances.open]
human_algorithm = "swing"
when = "lid == shut"

[affordances.reach_high]
human_algorithm = "swing"
needs = { reach = 3.0 }
"""

ALGORITHMS = {
    "swing": (
        "human",
        """
[parameters.link]
type = "str"
default = "right_upper_arm"

[parameters.angle]
type = "float"
default = 0.6
""",
        '''
import numpy as np
from ahmss.algorithm import HumanTask, run
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, multiply

def swing(task: HumanTask):
    link = INDEX[task.parameter("link", "right_upper_arm")]
    first = task.start.rotations[link].copy()
    for k in task.frames():
        t = k / task.length
        turn = from_axis_angle(np.array([0.0, 1.0, 0.0]), -task.parameter("angle", 0.6) * t * t * (3 - 2 * t))
        yield task.pose({task.parameter("link", "right_upper_arm"): multiply(first, turn)})

run(swing)
''',
    ),
    "glide": (
        "human", "",
        '''
from ahmss.algorithm import HumanTask, run

def glide(task: HumanTask):
    start, goal = task.start.root.copy(), task.goal_place
    for k in task.frames():
        root = start.copy()
        root[:2] += (goal[:2] - start[:2]) * k / task.length
        yield task.pose({}, root)

run(glide)
''',
    ),
    "stroll": (
        "human", "",
        '''
import numpy as np
from ahmss.algorithm import HumanTask, run

def stroll(task: HumanTask):
    """A centimetre a frame, or so that the frames asked for suffice."""
    goal = task.goal_place[:2]
    if task.length and task.length < 100 * np.linalg.norm(goal - task.start.root[:2]):
        task.note(f"{task.length} frames are few")
    pace = np.linalg.norm(goal - task.start.root[:2]) / task.length if task.length else 0.01
    for _ in task.frames():
        way = goal - task.present.root[:2]
        left = np.linalg.norm(way)
        if left < 1e-9:
            return
        root = task.present.root.copy()
        root[:2] += way * min(1.0, pace / left)
        yield task.pose({}, root)

run(stroll)
''',
    ),
    "touch": (
        "human", "",
        '''
import numpy as np
from ahmss.algorithm import HumanTask, run

def touch(task: HumanTask):
    side = task.hand or "right"
    start = task.start.grip(side).place.copy()
    for k in task.frames():
        place = start + (task.site.place - start) * k / task.length
        yield task.pose({}, targets={f"{side}_hand": place}, importance={f"{side}_hand": 1.0})

run(touch)
''',
    ),
    "carry": (
        "object",
        """
[parameters.dies]
type = "int"
default = 0
""",
        '''
import sys
from ahmss.algorithm import ObjectTask, run

def carry(task: ObjectTask):
    """From frame 5 on the object goes with the palm."""
    held = None
    for human in task.frames():
        grip = human.grip(task.hand or "right")
        if human.k == task.parameter("dies", 0):
            sys.exit("it was dropped")
        if human.k >= 5:
            held = held or grip.inverse().then(task.object.frame)
            now = grip.then(held)
            yield task.pose(now.place, now.rotation)
        else:
            yield task.pose()

run(carry)
''',
    ),
}  # fmt: skip

CUBE = "\n".join(
    [f"v {x} {y} {z}" for x in (-0.05, 0.05) for y in (-0.05, 0.05) for z in (-0.05, 0.05)]
    + ["f 1 3 4 2", "f 5 6 8 7", "f 1 2 6 5", "f 3 7 8 4", "f 1 5 7 3", "f 2 4 8 6"]
)


def write_algorithm(workspace: Path, name: str, kind: str, parameters: str, code: str) -> None:
    folder = workspace / "algorithms" / name
    folder.mkdir(parents=True)
    (folder / "algorithm.toml").write_text(f'kind = "{kind}"\nargv = ["python", "{name}.py"]\n{parameters}')
    (folder / f"{name}.py").write_text(code)


def write_peer(workspace: Path, how: str) -> None:
    """An affordance of the box that is carried out by a misbehaving program."""
    folder = workspace / "algorithms" / how
    folder.mkdir(parents=True)
    shutil.copy(PEER, folder / "peer.py")
    program = folder / "start"
    program.write_text(f'#!/bin/sh\nexec {sys.executable} -I -S "$(dirname "$0")/peer.py" {how}\n')
    program.chmod(0o755)
    (folder / "algorithm.toml").write_text('kind = "human"\nargv = ["./start"]\n')
    with (workspace / "objectdb/box/object.toml").open("a") as file:
        file.write(f'\n[affordances.{how}]\nhuman_algorithm = "{how}"\n')


def make_workspace(root: Path) -> Path:
    """The box, the humans and the small algorithms in a folder."""
    box = root / "objectdb" / "box"
    box.mkdir(parents=True)
    (box / "object.toml").write_text(OBJECT)
    (box / "box.obj").write_text(CUBE)
    shutil.copytree(ROOT / "humandb", root / "humandb")
    for name, (kind, parameters, code) in ALGORITHMS.items():
        write_algorithm(root, name, kind, parameters, code)
        os.utime(root / "algorithms" / name / f"{name}.py", (WRITTEN, WRITTEN))
    return root


@pytest.fixture
def workspace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Made anew for each test, but in the same place: its programs are known to the pool from the first one on."""
    root = tmp_path_factory.getbasetemp() / "workspace"
    shutil.rmtree(root, ignore_errors=True)
    return make_workspace(root)


@pytest.fixture(scope="session")
def pool() -> Iterator[None]:
    """The pool, kept alive between tests."""
    made = Pool()
    yield
    made.close()


@pytest.fixture
def server(tmp_path: Path) -> Iterator[Callable[..., ServerProcess]]:
    """Starts servers; they are stopped after the test."""
    servers: list[ServerProcess] = []

    def begin(**options: Any) -> ServerProcess:
        servers.append(ServerProcess(log=tmp_path / "server.log", **options))
        return servers[-1]

    yield begin
    for one in servers:
        one.stop()


@pytest.fixture
def join(workspace: Path, pool: None, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., MainProcess]]:
    """Makes mains in this process; what they say is in `report.messages`.

    Their frames come one upon another, without a clock: each waits for what is asked for, or none would be there.
    """
    monkeypatch.setattr(process, "Launcher", lambda **given: Launcher(**{**given, "once": False}))
    mains: list[MainProcess] = []

    def begin(server: ServerProcess | str, human: str = "ken", **options: Any) -> MainProcess:
        address = server if isinstance(server, str) else server.address
        setup = Setup(human, server=address, workspace=workspace, seed=1, **{"body": "ken", **options})
        mains.append(MainProcess(setup, lambda _: None))
        return mains[-1]

    yield begin
    for main in mains:
        main.close()
