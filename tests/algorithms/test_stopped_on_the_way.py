"""Who is told to rest on the way to where they act comes to a stand, on both feet, and does not act."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from ahmss.algorithm import HumanPose, HumanTask
from ahmss.motion.smoothness import worst_pop
from ahmss.walking.journey import Standing, footing
from tests.walking import measures as m

from .layouts import Layout, used
from .scene import Body, program
from .test_panels import upright
from .test_sit import STAND, chair, does
from .test_sit import at as before
from .test_swing import BEFORE, at_the_door


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize("at", [60, 85, 110])
def test_who_is_stopped_on_the_way_to_a_button_stands_and_does_not_press_it(name: str, at: int) -> None:
    control, body, tasks = upright(1.2), Body(name, -1.0, 0.3, 0.0), list[HumanTask]()
    start = Layout((control,)).start(control, body, "press", parameters={})
    done = used(body, start, stopped("press", at, tasks))
    assert at < len(done.shown) < at + 150
    assert not tasks[0].progress.arrived
    last = done.shown[-1]
    assert off_its_stand(body, last) < 0.005
    assert last.root[0] < 1.3  # nowhere near the button
    assert worst_pop(np.array([pose.rotations for pose in done.shown])[at:]).degrees < 20.0


def stopped(algorithm: str, at: int, tasks: list[HumanTask]) -> Callable[[HumanTask], Iterator[Any]]:
    """An algorithm that is told to rest with such a frame, as main tells it; with the task that it is given."""

    def told(task: HumanTask) -> Iterator[Any]:
        tasks.append(task)
        for made in program(algorithm)(task):
            for row in [made[i : i + 1] for i in range(len(made))] if isinstance(made, np.ndarray) else [made]:
                task.progress.rests = task.progress.rests or task.present.k >= at
                yield row

    return told


def off_its_stand(body: Body, pose: HumanPose) -> float:
    """Metres by which a foot is ahead of where it is in standing, or behind."""
    standing = Standing.of(body.skeleton, m.library())
    now = footing(body.skeleton, pose.rotations, pose.root, standing)
    ahead = np.array([np.cos(now.heading), np.sin(now.heading)])
    return float(np.abs((now.ankles - now.place) @ ahead - standing.ankles[:, 0]).max())


@pytest.mark.parametrize("at", [40, 90])
def test_who_is_stopped_on_the_way_to_a_chair_stands(at: int) -> None:
    frame = chair(1)
    body, tasks = before("ken", frame, np.array([1.6, 0.8, 0.0]), 190.0), list[HumanTask]()
    shown = does(body, "sit", frame, told=stopped("sit", at, tasks))
    assert at < len(shown) < at + 160
    assert off_its_stand(body, shown[-1]) < 0.005


@pytest.mark.parametrize("at", [20, 60])
def test_who_is_stopped_before_the_seat_bears_them_rises_again_softly(at: int) -> None:
    frame = chair(1)
    body, tasks = before("aiko", frame, STAND), list[HumanTask]()
    begun = body.root.copy()
    shown = does(body, "sit", frame, told=stopped("sit", at, tasks))
    assert len(shown) < 3 * at + 30
    np.testing.assert_allclose(shown[-1].root, begun, atol=0.01)
    root = np.array([pose.root for pose in shown])
    assert np.abs(np.diff(root, 2, axis=0)).max() * 3600.0 < 8.0
    assert worst_pop(np.array([pose.rotations for pose in shown])).degrees < 5.0


def test_who_is_stopped_as_they_step_with_a_door_stands_at_the_end_of_the_step() -> None:
    body, start = at_the_door("ken", "open", BEFORE, 90.0)
    whole = body.do("swing", start)
    steps = [k for k, pose in enumerate(whole) if float(np.hypot(*(pose.root - whole[0].root)[:2])) > 0.1]
    at, tasks = steps[0], list[HumanTask]()
    body, start = at_the_door("ken", "open", BEFORE, 90.0)
    shown = body.do(stopped("swing", at, tasks), start)
    assert at < len(shown) < min(len(whole) - 30, at + 120)
    assert off_its_stand(body, shown[-1]) < 0.005
