"""An elbow that never jumps: where its joints do not allow that, they give way."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.arm import excess, hand_angles, links_of, wrist_of
from ahmss.body.arm_path import STEP, follow
from ahmss.body.arm_yielding import yielding
from ahmss.body.quaternion import from_axis_angle, multiply

from .test_arm import KEN, random_links, same
from .test_arm_path import angle, path, steps

GRACE = np.radians(4.5)


@pytest.fixture(scope="module")
def jumping():
    """Paths of 120 frames along which limits that are kept make the elbow jump: one pose before, wrists, both ways."""
    links = random_links(np.random.default_rng(1), KEN, 400)
    found = []
    half = len(links) // 2
    for before, after in zip(links[:half], links[half : 2 * half], strict=True):
        wrist = path(before, after, 120)
        strict = follow(KEN, wrist, before)
        if strict.jumps.any():
            found.append((before, wrist, strict, yielding(KEN, wrist, before, GRACE)))
    assert len(found) > 8
    return found


def test_the_elbow_does_not_jump(jumping):
    for before, _, strict, way in jumping:
        assert steps(way, before)[:, 0].max() < np.radians(10.0)
        assert steps(strict, before).max() > steps(way, before).max()
    assert np.mean([way.jumps.any() for _, _, _, way in jumping]) < 0.2


def test_the_wrist_keeps_its_place_and_ends_as_it_was_asked_for(jumping):
    for _, wrist, _, way in jumping:
        got, met = wrist_of(KEN, way.links), np.abs(way.missing) < 1e-12
        assert np.abs(got.place - wrist.place)[met].max() < 1e-9
        assert same(got.rotation[-1], wrist.rotation[-1])
        assert excess(KEN, way.links)[-1] < 1e-7


def test_shoulders_give_little_and_hands_nothing(jumping):
    beyond = np.array([way.beyond.max() for _, _, _, way in jumping])
    assert np.median(beyond) < np.radians(5.0)
    low, high = KEN.limits[2, 1:].T
    for _, _, _, way in jumping:
        bent = hand_angles(way.links)[:, 1:]
        assert (bent > low - 1e-6).all()
        assert (bent < high + 1e-6).all()


def test_an_arm_that_begins_beyond_a_limit_comes_back_without_a_leap():
    """A forearm turned 30 degrees too far, the hand asked to stay: for either way, none of its joints leaps."""
    inside = links_of(np.array([0.4, 0.6, -0.5, 1.2, 0.0, 0.1, 0.2]))
    high = float(KEN.limits[1, 0, 1])
    twist = float(hand_angles(inside)[0])
    before = inside.copy()
    before[1] = multiply(
        inside[1], from_axis_angle(np.array([1.0, 0.0, 0.0]), np.array(high - twist + np.radians(30.0)))
    )
    assert excess(KEN, before) == pytest.approx(np.radians(30.0), abs=1e-6)
    wrist = path(before, inside, 60)
    for way in (follow(KEN, wrist, before), yielding(KEN, wrist, before, GRACE)):
        assert not way.jumps.any()
        assert steps(way, before).max() < 2.0 * STEP
        assert excess(KEN, way.links)[-1] < 1e-7
        assert angle(way.links[-1, 0], inside[0]).max() < np.radians(90.0)
        assert same(wrist_of(KEN, way.links).rotation[-1], wrist.rotation[-1])


def test_an_elbow_begins_softly_where_that_is_asked(jumping):
    """Joints that turn much from the first frame on turn less in it, and everything else is held as before."""
    hard = soft = 0
    for before, wrist, _, way in jumping:
        eased = yielding(KEN, wrist, before, GRACE, 10)
        first, then = (float(steps(one, before)[0, 0]) for one in (way, eased))
        hard, soft = hard + first, soft + then
        assert steps(eased, before)[:, 0].max() < np.radians(10.0)
        assert same(wrist_of(KEN, eased.links).rotation[-1], wrist.rotation[-1])
    assert soft < 0.5 * hard


@pytest.mark.parametrize("which", [9, 33, 50])
def test_an_elbow_begins_softly_that_has_far_to_go_to_where_the_last_frame_allows_it(which: int) -> None:
    links = random_links(np.random.default_rng(2), KEN, 400)
    before, wrist = links[which], path(links[which], links[200 + which], 120)
    assert steps(yielding(KEN, wrist, before, GRACE), before)[0, 0] > np.radians(0.7)
    assert steps(yielding(KEN, wrist, before, GRACE, 10), before)[0, 0] < np.radians(0.2)
