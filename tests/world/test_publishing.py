"""How often the world goes out between ticks."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
import zmq

from ahmss.world.assets import Assets
from ahmss.world.publisher import Publisher
from ahmss.world.space import Space

TICK = 1.0 / 60.0


@pytest.fixture
def publisher() -> Iterator[Publisher]:
    with zmq.Context() as context, context.socket(zmq.PUB) as socket:
        yield Publisher(Space(Assets(None), 60.0), socket, print)


@pytest.mark.parametrize(("clients", "gap"), [(0, 0.0), (2, 0.001), (11, 0.0055), (1000, TICK)])
def test_the_more_are_told_the_less_often_but_at_each_tick(publisher: Publisher, clients: int, gap: float) -> None:
    publisher.publish(1, 5.0, TICK, clients)
    assert publisher.due(everybody=True) == float("inf")  # nothing new
    publisher.note(5.0)
    assert publisher.due(everybody=True) == pytest.approx(5.0 + gap, abs=1e-4)
    assert publisher.due(everybody=False) == pytest.approx(5.0 + max(gap, 0.001), abs=1e-4)
