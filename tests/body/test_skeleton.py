"""The upright pose (table 5.3 as decided) by forward kinematics, proportions, mirror, records."""

import json

import numpy as np
import pytest

from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS, PARENTS
from ahmss.body.quaternion import conjugate, multiply, rotate, to_matrix
from ahmss.body.skeleton import UPRIGHT_WORLD, Skeleton, mirror

from .strategies import natural_pose

SKELETONS = [Skeleton.of(1.62, "female"), Skeleton.of(1.76, "male"), Skeleton.of(1.90, "male")]
H = np.sqrt(0.5)
# Table 5.3 as printed, world -> link, first link of each group; torso, arms, legs.
PRINTED = {
    **dict.fromkeys(("head", "spine", "hips"), (H, 0.0, H, 0.0)),
    **dict.fromkeys(("right_upper_arm", "right_lower_arm", "right_hand"), (0.0, H, 0.0, H)),
    **dict.fromkeys(("left_upper_arm", "left_lower_arm", "left_hand"), (0.0, -H, 0.0, -H)),
    **dict.fromkeys(("right_upper_leg", "left_upper_leg", "right_lower_leg", "left_lower_leg"), (H, 0.0, -H, 0.0)),
}


@pytest.fixture(params=SKELETONS, ids=lambda s: f"{s.sex} {s.stature}")
def upright(request):
    skeleton = request.param
    return skeleton, *forward(*skeleton.upright(), skeleton.offsets)


def axes(world, name):
    """The world directions of a link's x, y and z."""
    return to_matrix(world[INDEX[name]]).T


def test_upright_stands_on_the_floor_and_is_as_tall_as_its_stature(upright):
    skeleton, places, world = upright
    top = places[INDEX["head"]] + rotate(world[INDEX["head"]], skeleton.tips[INDEX["head"]])
    assert top[2] == pytest.approx(skeleton.stature, abs=0.02)
    for side, flip in (("right", 1.0), ("left", -1.0)):
        foot = INDEX[f"{side}_foot"]
        soles = places[foot] + rotate(world[foot], skeleton.soles * (1.0, flip, 1.0))
        assert np.allclose(soles[:, 2], 0.0, atol=1e-12)
    assert np.allclose(places[INDEX["hips"]][:2], 0.0)


def test_upright_head_is_above_hips_and_hands_hang(upright):
    _, places, _ = upright
    z = {name: places[INDEX[name], 2] for name in LINKS}
    assert z["head"] > z["right_upper_arm"] > z["spine"] > z["hips"] > z["right_lower_leg"] > z["right_foot"] > 0.0
    assert z["right_upper_arm"] > z["right_lower_arm"] > z["right_hand"] > z["right_middle_distal"]


def test_upright_right_is_right(upright):
    _, places, _ = upright
    for name in LINKS:
        if name.startswith("right"):
            left = places[INDEX[name.replace("right", "left", 1)]]
            assert places[INDEX[name], 1] < 0.0
            assert np.allclose(left * (1.0, -1.0, 1.0), places[INDEX[name]])


def test_upright_axes_are_those_of_table_5_3_turned_about_y(upright):
    _, _, world = upright
    for name, printed in PRINTED.items():
        mended = multiply(np.array(printed), np.array([0.0, 0.0, 1.0, 0.0]))
        assert abs(mended @ world[INDEX[name]]) == pytest.approx(1.0, abs=1e-12), name
        arm = "arm" in name or "hand" in name
        noted = np.array([0.0, H, 0.0, -H]) if arm else conjugate(np.array(printed))
        assert abs(noted @ world[INDEX[name]]) == pytest.approx(1.0, abs=1e-12), name
    for side in ("right", "left"):
        assert np.allclose(world[INDEX[f"{side}_foot"]], [1.0, 0.0, 0.0, 0.0])


def test_upright_every_link_points_to_its_next_joint(upright):
    _, places, world = upright
    for name in ("hips", "spine", "right_upper_arm", "left_lower_arm", "right_upper_leg", "left_lower_leg"):
        child = {"hips": "spine", "spine": "head"}.get(name)
        child = INDEX[child] if child else INDEX[name] + 1
        assert PARENTS[child] == INDEX[name]
        way = places[child] - places[INDEX[name]]
        assert np.allclose(way / np.linalg.norm(way), axes(world, name)[0], atol=1e-9), name
    assert np.allclose(axes(world, "hips")[0], [0, 0, 1])
    assert np.allclose(axes(world, "right_foot")[0], [1, 0, 0])
    assert np.allclose(axes(world, "left_hand")[0], [0, 0, -1])


def test_upright_palms_face_inward_with_the_thumbs_ahead(upright):
    skeleton, places, world = upright
    for row, side, inward in ((0, "right", 1.0), (1, "left", -1.0)):
        hand = INDEX[f"{side}_hand"]
        q_world_grip = multiply(world[hand], skeleton.grips[row, 3:])
        assert np.allclose(rotate(q_world_grip, np.array([1.0, 0, 0])), [0, inward, 0], atol=1e-9)
        assert np.allclose(rotate(q_world_grip, np.array([0, 0, 1.0])), [1, 0, 0], atol=1e-9)
        palm = places[hand] + rotate(world[hand], skeleton.grips[row, :3])
        assert (palm[1] - places[hand, 1]) * inward > 0.0
        assert places[INDEX[f"{side}_thumb_proximal"], 0] > places[INDEX[f"{side}_little_proximal"], 0]


def test_upright_world_is_one_table():
    skeleton = SKELETONS[0]
    _, world = forward(*skeleton.upright(), skeleton.offsets)
    assert np.allclose(np.abs(np.einsum("li,li->l", world, UPRIGHT_WORLD)), 1.0)


def test_bending_goes_the_human_way():
    skeleton = SKELETONS[1]
    rotations, root = skeleton.upright()
    before, _ = forward(rotations, root, skeleton.offsets)
    for name, seen, axis, sign in (
        ("right_lower_arm", "right_hand", 0, 1.0),  # a bent elbow brings the hand forward
        ("left_lower_leg", "left_foot", 0, -1.0),  # a bent knee takes the foot back
        ("spine", "head", 0, 1.0),
    ):
        bent = rotations.copy()
        middle = skeleton.limits[INDEX[name], 1].mean()
        bent[INDEX[name]] = multiply(bent[INDEX[name]], np.array([np.cos(middle / 2), 0.0, np.sin(middle / 2), 0.0]))
        after, _ = forward(bent, root, skeleton.offsets)
        assert sign * (after - before)[INDEX[seen], axis] > 0.1, name


def test_limits_hold_the_upright_pose_and_mirror():
    for skeleton in SKELETONS:
        low, high = skeleton.limits[..., 0], skeleton.limits[..., 1]
        assert np.all(low <= 0.0)
        assert np.all(high >= 0.0)
        for name in LINKS:
            if name.startswith("right"):
                r, left = skeleton.limits[INDEX[name]], skeleton.limits[INDEX[name.replace("right", "left", 1)]]
                assert np.allclose(left[1], r[1])
                assert np.allclose(left[[0, 2]], -r[[0, 2], ::-1])


def test_masses_sum_to_a_body():
    for skeleton in SKELETONS:
        assert 40.0 < skeleton.mass.sum() < 100.0
        assert np.all(skeleton.mass > 0.0)


def test_record_survives_json():
    skeleton = SKELETONS[0]
    back = Skeleton.from_record(json.loads(json.dumps(skeleton.to_record())))
    for key in ("offsets", "tips", "mass", "radii", "limits", "grips", "soles", "eye"):
        assert np.array_equal(getattr(back, key), getattr(skeleton, key)), key
    assert (back.name, back.stature, back.sex) == (skeleton.name, skeleton.stature, skeleton.sex)


def test_mirror_shows_the_other_side():
    skeleton = SKELETONS[0]
    rotations, root = natural_pose(skeleton, np.random.default_rng(5))
    places, _ = forward(rotations, root, skeleton.offsets)
    mirrored = mirror(rotations, root)
    seen, _ = forward(*mirrored, skeleton.offsets)
    for link, name in enumerate(LINKS):
        other = name.replace("right", "left", 1) if "right" in name else name.replace("left", "right", 1)
        assert np.allclose(seen[INDEX[other]], places[link] * (1.0, -1.0, 1.0), atol=1e-12), name
    again = mirror(*mirrored)
    assert np.allclose(again[0], rotations)


def test_relaxed_stands_upright_with_curled_fingers_and_open_arms():
    skeleton = SKELETONS[0]
    straight, _ = forward(*skeleton.upright(), skeleton.offsets)
    places, _ = forward(*skeleton.relaxed(), skeleton.offsets)
    right, tip = INDEX["right_hand"], INDEX["right_middle_distal"]
    assert places[right, 1] < straight[right, 1]
    assert np.linalg.norm(places[tip] - places[right]) < np.linalg.norm(straight[tip] - straight[right])
    assert places[tip, 1] - places[right, 1] > straight[tip, 1] - straight[right, 1] + 0.02  # towards the palm
    for name in LINKS:
        if name.startswith("right"):
            other = INDEX[name.replace("right", "left", 1)]
            assert np.allclose(places[INDEX[name]] * (1.0, -1.0, 1.0), places[other], atol=1e-12)
