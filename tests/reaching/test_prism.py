"""Blocks that a hand keeps clear of."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.reaching.prism import Prism, clearance, in_the_way, over_hand

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


def test_a_hand_under_an_edge_comes_out_sideways() -> None:
    """What is over it is in its way, from a little above it up to the top; all of a thing that it is beside or over."""
    here, radii = np.array([0.6, 0.0, 0.9]), np.array([0.03, 0.01])
    under = np.array([[0.9, 0.0, 0.8], [1.1, 0.0, 0.7]])
    lid = over_hand(BLOCK, here, under, radii)
    assert lid is not None
    assert (lid.low, lid.high) == (pytest.approx(0.75), 0.9)
    assert lid.signed(np.array([1.1, 0.0, 0.7])) > 0.0 > lid.signed(np.array([1.1, 0.0, 0.77]))
    beside, above = under - np.array([0.2, 0.0, 0.0]), under + np.array([0.0, 0.0, 0.3])
    assert over_hand(BLOCK, here, beside, radii) is over_hand(BLOCK, here, above, radii) is BLOCK
    nearly_in_it = over_hand(BLOCK, here, under + np.array([0.0, 0.0, 0.19]), radii)
    assert nearly_in_it is not None
    assert nearly_in_it.low == pytest.approx(0.86)


def test_what_one_is_in_or_has_a_hand_deep_in_is_not_in_its_way() -> None:
    under, radii = np.array([[1.1, 0.0, 0.7]]), np.array([0.01])
    assert over_hand(BLOCK, np.array([1.5, 0.0, 0.5]), under, radii) is None
    assert over_hand(BLOCK, np.array([0.6, 0.0, 0.9]), under + np.array([0.2, 0.0, 0.0]), radii) is None


def test_distances_are_exact_where_they_are_asked_for() -> None:
    """A box around each block spares the looking; where one is in two blocks, the deeper counts."""
    random = np.random.default_rng(3)
    turned = Prism(SQUARE @ np.array([[0.8, 0.6], [-0.6, 0.8]]) - np.array([0.0, 1.0]), 0.2, 0.7)
    points = random.uniform((-2.0, -2.0, -0.5), (4.0, 3.0, 1.5), (2000, 3))
    exact = np.minimum(BLOCK.signed(points), turned.signed(points))
    assert ((BLOCK.signed(points) < 0.0) & (turned.signed(points) < 0.0)).sum() > 20
    np.testing.assert_allclose(clearance([BLOCK, turned], points), exact)
    for prism in (BLOCK, turned):
        assert (prism.at_least(points) <= np.maximum(prism.signed(points), 0.0) + 1e-12).all()
    told = clearance([BLOCK, turned], points, 0.1)
    np.testing.assert_allclose(told[exact < 0.1], exact[exact < 0.1])
    assert (told[exact >= 0.1] >= 0.1).all()


WEDGE = Prism(SQUARE, 0.0, 0.9, cuts=np.array([[-np.sqrt(0.5), 0.0, np.sqrt(0.5), -0.7 * np.sqrt(0.5)]]))
"""The same block, its top rising by 45 degrees from 0.3 high at x = 1, as far as it was."""


@pytest.mark.parametrize(
    ("point", "distance", "out"),
    [
        ((1.2, 0.0, 0.9), 0.4 * np.sqrt(0.5), [-np.sqrt(0.5), 0.0, np.sqrt(0.5)]),
        ((1.5, 0.0, 0.7), -0.1 * np.sqrt(0.5), [-np.sqrt(0.5), 0.0, np.sqrt(0.5)]),
        ((2.0, 0.0, 1.2), 0.3, [0.0, 0.0, 1.0]),
        ((0.5, 0.0, 0.1), 0.5, [-1.0, 0.0, 0.0]),
    ],
)
def test_what_slopes_is_cut_off(point: tuple[float, float, float], distance: float, out: list[float]) -> None:
    at = np.array(point)
    assert WEDGE.signed(at) == pytest.approx(distance)
    assert clearance([WEDGE], at[None]) == pytest.approx([distance])
    np.testing.assert_allclose(WEDGE.way_out(at), out, atol=1e-9)
    np.testing.assert_allclose(WEDGE.tops(np.array([[1.1, 0.0], [1.5, 0.3], [2.5, 0.0]])), [0.4, 0.8, 0.9])


def test_a_hand_over_the_low_end_of_what_slopes_is_not_under_it() -> None:
    here, radii = np.array([0.6, 0.0, 0.9]), np.array([0.03])
    assert over_hand(WEDGE, here, np.array([[1.1, 0.0, 0.6]]), radii) is WEDGE
    assert over_hand(BLOCK, here, np.array([[1.1, 0.0, 0.6]]), radii) is not BLOCK
