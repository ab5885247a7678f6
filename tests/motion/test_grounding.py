"""Feet that stand: they neither slide nor sink, nothing pops, and what stood well is left alone."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.body.quaternion import align, conjugate, from_rotation_vector, multiply, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.motion.contact import bearing, contacts, foot_points, runs
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.grounding import ground
from ahmss.motion.hips import from_lowest_part, from_standing_parts
from ahmss.motion.importing import import_clip
from ahmss.motion.smoothness import pops
from tests.motion.mocap import capture_path

HUMAN = Skeleton.of(1.65, "female")
RATE = 60.0


def clip_of(name: str):
    clip, _ = import_clip(capture_path(name), HUMAN)
    return clip


def slip(rotations, root, stands) -> float:
    """How fast the lowest part of a foot that stands moves over the ground, the 99th percentile, m/s."""
    points = foot_points(HUMAN, rotations, root)
    speeds: list[float] = []
    for foot in range(2):
        lowest = points[:, foot, :, 2].argmin(axis=1)
        for first, end in runs(stands[:, foot] > 0.5):
            k = np.arange(first, end - 1)
            step = points[k + 1, foot, lowest[k], :2] - points[k, foot, lowest[k], :2]
            speeds += (np.linalg.norm(step, axis=-1) * RATE).tolist()
    return float(np.percentile(speeds, 99.0))


def swaying(frames: int = 240):
    """Standing, hips swaying over feet that are dragged along: every part of them slides."""
    pose, place = HUMAN.upright()
    time = np.arange(frames) / RATE
    root = place + np.stack([0.02 * np.sin(2.0 * np.pi * 0.4 * time), 0.01 * time, 0.0 * time], axis=-1)
    return np.tile(pose, (frames, 1, 1)), root


def test_feet_that_are_dragged_along_are_made_to_stand():
    rotations, root = swaying()
    before = foot_points(HUMAN, rotations, root)
    grounded = ground(HUMAN, rotations, root, RATE)
    after = foot_points(HUMAN, grounded.rotations, grounded.root)
    assert np.ptp(before, axis=0).max() > 0.03
    assert np.ptp(after, axis=0).max() < 0.003
    np.testing.assert_array_equal(grounded.contacts, 1.0)
    np.testing.assert_allclose(grounded.root[:, :2], root[:, :2], atol=1e-9)  # the hips go their way


def test_a_foot_in_the_ground_and_one_over_it_are_brought_to_it():
    rotations, root = swaying(120)
    for side, degrees in (("right", 4.0), ("left", -4.0)):
        foot = INDEX[f"{side}_foot"]
        rotations[:, foot] = multiply(rotations[:, foot], from_rotation_vector(np.radians([0.0, degrees, 0.0])))
    root = root + np.array([0.0, 0.0, 0.01])
    grounded = ground(HUMAN, rotations, root, RATE)
    lowest = foot_points(HUMAN, grounded.rotations, grounded.root)[..., 2].min(axis=-1)
    np.testing.assert_allclose(lowest, 0.0, atol=0.002)


def test_who_stands_well_is_left_alone():
    rotations, root = swaying(120)
    root[:] = root[0]
    grounded = ground(HUMAN, rotations, root, RATE)
    assert np.abs(align(grounded.rotations, rotations) - rotations).max() < 1e-9  # straight knees stay straight
    np.testing.assert_allclose(grounded.root, root, atol=1e-9)


def test_a_straight_knee_is_bent_smoothly_once_its_foot_is_off():
    """Who stood upright moves the hips, with the feet dragged along: the knees, straight before, must not jump."""
    pose, place = HUMAN.upright()
    rotations, root = np.tile(pose, (180, 1, 1)), np.tile(place, (180, 1))
    root[:, 0] += 0.02 * minimum_jerk((np.arange(180) / RATE - 1.0) / 1.0)  # the feet are dragged along
    grounded = ground(HUMAN, rotations, root, RATE)
    knee = INDEX["right_lower_leg"]
    turned = np.degrees(
        np.linalg.norm(
            to_rotation_vector(multiply(conjugate(rotations[:, knee]), grounded.rotations[:, knee])), axis=-1
        )
    )
    assert turned.max() > 2.0
    assert np.abs(np.diff(turned)).max() < 0.5
    assert np.ptp(foot_points(HUMAN, grounded.rotations, grounded.root), axis=0).max() < 0.001


@pytest.mark.parametrize("known", [True, False])
@pytest.mark.parametrize("name", ["B03", "A05"])
def test_real_motion_keeps_its_feet(name, known):
    clip = clip_of(name)
    grounded = ground(HUMAN, clip.rotations, clip.root if known else None, RATE)
    lowest = foot_points(HUMAN, grounded.rotations, grounded.root)[..., 2].min(axis=-1)
    assert lowest.min() > -0.001
    assert np.abs(lowest[grounded.contacts > 0.5]).max() < 0.002
    assert slip(grounded.rotations, grounded.root, grounded.contacts) < 0.1  # a real one's support speed is 0.15
    assert pops(grounded.rotations).max() < pops(clip.rotations).max() + 1.5
    way = np.linalg.norm(np.diff(grounded.root[[0, -1]], axis=0)[0, :2])
    meant = np.linalg.norm(np.diff(clip.root[[0, -1]], axis=0)[0, :2])
    assert way == pytest.approx(meant, rel=0.06, abs=0.05)


def test_by_the_lowest_part_alone_a_real_walker_sinks_and_jerks():
    clip = clip_of("B03")
    literal, _ = from_lowest_part(HUMAN, clip.rotations)
    beyond = from_standing_parts(HUMAN, clip.rotations, RATE)
    sunk = [foot_points(HUMAN, clip.rotations, way)[-60:, :, :2, 2].min() for way in (literal, beyond)]
    assert sunk[0] < -0.02  # the part that takes over is the lower one, each time
    assert sunk[1] > -0.01
    pushes = [np.linalg.norm(np.diff(way, n=2, axis=0), axis=-1).max() * RATE**2 for way in (literal, beyond)]
    assert pushes[1] < 0.7 * pushes[0]


def test_contact_is_height_and_speed_together():
    clip = clip_of("B03")
    points = foot_points(HUMAN, clip.rotations, clip.root)
    low = points[..., 2].min(axis=-1) < 0.05
    stands = ground(HUMAN, clip.rotations, clip.root, RATE).contacts > 0.5
    passing = low & ~stands
    assert passing.mean() > 0.05  # by height alone a swinging foot would stand
    assert bearing(points.reshape(-1, 6, 3), RATE).reshape(-1, 2, 3).any(axis=-1)[stands].mean() > 0.9


def test_contacts_are_those_that_the_clip_then_shows():
    rotations, root = swaying(120)
    grounded = ground(HUMAN, rotations, root, RATE)
    np.testing.assert_array_equal(contacts(HUMAN, grounded.rotations, grounded.root, RATE), grounded.contacts)
