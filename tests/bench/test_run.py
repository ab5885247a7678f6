"""`ahmss bench` and what its help says of it."""

from __future__ import annotations

from typing import get_args, get_type_hints

import pytest

from ahmss.bench import run
from ahmss.bench.goals import GOALS
from ahmss.bench.run import MEASURES, named
from ahmss.bench.thesis import TABLES
from ahmss.cli import bench


def test_the_help_names_all_that_can_be_measured() -> None:
    argument = get_args(get_type_hints(bench, include_extras=True)["what"])[1]
    assert argument.help == f"{', '.join(MEASURES)}; left out: all."


def test_what_the_documentation_calls_a_number_by_can_be_measured() -> None:
    keys = {*(goal.key for goal in GOALS), *(row.key for table in TABLES for row in table.rows), *MEASURES}
    assert {named(key) for key in keys} == set(MEASURES)
    assert named("compute_fps") == named("compute_fps.walk") == "compute"


def test_one_that_is_named_twice_is_measured_once(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[str] = []

    def measure(names: list[str], _: object) -> dict[str, object]:
        asked.extend(names)
        return {"polygons": {}}

    monkeypatch.setattr(run, "measure", measure)
    assert run.main(["compute_fps", "compute", "compute_fps.walk", "polygons", "--json"]) == 0
    assert asked == ["compute", "polygons"]
    with pytest.raises(SystemExit):
        run.main(["compute_fpx"])
    assert "nothing to measure called compute_fpx" in capsys.readouterr().err
