"""Of a human who has left the world algorithms are told so, whether they stood or walked."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ahmss.main.people import People
from ahmss.main.process import MainProcess
from ahmss.world.process import ServerProcess


def test_who_left_is_told_once(server: Callable[..., ServerProcess], join: Callable[..., MainProcess]) -> None:
    here = server()
    ken, aiko = join(here), join(here, "aiko", body="aiko", place=(0.0, 1.0))
    people, world = People(), ken.communication.world
    while "aiko" not in world.humans or len(world.human_ids) < 2:
        ken.frame()
    number = world.humans["aiko"].id
    assert people.moved(world, "ken")[:, 0].tolist() == [-number]
    assert len(people.moved(world, "ken")) == 0
    aiko.communication.leave(stay=False)
    while number in world.human_ids:
        ken.frame()
    (row,) = people.moved(world, "ken")
    assert row[0] == -number
    assert np.isnan(row[1:]).all()
    assert np.isnan(people.ways(row[:1])).all()
    assert len(people.moved(world, "ken")) == 0
