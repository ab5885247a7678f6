"""Room for the whole body where one comes to stand."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.skeleton import Skeleton
from ahmss.walking.goals import Goal
from ahmss.walking.pieces import Ground
from ahmss.walking.standing_room import with_room

HUMAN = Skeleton.of(1.76)
TABLE = np.array([[0.0, -0.6], [1.0, -0.6], [1.0, 0.6], [0.0, 0.6]])


def ground(top: float = 0.88) -> Ground:
    return Ground([TABLE], ["table"], [top])


@pytest.mark.parametrize("facing", [0.0, np.pi, None])
def test_who_has_room_stands_where_they_are_told(facing: float | None) -> None:
    place = np.array([-0.2 if facing is None else -0.13, 0.1])
    room = with_room(HUMAN, Goal(place, facing), ground())
    assert room is not None
    assert room.beside == ""
    np.testing.assert_array_equal(room.place, place)


@pytest.mark.parametrize("facing", [np.pi / 2, None])
def test_who_would_have_a_hip_in_a_table_stands_farther_off(facing: float | None) -> None:
    room = with_room(HUMAN, Goal(np.array([-0.13, 0.1]), facing), ground())
    assert room is not None
    assert room.beside == "table"
    assert -0.22 < room.place[0] < -0.185
    assert abs(room.place[1] - 0.1) < 1e-9


def test_shoulders_are_broader_where_a_thing_is_high() -> None:
    room = with_room(HUMAN, Goal(np.array([-0.2, 0.1]), np.pi / 2), ground(1.8))
    assert room is not None
    assert room.place[0] < -0.24


def test_there_is_none_in_a_thing_nor_between_two() -> None:
    assert with_room(HUMAN, Goal(np.array([0.3, 0.0]), 0.0), ground()) is None
    narrow = Ground([TABLE, TABLE - (1.3, 0.0)], ["table", "wall"], [0.88, 2.0])
    assert with_room(HUMAN, Goal(np.array([-0.13, 0.0]), np.pi / 2), narrow) is None
