"""What START tells of the world, by what algorithm.toml asks for."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ahmss.algorithm import messages
from ahmss.database.layout import init
from ahmss.database.workspace import Workspace
from ahmss.main.command import Do, parse
from ahmss.main.database import Database
from ahmss.main.process import MainProcess
from ahmss.world.process import ServerProcess
from tests.main.ground import steps

Start = Callable[..., ServerProcess]
Join = Callable[..., MainProcess]


@pytest.fixture
def ken(server: Start, join: Join, workspace: Path) -> MainProcess:
    """A main in lockstep with two boxes, one turned."""
    main = join(server(lockstep=["ken"]), fast=True, names=("ken",))
    main.play(steps("add box as a at 0.3 0 1", "add box as b at 1 1 0.5 facing 45"))
    return main


def told(main: MainProcess, line: str) -> messages.Start:
    """The START of a motion."""
    do = parse(line)
    assert isinstance(do, Do)
    order = main.database.order(do.acts[0], main.communication, main.actor)
    return main.database.start(order, "human", main.communication, main.actor, 1, 60.0)


def ask(workspace: Path, *lines: str) -> None:
    """Let `glide` ask for more."""
    with (workspace / "algorithms/glide/algorithm.toml").open("a") as file:
        file.write("".join(f"{line}\n" for line in lines))


def test_footprints_are_told_where_they_are_asked_for(ken: MainProcess, workspace: Path) -> None:
    start = told(ken, "do a step to b")
    assert start.object is not None
    assert start.goal.object is not None
    assert [record.name for record in start.world] == ["b"]
    assert [r.footprint for r in (start.object, start.goal.object, *start.world)] == [[], [], []]
    assert b'"footprint"' not in messages.encode_start(start)
    ask(workspace, "footprints = true")
    start = told(ken, "do a step to b")
    assert start.object is not None
    assert start.goal.object is not None
    for record in (start.object, start.goal.object, *start.world):
        (ring,) = record.footprint
        np.testing.assert_allclose(np.abs(ring), 0.055, atol=1e-9)  # in its own frame
    assert messages.decode_start(messages.encode_start(start)[5:]) == start


def test_the_shape_is_told_of_the_target_where_it_is_asked_for(ken: MainProcess, workspace: Path) -> None:
    start = told(ken, "do a step to b")
    assert start.object is not None
    assert start.object.shape is None
    assert b'"shape"' not in messages.encode_start(start)
    ask(workspace, "shape = true")
    start = told(ken, "do a step to b")
    assert start.object is not None
    assert start.object.shape is not None
    data = Path(start.object.shape.path).read_bytes()
    assert start.object.shape.hash == hashlib.sha256(data).hexdigest()
    assert [record.shape for record in start.world] == [None]
    assert messages.decode_start(messages.encode_start(start)[5:]) == start


def test_the_shapes_of_what_occupies_the_floor_are_told_where_they_are_asked_for(
    ken: MainProcess, workspace: Path
) -> None:
    ask(workspace, "footprints = true")
    assert [record.shape for record in told(ken, "do a step to b").world] == [None]
    ask(workspace, "shapes = true")
    start = told(ken, "do a step to b")
    assert start.object is not None
    assert start.object.shape is None
    assert [record.shape is not None for record in start.world] == [True]


def test_what_is_in_the_hand_occupies_nothing(ken: MainProcess, workspace: Path) -> None:
    ask(workspace, "footprints = true")
    ken.play(steps("do a take frames 10"))
    assert ken.control.holds == {"a": "right"}
    start = told(ken, "do b step to a")
    assert start.object is not None
    assert start.goal.object is not None
    assert start.object.footprint
    assert start.goal.object.footprint == start.world[0].footprint == []


def test_the_walks_of_a_workspace_are_known_before_one_is_asked_for(tmp_path: Path) -> None:
    own = init(tmp_path / "own", Workspace.find())
    (tmp_path / "own/objectdb/lamp/object.toml").write_text("name = 3")  # hides nothing but itself
    ((entry, motion),) = Database(own).walks()
    assert entry.name == "walk"
    assert motion == tmp_path / "own/objectdb/floor/walk.npz"


def test_frames_that_nobody_asked_for_are_a_wish_where_the_algorithm_stretches(
    ken: MainProcess, workspace: Path
) -> None:
    usual = told(ken, "do a step to b")
    assert usual.frames > 0
    assert not usual.wish
    ask(workspace, "stretches = true")
    start = told(ken, "do a step to b")
    assert (start.frames, start.wish) == (usual.frames, True)
    asked = told(ken, "do a step to b frames 33")
    assert asked.frames == 33
    assert not asked.wish
