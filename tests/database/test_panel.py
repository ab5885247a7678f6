"""`ahmss new panel`, the control room's shapes, and consequences that are about what an object contains."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from ahmss.algorithm import WorldObject
from ahmss.body.quaternion import rotate
from ahmss.database.check import check
from ahmss.database.footprint import triangles_of
from ahmss.database.panel import new_panel
from ahmss.database.workspace import Workspace
from ahmss.errors import CommandError, DataError
from ahmss.reaching.prism import clearance
from ahmss.skills.box import filled

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    for kind in ("push_button", "lever", "key_switch"):
        shutil.copytree(ROOT / "objectdb" / kind, tmp_path / "objectdb" / kind)
    for folder in ("press", "pressed", "slide", "slid", "turn", "turned"):
        shutil.copytree(ROOT / "algorithms" / folder, tmp_path / "algorithms" / folder)
    (tmp_path / "objectdb/floor").mkdir()
    (tmp_path / "objectdb/floor/object.toml").write_text('name = "floor"\nsentence = "A floor."\n')
    shutil.copy(ROOT / "objectdb/floor/walk.npz", tmp_path / "objectdb/floor/walk.npz")
    (tmp_path / "humandb").mkdir()
    return Workspace(tmp_path)


@pytest.mark.parametrize("slope", [0.0, 35.0, 90.0])
def test_rows_of_controls_stand_on_the_plate(workspace: Workspace, slope: float) -> None:
    new_panel(workspace, "board", ["push_button", "lever"], 3, 4, slope, 1.1)
    assert check(workspace).problems == ()
    placed = [one for one in workspace.objects.place("board", "board") if one.kind != "board"]
    names = [f"board/{name}_{i + 1}" for name, n in (("button", 8), ("lever", 4)) for i in range(n)]
    assert sorted(one.name for one in placed) == sorted(names)
    places = np.array([one.position for one in placed])
    out = np.array([np.sin(np.radians(slope)), 0.0, np.cos(np.radians(slope))])
    for one in placed:
        np.testing.assert_allclose(rotate(np.array(one.rotation), np.array([1.0, 0.0, 0.0])), out, atol=1e-4)
    assert np.ptp(places @ out) < 1e-3  # all in its plane
    at = {one.name: one.position for one in placed}
    assert at["board/button_1"][1] < at["board/button_2"][1]  # from the left, as one sees it who looks at it
    assert at["board/button_1"][2] >= at["board/lever_1"][2] >= at["board/button_5"][2]
    assert at["board/button_1"][0] <= at["board/lever_1"][0] <= at["board/button_5"][0]
    low, high = workspace.objects.shape("board").bounds
    assert high[2] >= places[:, 2].max()
    assert low[2] == pytest.approx(0.0, abs=1e-6)


def test_rows_leave_each_other_room_whatever_stands_out_and_up(workspace: Workspace) -> None:
    """A cover that is open is far above its key, and a hand that takes it comes aslant from below when it is closed."""
    new_panel(workspace, "board", ["key_switch", "lever", "push_button", "push_button"], 4, 2, 90.0, 1.1)
    rows: dict[str, list[float]] = {}
    for one in workspace.objects.place("board", "board"):
        if one.kind != "board":
            low, high = workspace.objects.get(one.kind).properties["box"]
            rows[f"{one.kind} {one.position[2]:.3f}"] = [one.position[2] + low[2], one.position[2] + high[2]]
    (key, lever, upper, lower) = sorted(rows.values(), reverse=True)
    assert key[0] - lever[1] == pytest.approx(0.8 * 0.092, abs=2e-4)
    assert lever[0] - upper[1] == pytest.approx(0.8 * 0.06, abs=2e-4)
    assert upper[0] - lower[1] == pytest.approx(0.035, abs=2e-4)
    top = workspace.objects.shape("board").bounds[1][2]
    assert top - key[1] == pytest.approx(0.05, abs=2e-4)


@pytest.mark.parametrize("slope", [0.0, 12.0, 35.0, 90.0])
def test_hands_are_told_of_a_console_as_it_is_drawn(workspace: Workspace, slope: float) -> None:
    new_panel(workspace, "board", ["push_button"], 3, 4, slope, 1.1)
    kind, shape = workspace.objects.get("board"), workspace.objects.shape("board")
    assert shape is not None
    board = WorldObject(1, "board", "board", np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]), properties=kind.properties)
    blocks = filled(board)
    faces = triangles_of(shape.glb)
    out = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    some = np.linalg.norm(out, axis=-1) > 1e-6
    middles, out = faces[some].mean(axis=1), out[some] / np.linalg.norm(out[some], axis=-1, keepdims=True)
    np.testing.assert_allclose(clearance(blocks, middles), 0.0, atol=2e-4)  # the file has tenths of millimetres
    beside = np.sort([clearance(blocks, middles + 0.01 * out), clearance(blocks, middles - 0.01 * out)], axis=0)
    np.testing.assert_allclose(beside[1], 0.01, atol=5e-4)
    assert (beside[0] < -0.009).all()


@pytest.mark.parametrize(
    ("name", "kinds", "rows", "slope", "height", "sentence"),
    [
        ("push_button", ["lever"], 1, 60.0, 1.0, "exists already"),
        ("9", ["lever"], 1, 60.0, 1.0, "no name for a panel"),
        ("board", ["handle"], 1, 60.0, 1.0, "no such object; of controls there are: key_switch, lever, push_button"),
        ("board", ["lever", "floor"], 2, 60.0, 1.0, "--of floor: no control, .* are: key_switch, lever, push_button"),
        ("board", ["lever"], 0, 60.0, 1.0, "allowed: 1 to 400"),
        ("board", ["lever"], 1, 95.0, 1.0, "0 .flat. to 90"),
        ("board", ["lever"], 14, 90.0, 1.0, "choose another height"),
    ],
)
def test_what_can_be_no_panel_is_told(
    workspace: Workspace, name: str, kinds: list[str], rows: int, slope: float, height: float, sentence: str
) -> None:
    with pytest.raises(CommandError, match=sentence):
        new_panel(workspace, name, kinds, rows, 4, slope, height)


def test_a_consequence_about_what_it_contains_names_something_that_it_contains(workspace: Workspace) -> None:
    file = new_panel(workspace, "board", ["push_button"], 1, 2, 60.0, 1.1)
    text = file.read_text() + '\n[states.lit]\nvalues = ["no", "yes"]\n\n[[consequences]]\nat = "button_2"\n'
    text += 'when = "position == in"\nstate = "lit"\nto = "yes"\n'
    file.write_text(text)
    (one,) = workspace.objects.get("board").consequences
    assert (one.at, one.of, one.state, one.to) == ("button_2", "", "lit", "yes")
    file.write_text(text.replace('at = "button_2"', 'at = "button_3"'))
    with pytest.raises(DataError, match=r'consequences\[0\]\.at .*contains no "button_3"'):
        Workspace(workspace.root).objects.get("board")


def test_the_shapes_are_made_to_the_byte(tmp_path: Path) -> None:
    subprocess.run([sys.executable, ROOT / "scripts/make_control_room.py", tmp_path], check=True, capture_output=True)
    made = sorted(tmp_path.glob("objectdb/*/*.dxf"))
    assert len(made) == 10
    for path in made:
        assert path.read_bytes() == (ROOT / path.relative_to(tmp_path)).read_bytes()
