"""Hands, feet and gaze on their targets: by forward kinematics of what came out."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ahmss.body.inverse import GAZE, LEFT_FOOT, RIGHT_FOOT, RIGHT_HAND, ends, grips, solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, norm, rotate, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.errors import ShapeError

from .strategies import natural_pose, random_rotations, seeds, turn

SKELETON = Skeleton.of(1.7, "male")
SIDES = (("right_upper_arm", "right_hand"), ("left_upper_arm", "left_hand"))
LIMBS = ("right_upper_arm", "left_upper_arm", "right_upper_leg", "left_upper_leg")


def angle(p, q):
    return np.linalg.norm(to_rotation_vector(multiply(conjugate(p), q)), axis=-1)


def targets_of(rotations, root, *, weight=1.0):
    """The targets that a pose itself meets, gaze left out."""
    targets = np.zeros((*root.shape[:-1], 5, 8))
    targets[..., :4, :7] = ends(SKELETON, rotations, root)
    targets[..., :4, 7] = weight
    return targets


def reachable(seed):
    """A pose, and targets of another pose of the same trunk."""
    rng = np.random.default_rng(seed)
    given_pose, root = natural_pose(SKELETON, rng)
    wanted, _ = natural_pose(SKELETON, rng)
    wanted[:2] = given_pose[:2]
    for side in ("right", "left"):  # well inside the reach
        for link in ("lower_arm", "lower_leg"):
            bent = turn(0.0, rng.uniform(0.7, 2.0), 0.0)
            wanted[INDEX[f"{side}_{link}"]] = bent
    return given_pose, root, targets_of(wanted, root)


@given(seeds)
def test_ends_and_grips_agree_with_forward_kinematics(seed):
    rotations, root = natural_pose(SKELETON, np.random.default_rng(seed))
    places, world = forward(rotations, root, SKELETON.offsets)
    seen = ends(SKELETON, rotations, root)
    for row, name in enumerate(("right_hand", "left_hand")):
        hand = INDEX[name]
        assert np.allclose(seen[row, :3], places[hand] + rotate(world[hand], SKELETON.grips[row, :3]), atol=1e-12)
        assert angle(seen[row, 3:], multiply(world[hand], SKELETON.grips[row, 3:])) < 1e-7
    for row, name in ((RIGHT_FOOT, "right_foot"), (LEFT_FOOT, "left_foot")):
        assert np.allclose(seen[row, :3], places[INDEX[name]], atol=1e-12)
        assert angle(seen[row, 3:], world[INDEX[name]]) < 1e-7
    assert np.array_equal(grips(SKELETON, rotations, root), seen[:2])
    batch = ends(SKELETON, np.stack([rotations] * 3), np.stack([root] * 3))
    assert np.allclose(batch[2], seen, atol=1e-14)


@given(seeds)
def test_hands_and_feet_meet_what_is_in_reach(seed):
    rotations, root, targets = reachable(seed)
    met = ends(SKELETON, solve(SKELETON, rotations, root, targets), root)
    assert np.allclose(met[:, :3], targets[:4, :3], atol=1e-9)
    assert np.all(angle(met[:, 3:], targets[:4, 3:7]) < 1e-6)


@given(seeds)
def test_a_free_rotation_meets_the_place_and_leaves_the_wrist(seed):
    rotations, root, targets = reachable(seed)
    targets[:4, 3:7] = 0.0
    solved = solve(SKELETON, rotations, root, targets)
    base = forward(rotations, root, SKELETON.offsets)[0][INDEX["right_upper_arm"]]
    reach = np.linalg.norm(targets[RIGHT_HAND, :3] - base)
    met = ends(SKELETON, solved, root)
    if reach < 0.5:  # a hand that is bent at the wrist reaches less far
        assert np.allclose(met[RIGHT_HAND, :3], targets[RIGHT_HAND, :3], atol=5e-3)
    assert np.array_equal(solved[INDEX["right_hand"]], rotations[INDEX["right_hand"]])
    assert np.array_equal(solved[INDEX["left_foot"]], rotations[INDEX["left_foot"]])


@given(seeds)
def test_targets_that_are_met_change_nothing(seed):
    rotations, root = natural_pose(SKELETON, np.random.default_rng(seed))
    solved = solve(SKELETON, rotations, root, targets_of(rotations, root))
    assert np.allclose(solved, rotations, atol=1e-7)


@given(seeds)
def test_no_weight_changes_nothing_at_all(seed):
    rng = np.random.default_rng(seed)
    rotations, root = natural_pose(SKELETON, rng)
    targets = rng.normal(size=(5, 8))
    targets[:, 7] = 0.0
    assert np.array_equal(solve(SKELETON, rotations, root, targets), rotations)


@given(seeds)
def test_one_pose_and_a_batch_give_the_same(seed):
    rng = np.random.default_rng(seed)
    poses = [natural_pose(SKELETON, rng) for _ in range(4)]
    rotations, root = np.stack([p[0] for p in poses]), np.stack([p[1] for p in poses])
    other = np.stack([natural_pose(SKELETON, rng)[0] for _ in range(4)])
    targets = targets_of(other, root)
    targets[..., 7] = rng.choice([0.0, 0.4, 1.0], size=(4, 5))
    targets[..., GAZE, :3] = root + rng.normal(size=(4, 3))
    targets[1, :2, 3:7] = 0.0
    batch = solve(SKELETON, rotations, root, targets)
    for i in range(4):
        assert np.allclose(batch[i], solve(SKELETON, rotations[i], root[i], targets[i]), atol=1e-12)
    shaped = solve(SKELETON, rotations.reshape(2, 2, 43, 4), root.reshape(2, 2, 3), targets.reshape(2, 2, 5, 8))
    assert np.allclose(shaped.reshape(4, 43, 4), batch, atol=1e-15)


@given(seeds, st.floats(1.0, 50.0))
def test_bones_are_never_stretched_and_the_limb_points_to_what_is_too_far(seed, far):
    rng = np.random.default_rng(seed)
    rotations, root = natural_pose(SKELETON, rng)
    places, _ = forward(rotations, root, SKELETON.offsets)
    base = places[INDEX["right_upper_arm"]]
    away = rng.normal(size=3)
    targets = np.zeros((5, 8))
    targets[RIGHT_HAND, :3] = base + away / np.linalg.norm(away) * far
    targets[RIGHT_HAND, 7] = 1.0
    solved = solve(SKELETON, rotations, root, targets)
    grip = grips(SKELETON, solved, root)[0, :3]
    way = (grip - base) / np.linalg.norm(grip - base)
    assert way @ away / np.linalg.norm(away) > 1.0 - 1e-9
    assert np.allclose(norm(solved), 1.0)
    untouched = [i for i in range(43) if i not in range(INDEX["right_upper_arm"], INDEX["right_hand"] + 1)]
    assert np.array_equal(solved[untouched], rotations[untouched])


def test_near_full_stretch_the_elbow_goes_soft():
    rotations, root = SKELETON.upright()
    rotations[INDEX["right_lower_arm"]] = turn(0.0, 1.2, 0.0)
    shoulder = forward(rotations, root, SKELETON.offsets)[0][INDEX["right_upper_arm"]]
    bends = []
    for far in np.linspace(0.45, 0.95, 500):
        targets = np.zeros((5, 8))
        targets[RIGHT_HAND, :3], targets[RIGHT_HAND, 7] = shoulder + np.array([far, 0.0, 0.0]), 1.0
        solved = solve(SKELETON, rotations, root, targets)
        bends.append(to_rotation_vector(solved[INDEX["right_lower_arm"]])[1])
    bends = np.degrees(bends)
    assert bends[0] > 60.0
    assert bends[-1] < 6.0
    assert np.all(np.diff(bends) <= 1e-6)
    assert np.abs(np.diff(bends)).max() < 2.0  # a millimetre of target never snaps the elbow


def test_the_elbow_keeps_its_side():
    rng = np.random.default_rng(11)
    for _ in range(50):
        rotations, root = natural_pose(SKELETON, rng)
        targets = targets_of(rotations, root)
        targets[:4, :3] += rng.normal(size=(4, 3)) * 0.02
        targets[:4, 3:7] = 0.0
        solved = solve(SKELETON, rotations, root, targets)
        before, after = (forward(r, root, SKELETON.offsets)[0] for r in (rotations, solved))
        for upper in LIMBS:
            assert np.linalg.norm((after - before)[INDEX[upper] + 1]) < 0.12, upper


@pytest.mark.parametrize("wanted", [-1.2, -0.6, 0.5, 1.2])
def test_the_forearm_takes_the_twist_of_the_hand(wanted):
    rotations, root = SKELETON.upright()
    elbow, hand = INDEX["right_lower_arm"], INDEX["right_hand"]
    rotations[elbow] = turn(0.0, 1.5, 0.0)
    turned = rotations.copy()
    turned[hand] = turn(wanted, 0.0, 0.0)
    solved = solve(SKELETON, rotations, root, targets_of(turned, root))
    of_hand = to_rotation_vector(solved[hand])[0]
    assert abs(of_hand) < 0.25 * abs(wanted)
    met, asked = grips(SKELETON, solved, root)[0], grips(SKELETON, turned, root)[0]
    assert np.allclose(met[:3], asked[:3], atol=1e-9)
    assert angle(met[3:], asked[3:]) < 1e-7


def test_a_turned_foot_turns_the_thigh_not_the_knee():
    rotations, root = SKELETON.upright()
    for side in ("right", "left"):
        rotations[INDEX[f"{side}_lower_leg"]] = turn(0.0, 0.3, 0.0)
    targets = targets_of(rotations, root)
    targets[RIGHT_FOOT, 3:7] = multiply(turn(0.0, 0.0, -0.5), targets[RIGHT_FOOT, 3:7])
    solved = solve(SKELETON, rotations, root, targets)
    assert np.allclose(ends(SKELETON, solved, root)[RIGHT_FOOT], targets[RIGHT_FOOT, :7], atol=1e-9)
    knee = INDEX["right_lower_leg"]
    twist = to_rotation_vector(solved[knee])[0]
    low, high = SKELETON.limits[knee, 0]
    assert low - 1e-9 <= twist <= high + 1e-9
    before, after = (forward(r, root, SKELETON.offsets)[0][knee] for r in (rotations, solved))
    assert after[1] < before[1] - 0.01  # the knee goes out with the toes


@given(seeds)
def test_a_part_of_the_weight_goes_a_part_of_the_way(seed):
    rotations, root, targets = reachable(seed)
    start = ends(SKELETON, rotations, root)
    targets[:4, 3:7] = start[:, 3:]
    targets[:4, :3] = start[:, :3] + 0.3 * (targets[:4, :3] - start[:, :3])
    targets[:4, 7] = 0.5
    met = ends(SKELETON, solve(SKELETON, rotations, root, targets), root)
    assert np.allclose(met[:, :3], 0.5 * (start[:, :3] + targets[:4, :3]), atol=4e-3)


@pytest.mark.parametrize(("x", "y", "z"), [(2.0, 0.5, 1.5), (1.5, -1.0, 0.9), (3.0, 0.0, 2.2), (0.3, 2.0, 1.4)])
def test_the_head_turns_most_of_the_way_to_what_is_looked_at(x, y, z):
    rotations, root = SKELETON.upright()
    targets = np.zeros((5, 8))
    targets[GAZE, :3], targets[GAZE, 7] = (x, y, z), 1.0
    solved = solve(SKELETON, rotations, root, targets)
    places, world = forward(solved, root, SKELETON.offsets)
    head = INDEX["head"]
    eye = places[head] + rotate(world[head], SKELETON.eye)
    ahead = rotate(world[head], np.array([0.0, 0.0, -1.0]))
    wanted = (np.array([x, y, z]) - eye) / np.linalg.norm(np.array([x, y, z]) - eye)
    before = np.degrees(np.arccos(wanted[0]))
    after = np.degrees(np.arccos(min(wanted @ ahead, 1.0)))
    assert after < max(0.35 * before, 3.0)
    assert abs(rotate(world[head], np.array([0.0, 1.0, 0.0]))[2]) < 0.1  # the head does not roll


def test_gaze_honours_its_weight_and_the_neck():
    rotations, root = SKELETON.upright()
    head, spine = INDEX["head"], INDEX["spine"]
    turns, leans = [], []
    for weight in (0.0, 0.5, 1.0):
        targets = np.zeros((5, 8))
        targets[GAZE] = [0.0, 2.0, 1.5, 0, 0, 0, 0, weight]
        solved = solve(SKELETON, rotations, root, targets)
        turns.append(to_rotation_vector(solved[head])[0])
        leans.append(angle(rotations[spine], solved[spine]))
    assert turns[0] == 0.0
    assert turns[1] == pytest.approx(0.5 * turns[2], rel=0.1)
    assert turns[2] > np.radians(45.0)
    assert leans[0] == 0.0 < leans[1] < leans[2] < np.radians(21.0)


@pytest.mark.parametrize(("y", "z"), [(0.02, 0.03), (-0.02, 0.25), (0.05, -0.2), (-0.15, 0.0)])
def test_gaze_at_what_passes_near_the_eyes_does_not_flip(y, z):
    """From ahead to behind, past the eyes at a metre and more a second: above, below, and close beside them."""
    rotations, root = SKELETON.upright()
    places, turned = forward(rotations, root, SKELETON.offsets)
    eyes = places[INDEX["head"]] + rotate(turned[INDEX["head"]], SKELETON.eye)
    heads = []
    for x in np.arange(0.6, -0.6, -0.02):
        targets = np.zeros((5, 8))
        targets[GAZE, :3], targets[GAZE, 7] = eyes + np.array([x, y, z]), 1.0
        heads.append(solve(SKELETON, rotations, root, targets)[[INDEX["spine"], INDEX["head"]]])
    heads = np.array(heads)
    assert np.degrees(angle(heads[:-1], heads[1:])).max() < 8.0
    assert np.degrees(angle(heads[0], rotations[[INDEX["spine"], INDEX["head"]]])).max() > 1.0


@pytest.mark.parametrize("y", [0.13, -0.13])
def test_gaze_at_what_passes_overhead_turns_aside_slowly(y):
    """From ahead to behind, higher above the eyes than the neck bends back."""
    rotations, root = SKELETON.upright()
    places, turned = forward(rotations, root, SKELETON.offsets)
    eyes = places[INDEX["head"]] + rotate(turned[INDEX["head"]], SKELETON.eye)
    heads = []
    for x in np.arange(0.7, -0.7, -0.02):
        targets = np.zeros((5, 8))
        targets[GAZE, :3], targets[GAZE, 7] = eyes + np.array([x, y, 0.36]), 1.0
        heads.append(solve(SKELETON, rotations, root, targets)[INDEX["head"]])
    assert np.degrees(angle(np.array(heads[:-1]), np.array(heads[1:]))).max() < 2.5


def test_gaze_passes_behind_without_a_jump():
    rotations, root = SKELETON.upright()
    heads = []
    for degrees in np.arange(90.0, 270.5, 0.5):
        a = np.radians(degrees)
        targets = np.zeros((5, 8))
        targets[GAZE] = [2.0 * np.cos(a), 2.0 * np.sin(a), 1.5, 0, 0, 0, 0, 1.0]
        heads.append(solve(SKELETON, rotations, root, targets)[[1, 2]])
    steps = np.degrees(angle(np.array(heads[:-1]), np.array(heads[1:])))
    assert steps.max() < 5.0


def test_results_lie_on_the_hemisphere_given():
    rng = np.random.default_rng(4)
    rotations, root, targets = reachable(8)
    targets[GAZE] = [2.0, 1.0, 1.0, 0, 0, 0, 0, 1.0]
    signs = rng.choice([-1.0, 1.0], size=(43, 1))
    plain, signed = (solve(SKELETON, r, root, targets) for r in (rotations, signs * rotations))
    assert np.allclose(signed, signs * plain, atol=1e-12)


def test_shapes_that_disagree_are_refused():
    rotations, root = SKELETON.upright()
    with pytest.raises(ShapeError, match="solve"):
        solve(SKELETON, rotations, root, np.zeros((2, 5, 8)))
    with pytest.raises(ShapeError, match="solve"):
        solve(SKELETON, random_rotations(np.random.default_rng(0), 2, 43), root, np.zeros((2, 5, 8)))


def test_gaze_sweeps_without_a_jerk_from_head_to_spine():
    rotations, root = SKELETON.upright()
    solved = []
    for degrees in np.arange(-110.0, 110.0, 2.0):
        a = np.radians(degrees)
        targets = np.zeros((5, 8))
        targets[GAZE] = [2.0 * np.cos(a), 2.0 * np.sin(a), 1.2, 0, 0, 0, 0, 1.0]
        solved.append(solve(SKELETON, rotations, root, targets)[[INDEX["spine"], INDEX["head"]]])
    solved = np.array(solved)
    steps = np.degrees(to_rotation_vector(multiply(conjugate(solved[:-1]), solved[1:])))
    assert np.linalg.norm(np.diff(steps, axis=0), axis=-1).max() < 0.2  # of steps of 2 degrees
