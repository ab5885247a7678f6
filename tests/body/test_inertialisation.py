"""Across a change of source the output keeps place and velocity, then meets the new source; idle, it is not there."""

import numpy as np
import pytest
from hypothesis import given, settings

from ahmss.body.inertialisation import Inertialiser, Places, Rotations
from ahmss.body.inverse import GAZE, LEFT_FOOT, RIGHT_FOOT, RIGHT_HAND, ends, solve
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, norm, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.body.target_inertialisation import TargetInertialiser

from .strategies import natural_pose, seeds, turn

RATE = 60.0
ALL, NONE = np.ones(43, bool), np.zeros(43, bool)
SKELETON = Skeleton.of(1.7, "male")
FREE_END, NO_END = np.ones(5, bool), np.zeros(5, bool)


def steps(rotations):
    """(frames - 1, joints, 3), degrees."""
    return np.degrees(to_rotation_vector(multiply(conjugate(rotations[:-1]), rotations[1:])))


def pop(rotations):
    """The largest step against its neighbours' mean, degrees."""
    s = steps(rotations)
    return np.linalg.norm(s[1:-1] - 0.5 * (s[:-2] + s[2:]), axis=-1).max()


def play(sources, changes, root=None):
    """Run poses (frames, 43, 4) through; `changes` maps a frame to the joints (43,) that switch there."""
    inertialiser = Inertialiser(RATE)
    root = np.zeros((len(sources), 3)) if root is None else root
    inertialiser.place(sources[0], root[0])
    out, places = [], []
    for k, (rotations, place) in enumerate(zip(sources, root, strict=True)):
        switched = changes.get(k, NONE)
        r, p = inertialiser.step(rotations, place, switched, bool(switched.any()))
        inertialiser.settle(r, p)
        out.append(r)
        places.append(p)
    return np.array(out), np.array(places), inertialiser


def swing(speed, frames, start=0.0):
    """All joints turning about x at a speed, radians a second."""
    return np.stack([np.tile(turn(start + speed * k / RATE, 0.0, 0.0), (43, 1)) for k in range(frames)])


def test_idle_gives_back_the_very_source():
    inertialiser = Inertialiser(RATE)
    pose, root = SKELETON.upright()
    inertialiser.place(pose, root)
    rotations, place = inertialiser.step(pose, root, NONE, False)
    assert rotations is pose
    assert np.array_equal(place, root)
    assert inertialiser.settled


@settings(max_examples=15)
@given(seeds)
def test_a_change_between_any_two_poses_neither_pops_nor_stays(seed):
    rng = np.random.default_rng(seed)
    a, root_a = natural_pose(SKELETON, rng)
    b, root_b = natural_pose(SKELETON, rng)
    signs = rng.choice([-1.0, 1.0], size=(43, 1))
    sources = np.concatenate([np.repeat(a[None], 10, 0), np.repeat((signs * b)[None], 40, 0)])
    roots = np.concatenate([np.repeat(root_a[None], 10, 0), np.repeat(root_b[None], 40, 0)])
    out, places, inertialiser = play(sources, {10: ALL}, roots)
    assert pop(out) < 1.5
    assert np.allclose(norm(out), 1.0)
    assert np.array_equal(out[-1], sources[-1])
    assert np.array_equal(places[-1], root_b)
    assert inertialiser.settled


def test_the_velocity_goes_on_and_fades():
    sources = np.concatenate([swing(2.0, 30), np.tile(turn(1.0, 0.3, 0.0), (50, 43, 1))])
    out, _, _ = play(sources, {30: ALL})
    before, after = steps(out)[28, 0], steps(out)[29, 0]
    assert after @ before / np.linalg.norm(before) == pytest.approx(np.linalg.norm(before), rel=0.05)
    assert pop(out) < 0.3
    acceleration = np.linalg.norm(np.diff(np.radians(steps(out)), axis=0), axis=-1) * RATE**2
    assert acceleration.max() < 100.0
    raw = np.linalg.norm(np.diff(np.radians(steps(sources)), axis=0), axis=-1) * RATE**2
    assert raw.max() > 500.0  # what it mends


def test_two_sources_that_move_alike_show_no_seam():
    sources = swing(1.5, 80)
    out, _, _ = play(sources, {40: ALL})
    assert np.degrees(np.abs(to_rotation_vector(multiply(conjugate(out), sources)))).max() < 1e-6


def test_only_the_joints_that_switch_are_touched():
    sources = swing(1.0, 60)
    sources[20:, 5] = turn(0.0, 0.7, 0.0)
    switched = NONE.copy()
    switched[5] = True
    out, _, _ = play(sources, {20: switched})
    others = [j for j in range(43) if j != 5]
    assert np.allclose(out[:, others], sources[:, others], atol=1e-15)
    assert pop(out) < 1.5


def test_changes_that_follow_each_other_stay_smooth():
    rng = np.random.default_rng(6)
    poses = [natural_pose(SKELETON, rng)[0] for _ in range(5)]
    first = [0, 10, 11, 12, 20, 70]
    sources = np.concatenate([np.repeat(p[None], b - a, 0) for p, a, b in zip(poses, first, first[1:], strict=False)])
    out, _, _ = play(sources, dict.fromkeys(first[1:-1], ALL))
    assert pop(out) < 2.0
    assert np.array_equal(out[-1], sources[-1])


@pytest.mark.parametrize("degrees", [85.0, 150.0])
def test_a_joint_that_has_far_to_turn_takes_longer_and_the_others_do_not(degrees):
    """85 degrees are an arm that was drawn in and hangs again."""
    sources = np.repeat(np.tile([1.0, 0.0, 0.0, 0.0], (43, 1))[None], 70, axis=0)
    sources[5:] = turn(0.0, np.radians(20.0), 0.0)
    sources[5:, 7] = turn(0.0, np.radians(degrees), 0.0)
    out, _, _ = play(sources, {5: ALL})
    turned = np.linalg.norm(steps(out), axis=-1)
    assert turned.max() < 5.5
    np.testing.assert_allclose(turned.sum(axis=0)[[7, 8]], [degrees, 20.0], atol=1e-6)
    assert np.flatnonzero(turned[:, 8] > 1e-9)[-1] < 5 + 25  # in 0.4 s
    assert np.flatnonzero(turned[:, 7] > 1e-9)[-1] < 5 + 56


def test_half_a_turn_away_has_no_jump():
    a = np.tile([1.0, 0.0, 0.0, 0.0], (10, 43, 1))
    wobble = np.stack([np.tile(turn(0.0, 0.0, np.pi + 0.02 * np.sin(k)), (43, 1)) for k in range(60)])
    out, _, _ = play(np.concatenate([a, wobble]), {10: ALL})
    assert np.linalg.norm(steps(out), axis=-1).max() < 20.0  # a jump would be 180


def test_a_source_that_leaps_after_its_first_frame_is_no_fast_one():
    """The first frame of who thinks before a motion is the pose as it is: what follows was taken for its velocity."""
    bent = np.tile(turn(0.7, 0.0, 0.0), (6, 43, 1))
    upright = np.tile([1.0, 0.0, 0.0, 0.0], (60, 43, 1))
    out, _, inertialiser = play(np.concatenate([bent, upright]), {5: ALL})
    assert np.linalg.norm(steps(out), axis=-1).max() < 5.3 + 1e-6
    angles = 2.0 * np.arctan2(out[:, 0, 1], out[:, 0, 0])
    assert angles.min() > -0.01
    assert inertialiser.settled
    assert np.allclose(np.abs(out[-1]), upright[-1])


def test_a_jump_that_is_meant_is_not_smoothed():
    inertialiser = Inertialiser(RATE)
    (a, root), (b, _) = SKELETON.upright(), natural_pose(SKELETON, np.random.default_rng(1))
    inertialiser.place(a, root)
    inertialiser.step(b, root, ALL, True)
    inertialiser.place(b, root)
    assert inertialiser.settled
    assert inertialiser.step(b, root, NONE, False)[0] is b


def test_places_keep_their_velocity_exactly_where_the_source_does():
    channel = Places(2, RATE)
    values = np.stack([np.array([[0.01 * k, 0.0, 1.0], [0.0, -0.02 * k, 0.0]]) for k in range(60)])
    channel.place(values[0])
    out = []
    for k, v in enumerate(values):
        shifted = v + (0.5 if k >= 30 else 0.0)
        out.append(channel.step(shifted, np.full(2, k == 30)))
        channel.settle(out[-1])
    out = np.array(out)
    assert np.abs(np.diff(out, axis=0)).max() < 0.06
    assert np.abs(np.diff(out, n=2, axis=0)).max() * RATE**2 < 25.0
    assert np.allclose(out[-1], values[-1] + 0.5)


def test_an_offset_and_a_velocity_decay_along_quintics_that_start_and_end_at_rest():
    """Seen through a source that jumps by 1 m, and one that stops from 0.01 m a frame."""
    for jump, speed in ((1.0, 0.0), (0.0, 0.01)):
        channel = Places(1, RATE, 0.5)
        channel.place(np.array([[-2.0 * speed, 0.0, 0.0]]))
        channel.settle(np.array([[-speed, 0.0, 0.0]]))
        out = []
        for k in range(40):
            out.append(channel.step(np.array([[-jump, 0.0, 0.0]]), np.array([k == 0])))
            channel.settle(out[-1])
        t = np.minimum(np.arange(40) / 30.0, 1.0)
        stays = 1.0 - 10.0 * t**3 + 15.0 * t**4 - 6.0 * t**5
        carried = 30.0 * (t - 6.0 * t**3 + 8.0 * t**4 - 3.0 * t**5)
        assert np.allclose(np.array(out)[:, 0, 0], -jump + jump * stays + speed * carried, atol=1e-12)


def test_without_a_place_the_first_source_is_the_present():
    channel = Rotations(1, RATE)
    first = turn(0.1, 0.2, 0.3)[None]
    assert np.allclose(channel.step(first, np.array([True])), first)


def run_targets(pose, root, frames):
    """Stand in a pose and follow (targets, switched ends) of each frame; the poses that come out."""
    inertialiser, targets_of = Inertialiser(RATE), TargetInertialiser(SKELETON, RATE)
    inertialiser.place(pose, root)
    targets_of.place(pose, root)
    held = np.zeros(5)
    out = []
    for targets, switched in frames:
        gone = (held > 0.0) & (targets[:, 7] == 0.0)
        held = targets[:, 7]
        rotations, place = inertialiser.step(pose, root, np.full(43, gone.any()), False)
        rotations = solve(SKELETON, rotations, place, targets_of.step(targets, switched))
        inertialiser.settle(rotations, place)
        targets_of.settle(rotations, place)
        out.append(rotations)
    assert targets_of.settled
    return np.array(out)


def scene(*rows):
    """Targets with some rows: (row, place, rotation or None)."""
    targets = np.zeros((5, 8))
    for row, place, rotation in rows:
        targets[row, :3], targets[row, 7] = place, 1.0
        if rotation is not None:
            targets[row, 3:7] = rotation
    return targets


def test_a_new_hand_target_takes_hold_of_the_hand_where_it_is():
    pose, root = SKELETON.upright()
    pose[INDEX["right_lower_arm"]] = turn(0.0, 1.0, 0.0)
    hand = ends(SKELETON, pose, root)[0]
    wanted = scene((RIGHT_HAND, hand[:3] + np.array([0.2, 0.1, 0.15]), multiply(turn(0.0, 0.0, 0.6), hand[3:])))
    frames = [(np.zeros((5, 8)), NO_END)] * 5
    frames += [(wanted, FREE_END)] + [(wanted, NO_END)] * 40 + [(np.zeros((5, 8)), FREE_END)]
    out = run_targets(pose, root, frames + [(np.zeros((5, 8)), NO_END)] * 40)
    assert pop(out) < 1.5
    assert np.allclose(ends(SKELETON, out[44], root)[0, :3], wanted[0, :3], atol=2e-3)
    assert np.allclose(out[-1], pose, atol=1e-9)


def test_feet_that_are_planted_where_they_stand_do_not_move():
    pose, root = natural_pose(SKELETON, np.random.default_rng(9))
    feet = ends(SKELETON, pose, root)[2:]
    wanted = scene((RIGHT_FOOT, feet[0, :3], feet[0, 3:]), (LEFT_FOOT, feet[1, :3], feet[1, 3:]))
    out = run_targets(pose, root, [(np.zeros((5, 8)), NO_END)] * 3 + [(wanted, FREE_END)] + [(wanted, NO_END)] * 30)
    seen = np.array([ends(SKELETON, r, root)[2:] for r in out])
    assert np.abs(seen[..., :3] - feet[:, :3]).max() < 1e-3


def test_idle_targets_are_given_back():
    inertialiser = TargetInertialiser(SKELETON, RATE)
    pose, root = SKELETON.upright()
    inertialiser.place(pose, root)
    targets = scene((GAZE, (1.0, 0.0, 1.5), None))
    assert inertialiser.step(targets, NO_END) is targets


def test_the_first_target_ever_starts_without_a_velocity():
    pose, root = SKELETON.upright()
    pose[INDEX["right_lower_arm"]] = turn(0.0, 1.0, 0.0)
    hand = ends(SKELETON, pose, root)[0]
    wanted = scene((RIGHT_HAND, hand[:3] + np.array([0.1, 0.0, 0.1]), None))
    out = run_targets(pose, root, [(wanted, FREE_END)] + [(wanted, NO_END)] * 40)
    seen = np.array([ends(SKELETON, r, root)[0, :3] for r in out])
    assert np.linalg.norm(seen[0] - hand[:3]) < 1e-3
    assert pop(out) < 1.5
    assert np.linalg.norm(seen - hand[:3], axis=-1).max() < 0.16
