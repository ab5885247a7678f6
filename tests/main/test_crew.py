"""Ten operators work at once: nothing is lost, stuck or grows, and who is killed leaves the rest alone.

AHMSS_CREW_S says for how many seconds they do; AHMSS_CREW_S=600 is the soak.
"""

from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np
import pytest

from ahmss.client import Client
from tests.main.conftest import ROOT
from tests.main.crew import Crew, Operator, cpu_s, memory_mb

SECONDS = float(os.environ.get("AHMSS_CREW_S", "180"))
GROWTH = 12.0  # MB from the first third of the time to the end


def states(crew: Crew, name: str) -> dict[str, object]:
    return dict(crew.viewer.refresh().objects[f"crew_room/{name}"].states)


def told(one: Operator) -> str:
    """A line about what one of them held, for who reads the output of the test."""
    (began, first, late, held), (ended, last, later, more) = one.frames[0], one.frames[-1]
    frames, most = last - first, max(one.off, default=0.0)
    return (
        f"{one.name}: {one.done} done, {one.yielded} left to others; "
        f"{frames / (ended - began):.1f} frames/s, {later - late} late and {more - held} held of {frames}; "
        f"{one.memory[0]:.1f} to {one.memory[-1]:.1f} MB, {cpu_s(one.process.pid):.0f} s of processor time; "
        f"levers off by {most:.3f} at the most"
    )


def is_as_left(crew: Crew, one: Operator) -> None:
    """What only this one works with is in the world as its main had it: no press, turn or slide was lost."""
    assert len(one.left) == 3
    for thing, told_states in one.left.items():
        assert states(crew, thing) == pytest.approx(told_states), f"{one.name} {thing}"


@pytest.mark.long
@pytest.mark.timeout(1500)
def test_ten_work_and_one_is_killed(tmp_path: Path) -> None:
    with Crew(tmp_path, ROOT) as crew:
        server = memory_mb(crew.server.pid)
        victim = crew.operators[3]
        crew.work(SECONDS, victim, after=0.6 * SECONDS)
        rest = [one for one in crew.operators if one is not victim]
        print(*(told(one) for one in rest), sep="\n")
        stats = crew.viewer.stats()
        print(f"server: late p50 and p99 {np.percentile(stats.late_ms, [50, 99])} ms, {stats.missed} missed")
        assert [line for one in crew.operators for line in one.wrong] == []
        assert victim.process.wait(5.0) == -9
        assert all(one.process.poll() is None for one in rest)
        for one in rest:
            assert one.done >= 5, told(one)
            is_as_left(crew, one)
            third = one.memory[len(one.memory) // 3]
            assert one.memory[-1] < third + GROWTH, told(one)
        assert memory_mb(crew.server.pid) < server + GROWTH
        # What the killed one had is free after its lease, and its neighbour takes it.
        end = time.monotonic() + 15.0
        while crew.held() and time.monotonic() < end:
            time.sleep(0.2)
        assert crew.held() == {}
        neighbour = crew.operators[2]
        assert neighbour.panel == victim.panel
        with Client(neighbour.port, timeout=30.0) as client:
            for thing, level in ((victim.shared, 0.5), (victim.lever, 0.25)):
                assert neighbour.act(client, thing, "slide", {"level": level}), neighbour.wrong
        assert neighbour.wrong == []
        assert states(crew, victim.lever)["level"] == pytest.approx(0.25, abs=0.03)
        assert states(crew, f"gauge_{victim.panel}")["value"] == pytest.approx(0.5, abs=0.03)
