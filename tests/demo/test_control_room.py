"""A pump started by two operators in twenty steps: examples/control_room.txt, played and followed in its recording."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from ahmss.main.play import PlaySetup, play_script
from ahmss.world.recording import Reader
from ahmss.world.view import World

from .conftest import ROOT

SCRIPT = ROOT / "examples" / "control_room.txt"
WATCHED = {
    "manual": ("taken", "cover"), "telephone": ("hook",), "control_room/key_switch": ("cover", "position"),
    "control_room/pump": ("running", "enabled"), "control_room/panel/button_1": ("lamp",),
    "control_room/panel/button_17": ("lamp",), "control_room/panel/switch_8": ("position",),
    "control_room/window_1": ("window",), "control_room/window_2": ("window",),
}  # fmt: skip
LEVELS = {"control_room/gauge_1": "value", "control_room/gauge_3": "value", "control_room/panel/lever_8": "level"}

Change = tuple[str, str, object]


def followed(recording: Path) -> tuple[list[Change], dict[str, list[float]], World]:
    """What became of the watched states, in order; the levels at each tick; the world in the end."""
    world, before = World(), dict[tuple[str, str], object]()
    changes: list[Change] = []
    levels: dict[str, list[float]] = {name: [] for name in LEVELS}
    with Reader(recording) as reader:
        for tick in range(len(reader)):
            reader.show(tick, world)
            if not (WATCHED.keys() | LEVELS.keys()) <= world.objects.keys():
                continue
            for name, states in WATCHED.items():
                for state in states:
                    value = world.objects[name].states[state]
                    if before.get((name, state), value) != value:
                        changes.append((name.rsplit("/", 1)[-1], state, value))
                    before[name, state] = value
            for name, state in LEVELS.items():
                levels[name].append(float(str(world.objects[name].states[state])))
    return changes, levels, world


def of(changes: list[Change], name: str, state: str) -> list[object]:
    return [value for one, other, value in changes if (one, other) == (name, state)]


def comes_in_order(changes: list[Change], *wanted: Change) -> None:
    """Each of them is found after the one before."""
    rest = iter(changes)
    for change in wanted:
        assert change in rest, change


def test_it_has_twenty_steps_for_two() -> None:
    text = SCRIPT.read_text()
    assert [int(number) for number in re.findall(r"#\s+(\d+)\b", text)] == list(range(1, 21))
    assert len(re.findall(r"^(\w+): wait .*[=<>]", text, re.M)) >= 8
    assert set(re.findall(r"^(\w+): do ", text, re.M)) == {"ken", "aiko"}
    stand = np.array(re.findall(r"^human .* at (\S+) (\S+)", text, re.M), float)
    assert np.linalg.norm(stand[1] - stand[0]) > 0.75  # side by side, clear of each other's arms


@pytest.mark.long
def test_the_handset_comes_back_into_its_cradle_from_where_it_was_taken(tmp_path: Path) -> None:
    """The telephone's own box is nothing that the hand which lays it there must keep out of."""
    lines = [line for line in SCRIPT.read_text().splitlines() if re.match(r"add|human|aiko: do (tele|hand)", line)]
    script, path = tmp_path / "call.txt", tmp_path / "call.rec"
    script.write_text("\n".join(lines) + "\n")
    report = play_script(script, PlaySetup(workspace=ROOT, fast=True, record=path))
    assert report.failures == 0, str(report)
    assert not [note for main in report.mains for note in main["notes"] if "goes to" in note]
    changes, _, world = followed(path)
    assert of(changes, "telephone", "hook") == ["off", "on"]
    assert world.pose("telephone/handset")[:3] == pytest.approx([0.15, 1.25, 0.92], abs=0.005)


@pytest.mark.long
@pytest.mark.timeout(240)
def test_the_pump_runs_in_the_end_and_everything_came_in_its_order(tmp_path: Path) -> None:
    path = tmp_path / "control_room.rec"
    report = play_script(SCRIPT, PlaySetup(workspace=ROOT, fast=True, record=path))
    assert report.failures == 0, str(report)
    changes, levels, world = followed(path)
    comes_in_order(
        changes,
        ("manual", "taken", "yes"), ("manual", "cover", "open"), ("manual", "taken", "no"),
        ("key_switch", "cover", "open"), ("key_switch", "position", "on"), ("pump", "enabled", "yes"),
        ("pump", "running", "on"), ("window_1", "window", "acknowledged"),
        ("window_1", "window", "normal"), ("window_2", "window", "alarm"), ("window_2", "window", "acknowledged"),
        ("window_2", "window", "normal"), ("switch_8", "position", "high"), ("button_17", "lamp", "on"),
        ("key_switch", "cover", "closed"),
    )  # fmt: skip
    assert of(changes, "telephone", "hook") == ["off", "on"]
    assert world.pose("telephone/handset")[:3] == pytest.approx([0.15, 1.25, 0.92], abs=0.005)  # in its cradle
    assert of(changes, "key_switch", "cover") == ["open", "closed"]  # it stays shut behind the hand
    assert of(changes, "pump", "running") == ["on"]
    assert of(changes, "button_1", "lamp") == ["on", "off"]
    assert of(changes, "window_1", "window") == ["alarm", "acknowledged", "normal"]
    pressure = levels["control_room/gauge_1"]
    assert max(pressure) == pytest.approx(0.95, abs=0.02)
    assert pressure[-1] == pytest.approx(0.8, abs=0.02)
    assert levels["control_room/gauge_3"][-1] == pytest.approx(0.9, abs=0.02)
    assert levels["control_room/panel/lever_8"][-1] == pytest.approx(1.0, abs=0.02)
    assert world.objects["control_room/castor_chair"].holder == "ken"
    assert world.objects["control_room/window_2"].states["window"] == "normal"
