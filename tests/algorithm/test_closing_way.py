"""A hand that turns on its way to a grip goes out round the corners of what it takes."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.quaternion import rotate
from ahmss.body.skeleton import Skeleton
from ahmss.grasping.distance import build
from ahmss.grasping.field import Field
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import opener
from ahmss.grasping.precision import precision
from ahmss.motion.fingers import opened
from ahmss.motion.steps import finished
from ahmss.skills.closing_way import THERE_BY, fingers_at, out_by, palms_at, there_by
from tests.grasping.shapes import box, frame

SITE = frame((0.0, 0.0, 0.07), (1, 0, 0), (0, -1, 0))
TIME = np.linspace(0.0, 1.0, 61)


def box_field() -> Field:
    """5 by 6 by 12 cm."""
    corners = (box(1.0) * np.array([0.05, 0.06, 1.0])).reshape(-1, 3)
    return build(corners, np.arange(len(corners)).reshape(-1, 3), corners.min(axis=0), corners.max(axis=0))


@pytest.fixture(scope="module", params=["right", "left"])
def way(request: pytest.FixtureRequest) -> tuple[Hand, Field, tuple[Array, Array], tuple[Array, Array, Array]]:
    """A hand before a box as its site is turned, the fingers down, which is to pinch it across."""
    hand, field = Hand.of(Skeleton.of(1.7), request.param), box_field()
    start = np.concatenate([[-0.07, 0.0, 0.07], SITE[3:]])
    holding = finished(precision(hand, field, start, SITE))
    assert holding is not None
    assert holding.holds
    fingers = opened(request.param), holding.shape, opener(hand, holding)
    return hand, field, (start, holding.palm), fingers


def depths(way: tuple[Hand, Field, tuple[Array, Array], tuple[Array, Array, Array]], out: float) -> float:
    hand, field, palms, fingers = way
    return hand.depth(field, palms_at(TIME, *palms, out), fingers_at(TIME, *fingers))


def test_it_goes_out_as_far_as_its_thumb_needs(
    way: tuple[Hand, Field, tuple[Array, Array], tuple[Array, Array, Array]],
) -> None:
    out = out_by(*way)
    assert 0.02 <= out <= 0.1
    assert depths(way, 0.0) > 0.005
    assert depths(way, out) < 0.002


def test_it_goes_straight_where_nothing_is_in_its_way(
    way: tuple[Hand, Field, tuple[Array, Array], tuple[Array, Array, Array]],
) -> None:
    hand, field, (_, palm), fingers = way
    back = palm.copy()
    back[:3] -= rotate(SITE[3:], np.array([0.06, 0.0, 0.0]))
    assert out_by(hand, field, (back, palm), (fingers[2], *fingers[1:])) == 0.0


def test_it_is_there_in_time_by_whatever_way() -> None:
    start, end = np.array([0.0, 0.1, 0.0, 1.0, 0.0, 0.0, 0.0]), np.array([0.3, 0.1, 0.2, 0.8, 0.0, 0.6, 0.0])
    palms = palms_at(np.array([0.0, 0.5 * THERE_BY, THERE_BY, 1.0]), start, end, 0.05)
    assert palms[[0, 2, 3]] == pytest.approx(np.array([start, end, end]))
    off = palms[1, :3] - 0.5 * (start + end)[:3]
    assert off == pytest.approx(-0.05 * rotate(palms[1, 3:], np.array([1.0, 0.0, 0.0])))


def test_fingers_open_before_they_close() -> None:
    turns = np.array([0.0, 1.0, -0.5])
    present, shape, wide = (np.tile([np.cos(a), 0.0, 0.0, np.sin(a)], (14, 1)) for a in turns)
    made = fingers_at(np.array([0.0, 0.5, 0.55, 1.0]), present, shape, wide)
    assert made == pytest.approx(np.array([present, wide, wide, shape]))
    direct = fingers_at(TIME, present, shape, None)
    assert (np.diff(direct[:, 0, 3]) >= 0.0).all()


def test_a_palm_that_turns_far_takes_all_of_the_time_and_turns_evenly() -> None:
    start, end = (np.array([0.0, 0.0, 0.0, np.cos(half), 0.0, 0.0, np.sin(half)]) for half in np.radians([0.0, 48.0]))
    by, frames = there_by(start, end, 30), np.arange(31) / 30.0
    assert by == 1.0
    assert there_by(start, end, 60) == THERE_BY
    turned = 2.0 * np.degrees(np.arctan2(*palms_at(frames, start, end, by=by)[:, [6, 3]].T))
    assert turned[[0, -1]] == pytest.approx([0.0, 96.0])
    assert 4.0 < np.diff(turned).max() < 5.0
    assert 0.3 < np.abs(np.diff(turned, n=2, prepend=0.0, append=96.0)).max() < 0.7  # at rest before and after


def test_fingers_open_and_close_later_where_the_palm_takes_all_of_the_time() -> None:
    present, shape, wide = (np.tile([np.cos(a), 0.0, 0.0, np.sin(a)], (14, 1)) for a in (0.0, 1.0, -0.5))
    made = fingers_at(np.array([0.0, 0.52, 0.58, 1.0]), present, shape, wide, 1.0)
    assert made[[0, 2, 3]] == pytest.approx(np.array([present, wide, shape]))
    assert -np.sin(0.5) + 1e-5 < made[1, 0, 3] < 0.0
