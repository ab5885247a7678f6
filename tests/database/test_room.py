"""The shipped room: what the script makes, and that it stands as the demo needs it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from ahmss.database import Workspace

CHECKOUT = Path(__file__).resolve().parents[2]
TABLE_5_7 = {
    "chair": 98,
    "table": 320,
    "door": 268,
    "floor": 10368,
    "sink": 185,
    "television": 167,
    "wall_1": 2,
    "wall_2": 2,
    "bed": 94,
    "lamp": 568,
    "bookshelf": 90,
    "cup": 216,
}


@pytest.fixture(scope="module")
def room() -> Workspace:
    return Workspace(CHECKOUT)


@pytest.mark.parametrize(("kind", "faces"), TABLE_5_7.items())
def test_polygons_are_about_those_of_table_5_7(room: Workspace, kind: str, faces: int) -> None:
    shape = room.objects.shape(kind)
    assert shape is not None
    assert 0.75 * faces <= shape.faces <= 1.55 * faces


def test_all_of_the_thesis_stands_in_the_room(room: Workspace) -> None:
    placed = room.objects.place("room", "room")
    kinds = {p.kind for p in placed}
    assert kinds >= set(TABLE_5_7) | {"tap", "switch"}
    assert {p.name for p in placed} >= {"room/cup", "room/doorway/door", "room/sink/tap", "room/television/switch"}


def test_sizes_are_those_of_real_things(room: Workspace) -> None:
    for kind, size in (("door", (None, None, 2.0)), ("cup", (0.072, None, 0.095)), ("chair", (None, 0.42, 0.86))):
        shape = room.objects.shape(kind)
        assert shape is not None
        extent = np.ptp(np.array(shape.bounds), axis=0)
        for measured, wanted in zip(extent, size, strict=True):
            assert wanted is None or measured == pytest.approx(wanted, abs=0.002)


def test_the_cup_stands_on_the_table(room: Workspace) -> None:
    placed = {p.kind: p for p in room.objects.place("room", "room")}
    table = room.objects.shape("table")
    assert table is not None
    low, high = np.array(table.bounds) + placed["table"].position
    x, y, z = placed["cup"].position
    assert z == pytest.approx(high[2], abs=1e-4)
    assert low[0] + 0.036 < x < high[0] - 0.036
    assert low[1] + 0.036 < y < high[1] - 0.036


def test_the_script_writes_the_same_bytes(tmp_path: Path) -> None:
    script = str(CHECKOUT / "scripts/make_room.py")
    subprocess.run([sys.executable, script, str(tmp_path)], check=True, capture_output=True)
    made = sorted(p.relative_to(tmp_path) for p in tmp_path.rglob("*") if p.is_file())
    assert len(made) == 21
    for path in made:
        if path.suffix == ".dxf":  # pictures depend on the version of the library that compresses them
            assert (CHECKOUT / path).read_bytes() == (tmp_path / path).read_bytes(), path
        else:
            assert (CHECKOUT / path).is_file(), path
