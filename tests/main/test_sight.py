"""What a human sees: in a cone about where the head faces, and behind nothing."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply
from ahmss.body.skeleton import Skeleton
from ahmss.main.afforded import Actor
from ahmss.main.mesh import Mesh
from ahmss.main.sight import View, eyes

UNTURNED = np.array([1.0, 0.0, 0.0, 0.0])
UP = np.array([0.0, 0.0, 1.0])


def box(half: tuple[float, float, float]) -> Array:
    """The twelve triangles of a box about its origin."""
    low, high = -np.array(half), np.array(half)
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    points = np.where(corners == 0, low, high)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return points[np.array([face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))])]


def view(*things: tuple[str, tuple[float, float, float], tuple[float, float, float], float]) -> View:
    """From (0, 0, 1.6) towards +x at boxes: name, place, half, turn about z in degrees; a half of 0 has no shape."""
    meshes = [Mesh.of(box(half) if any(half) else np.zeros((0, 3, 3))) for _, _, half, _ in things]
    turns = [from_axis_angle(UP, np.radians(degrees)) for _, _, _, degrees in things]
    poses = np.array([[*place, *turn] for (_, place, _, _), turn in zip(things, turns, strict=True)])
    radii = np.array([np.linalg.norm(half) if any(half) else -1.0 for _, _, half, _ in things])
    names = {name: row for row, (name, _, _, _) in enumerate(things)}
    return View(np.array([0.0, 0.0, 1.6]), np.array([1.0, 0.0, 0.0]), names, poses, poses[:, :3], radii, meshes)


SMALL = (0.05, 0.05, 0.05)
WALL = (0.05, 0.6, 0.6)


@pytest.mark.parametrize("degrees", [0.0, 55.0, -55.0])
@pytest.mark.parametrize("seen", [True, False])
def test_the_cone_of_sight_is_60_degrees_to_each_side(degrees: float, seen: bool) -> None:
    angle = np.radians(degrees if seen else 130.0 - degrees if degrees < 0.0 else degrees + 70.0)
    place = (2.0 * float(np.cos(angle)), 2.0 * float(np.sin(angle)), 1.6)
    assert view(("cup", place, SMALL, 0.0)).sees("cup") is seen


def test_a_wall_between_hides_and_one_behind_or_beside_does_not() -> None:
    cup = ("cup", (2.0, 0.0, 1.6), SMALL, 0.0)
    assert not view(cup, ("wall", (1.0, 0.0, 1.6), WALL, 0.0)).sees("cup")
    assert view(cup, ("wall", (3.0, 0.0, 1.6), WALL, 0.0)).sees("cup")
    assert view(cup, ("wall", (1.0, 1.0, 1.6), WALL, 0.0)).sees("cup")
    assert view(cup, ("wall", (-0.5, 0.0, 1.6), WALL, 0.0)).sees("cup")


def test_a_wall_hides_by_its_faces_as_it_is_turned_and_not_by_the_room_that_it_takes() -> None:
    cup = ("cup", (2.0, 0.35, 1.6), SMALL, 0.0)
    assert not view(cup, ("wall", (1.0, 0.0, 1.6), WALL, 0.0)).sees("cup")
    assert view(cup, ("wall", (1.0, 0.0, 1.6), WALL, 90.0)).sees("cup")


def test_what_is_half_covered_is_seen_and_what_has_no_shape_hides_nothing() -> None:
    wide = ("board", (2.0, 0.0, 1.6), (0.02, 2.5, 0.1), 0.0)
    assert view(wide, ("wall", (1.0, 0.0, 1.6), WALL, 0.0)).sees("board")
    assert view(("cup", (2.0, 0.0, 1.6), SMALL, 0.0), ("ghost", (1.0, 0.0, 1.6), (0.0, 0.0, 0.0), 0.0)).sees("cup")


def test_a_knob_on_a_panel_is_seen_from_the_front_and_not_through_the_panel() -> None:
    knob = (0.01, 0.01, 0.01)
    panel = ("panel", (2.0, 0.0, 1.6), (0.2, 0.5, 0.5), 0.0)
    assert view(panel).sees("panel")
    assert view(panel, ("knob", (1.8, 0.1, 1.6), knob, 0.0)).sees("knob")
    assert not view(panel, ("knob", (2.2, 0.1, 1.6), knob, 0.0)).sees("knob")


def test_one_that_is_not_there_is_not_seen() -> None:
    assert not view(("cup", (2.0, 0.0, 1.6), SMALL, 0.0)).sees("vase")


def test_the_eyes_are_in_front_of_the_head_and_turn_with_it() -> None:
    skeleton = Skeleton.of(1.76, "male", "ken")
    rotations, root = skeleton.upright()
    eye, ahead = eyes(Actor("ken", skeleton, root, rotations, {}))
    level, below = np.cos(np.radians(15.0)), -np.sin(np.radians(15.0))
    assert ahead == pytest.approx([level, 0.0, below], abs=1e-9)
    assert 1.55 < eye[2] < 1.76
    assert eye[0] > 0.05
    left = rotations.copy()
    left[0] = multiply(from_axis_angle(UP, np.pi / 2), rotations[0])
    turned, there = eyes(Actor("ken", skeleton, root, left, {}))
    assert there == pytest.approx([0.0, level, below], abs=1e-9)
    assert turned[1] == pytest.approx(eye[0])


@given(st.integers(0, 2**32 - 1))
def test_a_ray_meets_a_mesh_of_many_triangles_where_it_meets_one_of_them(seed: int) -> None:
    rng = np.random.default_rng(seed)
    triangles = rng.uniform(-1.0, 1.0, (300, 1, 3)) + rng.normal(0.0, 0.05, (300, 3, 3))
    mesh = Mesh.of(triangles)
    assert sum(len(group) for group in mesh.groups) == 300
    assert max(len(group) for group in mesh.groups) <= 32
    origin = rng.uniform(-2.0, 2.0, 3)
    way = rng.normal(size=3)
    way /= np.linalg.norm(way)
    alone = [Mesh.of(one[None]).hit(origin, way, 2.0) for one in triangles]
    assert mesh.hit(origin, way, 2.0) == any(alone)
    inside = triangles[0].mean(axis=0)
    towards = (inside - origin) / np.linalg.norm(inside - origin)
    assert mesh.hit(origin, towards, float(np.linalg.norm(inside - origin)) + 1e-6)
