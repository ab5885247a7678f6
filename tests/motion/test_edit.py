"""Clips cut, mirrored and begun anew."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, multiply, rotate, to_rotation_vector
from ahmss.motion.edit import at_rate, begun_at_origin, cut, floor_frame, mirrored, part

UP = np.array([0.0, 0.0, 1.0])


def turned(clip, angle, by):
    """The clip as a whole turned about the vertical and moved, its targets where they are."""
    turn = from_axis_angle(UP, angle)
    rotations = clip.rotations.copy()
    rotations[:, 0] = multiply(turn, rotations[:, 0])
    return replace(clip, rotations=rotations, root=rotate(turn, clip.root) + by)


def same_rotations(a, b):
    return np.abs(np.einsum("...c,...c->...", a, b)).min() > 1.0 - 1e-12


def test_the_floor_frame_is_under_the_hips_and_looks_where_they_do(skeleton):
    pose, root = skeleton.upright()
    heading = from_axis_angle(UP, 0.7)
    pose[0] = multiply(heading, multiply(pose[0], from_axis_angle(np.array([0.0, 1.0, 0.0]), 0.4)))  # bent forward
    place, rotation = floor_frame(pose, root + np.array([2.0, -1.0, 0.0]))
    assert np.allclose(place, [2.0, -1.0, 0.0])
    assert np.allclose(to_rotation_vector(rotation), [0.0, 0.0, 0.7])


def test_a_clip_begun_at_the_origin_forgets_where_it_was(swing):
    there = turned(swing, 1.1, np.array([3.0, -2.0, 0.0]))
    a, b = begun_at_origin(swing), begun_at_origin(there)
    assert np.allclose(a.root, b.root)
    assert same_rotations(a.rotations, b.rotations)
    place, rotation = floor_frame(b.rotations[0], b.root[0])
    assert np.allclose(place, 0.0)
    assert np.allclose(to_rotation_vector(rotation), 0.0, atol=1e-12)
    assert b.root[0, 2] == there.root[0, 2]


def test_targets_relative_to_the_human_stay_where_they_are_in_the_world(swing):
    own = replace(swing, header=msgspec.structs.replace(swing.header, targets="human"))
    there = turned(own, 0.9, np.array([1.0, 2.0, 0.0]))
    begun = begun_at_origin(there)
    place, rotation = floor_frame(there.rotations[0], there.root[0])
    held = own.targets[:, 0, 7] > 0.0
    assert np.allclose(place + rotate(rotation, begun.targets[held, 0, :3]), own.targets[held, 0, :3])
    assert same_rotations(multiply(rotation, begun.targets[held, 0, 3:7]), own.targets[held, 0, 3:7])
    assert np.array_equal(begun.targets[~held], own.targets[~held])
    at_site = begun_at_origin(turned(swing, 0.9, np.array([1.0, 2.0, 0.0])))
    assert np.array_equal(at_site.targets, swing.targets)  # those of a site know no human


def test_poses_relative_to_an_object_stay(swing):
    there = replace(swing, header=msgspec.structs.replace(swing.header, frame="object"))
    assert begun_at_origin(there) is there


def test_a_cut_holds_the_frames_asked_for_with_all_that_is_theirs(swing):
    piece = cut(swing, 20, 45)
    assert piece.frames == 26
    assert same_rotations(piece.rotations[:, 1:], swing.rotations[20:46, 1:])
    for name in ("importance", "contacts", "targets"):
        assert np.array_equal(getattr(piece, name), getattr(swing, name)[20:46])
    assert np.allclose(np.diff(piece.root, axis=0), np.diff(swing.root[20:46], axis=0))
    assert np.allclose(piece.root[0, :2], 0.0)
    assert piece.header == swing.header


@pytest.mark.parametrize(("first", "last"), [(-1, 5), (6, 5), (0, 61)])
def test_frames_that_are_not_there_are_not_cut(swing, first, last):
    with pytest.raises(ValueError, match="go from 0 to 60"):
        cut(swing, first, last)


def test_keyframes_are_not_cut_and_have_no_rate(swing):
    keys = part(swing, 0, 2)
    keys = replace(keys, header=msgspec.structs.replace(keys.header, times=(0.5, 1.0)))
    with pytest.raises(ValueError, match="keyframes"):
        cut(keys, 0, 1)
    with pytest.raises(ValueError, match="keyframes"):
        at_rate(keys, 30.0)


def test_a_mirror_shows_every_joint_on_the_other_side(swing, skeleton):
    seen = mirrored(swing)
    places, _ = forward(swing.rotations, swing.root, skeleton.offsets)
    there, _ = forward(seen.rotations, seen.root, skeleton.offsets)
    reflected = places * (1.0, -1.0, 1.0)
    for name, other in (("right_hand", "left_hand"), ("left_foot", "right_foot"), ("head", "head")):
        assert np.allclose(there[:, INDEX[name]], reflected[:, INDEX[other]])
    assert np.array_equal(seen.contacts[:, 1], swing.contacts[:, 0])
    assert np.allclose(seen.targets[:, 1, :3], swing.targets[:, 0, :3] * (1.0, -1.0, 1.0))
    assert not seen.targets[:, 0].any()


def test_importance_changes_sides_too(swing):
    importance = swing.importance.copy()
    importance[:, INDEX["right_thumb_distal"]], importance[:, 43] = 0.125, 0.25
    seen = mirrored(replace(swing, importance=importance))
    assert np.all(seen.importance[:, INDEX["left_thumb_distal"]] == 0.125)
    assert np.all(seen.importance[:, 43] == 0.25)


def test_twice_in_the_mirror_is_the_clip(swing):
    twice = mirrored(mirrored(swing))
    assert np.array_equal(twice.rotations, swing.rotations)
    assert np.array_equal(twice.targets, swing.targets)


@pytest.mark.parametrize(("rate", "frames"), [(30.0, 31), (120.0, 121), (25.0, 26)])
def test_another_rate_is_the_same_motion(swing, rate, frames):
    other = at_rate(swing, rate)
    assert (other.frames, other.rate) == (frames, rate)
    assert other.duration == pytest.approx(swing.duration)
    assert np.allclose(other.root[-1], swing.root[-1])
    middle = other.root[frames // 2]
    t = (frames // 2) / rate
    assert np.allclose(middle[:2], swing.root[0, :2] + np.array([0.3 * t * t, 0.1 * t]), atol=1e-6)
