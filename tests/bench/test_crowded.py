"""What is measured among many objects: through real processes, and by names that are found."""

from __future__ import annotations

import pytest

from ahmss.bench import crowded
from ahmss.bench.compute import rig
from ahmss.bench.crowded import fill, lookup_us
from ahmss.bench.goals import GOALS
from ahmss.database.workspace import Workspace
from ahmss.main.naming import find_object


def test_the_world_has_as_many_as_were_asked_for_and_each_is_found() -> None:
    with rig(Workspace.find()) as one:
        before = len(one.main.communication.objects)
        fill(one.main, "push_button", 1200)
        assert len(one.main.communication.objects) == before + 1201  # and the hall
        assert find_object(one.main.communication, "part_1199") == "hall/part_1199"


def test_every_count_is_measured_and_has_a_goal(monkeypatch: pytest.MonkeyPatch) -> None:
    goals = {goal.key for goal in GOALS}
    assert {f"lookup_us.{count}" for count in crowded.COUNTS} <= goals
    assert f"memory_mb.buttons_{crowded.BUTTONS}" in goals
    monkeypatch.setattr(crowded, "COUNTS", (5, 20))
    monkeypatch.setattr(crowded, "_EACH", 8)
    report = lookup_us(Workspace.find())
    assert set(report) == {"5", "asked_5", "20", "asked_20"}
    assert min(report.values()) > 0.0
