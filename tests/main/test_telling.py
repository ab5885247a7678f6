"""What algorithms tell of an object's states is so as it is told."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from ahmss.body.array import Array
from ahmss.main.process import MainProcess
from ahmss.main.telling import told
from ahmss.world.process import ServerProcess
from tests.main.conftest import write_algorithm
from tests.main.ground import steps

WATCH = '''
from ahmss.algorithm import HumanTask, run

def watch(task: HumanTask):
    """20 frames; what the lid is then."""
    for k in task.frames():
        if k == task.length:
            task.note("lid is {lid}, {weather} is no state of it")
        yield task.pose({})

run(watch)
'''


def test_a_state_in_braces_is_its_value() -> None:
    assert told("value is {value}, {lid} {x}", {"value": 0.625, "lid": "open"}) == "value is 0.62, open {x}"


def test_what_is_told_at_the_end_is_what_is_so_then(
    server: Callable[..., ServerProcess], join: Callable[..., MainProcess], workspace: Path
) -> None:
    write_algorithm(workspace, "watch", "human", "", WATCH)
    with (workspace / "objectdb/box/object.toml").open("a") as file:
        file.write('\n[affordances.watch]\nhuman_algorithm = "watch"\nframes = 40\n')
    main = join(server())
    main.play(steps("add box as b at 0.5 0 1"))
    communication = main.communication
    publish, shown = communication.publish, [0]

    def opened(root: Array, rotations: Array, moved: Array | None, way: Array) -> None:
        publish(root, rotations, moved, way)
        shown[0] += 1
        if shown[0] == 10:
            communication.set_state("b", "lid", "open")

    communication.publish = opened
    main.play(steps("do b watch"))
    assert main.report.messages == []
    assert main.report.notes == ["b watch: lid is open, {weather} is no state of it"]
