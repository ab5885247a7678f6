"""Who is told to rest on the way to a control comes to a stand, on both feet, and does not act."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from ahmss.algorithm import HumanTask
from ahmss.motion.smoothness import worst_pop
from ahmss.walking.journey import Standing, footing
from tests.walking import measures as m

from .layouts import Layout, used
from .scene import Body, program
from .test_panels import upright


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize("at", [60, 85, 110])
def test_who_is_stopped_on_the_way_to_a_button_stands_and_does_not_press_it(name: str, at: int) -> None:
    control, body, tasks = upright(1.2), Body(name, -1.0, 0.3, 0.0), list[HumanTask]()
    start = Layout((control,)).start(control, body, "press", parameters={})

    def told(task: HumanTask) -> Iterator[Any]:
        tasks.append(task)
        for rows in program("press")(task):
            for i in range(len(rows)):
                task.progress.rests = task.progress.rests or task.present.k >= at
                yield rows[i : i + 1]

    done = used(body, start, told)
    assert at < len(done.shown) < at + 150
    assert not tasks[0].progress.arrived
    last = done.shown[-1]
    standing = Standing.of(body.skeleton, m.library())
    now = footing(body.skeleton, last.rotations, last.root, standing)
    ahead = np.array([np.cos(now.heading), np.sin(now.heading)])
    assert np.abs((now.ankles - now.place) @ ahead - standing.ankles[:, 0]).max() < 0.005
    assert last.root[0] < 1.3  # nowhere near the button
    assert worst_pop(np.array([pose.rotations for pose in done.shown])[at:]).degrees < 20.0
