"""What objects occupy on the floor for one who walks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely

from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply
from ahmss.database import Workspace, outline
from ahmss.database.footprint import HIGH, LOW, Footprints, Rings
from ahmss.database.outline import outlines
from ahmss.database.silhouette import silhouette

from .conftest import add_object

CHECKOUT = Workspace(Path(__file__).resolve().parents[2])
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])
X, Y, Z = np.eye(3)


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> Array:
    """The twelve triangles (12, 3, 3) of a box."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)])
    places = np.array(low) + corners * (np.array(high) - low)
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return np.array([[places[f[i]] for i in pick] for f in faces for pick in ((0, 1, 2), (0, 2, 3))])


def area(rings: Rings) -> shapely.Geometry:
    """The union of outlines, each of which is whole and runs counter-clockwise."""
    shapes = [shapely.Polygon(ring) for ring in rings]
    assert all(shape.is_valid and shape.exterior.is_ccw for shape in shapes)
    assert sum(shape.area for shape in shapes) == pytest.approx(shapely.union_all(shapes).area, abs=1e-9)
    return shapely.union_all(shapes)


def seen(*triangles: Array) -> shapely.Geometry:
    return area(outlines(np.concatenate(triangles), LOW, HIGH))


def shipped(kind: str, height: float = 0.0, rotation: Array = UPRIGHT) -> shapely.Geometry:
    return area(CHECKOUT.objects.footprint(kind, height, rotation))


def has(shape: shapely.Geometry, x: float, y: float) -> bool:
    return bool(shape.contains(shapely.Point(x, y)))


def test_a_box_occupies_its_base_and_half_a_centimetre_more():
    shape = seen(box((0.2, -0.1, 0.0), (0.8, 0.5, 1.0)))
    np.testing.assert_allclose(shape.bounds, (0.195, -0.105, 0.805, 0.505), atol=1e-9)
    assert shape.area == pytest.approx(0.61**2)


def test_what_is_low_or_overhead_occupies_nothing():
    rug, lamp = box((-1, -1, 0.0), (1, 1, 0.03)), box((-1, -1, 2.0), (1, 1, 2.5))
    assert outlines(np.concatenate([rug, lamp]), LOW, HIGH) == ()
    assert shipped("floor").is_empty


def test_only_what_is_between_ankle_and_head_height_counts():
    # A wedge: at height z it reaches from x = 0 to x = 3 - z, and is cut at 5 cm.
    wedge = np.array([[[0, 0, 0], [3, 0, 0], [0, 0, 3]], [[0, 1, 0], [0, 1, 3], [3, 1, 0]]], float)
    np.testing.assert_allclose(seen(wedge).bounds, (-0.005, -0.005, 2.955, 1.005), atol=1e-6)
    # Upside down: it reaches to x = z.
    np.testing.assert_allclose(seen(wedge * [1, 1, -1] + [0, 0, 3]).bounds, (-0.005, -0.005, 1.905, 1.005), atol=1e-6)


def test_a_wall_without_thickness_is_a_centimetre_thick():
    wall = np.array([[[0, -1, 0], [0, 1, 0], [0, 1, 2]], [[0, -1, 0], [0, 1, 2], [0, -1, 2]]], float)
    shape = seen(wall)
    np.testing.assert_allclose(shape.bounds, (-0.005, -1.005, 0.005, 1.005), atol=1e-9)
    assert shape.area == pytest.approx(0.01 * 2.01)


def test_an_opening_stays_free_and_the_posts_beside_it_do_not():
    shape = shipped("doorway")
    assert not has(shape, 0.0, 0.0)
    assert not has(shape, 0.38, 0.0)
    assert has(shape, 0.43, 0.0)
    assert has(shape, -0.43, 0.0)
    leaf = shipped("door", 0.005)
    assert has(leaf, 0.4, 0.0)
    assert not has(leaf, -0.1, 0.0)


def test_the_inside_of_furniture_is_occupied():
    table = shipped("table")
    assert has(table, 0.0, 0.0)
    np.testing.assert_allclose(table.bounds, (-0.505, -0.605, 0.505, 0.605), atol=0.005)
    frame = [box((-0.4, -0.4, 0), (0.4, -0.3, 1)), box((-0.4, 0.3, 0), (0.4, 0.4, 1))]
    frame += [box((-0.4, -0.4, 0), (-0.3, 0.4, 1)), box((0.3, -0.4, 0), (0.4, 0.4, 1))]
    assert has(seen(*frame), 0.0, 0.0)


def test_the_inside_of_a_room_is_free():
    walls = [box((-3, -2, 0), (3, -1.9, 2.5)), box((-3, 1.9, 0), (3, 2, 2.5))]
    walls += [box((-3, -2, 0), (-2.9, 2, 2.5)), box((2.9, -2, 0), (3, 2, 2.5))]
    shape = seen(*walls)
    assert not has(shape, 0.0, 0.0)
    assert not has(shape, 2.8, 1.8)
    for x, y in ((2.95, 0.5), (-2.95, 0.5), (0.5, 1.95), (0.5, -1.95)):
        assert has(shape, x, y)


def test_heights_are_those_of_the_world():
    assert shipped("cup", 0.88).area == pytest.approx(np.pi * 0.04**2, rel=0.02)
    assert shipped("cup", 1.9).is_empty
    assert shipped("lamp").area == pytest.approx(np.pi * 0.214**2, rel=0.02)
    assert shipped("lamp", 0.7).area < 0.5 * shipped("lamp").area  # its shade is over head height
    assert shipped("lamp", 1.95).is_empty


def test_a_turn_about_z_is_left_to_who_places_it_and_a_tilt_is_not():
    turn = from_axis_angle(Z, 2.0)
    assert CHECKOUT.objects.footprint("door", 0.0, turn) == CHECKOUT.objects.footprint("door", 0.0, UPRIGHT)
    # Tipped over its foot towards +x, the bookshelf of 1.8 m lies ahead of where it stood.
    tip = from_axis_angle(Y, np.pi / 2)
    for rotation in (tip, multiply(turn, tip)):
        low_x, low_y, high_x, high_y = shipped("bookshelf", 0.17, rotation).bounds
        assert abs(low_x) < 0.01
        assert high_x == pytest.approx(1.8, abs=0.02)
        assert (low_y, high_y) == pytest.approx((-0.455, 0.455), abs=0.01)


def test_a_changed_shape_is_seen_and_what_is_known_is_kept_on_disk(workspace: Workspace, monkeypatch):
    text = 'shape = "slab.obj"\n'
    file = add_object(workspace, "slab", text)
    (file.parent / "slab.obj").write_text("v 0 0 1\nv 2 0 1\nv 0 1 1\nf 1 2 3\n")
    first = workspace.objects.footprint("slab", 0.0, UPRIGHT)
    assert area(first).area == pytest.approx(1.0, abs=0.05)
    (file.parent / "slab.obj").write_text("v 0 0 1\nv 4 0 1\nv 0 1 1\nf 1 2 3\n")
    assert area(workspace.objects.footprint("slab", 0.0, UPRIGHT)).area == pytest.approx(2.0, abs=0.05)
    (file.parent / "slab.obj").write_text("v 0 0 1\nv 2 0 1\nv 0 1 1\nf 1 2 3\n")
    monkeypatch.setattr(outline, "outlines", None)
    again = Workspace(workspace.root).objects
    assert again.footprint("slab", 0.0, UPRIGHT) == first
    assert again.footprint("slab", 0.0, UPRIGHT) is again.footprint("slab", 0.2, UPRIGHT)


def test_a_kind_without_a_shape_occupies_nothing():
    assert CHECKOUT.objects.footprint("room", 0.0, UPRIGHT) == ()


def test_many_triangles_are_seen_as_cells_that_cover_them():
    rng = np.random.default_rng(3)
    corners = rng.uniform(-1.0, 1.0, (300, 1, 2)) * [2.0, 1.0] + rng.normal(0.0, 0.05, (300, 3, 2))
    corners = np.round(corners, 3)
    exact = shapely.union_all(shapely.polygons(corners))
    cells, size = silhouette(corners)
    assert size == 0.01
    assert exact.difference(cells).area < 1e-9
    assert cells.difference(exact.buffer(1.5 * size)).area < 1e-9


def test_a_shape_of_very_many_triangles_has_an_outline_like_another():
    x, y = np.meshgrid(np.linspace(0.0, 2.0, 81), np.linspace(0.0, 1.0, 61), indexing="ij")
    grid = np.stack([x, y, 0.5 + 0.2 * np.sin(5 * x)], axis=-1)
    a, b, c, d = grid[:-1, :-1], grid[1:, :-1], grid[1:, 1:], grid[:-1, 1:]
    triangles = np.concatenate([np.stack(t, axis=2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))])
    assert len(triangles) == 9600
    shape = seen(triangles)
    assert shape.bounds == pytest.approx((0.0, 0.0, 2.0, 1.0), abs=0.025)
    assert shape.area == pytest.approx(2.0, abs=0.06)


@pytest.mark.filterwarnings("error")
def test_a_lever_that_leans_has_a_footprint_and_nobody_is_warned_of_it() -> None:
    """Seen from above two corners of its outline are next to in one place."""
    leans = np.array([0.8659375654532745, -0.07846501503152778, -0.48290676072143257, -0.10390589301137454])
    shape = CHECKOUT.objects.shape("lever")
    assert shape is not None
    assert 0.002 < area(Footprints().of(shape, 1.2121, leans)).area < 0.03
