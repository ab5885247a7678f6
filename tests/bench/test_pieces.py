"""How deep points are in the pieces of a shape."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.bench.pieces import Piece, pieces
from ahmss.body.array import Array

SQUARES = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> Array:
    """The twelve triangles (12, 3, 3) of a box, counter-clockwise from outside."""
    ends = np.array([low, high])
    corners = np.array([[ends[i, 0], ends[j, 1], ends[k, 2]] for k in (0, 1) for j in (0, 1) for i in (0, 1)])
    return np.concatenate([corners[SQUARES[:, [0, 1, 2]]], corners[SQUARES[:, [0, 2, 3]]]])


def turned_in(corners: Array) -> Array:
    return corners[:, ::-1]


BAR, LEAF = box((0.0, -0.01, -0.01), (0.12, 0.01, 0.01)), box((0.1, -0.4, -1.0), (0.14, 0.4, 1.0))


def test_what_overlaps_counts_each_for_itself() -> None:
    found = pieces(np.concatenate([BAR, LEAF]))
    assert [len(piece.triangles) for piece in found] == [12, 12]
    middle = np.array([[0.05, 0.002, 0.003], [0.11, 0.0, 0.0], [0.05, 0.0, 0.011]])
    assert found[0].depth(middle) == pytest.approx([0.007, 0.01, 0.0])
    assert found[1].depth(middle) == pytest.approx([0.0, 0.01, 0.0])


def test_what_is_not_convex_is_as_deep_as_its_nearest_face() -> None:
    """A tube of square section: between its walls one is outside."""
    tube = np.concatenate(
        [box((0.0, 0.0, 0.0), (0.1, 0.1, 0.1)), turned_in(box((0.02, 0.02, 0.02), (0.08, 0.08, 0.08)))]
    )
    hollow = Piece(tube)
    assert hollow.planes is None
    inside = np.array([[0.01, 0.05, 0.05], [0.013, 0.05, 0.05], [0.05, 0.05, 0.05], [0.05, 0.05, 0.12]])
    assert hollow.depth(inside) == pytest.approx([0.01, 0.007, 0.0, 0.0])


def test_a_shape_seen_from_within_has_the_same_inside() -> None:
    points = np.random.default_rng(5).uniform(-0.02, 0.13, (400, 3))
    assert Piece(turned_in(BAR)).depth(points) == pytest.approx(Piece(BAR).depth(points), abs=1e-12)


def test_what_is_not_closed_is_left_together() -> None:
    """A box in two halves that hang together nowhere: neither has an inside of its own."""
    halves = BAR[[0, 1, 2, 6, 7, 8]], BAR[[3, 4, 5, 9, 10, 11]] + np.array([0.0, 0.0, 2e-5])
    found = pieces(np.concatenate([LEAF, *halves]))
    assert sorted(len(piece.triangles) for piece in found) == [12, 12]
    assert found[-1].depth(np.array([[0.05, 0.002, 0.003]])) == pytest.approx([0.007], abs=1e-4)


def test_where_nothing_is_near_nothing_is_deep() -> None:
    assert Piece(BAR).depth(np.array([[9.0, 9.0, 9.0]])) == pytest.approx([0.0])
    assert Piece(BAR).depth(np.zeros((0, 3))).shape == (0,)
