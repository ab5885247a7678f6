"""Importance that follows from a motion: what moves matters, by how far it moves what it carries."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS, PARENTS
from ahmss.body.quaternion import from_axis_angle, from_rotation_vector, multiply, rotate
from ahmss.motion.importance import derive, importance_of

FRAMES, RATE = 120, 60.0


def standing(skeleton):
    """A person who just stands: rotations, root."""
    pose, place = skeleton.relaxed()
    return np.repeat(pose[None], FRAMES, 0), np.repeat(place[None], FRAMES, 0)


def bent(rotations, link, angles):
    """The rotations with a joint bent about its y axis by angles (frames,)."""
    out = rotations.copy()
    vectors = np.stack([0.0 * angles, angles, 0.0 * angles], axis=-1)
    out[:, INDEX[link]] = multiply(out[:, INDEX[link]], from_rotation_vector(vectors))
    return out


def held(angle):
    return np.full(FRAMES, angle)


def test_who_just_stands_does_nothing_that_matters(skeleton):
    rotations, root = standing(skeleton)
    assert importance_of(skeleton, rotations, root, RATE).max() < 1e-9


def test_where_one_stands_and_heads_does_not_matter(skeleton):
    rotations, root = standing(skeleton)
    rotations = bent(rotations, "spine", held(0.3))
    here = importance_of(skeleton, rotations, root, RATE)
    rotations[:, 0] = multiply(from_axis_angle(np.array([0.0, 0.0, 1.0]), 2.0), rotations[:, 0])
    assert np.allclose(importance_of(skeleton, rotations, root + np.array([4.0, 1.0, 0.0]), RATE), here)


def test_only_the_joint_that_is_bent_matters(skeleton):
    rotations, root = standing(skeleton)
    found = importance_of(skeleton, bent(rotations, "right_lower_arm", held(1.2)), root, RATE)
    elbow = INDEX["right_lower_arm"]
    assert found[:, elbow].min() > 0.9
    assert np.delete(found, elbow, axis=1).max() < 1e-9


def carried(link):
    """A link and all that hangs on it."""
    chain = {link}
    for i, parent in enumerate(PARENTS):
        if parent in chain:
            chain.add(i)
    return sorted(chain)


@pytest.mark.parametrize("name", ["spine", "right_upper_arm", "left_lower_leg", "right_index_proximal"])
def test_it_is_the_formula(skeleton, name):
    rotations, root = standing(skeleton)
    theta = 0.4
    rotations = bent(rotations, name, held(theta))
    places, world = forward(rotations[0], root[0], skeleton.offsets)
    link = INDEX[name]
    below = carried(link)
    away = places[below] + rotate(world[below], 0.5 * skeleton.tips[below]) - places[link]
    rho = np.sqrt((skeleton.mass[below] * (away**2).sum(axis=1)).sum() / skeleton.mass[below].sum())
    expected = (rho * theta) ** 2 / ((rho * theta) ** 2 + 0.05**2)
    assert importance_of(skeleton, rotations, root, RATE)[:, link] == pytest.approx(expected)


def test_speed_counts_where_the_posture_does_not(skeleton):
    """Going through where one stands at rest: the angle is 0 there, the speed is not."""
    rotations, root = standing(skeleton)
    t = np.arange(FRAMES) / RATE
    arm = INDEX["left_upper_arm"]
    slow = importance_of(skeleton, bent(rotations, "left_upper_arm", 0.1 * (t - 1.0)), root, RATE)[60, arm]
    fast = importance_of(skeleton, bent(rotations, "left_upper_arm", 2.0 * (t - 1.0)), root, RATE)[60, arm]
    assert fast > 0.8 > 0.1 > slow


def test_a_turn_matters_more_the_farther_what_it_carries_reaches(skeleton):
    rotations, root = standing(skeleton)
    chain = ("right_upper_arm", "right_lower_arm", "right_hand", "right_index_proximal")
    found = [importance_of(skeleton, bent(rotations, n, held(0.3)), root, RATE)[0, INDEX[n]] for n in chain]
    assert found == sorted(found, reverse=True)
    assert found[0] > 0.5 > found[-1] > 0.0


def test_it_does_not_jump(skeleton):
    rotations, root = standing(skeleton)
    angles = np.where(np.arange(FRAMES) < 60, 0.0, 1.5)  # a pose that jumps
    found = importance_of(skeleton, bent(rotations, "right_upper_arm", angles), root, RATE)
    assert found[:, INDEX["right_upper_arm"]].max() > 0.9
    assert np.abs(np.diff(found, axis=0)).max() < 0.12
    assert found.min() >= 0.0
    assert found.max() <= 1.0


def test_the_root_matters_where_it_goes_or_sinks(skeleton):
    rotations, root = standing(skeleton)
    walking = root + np.stack([np.arange(FRAMES) / RATE, np.zeros(FRAMES), np.zeros(FRAMES)], axis=-1)
    assert importance_of(skeleton, rotations, walking, RATE)[:, -1].min() == pytest.approx(
        0.25**2 / (0.25**2 + 0.05**2)
    )
    seated = root - np.array([0.0, 0.0, 0.4])
    assert importance_of(skeleton, rotations, seated, RATE)[:, -1].min() > 0.95


def test_keyframes_count_by_their_postures_alone(swing, skeleton):
    keys = replace(
        swing, rotations=swing.rotations[[0, 30]], root=swing.root[[0, 0]], importance=swing.importance[:2],
        contacts=swing.contacts[:2], targets=None, header=msgspec.structs.replace(swing.header, times=(0.5, 1.0)),
    )  # fmt: skip
    found = derive(keys, skeleton)
    arm = INDEX["right_upper_arm"]
    assert found.importance[0, arm] < 0.5 < 0.95 < found.importance[1, arm]
    assert found.importance.shape == (2, len(LINKS) + 1)
    assert found.rotations is keys.rotations
