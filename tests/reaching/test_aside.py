"""Points of an arm are moved out of things softly, and come back when there is room."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.reaching.aside import AIR, Aside, kept_aside
from ahmss.reaching.prism import Prism, clearance

SQUARE = np.array([[1.0, -1.0], [3.0, -1.0], [3.0, 1.0], [1.0, 1.0]])
BLOCK = Prism(SQUARE, 0.0, 0.9)
RADII = np.array([0.03, 0.02])


def points(x: float, z: float) -> Array:
    return np.array([[x, 0.0, z], [x - 0.1, 0.0, z]])


@pytest.mark.parametrize(
    ("point", "out"),
    [
        ((0.7, 0.2, 0.5), (-1.0, 0.0, 0.0)), ((1.1, 0.0, 0.5), (-1.0, 0.0, 0.0)), ((2.0, 0.0, 0.85), (0.0, 0.0, 1.0)),
        ((2.0, 0.0, 1.2), (0.0, 0.0, 1.0)), ((2.0, 0.0, -0.2), (0.0, 0.0, -1.0)), ((0.7, 0.0, 1.3), (-0.6, 0.0, 0.8)),
    ],
)  # fmt: skip
def test_the_way_out_is_the_shortest(point: tuple[float, float, float], out: tuple[float, float, float]) -> None:
    np.testing.assert_allclose(BLOCK.way_out(np.array(point)), out, atol=1e-9)


def test_a_hand_that_would_be_in_a_block_goes_over_it_and_comes_back() -> None:
    aside, way = Aside(60.0), [np.zeros(3)]
    for _ in range(60):
        way.append(aside.step([BLOCK], points(1.8, 0.88), RADII))
    assert clearance([BLOCK], points(1.8, 0.88) + way[-1])[0] - RADII[0] == pytest.approx(AIR, abs=0.003)
    np.testing.assert_allclose(way[-1][:2], 0.0, atol=1e-9)
    for _ in range(400):
        way.append(aside.step([BLOCK], points(0.5, 0.88), RADII))
    assert np.abs(way[-1]).max() < 1e-4
    assert aside.still
    assert np.abs(np.diff(way, n=2, axis=0)).max() < 0.005  # softly


def test_where_there_is_room_nothing_moves() -> None:
    aside = Aside(60.0)
    assert not aside.step([BLOCK], points(0.8, 0.5), RADII).any()
    assert aside.still
    assert not kept_aside([BLOCK], np.tile(points(0.8, 0.5), (40, 1, 1)), RADII).any()


def test_a_known_way_keeps_out_and_begins_where_it_is() -> None:
    x = 0.7 + 0.4 * np.sin(np.linspace(0.0, np.pi, 120))  # 0.1 m into the block, and back
    way = np.stack([points(at, 0.5) for at in x])
    assert clearance([BLOCK], way).min() < -0.09
    moved = kept_aside([BLOCK], way, RADII)
    assert (clearance([BLOCK], way + moved[:, None]) - RADII).min() > 0.0
    assert np.abs(moved[0]).max() < 1e-3
    assert np.abs(np.diff(moved, n=2, axis=0)).max() < 0.003


def test_an_arm_passes_a_post_on_the_side_of_its_shoulder() -> None:
    """Its hand, which would be out of it sooner on the other side, would have the elbow in it there."""
    post = Prism(np.array([[0.0, -0.05], [0.05, -0.05], [0.05, 0.05], [0.0, 0.05]]), 0.0, 2.0)
    arm, shoulder = np.array([[0.024, 0.0, 1.1], [0.045, 0.0, 1.1]]), np.array([0.3, 0.1, 1.3])
    moved, other = (
        [aside.step([post], arm, RADII, None, where) for _ in range(60)][-1]
        for aside, where in ((Aside(60.0), shoulder), (Aside(60.0), shoulder * [-1.0, 1.0, 1.0]))
    )
    assert moved[0] > 0.0
    assert (clearance([post], arm + moved) - RADII).min() > 0.0
    assert other[0] < 0.0
