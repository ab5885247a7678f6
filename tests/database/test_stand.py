"""Where one stands to use the things of the shipped room: on the floor, clear of them, where their actions start."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely

from ahmss.body.array import Array
from ahmss.body.quaternion import rotate
from ahmss.database import Placed, Workspace

ROOM = Workspace(Path(__file__).resolve().parents[2])
PLACED = {placed.name: placed for placed in ROOM.objects.place("room", "room")}
FIXED = [
    "table", "doorway", "doorway/door", "television", "television/switch", "chair", "sink", "sink/tap", "bookshelf",
    "bed",
]  # fmt: skip
NEAREST = 0.12  # metres from any thing to the middle of one who stands at it


def in_world(placed: Placed, point: Array) -> Array:
    return np.array(placed.position) + rotate(np.array(placed.rotation), point)


def stand(name: str) -> tuple[Array, float]:
    """Place (3,) and heading, degrees, in the room's frame."""
    placed = PLACED[f"room/{name}"]
    site = ROOM.objects.get(placed.kind).sites["stand"]
    place = in_world(placed, np.array(site.position))
    ahead = in_world(placed, site.position + rotate(np.array(site.rotation), np.array([1.0, 0.0, 0.0]))) - place
    return place, float(np.degrees(np.arctan2(ahead[1], ahead[0])))


def occupied() -> shapely.Geometry:
    shapes: list[shapely.Polygon] = []
    for placed in PLACED.values():
        for ring in ROOM.objects.footprint(placed.kind, placed.position[2], np.array(placed.rotation)):
            corners = np.pad(np.array(ring), ((0, 0), (0, 1)))
            shapes.append(shapely.Polygon(in_world(placed, corners)[:, :2]))
    return shapely.union_all(shapes)


@pytest.mark.parametrize("name", FIXED)
def test_one_stands_on_the_floor_clear_of_things(name: str) -> None:
    place, _ = stand(name)
    assert place[2] == pytest.approx(0.0, abs=1e-9)
    assert occupied().distance(shapely.Point(place[:2])) > NEAREST
    floor = PLACED["room/floor"].position
    assert np.abs(place[:2] - floor[:2]).max() < 2.9


@pytest.mark.parametrize("name", [name for name in FIXED if name not in ("chair", "doorway", "doorway/door")])
def test_one_faces_what_one_uses(name: str) -> None:
    place, heading = stand(name)
    away = np.array(PLACED[f"room/{name}"].position) - place
    assert heading == pytest.approx(np.degrees(np.arctan2(away[1], away[0])), abs=1e-6)
    assert np.hypot(*away[:2]) < 0.8


@pytest.mark.parametrize(
    ("name", "x", "y", "facing"),
    [("chair", 1.78, 0.2, 180.0), ("doorway", -0.18, -0.08, -55.0), ("doorway/door", -0.18, -0.08, -55.0)],
)
def test_actions_start_from_there(name: str, x: float, y: float, facing: float) -> None:
    place, heading = stand(name)
    np.testing.assert_allclose(place, [x, y, 0.0], atol=1e-9)
    assert np.cos(np.radians(heading - facing)) == pytest.approx(1.0)


def test_the_carton_is_lifted_from_behind() -> None:
    site = ROOM.objects.get("carton").sites["stand"]
    assert (site.position, site.rotation) == ((-0.35, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))


def test_what_is_used_from_any_side_says_from_how_far() -> None:
    for kind, least, most in (("cup", 0.4, 0.5), ("lamp", 0.4, 0.6)):
        site = ROOM.objects.get(kind).sites["stand"]
        assert site.free_axis == "z"
        assert least < -site.position[0] < most
        assert site.rotation == (1.0, 0.0, 0.0, 0.0)
