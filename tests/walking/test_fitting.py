"""Fitted clips begin and end as they must, and are corrected by the rotations of A.1 to A.7 on the right side."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ahmss.body import skeleton
from ahmss.body.quaternion import align, from_rotation_vector, multiply
from ahmss.body.skeleton import Skeleton
from ahmss.walking.catalogue import STRAIGHT, Key
from ahmss.walking.fitting import (
    STILL,
    Pose,
    Speeds,
    close_onto_mirror,
    close_speeds,
    fit_ends,
    fit_speeds,
    turned,
    wanted_ends,
    wanted_speeds,
)
from ahmss.walking.library import BODY, WalkClip
from ahmss.walking.mirroring import mirror, mirrored

N = 24
EXACT = 1e-12


def clip_of(key: Key = STRAIGHT, seed: int = 0) -> WalkClip:
    """A motion in which every joint turns, by much, about changing axes, with signs that change from frame to frame."""
    rng = np.random.default_rng(seed)
    upright = Skeleton.of(1.7, "female").upright()[0][:BODY]
    share = np.linspace(0.0, 1.0, N + 1)[:, None, None]
    turns = from_rotation_vector(rng.normal(0.0, 0.5, (1, BODY, 3)) + share**2 * rng.normal(0.0, 0.5, (1, BODY, 3)))
    rotations = multiply(upright, turns)
    rotations[1::2] *= -1.0
    root = np.array([0.0, 0.03, 0.9]) + share[:, 0] * np.array([0.7, -0.02, 0.04]) + rng.normal(0, 0.01, (N + 1, 3))
    bearing = rng.random((N + 1, 2, 3)) > 0.5
    return WalkClip(key, rotations, root, bearing, "made here")


def smooth_clip(key: Key, seed: int) -> WalkClip:
    """The same without what changes from frame to frame at random."""
    clip = clip_of(key, seed)
    rotations = clip.rotations.copy()
    rotations[1::2] *= -1.0
    x = np.linspace(0.0, 1.0, N + 1)[:, None]
    return replace(clip, rotations=rotations, root=np.array([0.0, 0.03, 0.9]) + x * [0.7, 0.02, 0.0] + 0.02 * x**2)


def pose_of(seed: int) -> Pose:
    clip = clip_of(seed=seed)
    return Pose(clip.rotations[5], clip.root[5] + np.array([0.2, 0.1, -0.05]))


def same(p, q) -> float:
    """By how much rotations differ, whatever their signs."""
    return float(np.abs(align(p, q) - q).max())


def matrices(q) -> np.ndarray:
    return Rotation.from_quat(q, scalar_first=True).as_matrix()


def test_a_straight_step_ends_as_the_mirror_image_of_its_beginning():  # (A.3)
    clip = clip_of()
    closed = close_onto_mirror(clip)
    expected, place = mirror(clip.rotations[0], clip.root[0])
    assert same(closed.rotations[-1], expected) < EXACT
    np.testing.assert_allclose(closed.root[-1, 1:], place[1:], atol=EXACT)
    assert same(closed.rotations[0], clip.rotations[0]) < EXACT
    np.testing.assert_allclose(closed.root[0], clip.root[0], atol=EXACT)
    np.testing.assert_array_equal(closed.root[:, 0], clip.root[:, 0])  # the step is as long as it was
    np.testing.assert_array_equal(closed.bearing, clip.bearing)


def test_each_frame_of_a_straight_step_is_turned_by_its_share():  # (A.1), (A.2)
    clip = clip_of()
    closed = close_onto_mirror(clip)
    last, wanted = matrices(clip.rotations[-1]), matrices(mirror(clip.rotations[0], clip.root[0])[0])
    change = Rotation.from_matrix(np.swapaxes(last, -1, -2) @ wanted).as_rotvec()
    assert np.linalg.norm(change, axis=-1).min() > 0.05
    for x in (1, 7, 12, 23):
        expected = matrices(clip.rotations[x]) @ Rotation.from_rotvec(change * x / N).as_matrix()
        np.testing.assert_allclose(matrices(closed.rotations[x]), expected, atol=1e-9)
        across, up = -clip.root[0, 1] - clip.root[-1, 1], clip.root[0, 2] - clip.root[-1, 2]
        np.testing.assert_allclose(closed.root[x] - clip.root[x], [0.0, across * x / N, up * x / N], atol=EXACT)


def test_what_is_closed_already_stays():
    closed = close_onto_mirror(clip_of())
    again = close_onto_mirror(closed)
    assert same(again.rotations, closed.rotations) < EXACT
    np.testing.assert_allclose(again.root, closed.root, atol=EXACT)


@pytest.mark.parametrize(("d1", "d2"), [(1, 1), (2, 3), (5, 2)])
def test_a_clip_begins_and_ends_as_it_is_told(d1, d2):  # (A.4), (A.5)
    clip, first, last = clip_of(Key("start", 0)), pose_of(1), pose_of(2)
    fitted = fit_ends(clip, first, last, d1, d2)
    assert same(fitted.rotations[0], first.rotations) < EXACT
    assert same(fitted.rotations[-1], last.rotations) < EXACT
    np.testing.assert_allclose(fitted.root[0, 1:], first.root[1:], atol=EXACT)
    np.testing.assert_allclose(fitted.root[-1, 1:], last.root[1:], atol=EXACT)
    np.testing.assert_array_equal(fitted.root[:, 0], clip.root[:, 0])


def test_between_the_ends_both_corrections_add_up():  # (A.6), (A.7)
    clip, first, last = clip_of(Key("start", 0)), pose_of(1), pose_of(2)
    fitted = fit_ends(clip, first, last, 2, 3)
    own, wanted_first, wanted_last = matrices(clip.rotations), matrices(first.rotations), matrices(last.rotations)
    change_first = Rotation.from_matrix(np.swapaxes(own[0], -1, -2) @ wanted_first).as_rotvec()
    change_last = Rotation.from_matrix(np.swapaxes(own[-1], -1, -2) @ wanted_last).as_rotvec()
    for x in (1, 6, 12, 20):
        fading, growing = ((N - x) / N) ** 2, (x / N) ** 3
        turn = Rotation.from_rotvec(change_first * fading + change_last * growing).as_matrix()
        np.testing.assert_allclose(matrices(fitted.rotations[x]), own[x] @ turn, atol=1e-9)
        moved = fading * (first.root - clip.root[0]) + growing * (last.root - clip.root[-1])
        np.testing.assert_allclose(fitted.root[x] - clip.root[x], moved * [0.0, 1.0, 1.0], atol=EXACT)


def test_the_way_of_a_start_to_the_side_is_left_as_long_as_it_is():
    clip, last = clip_of(Key("start", 30)), pose_of(2)
    fitted = fit_ends(clip, None, last)
    way, across = np.array([np.sqrt(0.75), 0.5]), np.array([-0.5, np.sqrt(0.75)])
    np.testing.assert_allclose(fitted.root[:, :2] @ way, clip.root[:, :2] @ way, atol=EXACT)
    np.testing.assert_allclose(fitted.root[-1, :2] @ across, last.root[:2] @ across, atol=EXACT)
    np.testing.assert_allclose(fitted.root[-1, 2], last.root[2], atol=EXACT)


def test_a_pose_is_turned_to_the_left_as_a_whole():
    pose = pose_of(3)
    left = turned(pose, 90.0)
    np.testing.assert_allclose(left.root, [-pose.root[1], pose.root[0], pose.root[2]], atol=EXACT)
    quarter = Rotation.from_euler("z", 90.0, degrees=True).as_matrix()
    np.testing.assert_allclose(matrices(left.rotations[0]), quarter @ matrices(pose.rotations[0]), atol=EXACT)
    np.testing.assert_array_equal(left.rotations[1:], pose.rotations[1:])


def test_an_end_that_is_left_stays():
    clip, pose = clip_of(Key("end")), pose_of(1)
    begun, ended = fit_ends(clip, pose, None), fit_ends(clip, None, pose)
    assert same(begun.rotations[-1], clip.rotations[-1]) < EXACT
    assert same(ended.rotations[0], clip.rotations[0]) < EXACT
    assert same(begun.rotations[0], pose.rotations) < EXACT
    assert same(ended.rotations[-1], pose.rotations) < EXACT
    untouched = fit_ends(clip, None, None)
    assert same(untouched.rotations, clip.rotations) < EXACT
    np.testing.assert_array_equal(untouched.root, clip.root)


def test_the_middle_is_left_alone_as_the_exponents_grow():
    clip, first, last = clip_of(Key("end")), pose_of(1), pose_of(2)
    off = [same(fit_ends(clip, first, last, d, d).rotations[N // 2], clip.rotations[N // 2]) for d in (1, 3, 9, 40)]
    assert off == sorted(off, reverse=True)
    assert off[0] > 0.1
    assert off[-1] < 1e-9
    late = fit_ends(clip, first, None, 1, 40), fit_ends(clip, None, last, 40, 1)
    for fitted in late:  # d1 is the beginning's, d2 the end's
        assert same(fitted.rotations[N // 2], clip.rotations[N // 2]) > 0.05


@pytest.mark.parametrize(("d1", "d2", "named"), [(0, 2, "d1: 0"), (2, -1, "d2: -1"), (1.5, 2, "d1: 1.5")])
def test_exponents_are_whole_numbers_from_1_on(d1, d2, named):
    with pytest.raises(ValueError, match=named):
        fit_ends(clip_of(), None, None, d1, d2)


def test_a_clip_in_the_mirror():
    clip = clip_of(Key("end", 0, 60, "small", "left"))
    seen = mirrored(clip)
    assert seen.key == Key("end", 0, -60, "small", "right")
    whole = np.zeros((N + 1, 43, 4))
    whole[..., 0] = 1.0
    whole[:, :BODY] = clip.rotations
    expected, place = skeleton.mirror(whole, clip.root)
    np.testing.assert_array_equal(seen.rotations, expected[:, :BODY])
    np.testing.assert_array_equal(seen.root, place)
    np.testing.assert_array_equal(seen.bearing[:, 0], clip.bearing[:, 1])
    back = mirrored(seen)
    assert back.key == clip.key
    np.testing.assert_array_equal(back.rotations, clip.rotations)


def speeds_of(clip: WalkClip, frame: int) -> Speeds:
    return Speeds.between(*(Pose(clip.rotations[k], clip.root[k]) for k in (frame, frame + 1)))


def test_speeds_at_the_ends_become_those_wanted_and_the_end_poses_stay():
    clip, other = smooth_clip(Key("start", 0), 1), smooth_clip(Key("start", 0), 2)
    first, last = speeds_of(other, 3), speeds_of(other, 9)
    fitted = fit_speeds(clip, first, last)
    for got, wanted in ((speeds_of(fitted, 0), first), (speeds_of(fitted, N - 1), last)):
        np.testing.assert_allclose(got.joints, wanted.joints, atol=1e-9)
        np.testing.assert_allclose(got.root, wanted.root, atol=1e-9)
    assert np.abs(speeds_of(clip, 0).joints - first.joints).max() > 0.01
    assert same(fitted.rotations[[0, -1]], clip.rotations[[0, -1]]) < EXACT
    np.testing.assert_allclose(fitted.root[[0, -1]], clip.root[[0, -1]], atol=EXACT)
    assert same(fitted.rotations[N // 2], clip.rotations[N // 2]) < EXACT
    left = fit_speeds(clip, None, None)
    assert same(left.rotations, clip.rotations) < EXACT


def test_a_straight_step_goes_on_at_the_speeds_at_which_it_began():
    closed = close_speeds(close_onto_mirror(smooth_clip(STRAIGHT, 1)))
    begun, ended = speeds_of(closed, 0), speeds_of(closed, N - 1).mirrored()
    np.testing.assert_allclose(ended.joints, begun.joints, atol=1e-9)
    np.testing.assert_allclose(ended.root, begun.root, atol=1e-9)
    seen = mirrored(closed)
    np.testing.assert_allclose(speeds_of(seen, 0).joints, begun.mirrored().joints, atol=1e-9)
    np.testing.assert_allclose(speeds_of(seen, 0).root, begun.mirrored().root, atol=1e-9)


def test_what_clips_must_join():
    straight, standing = close_onto_mirror(smooth_clip(STRAIGHT, 1)), pose_of(2)
    landing = Pose(straight.rotations[0], straight.root[0])
    begun, arriving = speeds_of(straight, 0), speeds_of(straight, straight.frames - 1)

    first, last = wanted_ends(Key("start", 60), straight, standing)
    assert first is standing
    assert same(last.rotations, turned(landing, 60.0).rotations) < EXACT
    assert np.abs(last.root - turned(landing, 60.0).root).max() < EXACT
    still, walking = wanted_speeds(Key("start", 90), straight)
    assert still is STILL
    # As the straight before comes to land, which is this one's mirror image; turned by 90 degrees.
    np.testing.assert_allclose(walking.root, [arriving.root[1], arriving.root[0], arriving.root[2]], atol=EXACT)
    np.testing.assert_array_equal(walking.joints, arriving.mirrored().joints)

    for side, expected in (("right", landing), ("left", Pose(*mirror(*landing)))):
        first, last = wanted_ends(Key("end", 0, 120, "small", side), straight, standing)
        assert same(first.rotations, expected.rotations) < EXACT
        np.testing.assert_array_equal(first.root, expected.root)
        assert same(last.rotations, turned(standing, 120.0).rotations) < EXACT
    np.testing.assert_allclose(wanted_speeds(Key("end", last="left"), straight)[0].root, begun.root * [1, -1, 1])
    np.testing.assert_array_equal(wanted_speeds(Key("end", last="right"), straight)[0].root, begun.root)

    first, last = wanted_ends(Key("two_step", 150, -30), straight, standing)
    assert first is standing
    assert same(last.rotations, turned(standing, 120.0).rotations) < EXACT
    assert wanted_speeds(Key("two_step", 150, -30), straight) == (STILL, STILL)
