"""A hand goes the first of some ways on which its fingers are not in a thing."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.grasping.clear import first_clear
from ahmss.grasping.hand import Hand
from ahmss.motion.fingers import opened
from ahmss.motion.steps import finished


class Floor:
    """All that is below a height."""

    def __init__(self, height: float) -> None:
        self.height = height

    def clearance(self, points: Array) -> Array:
        return points[..., 2] - self.height


def way(*heights: float) -> tuple[Array, Array]:
    """Palms above each other, the fingers open."""
    palms = np.tile([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0], (len(heights), 1))
    palms[:, 2] = heights
    return palms, np.repeat(opened("right")[None], len(heights), axis=0)


LOW, LESS_LOW, OVER = way(0.3, 0.02, 0.3), way(0.3, 0.04, 0.3), way(0.3, 0.2, 0.3)
HELD = (way(0.3)[0][0], way(0.3)[1][0])


@pytest.fixture
def hand() -> Hand:
    return Hand.of(Skeleton.of(1.72), "right")


def test_the_first_that_is_clear_is_gone(hand: Hand) -> None:
    assert finished(first_clear(hand, Floor(0.0), [LOW, OVER, OVER], HELD)) == 1


def test_where_none_is_clear_the_least_bad_one_is_gone(hand: Hand) -> None:
    assert finished(first_clear(hand, Floor(0.0), [LOW, LESS_LOW, LOW], HELD)) == 1


def test_where_it_holds_it_may_be_as_deep_as_its_fist_is_and_no_deeper(hand: Hand) -> None:
    held = (way(0.03)[0][0], way(0.03)[1][0])
    stays, goes_in, goes_off = way(0.03, 0.2), way(0.028, 0.2), way(0.032, 0.2)
    assert finished(first_clear(hand, Floor(0.0), [goes_in, stays], held)) == 1
    assert finished(first_clear(hand, Floor(0.0), [goes_off, stays], held)) == 0


def test_no_ways_are_an_error(hand: Hand) -> None:
    with pytest.raises(ValueError, match="no ways"):
        finished(first_clear(hand, Floor(0.0), [], HELD))
