"""Reaches from seeded standing places to a cup anywhere on a table, both turned, by both humans."""

from __future__ import annotations

import pytest

from .reached import Scene

BEFORE = 0.066  # metres from the cup's axis to the palm: half its diameter, and the air that `before` asks


def check(seed: int) -> None:
    reached = Scene.drawn(seed).reach()
    assert max(reached.off_site(BEFORE)) < 1e-3, "metres, degrees"
    assert max(reached.off_target()) < 1e-3
    depth, link = reached.depth_in_table()
    assert depth < 0.0, link
    assert reached.out_of_balance() < -0.02
    assert reached.foot_slide() < 1e-3
    assert reached.beyond_limits() < 0.1
    assert reached.largest_step() < 6.0


@pytest.mark.parametrize("seed", range(20))
def test_a_cup_is_reached_in_balance_and_nothing_is_touched_on_the_way(seed: int) -> None:
    check(seed)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(20, 220))
def test_two_hundred_cups_are_reached(seed: int) -> None:
    check(seed)
