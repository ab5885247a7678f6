"""Fields of distances against exact ones: closed meshes, pieces that overlap, surfaces with a border."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.errors import DataError
from ahmss.grasping.distance import build, distances
from ahmss.grasping.field import Field

from .shapes import box, field, kind, outside, thing

DEEP = 0.03


@pytest.mark.parametrize(
    "name", ["cup72", "plate", *(pytest.param(name, marks=pytest.mark.long) for name in ("lever", "tap", "knob"))]
)
def test_it_is_within_half_a_step_near_the_surface(name: str) -> None:
    made, triangles = field(name), thing(name).triangles
    middle = thing(name).site[:3]
    points = np.random.default_rng(7).uniform(middle - 0.09, middle + 0.09, (3000, 3))
    points = points[(made.clearance(points) < 0.6 * DEEP) & (made.clearance(points) > -0.6 * DEEP)]
    assert len(points) > 60
    assert np.abs(made.clearance(points) - outside(points, triangles)).max() < 0.5 * made.spacing + 2e-4


def test_what_is_within_a_wall_is_inside_and_what_is_in_the_cup_is_not() -> None:
    points = np.array([[0.0343, 0.0, 0.05], [0.0, 0.0, 0.05], [0.0, 0.0, 0.004], [0.0, 0.0, -0.01], [0.05, 0.0, 0.05]])
    assert np.sign(field("cup72").clearance(points)).tolist() == [-1.0, 1.0, -1.0, 1.0, 1.0]


def test_a_surface_with_a_border_has_no_inside() -> None:
    square = np.array([[0.0, -0.1, -0.1], [0.0, 0.1, -0.1], [0.0, 0.1, 0.1], [0.0, -0.1, 0.1]])
    made = build(square, np.array([[0, 1, 2], [0, 2, 3]]), np.full(3, -0.14), np.full(3, 0.14))
    points = np.array([[0.01, 0.02, 0.0], [-0.01, 0.02, 0.0]])
    np.testing.assert_allclose(made.clearance(points), 0.01, atol=1e-4)
    np.testing.assert_allclose(made.normals(points), [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]], atol=1e-3)


def test_a_hole_that_other_faces_hide_does_no_harm() -> None:
    legs = box(0.06, 0.1)
    legs = legs[(legs[..., 2] < 0.099).any(axis=1)]  # without its top
    top = box(0.12, 0.04) + np.array([0.0, 0.0, 0.08])
    both = np.concatenate([legs, top]).reshape(-1, 3)
    made = build(both, np.arange(len(both)).reshape(-1, 3), np.full(3, -0.2), np.full(3, 0.2))
    assert made.clearance(np.array([[0.0, 0.0, 0.05], [0.0, 0.0, 0.09], [0.05, 0.0, 0.05]])) == pytest.approx(
        [-0.03, -0.01, 0.02], abs=5e-3
    )
    assert made.clearance(np.array([[0.0, 0.0, 0.05]]))[0] < -0.02


def test_beyond_the_grid_it_is_never_more_than_it_is() -> None:
    made, corners = field("cup72"), kind("cup")
    points = np.random.default_rng(3).uniform(-0.3, 0.3, (200, 3))
    exact = np.array([distances(np.repeat(point[None], len(corners), axis=0), corners).min() for point in points])
    found = made.clearance(points)
    assert (found < exact + 1e-3).all()
    assert (found > 0.7 * exact - 2e-3).all()


def test_a_normal_points_out() -> None:
    points = np.array([[0.05, 0.0, 0.05], [0.0, -0.045, 0.05], [0.0, 0.0, 0.02]])
    normals = field("cup72").normals(points)
    np.testing.assert_allclose(normals, [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]], atol=0.2)


def test_bytes_come_back_and_broken_ones_are_refused() -> None:
    made = field("knob")
    data = made.to_bytes()
    again = Field.from_bytes(data)
    np.testing.assert_array_equal(again.nodes, made.nodes)
    assert again.spacing == made.spacing
    for broken in (b"", b"nothing" * 20, data[:-1]):
        with pytest.raises(DataError, match="delete what is kept"):
            Field.from_bytes(broken)


def test_nothing_there_is_told() -> None:
    corners = box(0.1).reshape(-1, 3)
    with pytest.raises(ValueError, match="nothing of the shape"):
        build(corners, np.arange(len(corners)).reshape(-1, 3), np.full(3, 0.5), np.full(3, 0.7))
