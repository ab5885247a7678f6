"""A panel that is redesigned while somebody works at it, and a control room in which one thing leads to another."""

from __future__ import annotations

import re
import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ahmss.database.panel import new_panel
from ahmss.database.workspace import Workspace
from ahmss.main.process import MainProcess, Setup
from ahmss.world.process import ServerProcess
from tests.main.conftest import ROOT
from tests.main.ground import steps

Start = Callable[..., ServerProcess]
Enter = Callable[..., MainProcess]


@pytest.fixture
def enter(pool: None) -> Iterator[Enter]:
    """Makes mains of a workspace in this process."""
    mains: list[MainProcess] = []

    def begin(server: ServerProcess, workspace: Path, **options: Any) -> MainProcess:
        setup = Setup("ken", "ken", server=server.address, workspace=workspace, seed=1, **options)
        mains.append(MainProcess(setup, lambda _: None))
        return mains[-1]

    yield begin
    for main in mains:
        main.close()


@pytest.fixture
def plant(tmp_path: Path) -> Workspace:
    """A workspace with a panel of three buttons that stay in."""
    root = tmp_path / "plant"
    for folder in ("objectdb/latching_button", "algorithms/press", "algorithms/pressed", "humandb/ken"):
        shutil.copytree(ROOT / folder, root / folder)
    (root / "objectdb" / "floor").mkdir()
    shutil.copy(ROOT / "objectdb/floor/walk.npz", root / "objectdb/floor/walk.npz")
    workspace = Workspace(root)
    new_panel(workspace, "panel", ["latching_button"], 1, 3, 45.0, 1.1)
    return workspace


def test_the_panel_is_used_as_it_now_is(server: Start, enter: Enter, plant: Workspace) -> None:
    """While the world runs one button is moved and tilted, one is taken away, and one is added."""
    main = enter(server(), plant.root)
    main.play(steps("add panel at 0.55 0 0 facing 180"))
    assert main.report.messages == []
    file = plant.root / "objectdb" / "panel" / "object.toml"
    lines = file.read_text().splitlines()
    numbered = {name: i for i, line in enumerate(lines) if (name := "".join(re.findall(r'name = "(button_\d)"', line)))}
    line = '  {{ kind = "latching_button", name = "{}", position = [{}, {}, {}], orientation_deg = [0, {}, 0] }},'
    lines[numbered["button_2"]] = line.format("button_2", 0.02, -0.1, 1.32, -10)
    lines[numbered["button_3"]] = line.format("button_4", 0.02, 0.1, 1.3, -70)
    file.write_text("\n".join(lines))
    for _ in range(20):  # it looks at the files once in a second
        main.play(steps("wait 0.5"))
        objects = main.communication.world.objects
        if "panel/button_4" in objects and "panel/button_3" not in objects and moved(main):
            break
    main.play(steps("do panel/button_2 press", "do panel/button_4 press", "do panel/button_3 press"))
    world = main.communication.world
    assert world.pose("panel/button_2")[:3] == pytest.approx([0.53, 0.1, 1.32], abs=1e-6)
    states = {name: record.states["position"] for name, record in world.objects.items() if "/" in name}
    assert states == {"panel/button_1": "out", "panel/button_2": "in", "panel/button_4": "in"}
    assert len(main.report.messages) == 1
    assert "button_3" in main.report.messages[0]


def moved(main: MainProcess) -> bool:
    return abs(float(main.communication.world.pose("panel/button_2")[2]) - 1.32) < 1e-6


def test_in_the_control_room_one_thing_leads_to_another(server: Start, enter: Enter) -> None:
    main = enter(server(lockstep=["ken"]), ROOT, fast=True, names=("ken",))

    def after(*lines: str) -> dict[str, object]:
        main.play(steps(*lines))
        assert main.report.messages == []
        objects = main.communication.world.objects
        of = {"pump": "running", "gauge_1": "value", "window_1": "window", "window_2": "window"}
        return {name: objects[f"room/{name}"].states[state] for name, state in of.items()}

    asleep = {"pump": "off", "gauge_1": 0.0, "window_1": "normal", "window_2": "normal"}
    start = ("set room/panel/button_1 position in", "set room/panel/button_1 position out")
    assert after("add control_room as room", *start) == asleep  # the key does not allow it
    assert after("set room/key_switch position on", *start) == asleep | {"pump": "on", "window_1": "alarm"}
    acknowledged = after("set room/panel/button_10 position in", "set room/panel/button_10 position out")
    assert acknowledged == asleep | {"pump": "on", "window_1": "acknowledged"}
    assert after("set room/panel/lever_1 level 0.6") == asleep | {"pump": "on", "gauge_1": 0.6}
    assert after("set room/panel/lever_1 level 0.95") == asleep | {"pump": "on", "gauge_1": 0.95, "window_2": "alarm"}
    assert after("set room/panel/button_2 position in") == asleep


def test_all_controls_of_a_kind_share_one_record_and_one_shape() -> None:
    workspace = Workspace(ROOT)
    placed = [one for one in workspace.objects.place("panel", "panel") if one.kind != "panel"]
    assert len(placed) == 40
    kinds = {one.kind for one in placed}
    assert len(kinds) == 4
    for kind in kinds:
        assert workspace.objects.get(kind) is workspace.objects.get(kind)
        assert workspace.objects.shape(kind) is workspace.objects.shape(kind)
    places = np.array([one.position for one in placed])
    assert np.linalg.norm(places[:, None] - places, axis=-1)[~np.eye(40, dtype=bool)].min() > 0.05
