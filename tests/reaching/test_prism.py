"""Blocks that a hand keeps clear of."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.reaching.prism import Prism, clearance, in_the_way

SQUARE = np.array([[1.0, -1.0], [3.0, -1.0], [3.0, 1.0], [1.0, 1.0]])
BLOCK = Prism(SQUARE, 0.0, 0.9)


@pytest.mark.parametrize(
    ("point", "distance"),
    [
        ((0.5, 0.0, 0.5), 0.5), ((2.0, 0.0, 1.2), 0.3), ((0.6, 0.0, 1.2), 0.5), ((1.1, 0.0, 0.5), -0.1),
        ((2.0, 0.0, 0.85), -0.05), ((2.0, 0.0, -0.2), 0.2),
    ],
)  # fmt: skip
def test_distances_are_signed(point: tuple[float, float, float], distance: float) -> None:
    assert BLOCK.signed(np.array(point)) == pytest.approx(distance)


def test_the_nearest_counts() -> None:
    other = Prism(SQUARE + np.array([-3.0, 0.0]), 0.0, 0.2)
    assert clearance([BLOCK, other], np.array([[0.5, 0.0, 0.1]])) == pytest.approx([0.5])
    assert clearance([BLOCK, other], np.array([[0.1, 0.0, 0.1]])) == pytest.approx([0.1])
    assert np.isinf(clearance([], np.zeros((2, 3)))).all()


def test_what_a_hand_comes_into_or_is_in_is_not_in_its_way() -> None:
    here, inside, over = np.array([0.5, 0.0]), np.array([2.0, 0.0, 0.5]), np.array([2.0, 0.0, 1.0])
    assert in_the_way([BLOCK], here, over) == [BLOCK]
    assert in_the_way([BLOCK], here, over, inside) == []
    assert in_the_way([BLOCK], np.array([-2.0, 0.0]), over) == []
