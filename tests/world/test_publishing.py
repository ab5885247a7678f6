"""How often the world goes out between ticks."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import zmq
from ground import eventually

from ahmss.world.address import Address
from ahmss.world.assets import Assets
from ahmss.world.publisher import Publisher
from ahmss.world.sockets import Sockets
from ahmss.world.space import Space

TICK = 1.0 / 60.0


@pytest.fixture
def publisher() -> Iterator[Publisher]:
    with zmq.Context() as context, context.socket(zmq.PUB) as socket:
        yield Publisher(Space(Assets(None), 60.0), socket, print)


@pytest.mark.parametrize(("listeners", "gap"), [(0, 0.0), (2, 0.0016), (11, 0.0088), (1000, TICK)])
def test_the_more_are_told_the_less_often_but_at_each_tick(publisher: Publisher, listeners: int, gap: float) -> None:
    publisher.publish(1, 5.0, TICK, listeners)
    assert publisher.due(everybody=True) == float("inf")  # nothing new
    publisher.note(5.0)
    assert publisher.due(everybody=True) == pytest.approx(5.0 + gap, abs=1e-4)
    assert publisher.due(everybody=False) == pytest.approx(5.0 + max(gap, 0.001), abs=1e-4)


def test_it_is_known_how_many_are_told() -> None:
    sockets = Sockets(Address("127.0.0.1", 0), None)
    try:
        with zmq.Context() as context:
            assert sockets.listeners() == 0
            own = [context.socket(zmq.SUB) for _ in range(3)]
            for socket in own:
                socket.connect(sockets.address.endpoint(sockets.snapshots))
            eventually(lambda: sockets.listeners() == 3)
            own.pop().close(0)
            eventually(lambda: sockets.listeners() == 2)
            for socket in own:
                socket.close(0)
            eventually(lambda: sockets.listeners() == 0)
    finally:
        sockets.close()
