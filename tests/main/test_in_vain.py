"""A motion that was to bring something about, and has not, is told as failed; one that has is done."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from ahmss.main.process import MainProcess
from ahmss.world.process import ServerProcess
from tests.main.conftest import write_algorithm
from tests.main.ground import steps

RAISE = '''
from ahmss.algorithm import HumanTask, run

def lift(task: HumanTask):
    """20 frames, in the tenth of which it comes to what `comes` says."""
    task.means("it is at {level} only; try again", level=(0.9, 1.0))
    for k in task.frames():
        yield task.pose({}, states={"level": task.parameter("comes", 1.0)} if k == 10 else None)

run(lift)
'''
COMES = """
[parameters.comes]
type = "float"
default = 1.0
"""
OFFERED = """
[states.level]
range = [0.0, 1.0]

[affordances.lift]
human_algorithm = "lift"
frames = 20
"""


@pytest.mark.parametrize(
    ("comes", "told"),
    [(1.0, []), (0.93, []), (0.4, ["b lift: it is at 0.40 only; try again"])],
)
def test_what_was_not_brought_about_has_failed(
    server: Callable[..., ServerProcess],
    join: Callable[..., MainProcess],
    workspace: Path,
    comes: float,
    told: list[str],
) -> None:
    write_algorithm(workspace, "lift", "human", COMES, RAISE)
    with (workspace / "objectdb/box/object.toml").open("a") as file:
        file.write(OFFERED)
    main = join(server())
    main.play(steps("add box as b at 0.5 0 1", f"do b lift comes={comes}", "do b wave"))
    assert main.report.messages == told
    assert main.control.failures == len(told)
    assert not main.control.busy


def test_of_two_that_follow_each_other_the_second_is_not_begun_in_vain(
    server: Callable[..., ServerProcess], join: Callable[..., MainProcess], workspace: Path
) -> None:
    write_algorithm(workspace, "lift", "human", COMES, RAISE)
    with (workspace / "objectdb/box/object.toml").open("a") as file:
        file.write(OFFERED)
    main = join(server())
    main.play(steps("add box as b at 0.5 0 1", "do b lift comes=0.2 then b lift"))
    assert main.report.messages == ["b lift: it is at 0.20 only; try again"]
    assert main.communication.objects["b"].states["level"] == 0.2
