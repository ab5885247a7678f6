"""Fewer frames than a motion needs: it takes those that it needs, and the person is told how many."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from ahmss.database.workspace import Workspace
from ahmss.errors import DataError
from ahmss.main.command import Act
from ahmss.main.database import Database
from ahmss.main.process import MainProcess
from ahmss.world.process import ServerProcess
from tests.main.ground import steps

from .test_afforded import SHIPPED, Room, ken


def hurry(workspace: Path, share: str = "0.5") -> None:
    file = workspace / "algorithms/swing/algorithm.toml"
    file.write_text(file.read_text().replace("\n[parameters.link]", f"fewest = {share}\n\n[parameters.link]", 1))


def test_an_action_takes_no_fewer_frames_than_its_algorithm_says(
    server: Callable[..., ServerProcess], join: Callable[..., MainProcess], workspace: Path
) -> None:
    hurry(workspace)  # of the 20 of `wave`
    main = join(server(lockstep=["ken"]), fast=True, names=("ken",))
    took: list[int] = []
    main.play(steps("add box as b at 0.3 0 1"))
    for frames in (1, 9, 10, 15):
        before = main.report.frames
        for step in steps(f"do b wave frames {frames}"):
            main.agenda.add(step)
        while not main.agenda.done:
            main.frame()
        took.append(main.report.frames - before)
    assert [one - took[0] for one in took] == [0, 0, 0, 5]
    assert main.report.notes == [
        "b wave: 1 frame is too few; it takes 10",
        "b wave: 9 frames are too few; it takes 10",
    ]
    assert not main.report.messages


@pytest.mark.parametrize("share", ["-0.1", "1.5"])
def test_the_share_is_one(workspace: Path, share: str) -> None:
    hurry(workspace, share)
    with pytest.raises(DataError, match=r"swing/algorithm\.toml: fewest .*: .* is no share of the action's frames"):
        Workspace(workspace).algorithms.find("swing")


@pytest.mark.parametrize(
    ("name", "action", "least"),
    [("cup", "lift", 28), ("cup", "drink", 108), ("cup", "release", 23), ("lamp", "look", 30)],
)
def test_what_the_room_affords_takes_half_of_its_frames_at_least(name: str, action: str, least: int) -> None:
    held = ken(room__cup="right") if name == "cup" else ken()
    for asked, given in ((1, least), (least - 1, least), (least + 1, least + 1)):
        order = Database(SHIPPED).order(Act(f"room/{name}", action, frames=asked), Room(), held)
        assert order.frames == given
