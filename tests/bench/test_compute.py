"""The bench measures real processes: every case runs, and what goes wrong is no number."""

from __future__ import annotations

import pytest

from ahmss.bench.compute import CASES, rig
from ahmss.bench.goals import GOALS
from ahmss.bench.start import WALKS
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError


def test_every_case_makes_frames_through_real_processes() -> None:
    with rig(Workspace.find()) as one:
        for line in CASES.values():
            assert one.rate(line, frames=5, rounds=2, warm=5) > 0.0


def test_what_is_only_watched_stays_where_it_is_for_the_next_motion() -> None:
    with rig(Workspace.find()) as one:
        before = one.place_of("thing")
        one.rate(CASES["object"], frames=100, rounds=2, warm=50)
        assert one.place_of("thing") == pytest.approx(before, abs=1e-12)


def test_a_line_that_fails_gives_no_number() -> None:
    with rig(Workspace.find()) as one, pytest.raises(AhmssError, match="juggle"):
        one.rate("do thing juggle frames {n}", frames=5, rounds=2, warm=5)


def test_a_motion_that_is_over_too_soon_gives_no_number() -> None:
    with rig(Workspace.find()) as one, pytest.raises(AhmssError, match="over before 411 frames"):
        one.rate("do thing walk to 0.3 0", frames=200, rounds=2, warm=10)


def test_every_case_has_a_goal() -> None:
    wanted = {goal.key.removeprefix("compute_fps.") for goal in GOALS if goal.key.startswith("compute_fps.")}
    assert wanted == set(CASES)
    starts = {goal.key.removeprefix("start_ms.") for goal in GOALS if goal.key.startswith("start_ms.")}
    assert set(WALKS) < starts


def test_the_walks_whose_start_is_measured_can_be_started() -> None:
    with rig(Workspace.find()) as one:
        for lines in WALKS.values():
            for line in lines[:-1]:
                one.carry_out(line)
            entry, start = one.start_of(lines[-1])
            assert entry.name == "walk"
            assert start.goal.place is not None
            assert start.frames == 0
            assert any(thing.footprint for thing in start.world) == ("add room" in lines)


def test_an_object_goes_along_in_the_hand() -> None:
    with rig(Workspace.find()) as one:
        before = one.place_of("thing")
        one.carry_out("do thing stroll to 1 0")
        assert one.place_of("thing")[0] > before[0] + 0.8
