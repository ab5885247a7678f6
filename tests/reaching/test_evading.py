"""A hand goes aside for things: in time, softly, and no faster than its arm's joints turn."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.reaching.arm_on_way import fastest_of
from ahmss.reaching.comfort import palms_at
from ahmss.reaching.evading import Evading
from ahmss.reaching.prism import Prism
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.tracking import Tracking

HUMAN = Skeleton.of(1.7)
ROTATIONS, ROOT = HUMAN.relaxed()
SEAT = seat(HUMAN, ROTATIONS, ROOT)
HAND = np.zeros((1, 3)), np.array([0.02])  # a ball in the palm
# Hands are mirror images: the other one is seen to in the long tests.
MIRRORED = ["left", pytest.param("right", marks=pytest.mark.long)]


def stretched(side: str, ahead: float, up: float) -> tuple[Reacher, Array, Array]:
    """An arm (3, 4) whose palm (7,) is so far ahead of its shoulder and above it."""
    reacher = Reacher.of(HUMAN, side)
    shoulder = reacher.shoulder(SEAT)
    place = shoulder + np.array([ahead, 0.0, up])
    palm = np.append(place, palms_at(shoulder, place, reacher.sign)[40])
    tracking = Tracking(reacher, reacher.arm.from_pose(ROTATIONS[reacher.links]))
    for _ in range(120):
        had = tracking.step(palm, SEAT, 1.0)
    return reacher, tracking.links, had


def block(palm: Array, ahead: float, over: float) -> Prism:
    """One that begins so far ahead of a palm and whose top is so far over it."""
    x, y, z = (float(v) for v in palm[:3])
    ring = np.array([[x + ahead, y - 0.5], [x + 0.5, y - 0.5], [x + 0.5, y + 0.5], [x + ahead, y + 0.5]])
    return Prism(ring, 0.0, z + over)


@pytest.mark.parametrize("side", MIRRORED)
def test_a_straight_arm_is_bent_for_it_no_faster_than_a_joint_turns(side: str) -> None:
    """Drawn back out of a block by 5 mm a frame and more, an elbow that is nearly straight would bend by 15 degrees."""
    reacher, links, palm = stretched(side, 0.62, -0.05)
    assert np.linalg.norm(reacher.hand(palm)[0] - reacher.shoulder(SEAT)) > 0.99 * reacher.length
    near, end = [block(palm, -0.05, 0.3)], palm + np.array([-0.2, 0, 0, 0, 0, 0, 0])
    evading, made = Evading(reacher, links), [links]
    for _ in range(40):
        arm, had = evading.step(near, HAND, links, (palm, end), SEAT)
        made.append(arm)
    assert 4.0 < np.degrees(fastest_of(np.array(made))) < 6.71
    assert near[0].signed(had[:3]) > 0.02  # and it is out in the end
    np.testing.assert_allclose(reacher.palm(arm, SEAT)[:3], had[:3], atol=2e-3)


@pytest.mark.parametrize("side", MIRRORED)
def test_where_there_is_nothing_the_arm_stays_as_it_is(side: str) -> None:
    reacher, links, palm = stretched(side, 0.4, -0.1)
    evading = Evading(reacher, links)
    for near, hand in (([], None), ([block(palm, 0.2, 0.0)], HAND)):
        arm, had = evading.step(near, hand, links, (palm, palm), SEAT)
        np.testing.assert_allclose(arm, links, atol=1e-12)
        assert np.array_equal(had, palm)


@pytest.mark.parametrize("side", MIRRORED)
def test_a_hand_that_comes_down_is_seen_to_before_it_is_there(side: str) -> None:
    """At 20 mm a frame it is held back before the top: seen to only where it is, it would come within 2 mm of it."""
    reacher, links, palm = stretched(side, 0.4, -0.1)
    top = block(palm, -0.3, -0.14)
    evading, gaps = Evading(reacher, links), []
    for k in range(12):
        down = palm + np.array([0.0, 0.0, -0.02 * k, 0, 0, 0, 0])
        _, had = evading.step([top], HAND, links, (down, palm), SEAT)
        gaps.append(float(top.signed(had[:3])) - 0.02)
    assert min(gaps) > 0.03


@pytest.mark.parametrize("side", MIRRORED)
def test_it_comes_back_and_to_rest(side: str) -> None:
    reacher, links, palm = stretched(side, 0.4, -0.1)
    near, evading = [block(palm, -0.02, 0.3)], Evading(reacher, links)
    end = palm + np.array([-0.2, 0, 0, 0, 0, 0, 0])
    way = []
    for k in range(80):
        evading.step(near if k < 40 else [], HAND if k < 40 else None, links, (palm, end), SEAT)
        way.append(evading.aside)
    assert way[39][0] < -0.05
    np.testing.assert_allclose(way[-1], 0.0, atol=1e-4)
    assert np.max(way, axis=0)[0] < 0.001  # without going past where it was
    assert np.linalg.norm(np.diff(way, n=2, axis=0), axis=-1).max() < 0.0051
