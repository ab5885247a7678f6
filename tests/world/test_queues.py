"""Who waits for what another has is served in the order in which they came, and only as long as they wait."""

from __future__ import annotations

from ahmss.world.queues import Queues


def test_who_came_first_is_first_until_they_leave() -> None:
    queues = Queues()
    assert queues.first("b") == ""
    for human in ("ken", "aiko", "ken"):
        queues.wait("b", human)
    queues.wait("c", "aiko")
    assert (queues.first("b"), queues.first("c")) == ("ken", "aiko")
    queues.leave("ken", "b")
    assert queues.first("b") == "aiko"
    queues.leave("aiko")
    assert (queues.first("b"), queues.first("c")) == ("", "")


def test_who_says_so_no_more_is_waited_for_no_more() -> None:
    queues = Queues()
    for human in ("ken", "aiko"):
        queues.wait("b", human)
    for _ in range(100):
        queues.step(1.0 / 60.0)
    queues.wait("b", "aiko")
    assert queues.first("b") == "aiko"
    for _ in range(80):
        queues.step(1.0 / 60.0)
    assert queues.first("b") == "aiko"
    for _ in range(20):
        queues.step(1.0 / 60.0)
    assert queues.first("b") == ""
