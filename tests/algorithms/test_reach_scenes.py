"""Reaches from seeded places close before any edge of a table to a cup on it, both turned, by both humans."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.algorithm.messages import Goal
from ahmss.errors import AlgorithmError
from ahmss.motion.smoothness import worst_pop

from .reached import Reached, Scene
from .scene import FLOOR, Body, frame_of

BEFORE = 0.066  # metres from the cup's axis to the palm: half its diameter, and the air that `before` asks


def check(seed: int) -> None:
    reached = Scene.drawn(seed).reach()
    assert max(reached.off_site(BEFORE)) < 1e-3, "metres, degrees"
    assert max(reached.off_target()) < 1e-3
    depth, link = reached.depth_in_top()
    assert depth < 0.0, link
    assert reached.out_of_balance() < -0.02
    assert reached.foot_slide() < 1e-3
    assert reached.beyond_limits() < 0.1
    assert reached.largest_step() < 6.0
    assert worst_pop(reached.rotations).degrees < 3.0
    assert reached.fastest("lower_arm") < 1.6
    assert reached.fastest("hand") < 1.3
    assert reached.peak() < 3.0


@pytest.mark.parametrize("seed", range(10))
def test_a_cup_is_reached_in_balance_and_nothing_is_touched_on_the_way(seed: int) -> None:
    check(seed)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(10, 220))
def test_two_hundred_cups_are_reached(seed: int) -> None:
    check(seed)


@pytest.mark.parametrize("name", ["aiko", pytest.param("ken", marks=pytest.mark.long)])
def test_points_all_around_from_the_floor_to_over_the_head(name: str) -> None:
    """Reached, or a little short of as far as the arm goes, or refused; in no case does anything flip or slide."""
    random = np.random.default_rng(7)
    reached_all = 0
    for _ in range(16):
        radius, aside, height = random.uniform((0.25, -1.5, 0.05), (0.8, 1.5, 1.85))
        place = (radius * np.cos(aside), radius * np.sin(aside), height)
        body = Body(name, facing=0.0)
        start = body.start(FLOOR, "stand", frames=0, wish=True, hand="", parameters={}, goal=Goal(place=place))
        try:
            shown = body.do("reach", start)
        except AlgorithmError:
            continue
        reached = Reached(Scene(body, frame_of(FLOOR), frame_of(FLOOR)), body.skeleton, shown)
        reached_all += float(np.linalg.norm(reached.palm().place - place)) < 1e-3
        assert np.linalg.norm(reached.palm().place - place) < 0.035
        assert reached.out_of_balance() < -0.02
        assert reached.foot_slide() < 1e-3
        assert reached.beyond_limits() < 0.5
        assert worst_pop(reached.rotations).degrees < 4.0
    assert reached_all > 10
