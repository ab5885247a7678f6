"""The arm as seven angles and as three links of a body, by forward kinematics of the whole body."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ahmss.body.arm import Arm, angles_of, excess, hand_angles, into_arm, links_of, split_wrist, with_hand, wrist_of
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, from_rotation_vector, multiply, rotate, to_matrix, to_rotation_vector
from ahmss.body.skeleton import LINK_ARM, Skeleton
from ahmss.database.workspace import Workspace
from ahmss.errors import DataError
from ahmss.motion.quality import beyond_limits

from .strategies import natural_pose, random_rotations, turn
from .test_arm_cases import about

SIDES = ("right", "left")
HUMANS = {name: Workspace(Path(__file__).resolve().parents[2]).humans.get(name).skeleton for name in ("ken", "aiko")}
KEN = Arm.of(HUMANS["ken"], "right")


def same(p, q, atol=1e-9):
    """Whether quaternions are the same rotations."""
    return np.allclose(np.abs((p * q).sum(axis=-1)), 1.0, rtol=0, atol=atol)


def random_links(rng, arm, n, spread=1.0, *, beyond=False):
    """Arms within their limits (m, 3, 4), m < n, whose elbows are bent, or straightened beyond the line."""
    lower = turn_about_y(arm.limits[1, 1, 0 if beyond else 1] * rng.uniform(size=n))
    lower = multiply(lower, from_rotation_vector(rng.uniform(*arm.limits[1, 0], n)[:, None] * [1.0, 0.0, 0.0]))
    bend = np.stack([np.zeros(n), rng.uniform(*arm.limits[2, 1], n), rng.uniform(*arm.limits[2, 2], n)], axis=-1)
    upper = from_rotation_vector(rng.normal(size=(n, 3)) * spread)
    links = np.stack([upper, lower, from_rotation_vector(bend)], axis=-2)
    return links[excess(arm, links) == 0.0]


def turn_about_y(angle):
    return from_rotation_vector(np.asarray(angle)[..., None] * np.array([0.0, 1.0, 0.0]))


@pytest.mark.parametrize("name", HUMANS)
@pytest.mark.parametrize("side", SIDES)
def test_the_turn_between_appendix_b_and_our_links(name, side):
    """The thesis's own matrices, put onto the shoulder through the table, bring the hand where the whole body does."""
    skeleton, rng = HUMANS[name], np.random.default_rng(1)
    arm = Arm.of(skeleton, side)
    for _ in range(20):
        t = rng.uniform(-np.pi, np.pi, 7)
        pose, root = natural_pose(skeleton, rng)
        upright, _ = skeleton.upright()
        first = INDEX[f"{side}_upper_arm"]
        pose[first : first + 3] = arm.into_pose(links_of(t))
        places, world = forward(pose, root, skeleton.offsets)
        upper = about("z", t[0]) @ about("x", t[1]) @ about("z", t[2])
        forearm = upper @ about("y", t[3])
        hand = forearm @ about("y", t[4]) @ about("x", t[5]) @ about("z", t[6])
        q_world_arm = multiply(multiply(world[INDEX["spine"]], upright[first]), LINK_ARM)
        elbow = skeleton.offsets[first + 1][0] * upper[:, 2]
        wrist = elbow + skeleton.offsets[first + 2][0] * forearm[:, 2]
        assert np.allclose(places[first + 1], places[first] + rotate(q_world_arm, elbow), atol=1e-12)
        assert np.allclose(places[first + 2], places[first] + rotate(q_world_arm, wrist), atol=1e-12)
        assert np.allclose(to_matrix(multiply(world[first + 2], LINK_ARM)), to_matrix(q_world_arm) @ hand, atol=1e-12)


def test_the_arm_lies_along_z_bends_about_y_and_our_links_lie_along_x():
    x, y, z = rotate(LINK_ARM, np.eye(3))
    assert np.allclose(z, [1, 0, 0])
    assert np.allclose(y, [0, 1, 0])
    assert np.allclose(x, [0, 0, -1])  # forward


@pytest.mark.parametrize("side", SIDES)
def test_all_angles_0_is_the_upright_arm_and_theta_4_brings_the_hand_forward(side):
    skeleton = HUMANS["aiko"]
    arm, first = Arm.of(skeleton, side), INDEX[f"{side}_upper_arm"]
    pose, root = skeleton.upright()
    assert same(arm.into_pose(links_of(np.zeros(7))), pose[first : first + 3])
    pose[first : first + 3] = arm.into_pose(links_of(np.array([0, 0, 0, 1.2, 0, 0, 0])))
    places, _ = forward(pose, root, skeleton.offsets)
    assert places[first + 2][0] > places[first + 1][0] + 0.2  # x is forward


def test_links_and_angles_are_the_same_arm():
    rng = np.random.default_rng(2)
    t = rng.uniform(-np.pi, np.pi, (500, 7))
    links = links_of(t)
    again = angles_of(links)
    assert same(links_of(again), links)
    assert np.all(again[:, 1] >= 0.0)
    assert np.all(np.abs(again[:, 5]) <= np.pi / 2 + 1e-12)
    named = t.copy()
    named[:, 1], named[:, 5] = np.abs(t[:, 1]), t[:, 5] / 2
    off = angles_of(links_of(named)) - named
    assert np.abs(np.exp(1j * off) - 1.0).max() < 1e-6


@pytest.mark.parametrize("t", [[0.3, 0, 0.5, 1, 0.1, 0.2, 0.3], [0.3, 0.4, 0.5, 1, 0.1, np.pi / 2, 0.3], [0] * 7])
def test_singular_arms_have_angles_too(t):
    links = links_of(np.array(t, float))
    again = angles_of(links)
    assert same(links_of(again), links)
    assert t[1] != 0 or abs(again[2]) < 1e-12  # (B.36)


def test_the_forearm_takes_the_hand_s_turn_and_the_hand_only_bends():
    t = np.random.default_rng(3).uniform(-1.2, 1.2, (200, 7))
    links = links_of(t)
    assert np.allclose(links[:, 2, 1], 0.0, atol=1e-12)
    assert same(links[:, 1], multiply(turn_about_y(t[:, 3]), split_wrist(links[:, 1])[0]))
    rotation = random_rotations(np.random.default_rng(4), 100)
    around, bend = split_wrist(rotation)
    assert same(multiply(around, bend), rotation)
    assert np.allclose(around[:, 2:], 0.0)
    assert np.allclose(bend[:, 1], 0.0, atol=1e-12)


def test_the_wrist_is_where_the_whole_body_has_it():
    skeleton, rng = HUMANS["ken"], np.random.default_rng(5)
    for side in SIDES:
        arm, first = Arm.of(skeleton, side), INDEX[f"{side}_upper_arm"]
        pose, root = natural_pose(skeleton, rng)
        places, world = forward(pose, root, skeleton.offsets)
        spine = (places[INDEX["spine"]], world[INDEX["spine"]])
        seen = arm.seen(places[first + 2], world[first + 2], spine)
        found = wrist_of(arm, arm.from_pose(pose[first : first + 3]))
        assert np.allclose(seen.place, found.place, atol=1e-12)
        assert same(seen.rotation, found.rotation)
        assert np.allclose(arm.into_pose(arm.from_pose(pose[first : first + 3])), pose[first : first + 3])


def test_rotations_in_the_arm_s_axes():
    q = random_rotations(np.random.default_rng(6), 10)
    turn_matrix = to_matrix(LINK_ARM)
    assert np.allclose(into_arm(q), turn_matrix.T @ to_matrix(q) @ turn_matrix, atol=1e-12)


@pytest.mark.parametrize("side", SIDES)
def test_who_is_within_these_limits_is_within_the_skeleton_s(side):
    skeleton, rng = HUMANS["aiko"], np.random.default_rng(7)
    arm, first = Arm.of(skeleton, side), INDEX[f"{side}_upper_arm"]
    links = random_links(rng, arm, 4000, spread=1.2)
    assert len(links) > 1000
    pose = np.tile(skeleton.upright()[0], (len(links), 1, 1))
    pose[:, first : first + 3] = arm.into_pose(links)
    assert beyond_limits(pose, skeleton).degrees < 1e-6


@pytest.mark.parametrize(
    ("link", "vector"),
    [
        (0, [1, 0, 0]), (0, [-1, 0, 0]), (1, [0, 1, 0]), (1, [1, 0, 0]), (1, [-1, 0, 0]),
        (2, [0, 1, 0]), (2, [0, -1, 0]), (2, [0, 0, 1]), (2, [0, 0, -1]),
    ],
)  # fmt: skip
def test_each_limit_is_the_skeleton_s_own(link, vector):
    axis = int(np.argmax(np.abs(vector)))
    limit = abs(KEN.limits[link, axis, int(sum(vector) > 0)])
    links = np.tile([1.0, 0.0, 0.0, 0.0], (2, 3, 1))
    for i, beyond in enumerate((-0.01, 0.01)):
        links[i, link] = turn(*((limit + beyond) * np.array(vector)))
    assert np.allclose(excess(KEN, links), [0.0, 0.01], atol=1e-9)
    assert np.allclose(excess(KEN, -links), [0.0, 0.01], atol=1e-9)


def test_an_elbow_bent_sideways_or_backwards_is_beyond_its_limits():
    links = np.tile([1.0, 0.0, 0.0, 0.0], (3, 1))
    links[1] = turn(0.0, 0.0, 0.5)
    assert excess(KEN, links) == pytest.approx(0.5 - np.radians(10.0))
    links[1] = turn(0.0, -0.5, 0.0)
    assert excess(KEN, links) == pytest.approx(0.5 - np.radians(5.0))


def test_hand_angles_read_and_set():
    rng = np.random.default_rng(8)
    links = random_links(rng, KEN, 200)
    angles = hand_angles(links)
    assert same(with_hand(links, angles), links)
    other = rng.uniform(-0.4, 0.4, angles.shape)
    changed = with_hand(links, other)
    assert np.allclose(hand_angles(changed), other, atol=1e-9)
    assert np.allclose(wrist_of(KEN, changed).place, wrist_of(KEN, links).place, atol=1e-12)
    assert np.allclose(to_rotation_vector(conjugate(changed[:, 2]))[:, 0], 0.0, atol=1e-12)


def test_an_arm_whose_bones_do_not_lie_along_x_is_refused():
    skeleton = Skeleton.of(1.7, "male")
    offsets = skeleton.offsets.copy()
    offsets[INDEX["left_hand"]] += (0.0, 0.01, 0.0)
    crooked = replace(skeleton, offsets=offsets)
    Arm.of(crooked, "right")
    with pytest.raises(DataError, match=r"links\.left_hand\.offset"):
        Arm.of(crooked, "left")
