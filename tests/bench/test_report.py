"""The bench's report: what counts as reached, and what stands where."""

from __future__ import annotations

import pytest

from ahmss.bench.goals import GOALS, look_up
from ahmss.bench.report import markdown, missed, show

REPORT = {"start_ms": {"python": 0.8, "native": 1.3}, "compute_fps": {"playback": 4100.0}, "body_us_per_human": 2.5}


def test_a_number_that_is_too_large_or_too_small_is_missed() -> None:
    assert missed(REPORT) == ["start_ms.native", "body_us_per_human"]


def test_what_was_not_measured_is_neither_reached_nor_missed() -> None:
    rows = markdown({}).splitlines()[2:]
    assert len(rows) == len(GOALS)
    assert all("not measured" in row and "reached" not in row and "missed" not in row for row in rows)


def test_a_person_is_shown_what_was_measured_and_nothing_else(capsys: pytest.CaptureFixture[str]) -> None:
    show(REPORT)
    told = capsys.readouterr().out
    assert "not measured" not in told
    assert sum(word in told for word in ("reached", "missed")) == 2
    assert "pictures shown" not in told
    assert "native" in told


def test_a_row_tells_thesis_goal_and_measurement() -> None:
    row = next(line for line in markdown(REPORT).splitlines() if "playback" in line)
    assert [cell.strip() for cell in row.split("|")[2:6]] == ["24.98 /s", "≥ 4,000 /s", "4,100 /s", "reached"]


def test_a_dotted_key_that_is_missing_gives_nothing() -> None:
    assert look_up(REPORT, "compute_fps.playback") == 4100.0
    assert look_up(REPORT, "compute_fps.slerp") is None
    assert look_up(REPORT, "server.humans") is None
