"""The frame loop with a real server and real algorithm processes, in lockstep."""

from collections.abc import Callable

import numpy as np

from ahmss.body.links import INDEX
from ahmss.main.process import MainProcess
from ahmss.world.process import ServerProcess
from tests.main.ground import steps

Start = Callable[..., ServerProcess]
Join = Callable[..., MainProcess]
ARM = INDEX["right_upper_arm"]


def fast(server: Start, join: Join) -> MainProcess:
    return join(server(lockstep=["ken"]), fast=True, names=("ken",))


def test_a_motion_is_made_by_a_process_and_seen_in_the_world(server: Start, join: Join) -> None:
    main = fast(server, join)
    before = main.blending.rotations.copy()
    report = main.play(steps("add box as b at 1 0 1", "do b wave frames 30"))
    assert report.messages == []
    turned = 2.0 * np.arccos(abs(float(main.blending.rotations[ARM] @ before[ARM])))
    assert abs(turned - 0.6) < 1e-6
    others = [link for link in range(43) if link != ARM]
    assert np.abs(main.blending.rotations[others] - before[others]).max() < 1e-12
    main.communication.client.refresh()
    _, seen = main.communication.world.human("ken")
    assert np.abs(seen - main.blending.rotations).max() < 1e-6
