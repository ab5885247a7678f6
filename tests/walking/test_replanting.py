"""Fitted clips whose feet stand again: no part that bears moves, and the end poses are what they were fitted to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ahmss.body.inverse import solve
from ahmss.body.links import INDEX
from ahmss.body.quaternion import align, from_rotation_vector, multiply, rotate
from ahmss.motion.contact import foot_points, runs
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.planting import feet
from ahmss.walking.build import cut_out
from ahmss.walking.catalogue import STRAIGHT, Key
from ahmss.walking.fitting import Pose, close_onto_mirror, fit_ends, wanted_ends
from ahmss.walking.library import BODY, WalkClip
from ahmss.walking.mirroring import mirror
from ahmss.walking.replanting import closed, replanted, touching, whole
from tests.walking.performed import HUMAN, STANDING, performance

KEYS = [
    Key("start", 0), Key("start", 90), Key("start", 180), Key("end", 0, 0, "normal", "left"),
    Key("end", 0, 90, "small", "right"), Key("one_step", 90, -60), Key("two_step", 30, 60),
]  # fmt: skip


def raw(key: Key) -> WalkClip:
    return cut_out(*performance(key), key)


def points(clip: WalkClip):
    return foot_points(HUMAN, whole(HUMAN, clip.rotations), clip.root)


def drift(clip: WalkClip) -> float:
    """How far a part of a foot that bears gets from where it was set down, metres."""
    places = points(clip)
    return max(
        float(np.linalg.norm(places[a:b, foot, part, :2] - places[a, foot, part, :2], axis=-1).max())
        for foot in range(2) for part in range(3) for a, b in runs(clip.bearing[:, foot, part])
    )  # fmt: skip


def same(p, q) -> float:
    return float(np.abs(align(p, q) - q).max())


def with_feet(rotations, root, out: tuple[float, float], degrees: tuple[float, float], about=None):
    """Poses whose right and left foot stand farther out, metres, and turned to the left about the ankle or a place."""
    frames = feet(HUMAN, rotations, root)
    targets = np.zeros((*root.shape[:-1], 5, 8))
    for foot, (row, sign) in enumerate(((2, -1.0), (3, 1.0))):
        turn = from_rotation_vector(np.radians([0.0, 0.0, degrees[foot]]))
        centre = frames[..., foot, :3] if about is None else about[foot]
        ankles = centre + rotate(turn, frames[..., foot, :3] - centre)
        targets[..., row, :3] = ankles + np.array([0.0, sign * out[foot], 0.0])
        targets[..., row, 3:7], targets[..., row, 7] = multiply(turn, frames[..., foot, 3:]), 1.0
    lower = root - np.array([0.0, 0.0, 0.01])
    return solve(HUMAN, whole(HUMAN, rotations), lower, targets)[..., :BODY, :], lower


def wanted(key: Key) -> tuple[Pose, Pose]:
    """What a clip must join: a straight step and a standing pose that are not quite the performer's."""
    straight = close_onto_mirror(raw(STRAIGHT))
    turns = np.random.default_rng(4).normal(0.0, 0.05, (BODY, 3))
    turns[[0, *range(6, 9), *range(12, 15)]] = 0.0
    poses = [(straight.rotations, straight.root), (STANDING.rotations[None], STANDING.root[None])]
    poses = [with_feet(multiply(q, from_rotation_vector(turns)), p, (0.02, 0.01), (4.0, -6.0)) for q, p in poses]
    straight = replace(straight, rotations=poses[0][0], root=poses[0][1])
    return wanted_ends(key, straight, Pose(poses[1][0][0], poses[1][1][0]))


@pytest.mark.parametrize("key", KEYS, ids=lambda key: key.name)
def test_feet_stand_again_and_the_ends_stay(key):
    own = raw(key)
    first, last = wanted(key)
    fitted = fit_ends(own, first, last)
    assert drift(fitted) > 0.005
    planted = replanted(HUMAN, own, fitted)
    assert drift(planted) < 0.001
    assert points(planted)[1:-1, ..., 2].min() > -0.002
    assert same(planted.rotations[0], first.rotations) < 1e-9
    assert same(planted.rotations[-1], last.rotations) < 1e-9
    np.testing.assert_allclose(planted.root[[0, -1]], fitted.root[[0, -1]], atol=1e-12)
    upper = [INDEX[name] for name in ("hips", "spine", "head", "right_upper_arm", "left_lower_arm")]
    assert same(planted.rotations[:, upper], fitted.rotations[:, upper]) < 1e-9
    steps = np.abs(align(planted.rotations[1:], planted.rotations[:-1]) - planted.rotations[:-1])
    assert steps.max() < 0.12  # nothing jumps, the first and the last frame neither


def test_what_fits_already_stays():
    own = raw(Key("start", 60))
    planted = replanted(HUMAN, own, own)
    assert np.abs(points(planted) - points(own)).max() < 0.002
    assert drift(planted) < 2e-4


def test_a_stance_in_the_middle_is_moved_as_a_whole():
    """In two steps the foot that leads stands once in between, where neither end pose says how."""
    own = raw(Key("two_step", 0, 0))
    last = Pose(STANDING.rotations, own.root[-1] + np.array([0.0, 0.06, 0.0]))
    planted = replanted(HUMAN, own, fit_ends(own, None, last))
    stances = [
        (foot, a, b) for foot in range(2) for a, b in runs(own.bearing[:, foot].any(axis=-1)) if a and b < len(own.root)
    ]
    assert len(stances) == 1
    foot, a, b = stances[0]
    moved = (points(planted) - points(own))[a:b, foot, :, 1]
    assert np.ptp(moved) < 0.002
    assert 0.005 < moved.mean() < 0.055


def heading(frame) -> float:
    ahead = rotate(frame[3:], np.array([1.0, 0.0, 0.0]))
    return float(np.degrees(np.arctan2(ahead[1], ahead[0])))


def test_a_foot_that_stands_in_both_end_poses_slides_rather_than_jumps():
    """A limping step closed without its footprints made even: the right foot can't be in both places."""
    own = raw(STRAIGHT)
    rotations, root = with_feet(own.rotations, own.root, (0.03, 0.0), (0.0, 0.0))
    own = replace(own, rotations=rotations, root=root)
    planted = replanted(HUMAN, own, close_onto_mirror(own))
    way = np.diff(points(planted)[:, 0, :, 1], axis=0)
    assert abs(points(planted)[-1, 0, 1, 1] - points(planted)[0, 0, 1, 1]) > 0.02
    assert np.abs(way).max() < 0.01


def test_a_straight_step_is_closed_with_its_footprints():
    own = raw(STRAIGHT)
    ankles = feet(HUMAN, own.rotations, own.root)[..., :3]
    swing = minimum_jerk(np.linspace(-0.3, 1.1, len(own.root)))[:, None]  # the left foot stands before and after it
    left = ankles[0, 1] + swing * (ankles[-1, 1] - ankles[0, 1])
    about = (ankles[10, 0], left)
    rotations, root = with_feet(own.rotations, own.root, (0.01, 0.03), (3.0, -8.0), about)
    moved = root + np.array([0.0, 0.04, 0.0])  # as a whole, to the left of the line
    cut = replace(own, rotations=rotations, root=moved)
    assert drift(cut) < 0.001
    step = closed(HUMAN, cut)
    expected, place = mirror(step.rotations[0], step.root[0])
    assert same(step.rotations[-1], expected) < 1e-9
    np.testing.assert_allclose(step.root[-1, 1:], place[1:], atol=1e-9)
    assert step.root[0, 0] == pytest.approx(0.0, abs=1e-12)
    assert drift(step) < 0.001
    # As wide and as turned out as the cut, half of it to each side, and the hips where they were over the feet.
    before, after = feet(HUMAN, cut.rotations, cut.root), feet(HUMAN, step.rotations, step.root)
    for k in (12, 20):  # the right foot lies flat
        wide = 0.5 * (before[0, 1, 1] + before[-1, 1, 1]) - before[k, 0, 1]
        assert -2.0 * after[k, 0, 1] == pytest.approx(wide, abs=0.004)
        turned_out = 0.5 * (heading(before[0, 1]) + heading(before[-1, 1]) - 2.0 * heading(before[k, 0]))
        assert -2.0 * heading(after[k, 0]) == pytest.approx(turned_out, abs=0.6)
    assert np.ptp(step.root[:, 1] - cut.root[:, 1]) < 0.02
    middle = 0.25 * (before[0, 1, 1] + before[-1, 1, 1] + 2.0 * before[12, 0, 1])
    assert step.root[18, 1] == pytest.approx(cut.root[18, 1] - middle, abs=0.012)
    # It goes on as its own mirror image: the foot that landed last is where its mirror image landed first.
    places = points(step)
    ahead = np.array([step.root[-1, 0] - step.root[0, 0], 0.0, 0.0])
    np.testing.assert_allclose(places[-1, 1], places[0, 0] * [1.0, -1.0, 1.0] + ahead, atol=1e-6)
    np.testing.assert_allclose(places[-1, 0], places[0, 1] * [1.0, -1.0, 1.0] + ahead, atol=1e-6)


def test_what_bears_is_on_the_ground_and_at_rest():
    own = raw(Key("start", 0))
    stands = own.bearing.any(axis=-1)
    bears = touching(HUMAN, own.rotations, own.root, stands)
    np.testing.assert_array_equal(bears.any(axis=-1), stands)
    heights = points(own)[..., 2]
    assert heights[bears].max() < 0.0041
    assert (bears & own.bearing).sum() > 0.9 * own.bearing.sum()
