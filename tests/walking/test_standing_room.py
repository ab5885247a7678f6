"""Room for the whole body where one comes to stand."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.skeleton import Skeleton
from ahmss.walking.goals import Goal
from ahmss.walking.pieces import Ground
from ahmss.walking.standing_room import Load, Room, with_room

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


BOX = Load(np.array([[0.15, -0.2], [0.15, 0.2], [0.5, -0.2], [0.5, 0.2]]), 0.8, 0.03)


def laden(place: tuple[float, float], facing: float | None, top: float = 1.3) -> Room | None:
    return with_room(HUMAN, Goal(np.array(place), facing), ground(top), BOX, body=False)


@pytest.mark.parametrize(
    ("place", "facing", "there"),
    [
        ((-0.3, 0.1), 0.0, (-0.53, 0.1)),  # back from it
        ((-0.3, 0.7), 0.0, (-0.3, 0.83)),  # past its corner
        ((-0.3, 0.1), np.pi, (-0.3, 0.1)),  # it is behind
    ],
)
def test_who_carries_something_stands_where_that_is_in_nothing(
    place: tuple[float, float], facing: float, there: tuple[float, float]
) -> None:
    room = laden(place, facing)
    assert room is not None
    np.testing.assert_allclose(room.place, there, atol=1e-3)
    over = laden(place, facing, top=0.7)
    assert over is not None
    np.testing.assert_array_equal(over.place, place)


def test_where_what_is_carried_has_room_only_where_the_body_has_none_there_is_none() -> None:
    behind = Ground([TABLE, TABLE - (1.45, 0.0)], ["table", "wall"], [1.3, 2.0])
    assert with_room(HUMAN, Goal(np.array([-0.25, 0.1]), 0.0), behind, BOX, body=False) is None
