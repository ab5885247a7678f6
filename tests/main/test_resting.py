"""A motion that is given up: at once, or as it has come to rest where its algorithm can do that."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.main.process import MainProcess
from ahmss.world.process import ServerProcess
from tests.main.conftest import write_algorithm
from tests.main.ground import steps

pytestmark = pytest.mark.usefixtures("pool")

ARM = INDEX["right_upper_arm"]
RAISES = '''
import numpy as np
from ahmss.algorithm import HumanTask, run
from ahmss.body.quaternion import from_axis_angle

def raises(task: HumanTask):
    """The right arm goes up by 1 degree a frame, and once it is to rest down again, by 2; or never ends."""
    angle = 0.0
    for k in task.frames():
        if task.rests and {stubborn}:
            angle -= 2.0
            if angle < 0.0:
                task.note(f"rests at frame {{k}}")
                return
        else:
            angle = min(angle + 1.0, 60.0)
        turned = from_axis_angle(np.array([1.0, 0.0, 0.0]), np.radians(angle))
        yield task.pose({{"right_upper_arm": turned}})

run(raises)
'''


@pytest.fixture
def raising(workspace: Path) -> Path:
    """The box affords `raise`, whose algorithm comes to rest, and `hold_up`, whose never does."""
    for name, word, stubborn in (("raises", "raise", "True"), ("stubborn", "hold_up", "False")):
        write_algorithm(workspace, name, "human", "rests = true\n", RAISES.format(stubborn=stubborn))
        with (workspace / "objectdb/box/object.toml").open("a") as file:
            file.write(f'\n[affordances.{word}]\nhuman_algorithm = "{name}"\nframes = 0\n')
    return workspace


@pytest.fixture
def ken(raising: Path, server: Callable[..., ServerProcess], join: Callable[..., MainProcess]) -> MainProcess:
    main = join(server(lockstep=["ken"]), fast=True, names=("ken",))
    main.play(steps("add box as b at 0.3 0 1"))
    return main


def begin(main: MainProcess, line: str, frames: int) -> None:
    for step in steps(line):
        main.agenda.add(step)
    go_on(main, frames)


def go_on(main: MainProcess, frames: int) -> None:
    for _ in range(frames):
        main.frame()


def test_who_can_comes_to_rest_before_the_next_line_begins(ken: MainProcess) -> None:
    begin(ken, "do b raise", 40)
    ken.stop_motion()
    for step in steps("do b wave frames 10"):
        ken.agenda.add(step)
    go_on(ken, 5)
    assert [title for title, _, _ in ken.control.progress] == ["b raise"]
    go_on(ken, 60)
    assert ken.agenda.done
    assert [note.partition(" at frame")[0] for note in ken.report.notes] == ["b raise: rests"]
    assert ken.report.messages == []


def test_given_up_once_more_it_ends_at_once(ken: MainProcess) -> None:
    begin(ken, "do b raise", 40)
    ken.stop_motion()
    go_on(ken, 3)
    ken.stop_motion()
    go_on(ken, 2)
    assert not ken.control.busy
    assert ken.report.notes == []


def test_who_does_not_come_to_rest_is_given_up_after_a_while(ken: MainProcess) -> None:
    begin(ken, "do b hold_up", 40)
    ken.stop_motion()
    go_on(ken, 230)
    assert ken.control.busy
    go_on(ken, 15)
    assert not ken.control.busy
    assert np.abs(ken.blending.rotations[ARM]).max() <= 1.0


def test_what_has_not_begun_ends_at_once(ken: MainProcess) -> None:
    for step in steps("do b raise after 100"):
        ken.agenda.add(step)
    go_on(ken, 3)
    ken.stop_motion()
    go_on(ken, 2)
    assert not ken.control.busy
