"""The thesis's tables 5.5 to 5.8 beside ours, row by row."""

from __future__ import annotations

import pytest

from ahmss.bench import cases, compute
from ahmss.bench.polygons import polygons
from ahmss.bench.thesis import TABLES, markdown, show
from ahmss.database.workspace import Workspace
from ahmss.main.command import Do, parse

from .made import ROOT

REPORT = {
    "compute_fps": {"playback": 4100.0, "walk": 250.0},
    "polygons": {"chair": 104, "cup": 216},
    "start_ms_of": {"walk_object": {"walk": 12.34, "follow_hand": 3.1}},
}


def rows(text: str, table: str) -> list[list[str]]:
    part = text[text.index(f"Table {table}") :].split("\n\n")[1]
    return [[cell.strip() for cell in line.split("|")[1:-1]] for line in part.splitlines()]


def test_a_rate_stands_beside_the_thesis_with_its_milliseconds() -> None:
    found = rows(markdown(REPORT), "5.6")
    assert found[2] == ["playback of motion capture", "24.98", "4,100", "40.03", "0.24"]
    assert found[3] == ["a walk", "24.93", "250", "40.11", "4.00"]
    assert found[4][2] == found[4][4] == "-"
    assert len(found) == 2 + 6


def test_polygons_are_summed() -> None:
    found = rows(markdown(REPORT), "5.7")
    assert ["chair", "98", "104"] in found
    assert ["cup", "-", "216"] in found
    assert found[-1] == ["total", "13,679", "320"]
    assert len(found) == 2 + 13 + 1


def test_each_algorithm_of_a_case_has_its_start() -> None:
    found = rows(markdown(REPORT), "5.8")
    assert ["object operation (a walk, follow_hand): follow_hand", "5.9", "3.1"] in found
    assert len(found) == 2 + 10


def test_a_table_of_which_nothing_was_measured_is_left_out(capsys: pytest.CaptureFixture[str]) -> None:
    assert "5.5" not in markdown(REPORT)
    assert markdown({}) == ""
    show(REPORT)
    told = capsys.readouterr().out
    assert "Table 5.6" in told
    assert "Table 5.5" not in told


def test_the_printed_numbers_are_the_thesiss() -> None:
    shown, computed, counted, started = TABLES
    assert {row.thesis for row in shown.rows} == {4.96}
    for row in computed.rows:
        assert row.thesis is not None
        assert float(row.each) == pytest.approx(1e3 / row.thesis, rel=1e-3)
    known = [row.thesis for row in counted.rows if row.thesis is not None]
    assert sum(known) == 13_463
    assert counted.total == 13_463 + 216  # the cup, presumably
    assert sum(row.thesis or 0.0 for row in started.rows) == pytest.approx(56.9)


def test_every_number_that_is_shown_is_measured() -> None:
    workspace = Workspace.find(ROOT)
    shown, computed, counted, started = TABLES
    assert {row.key.split(".")[1] for row in shown.rows} == set(cases.CASES)
    assert {row.key.split(".")[1] for row in computed.rows} <= set(compute.CASES)
    assert {row.key.split(".")[1] for row in counted.rows} == set(polygons(workspace))
    assert {row.key.split(".")[1] for row in started.rows} == set(cases.CASES)


def test_every_algorithm_of_every_case_starts() -> None:
    found = cases.start_ms_of(Workspace.find(ROOT), repeats=1)
    wanted = {tuple(row.key.split(".")[1:]) for row in TABLES[3].rows}
    assert {(case, name) for case, starts in found.items() for name in starts} == wanted
    assert all(took > 0.0 for starts in found.values() for took in starts.values())


@pytest.mark.parametrize("case", cases.CASES)
def test_a_case_is_a_script_that_can_be_read(case: str) -> None:
    lines = [parse(line) for line in cases.script_of(cases.CASES[case]).splitlines()]
    motions = [line for line in lines if isinstance(line, Do)]
    assert len(motions) == 4
    assert all(len(motion.acts) == (2 if "fusion" in case else 1) for motion in motions)
