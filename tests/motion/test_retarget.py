"""A motion from other makers' axes and onto other lengths: what is kept, and what follows the human."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, from_rotation_vector, multiply, rotate, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.motion.alignment import TRACKED, align
from ahmss.motion.bvh import read_bvh
from ahmss.motion.bvh_out import write_bvh
from ahmss.motion.contact import foot_points
from ahmss.motion.importing import import_clip, read_body
from ahmss.motion.naming import parts_of
from ahmss.motion.refining import levelled, refined
from ahmss.motion.retarget import retarget

from .makers import RATE, remounted, save_bvh, stepping
from .mocap import capture_path

OTHERS = {"tall man": Skeleton.of(1.9, "male"), "small woman": Skeleton.of(1.5, "female")}
BODY = [i for i, name in enumerate(TRACKED) if not name.endswith("hand")]


def degrees_apart(a, b):
    return np.degrees(np.linalg.norm(to_rotation_vector(multiply(conjugate(a), b)), axis=-1))


@pytest.fixture
def performed(skeleton):
    return stepping(skeleton)


@pytest.fixture
def file(tmp_path, skeleton, performed):
    path = tmp_path / "performed.bvh"
    write_bvh(path, skeleton, *performed, RATE)
    return path


def test_the_performers_own_body_does_the_same(file, skeleton, performed):
    body, _ = read_body(file)
    rotations, root = retarget(body, skeleton)
    apart = degrees_apart(rotations, performed[0])[:, BODY].max(axis=0)
    arms = [TRACKED[link].endswith("arm") for link in BODY]
    assert apart[~np.array(arms)].max() < 2.0
    assert apart[arms].max() < 5.0  # an elbow that is nearly straight slows down: 3 mm at the hand
    assert np.abs(root - performed[1]).max() < 0.005


@pytest.mark.parametrize("order", ["XYZ", "ZYX", "YXZ"])
def test_axes_zero_pose_unit_and_channels_of_a_file_dont_matter(tmp_path, file, skeleton, order):
    """Every joint has axes of its own: the zero pose is a heap, and the clip's own standing frames serve."""
    source = remounted(read_bvh(file), seed=len(order) + ord(order[0]))
    body, report = read_body(save_bvh(source, tmp_path / "other.bvh", order, unit=0.01))
    assert any("unit taken to be cm" in sentence for sentence in report)
    assert any("nobody stands in its zero pose" in sentence for sentence in report)
    same, _ = read_body(file)
    np.testing.assert_allclose(body.places, same.places, atol=1e-6)
    # Its upright frames are relaxed ones: trunk, head and feet are taken to be upright in them, a few degrees aside.
    assert degrees_apart(body.rotations, same.rotations).max(axis=0)[BODY].max() < 9.0


def test_a_zero_pose_with_hanging_arms_serves_as_a_t_pose_does(tmp_path, file):
    """The A-pose in which Bandai's people or games' models stand: the same motion from other constant turns."""
    source = read_bvh(file)
    mounts = np.tile([1.0, 0.0, 0.0, 0.0], (len(source.names), 1))
    world = mounts.copy()
    for side, sign in (("right", 1.0), ("left", -1.0)):  # arms lowered by 50 degrees about z, which points ahead
        turned = from_rotation_vector(np.array([0.0, 0.0, sign * np.radians(50.0)]))
        chain = [i for i, name in enumerate(source.names) if name.startswith(side) and "leg" not in name]
        world[[i for i in chain if "foot" not in source.names[i]]] = turned
    parents = np.array(source.parents)
    before = world[np.maximum(parents, 0)]
    before[parents < 0] = mounts[0]
    # With w the world turn of each bone in the new zero pose, the same pose needs w_parent q w*, offsets w_parent o.
    turned = replace(
        source,
        rotations=multiply(multiply(before, source.rotations), conjugate(world)),
        offsets=rotate(before, source.offsets),
        translations=np.where(parents[:, None] < 0, source.translations, rotate(before, source.translations)),
    )
    body, _ = align(turned, parts_of(turned), 1.0)
    same, _ = align(source, parts_of(source), 1.0)
    np.testing.assert_allclose(body.places, same.places, atol=1e-6)
    assert degrees_apart(body.rotations, same.rotations).max() < 0.01


@pytest.mark.parametrize("human", OTHERS)
def test_feet_stand_on_the_ground_and_keep_their_place(file, human):
    skeleton = OTHERS[human]
    clip, _ = import_clip(file, skeleton)
    points = foot_points(skeleton, clip.rotations, clip.root)
    assert np.abs(points[..., 2]).max() < 0.01
    assert np.abs(points - points[0]).max() < 0.01
    assert clip.contacts.all()
    assert clip.header.human == skeleton.name


@pytest.mark.parametrize("human", OTHERS)
def test_hands_that_meet_in_front_meet_on_other_shoulders(tmp_path, skeleton, human):
    pose, place = skeleton.upright()
    rotations, root = np.repeat(pose[None], 60, axis=0), np.repeat(place[None], 60, axis=0)
    for side, sign in (("right", 1.0), ("left", -1.0)):
        bend = np.clip(np.arange(60) / 40.0, 0.0, 1.0)
        for link, vector in (("upper_arm", (0.0, 1.2, 0.0)), ("upper_arm", (0.0, 0.0, -0.42 * sign))):
            turn = from_rotation_vector(bend[:, None] * np.array(vector))
            index = INDEX[f"{side}_{link}"]
            rotations[:, index] = multiply(rotations[:, index], turn)
    write_bvh(tmp_path / "pray.bvh", skeleton, rotations, root, RATE)
    body, _ = read_body(tmp_path / "pray.bvh")
    hands = [INDEX["right_hand"], INDEX["left_hand"]]
    gap = np.linalg.norm(np.diff(body.places[-1, hands], axis=0))
    solved, at = retarget(body, OTHERS[human])
    places, _ = forward(solved[-1], at[-1], OTHERS[human].offsets)
    assert gap < 0.12
    assert np.linalg.norm(np.diff(places[hands], axis=0)) < gap + 0.03


def test_elbows_bend_about_their_own_axis(file):
    """CMU's zero pose has the elbows' axes aside; from the bending itself they are found."""
    body, _ = read_body(file)
    askew = body.rotations.copy()
    arm = INDEX["right_upper_arm"]
    askew[:, arm] = multiply(askew[:, arm], from_rotation_vector(np.array([np.radians(30.0), 0.0, 0.0])))
    mended = refined(replace(body, rotations=askew))
    assert degrees_apart(askew, body.rotations)[:, arm].min() > 29.0
    assert degrees_apart(mended.rotations, body.rotations)[:, arm].max() < 0.1


def test_a_floor_that_leans_is_levelled_and_a_ramp_stays():
    body, report = read_body(capture_path("B03"))
    assert any("its floor leans by 0.8 %: levelled" in sentence for sentence in report)
    way = body.places[-1, 0, :2] - body.places[0, 0, :2]
    far = np.linalg.norm(way)
    along = (body.places[:, 0, :2] - body.places[0, 0, :2]) @ way / far
    for rise, left in ((0.02, 0.0), (-0.012, 0.0), (0.06, 0.06)):
        leaning = body.places.copy(), body.toes.copy()
        for places in leaning:
            places[..., 2] += rise * (places[..., :2] @ way) / far
        mended, slope = levelled(replace(body, places=leaning[0], toes=leaning[1]))
        risen = mended.places[:, 0, 2] - body.places[:, 0, 2] - left * along
        assert np.ptp(risen) < 0.1 * abs(rise - left) * far + 1e-9
        assert slope == pytest.approx(abs(rise - left), rel=0.1)


def test_soles_are_level_while_they_stand(file):
    body, _ = read_body(file)
    askew = body.rotations.copy()
    foot = INDEX["left_foot"]
    askew[:, foot] = multiply(askew[:, foot], from_rotation_vector(np.array([0.1, 0.3, 0.0])))
    mended = refined(replace(body, rotations=askew)).rotations
    up = rotate(mended[:, foot], np.array([0.0, 0.0, 1.0]))
    assert np.degrees(np.arccos(np.clip(up[:, 2], -1.0, 1.0))).max() < 1.5
