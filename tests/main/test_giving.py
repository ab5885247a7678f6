"""What a human has is taken out of its hand by nobody but its own main, and then it lets go at once."""

from __future__ import annotations

import time
from collections.abc import Callable

import pytest

from ahmss.main.process import MainProcess
from ahmss.world.process import ServerProcess
from tests.main.ground import steps

Start = Callable[..., ServerProcess]
Join = Callable[..., MainProcess]


def go_on(main: MainProcess, done: Callable[[], bool]) -> None:
    """Frames until it is so."""
    end = time.monotonic() + 20.0
    while not done():
        assert time.monotonic() < end, main.report.messages
        main.frame()
        time.sleep(0.005)


@pytest.mark.parametrize(
    ("doing", "said"), [((), "aiko has b now"), (("do b shake frames 600",), "b shake: aiko has b now")]
)
def test_what_was_given_away_is_dropped_at_once_and_said_in_one_line(
    server: Start, join: Join, doing: tuple[str, ...], said: str
) -> None:
    one = server(lease_s=60.0)  # aiko is not heard of meanwhile
    ken, aiko = join(one), join(one, "aiko", place=(1.0, 0.0))
    ken.play(steps("add box as b at 0.3 0 1", "do b take frames 20"))
    for step in steps(*doing):
        ken.agenda.add(step)
    go_on(ken, lambda: ken.control.busy == bool(doing))
    assert ken.control.holds == {"b": "right"}
    ken.communication.client.transfer("b", "ken", "aiko", "left")
    go_on(ken, lambda: not ken.control.holds)
    assert not ken.control.busy
    go_on(ken, lambda: ken.agenda.done)
    assert ken.report.messages == [said]
    assert aiko.communication.client.refresh().objects["b"].holder == "aiko"
    ken.play(steps("do b take patience=0 frames 20"))
    assert "b is held by aiko" in ken.report.messages[-1]
