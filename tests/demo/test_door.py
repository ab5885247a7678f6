"""The door's example, played: captured motions open and close it, from where they begin."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.inverse import RIGHT_HAND
from ahmss.body.quaternion import conjugate, multiply, to_rotation_vector
from ahmss.main.play import PlaySetup, play_script

from .conftest import DOOR, ROOT
from .recorded import Recorded

KNOB = np.array([0.68, -0.075, 1.02])  # in the door's frame


@pytest.fixture(scope="module")
def demo(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    path = tmp_path_factory.mktemp("door") / "door.rec"
    report = play_script(ROOT / "examples" / "door.txt", PlaySetup(workspace=str(ROOT), fast=True, record=path))
    assert report.failures == 0
    return Recorded.read(path, "ken", (DOOR,))


def door_angle(demo: Recorded) -> np.ndarray:
    """Degrees from where the door stands at first."""
    turned = demo.objects[DOOR][:, 3:]
    return np.degrees(to_rotation_vector(multiply(conjugate(turned[:1]), turned))[:, 2])


def test_the_door_is_opened_and_closed(demo: Recorded) -> None:
    angle = door_angle(demo)
    assert 25.0 < angle.max() < 50.0
    assert abs(angle[-1]) < 0.5
    assert np.abs(np.diff(angle, n=2)).max() < 0.2


def test_the_hand_is_on_the_knob_while_the_door_moves(demo: Recorded) -> None:
    door = demo.object(DOOR)
    grip = demo.grip(RIGHT_HAND)
    moving = np.flatnonzero(np.abs(np.diff(door_angle(demo))) > 0.01)
    knob = door.apply(np.broadcast_to(KNOB, door.place.shape))
    apart = door.inverse().apply(grip.place)[moving] - KNOB
    across = np.linalg.norm(apart[:, 1:], axis=1)  # the lever lies along the door's x
    assert len(moving) > 120
    assert across.max() < 0.030  # a palm's thickness and half a lever
    assert np.ptp(apart, axis=0).max() < 0.008
    assert np.linalg.norm(knob[moving] - grip.place[moving], axis=1).max() < 0.04


def test_the_door_stands_still_while_no_hand_holds_it(demo: Recorded) -> None:
    door = demo.object(DOOR)
    apart = np.linalg.norm(door.inverse().apply(demo.grip(RIGHT_HAND).place) - KNOB, axis=1)
    away = apart[1:] > 0.06
    assert np.abs(np.diff(door_angle(demo)))[away].max() < 1e-9
