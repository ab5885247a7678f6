"""Two who want one thing: the second waits, says for whom, and has it when it is let go; who is killed lets go."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from ahmss.main.process import MainProcess
from ahmss.world.process import ServerProcess
from tests.main.ground import steps

Start = Callable[..., ServerProcess]
Join = Callable[..., MainProcess]
WAITS = "b take: waits for ken, who has b"


def until(done: Callable[[], bool], *mains: MainProcess, seconds: float = 20.0) -> None:
    """Make frames until it is so."""
    end = time.monotonic() + seconds
    while not done():
        assert time.monotonic() < end, [main.report.messages for main in mains]
        for main in mains:
            main.frame()
        time.sleep(0.005)


@pytest.fixture
def two(server: Start, join: Join) -> tuple[MainProcess, MainProcess]:
    """Ken has the box, aiko stands by."""
    one = server(lease_s=1.0)
    ken, aiko = join(one), join(one, "aiko", place=(0.0, 1.0))
    for step in steps("add box as b at 0.3 0 1", "do b take frames 20"):
        ken.agenda.add(step)
    until(lambda: ken.agenda.done and aiko.communication.world.objects.get("b") is not None, ken, aiko)
    until(lambda: aiko.communication.world.objects["b"].holder == "ken", ken, aiko)
    return ken, aiko


def test_who_comes_second_waits_and_has_it_when_it_is_let_go(two: tuple[MainProcess, MainProcess]) -> None:
    ken, aiko = two
    before = aiko.blending.rotations.copy()
    for step in steps("do b take frames 20"):
        aiko.agenda.add(step)
    for _ in range(60):
        ken.frame()
        aiko.frame()
        time.sleep(0.005)
    assert aiko.report.notes == [WAITS]
    assert not aiko.agenda.done
    np.testing.assert_array_equal(aiko.blending.rotations, before)
    for step in steps("do b drop frames 10"):
        ken.agenda.add(step)
    until(lambda: aiko.agenda.done, ken, aiko)
    assert aiko.control.holds == {"b": "right"}
    assert ken.report.messages == aiko.report.messages == []
    assert aiko.report.notes == [WAITS]


def test_who_has_waited_has_it_before_who_takes_it_once_more(two: tuple[MainProcess, MainProcess]) -> None:
    ken, aiko = two
    for step in steps("do b take frames 20"):
        aiko.agenda.add(step)
    until(lambda: bool(aiko.report.notes), ken, aiko)
    aiko.communication.client.hello()  # answered after what she asked before: the server knows that she waits
    for step in steps("do b drop frames 10", "do b take patience=0 frames 20"):
        ken.agenda.add(step)
    until(lambda: ken.agenda.done, ken)
    assert ken.report.messages == ["b take: b is waited for by aiko, who came first; wait until they let it go"]
    until(lambda: aiko.agenda.done, ken, aiko)
    assert aiko.control.holds == {"b": "right"}
    for step in steps("do b take frames 20"):
        ken.agenda.add(step)
    for step in steps("do b drop frames 10"):
        aiko.agenda.add(step)
    until(lambda: ken.agenda.done, ken, aiko)
    assert ken.control.holds == {"b": "right"}
    assert aiko.report.messages == []


def test_who_waits_for_it_does_not_have_it_after_a_break(two: tuple[MainProcess, MainProcess]) -> None:
    _, aiko = two
    for step in steps("do b take frames 20"):
        aiko.agenda.add(step)
    until(lambda: bool(aiko.report.notes), *two)
    for _ in range(40):
        aiko.frame()
        time.sleep(0.005)
    assert aiko.communication.client._own["aiko"].holds == {}  # what it would come back with


@pytest.mark.parametrize(
    ("patience", "waited"),
    [
        pytest.param("", "; waited 10 s", marks=pytest.mark.long),
        (" patience=0.5", "; waited 0.5 s"),
        (" patience=0", ""),
    ],
)
def test_who_waits_too_long_does_something_else_and_says_why(
    two: tuple[MainProcess, MainProcess], patience: str, waited: str
) -> None:
    ken, aiko = two
    before = aiko.report.frames
    for step in steps(f"do b take{patience} frames 20", "do b wave frames 10"):
        aiko.agenda.add(step)
    until(lambda: aiko.agenda.done, ken, aiko, seconds=40.0)
    assert aiko.report.messages == [f"b take: b is held by ken{waited}"]
    assert aiko.report.notes == ([WAITS] if waited else [])
    seconds = {"": 10.0, " patience=0.5": 0.5, " patience=0": 0.0}[patience]
    assert aiko.report.frames - before >= 60 * seconds + 10
    assert ken.control.holds == {"b": "right"}


def test_patience_is_a_number_of_seconds(two: tuple[MainProcess, MainProcess]) -> None:
    _, aiko = two
    aiko.play(steps("do b take patience=long"))
    assert aiko.report.messages == ['line 1: b take: patience "long" is no number of seconds; allowed: 0 to 3600']


def test_two_who_claim_in_the_same_moment_have_it_one_after_the_other(server: Start, join: Join) -> None:
    one = server()
    ken, aiko = join(one), join(one, "aiko", place=(0.0, 1.0))
    ken.play(steps("add box as b at 0.3 0 1"))
    until(lambda: "b" in aiko.communication.world.objects, aiko)
    for main in (ken, aiko):
        for step in steps("do b take frames 20", "wait 0.3", "do b drop frames 10"):
            main.agenda.add(step)
    had: list[str] = []

    def over() -> bool:
        holder = ken.communication.world.objects["b"].holder
        if holder and holder not in had[-1:]:
            had.append(holder)
        return ken.agenda.done and aiko.agenda.done

    until(over, ken, aiko)
    assert ken.report.messages == aiko.report.messages == []
    assert sorted(had) == ["aiko", "ken"]


@pytest.fixture
def console(workspace: Path) -> Iterator[Callable[[str, str], subprocess.Popen[str]]]:
    """Starts mains in processes of their own."""
    made: list[subprocess.Popen[str]] = []

    def begin(address: str, human: str) -> subprocess.Popen[str]:
        command = [sys.executable, "-m", "ahmss", "main", "--server", address, "--workspace", str(workspace)]
        made.append(subprocess.Popen([*command, "--human", human, "--body", "ken"], stdin=subprocess.PIPE, text=True))
        return made[-1]

    yield begin
    for one in made:
        one.kill()
        one.wait()
        assert one.stdin is not None
        one.stdin.close()


def test_who_is_killed_in_the_midst_of_two_actions_lets_go_and_disturbs_nobody(
    server: Start, join: Join, console: Callable[[str, str], subprocess.Popen[str]]
) -> None:
    one = server(lease_s=1.0)
    ken = join(one)
    ken.play(steps("add box as b at 0.3 0 1", "add box as c at 0.3 0.5 1", "add box as d at 0.3 -0.5 1"))
    doomed = [console(one.address, "aiko"), console(one.address, "mari")]
    for process, thing in zip(doomed, ("b", "c"), strict=True):
        assert process.stdin is not None
        process.stdin.write(f"do {thing} take frames 20\ndo {thing} shake frames 6000 with d wave frames 6000\n")
        process.stdin.flush()
    for step in steps("do d take frames 20", "do d shake frames 600"):
        ken.agenda.add(step)
    world = ken.communication.world
    until(lambda: (world.objects["b"].holder, world.objects["c"].holder) == ("aiko", "mari"), ken, seconds=60.0)
    for process in doomed:
        os.kill(process.pid, signal.SIGKILL)
    until(lambda: world.objects["b"].holder == world.objects["c"].holder == "", ken)
    assert world.objects["d"].holder == "ken"
    for step in steps("do b wave frames 5"):
        ken.agenda.add(step)
    until(lambda: ken.agenda.done, ken)
    assert ken.report.messages == []
    assert ken.control.holds == {"d": "right"}
    assert [process.wait() for process in doomed] == [-signal.SIGKILL] * 2
