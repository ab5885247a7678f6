"""The door's example, played: out through the door, which is shut from outside, and in again."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, to_rotation_vector
from ahmss.main.play import PlaySetup, play_script

from .conftest import DOOR, ROOT
from .recorded import Recorded

LEVERS = np.array([[0.68, -0.075, 1.02], [0.68, 0.075, 1.02]])  # in the door's frame
WIDE, SHUT = np.radians(70.0), np.radians(3.0)


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    path = tmp_path_factory.mktemp("door") / "door.rec"
    report = play_script(ROOT / "examples" / "door.txt", PlaySetup(workspace=str(ROOT), fast=True, record=path))
    assert report.failures == 0
    return Recorded.read(path, "ken", (DOOR,))


@pytest.fixture(scope="module")
def angle(played: Recorded) -> Array:
    """Radians from where the door stands at first."""
    turned = played.objects[DOOR][:, 3:]
    return to_rotation_vector(multiply(conjugate(turned[:1]), turned))[:, 2]


def test_it_is_opened_wide_and_shut_twice(angle: Array) -> None:
    wide = angle > WIDE
    assert np.diff(wide.astype(int)).tolist().count(1) == 2
    assert np.diff((angle < SHUT).astype(int)).tolist().count(1) == 2
    assert abs(angle[-1]) < SHUT


def test_it_turns_softly(angle: Array) -> None:
    assert np.degrees(np.abs(np.diff(angle, n=2)).max()) < 0.15


def test_a_palm_is_on_a_lever_while_it_turns(played: Recorded, angle: Array) -> None:
    door = played.object(DOOR)
    palms = [door.inverse().apply(played.grip(side).place) for side in (0, 1)]
    apart = np.min([np.linalg.norm(palm - lever, axis=1) for palm in palms for lever in LEVERS], axis=0)[1:]
    turns = np.abs(np.diff(angle)) > 1e-4
    assert turns.sum() > 300
    assert apart[turns].max() < 0.03


def test_the_human_goes_out_and_in_while_it_is_wide(played: Recorded, angle: Array) -> None:
    y = played.root[:, 1] + 0.5
    middle = np.flatnonzero(np.abs(np.diff(np.sign(y))) > 0.0)
    assert y.min() < -1.0 < 1.0 < y.max()
    assert angle[middle].min() > np.radians(40.0)
