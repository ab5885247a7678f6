"""Boxes that many points are near: the same distances all at once as of each box and each point by itself."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.algorithm.place import Transform, WorldObject
from ahmss.body.array import Array
from ahmss.body.quaternion import normalize
from ahmss.skills.box import Box, filled, nearest

FAR = 0.2


def boxes_about(seed: int, turns: int) -> list[Box]:
    """Twelve boxes in a cube of 0.6 m, turned in so many ways."""
    random = np.random.default_rng(seed)
    rotations = normalize(random.normal(size=(turns, 4)))
    made: list[Box] = []
    for number in range(12):
        size = random.uniform(0.02, 0.1, 3)
        frame = Transform(random.uniform(-0.3, 0.3, 3), rotations[number % turns])
        made.append(Box(frame, -0.2 * size, 0.8 * size))
    return made


def hands(seed: int, n: int = 200) -> Array:
    """Points (n, 20, 3), those of one within 12 cm of each other, in and about the cube."""
    random = np.random.default_rng(seed)
    return random.uniform(-0.6, 0.6, (n, 1, 3)) + random.uniform(-0.06, 0.06, (n, 20, 3))


@pytest.mark.parametrize("turns", [1, 3, 12])
def test_the_nearest_of_many_boxes_is_as_near_as_each_says(turns: int) -> None:
    boxes, points = boxes_about(turns, turns), hands(turns)
    each = np.min([box.gap(points).min(axis=1) for box in boxes], axis=0)
    found = nearest(boxes, points, FAR)
    np.testing.assert_allclose(found, np.minimum(each, FAR), atol=1e-12)
    assert (found < 0.0).any()
    assert ((found > 0.0) & (found < FAR)).any()
    assert (found == FAR).any()


def test_without_boxes_all_is_far() -> None:
    np.testing.assert_array_equal(nearest([], hands(0, n=3), FAR), np.full(3, FAR))


def test_what_a_thing_fills_is_worked_out_once_while_it_stays_where_it_is() -> None:
    block = {"box": [[0.0, 0.0, 0.0], [1.0, 0.5, 0.2]]}
    thing = WorldObject(1, "shelf", "shelf", np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]), properties=block)
    first = filled(thing)
    first.clear()  # what is done with the list does not come back
    (before,), (again,), (sought,) = filled(thing), filled(thing), filled(thing, sought=True)
    assert before is again
    assert sought.sought
    assert not before.sought
    thing.place[2] = 0.3
    (moved,) = filled(thing)
    assert (moved.low, moved.high) == pytest.approx((0.3, 0.5))
