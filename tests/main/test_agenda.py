"""Lines that are refused before anything of them begins, and what is told when they are over."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from ahmss.main.process import MainProcess
from ahmss.world.process import ServerProcess
from tests.main.conftest import ALGORITHMS, write_algorithm
from tests.main.ground import steps

MARCH = """
[affordances.march]
human_algorithm = "march"
asks = ["goal_position"]
"""


@pytest.fixture
def ken(server: Callable[..., ServerProcess], join: Callable[..., MainProcess], workspace: Path) -> MainProcess:
    """A main in lockstep with a box that can be marched on: what it does carries the body."""
    code = ALGORITHMS["glide"][2].replace("glide", "march")
    write_algorithm(workspace, "march", "human", "carries = true\n", code)
    with (workspace / "objectdb/box/object.toml").open("a") as file:
        file.write(MARCH)
    main = join(server(lockstep=["ken"]), fast=True, names=("ken",))
    main.play(steps("add box as b at 0.3 0 1"))
    return main


def test_two_motions_that_carry_the_body_are_not_made_together(ken: MainProcess) -> None:
    before = ken.blending.root.copy()
    ken.play(steps("do b march to 1 0 frames 20 with b wave with b march to 0 1 frames 20 after 10"))
    assert ken.report.messages == [
        "line 1: b march with b march: each takes the body its own way, and only one can at a time; "
        "join them by `then`, or do one after the other, each in a line of its own"
    ]
    np.testing.assert_allclose(ken.blending.root, before, atol=1e-9)


def test_one_of_them_follows_the_other_in_one_line(ken: MainProcess) -> None:
    ken.play(steps("do b march to 1 0 frames 60 then b march to 0 1 frames 60"))
    assert ken.report.messages == []
    np.testing.assert_allclose(ken.blending.root[:2], [0.0, 1.0], atol=0.05)


def test_one_of_them_is_made_with_others(ken: MainProcess) -> None:
    ken.play(steps("do b march to 1 0 frames 60 with b wave", "do b march to 0 1 frames 60"))
    assert ken.report.messages == []
    np.testing.assert_allclose(ken.blending.root[:2], [0.0, 1.0], atol=0.05)


def test_what_is_waited_for_and_holds_is_said_to_hold(ken: MainProcess) -> None:
    said: list[str] = []
    ken.agenda.said = said.append
    ken.play(steps("wait b lid == shut", "set b lid open", "wait b lid == open"))
    assert said == ["b lid is shut", "b lid is open", "b lid is open"]
