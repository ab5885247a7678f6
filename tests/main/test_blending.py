"""The blend alone, with rows made by hand."""

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.inverse import ends
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, multiply
from ahmss.body.skeleton import Skeleton
from ahmss.main.blending import Blending, Contribution

SKELETON = Skeleton.of(1.7, "male")
ROTATIONS, ROOT = SKELETON.upright()
SPINE, HEAD = INDEX["spine"], INDEX["head"]
X = np.array([1.0, 0.0, 0.0])


def row(turns: dict[int, float] | None = None, root: Array = ROOT, **importance: float) -> Array:
    """A POSE row: joints turned about x, importance by link or `root`, else 0."""
    made = np.zeros(260)
    rotations = ROTATIONS.copy()
    for joint, angle in (turns or {}).items():
        rotations[joint] = multiply(rotations[joint], from_axis_angle(X, angle))
    made[1:4], made[4:176] = root, rotations.reshape(172)
    for name, share in importance.items():
        made[176 + (43 if name == "root" else INDEX[name])] = share
    return made


@pytest.fixture
def blending() -> Blending:
    return Blending(SKELETON, ROTATIONS, ROOT, 60.0)


def settle(blending: Blending, *rows: Array) -> None:
    """Show the same rows until nothing decays any more."""
    motions = [Contribution(number, one) for number, one in enumerate(rows, 1)]
    for _ in range(60):
        blending.step(motions)
        for motion in motions:
            motion.hold()


def angle(blending: Blending, joint: int) -> float:
    """How far a joint is turned about x from upright."""
    turned = multiply(ROTATIONS[joint] * [1, -1, -1, -1], blending.rotations[joint])
    return float(2.0 * np.arctan2(turned[1], turned[0]))


def test_a_joint_follows_the_motions_by_their_importance(blending: Blending) -> None:
    settle(blending, row({SPINE: 0.2, HEAD: 0.4}, spine=1.0, head=3.0), row({SPINE: 0.6, HEAD: 0.0}, head=1.0))
    assert angle(blending, SPINE) == pytest.approx(0.2)
    assert angle(blending, HEAD) == pytest.approx(0.3, abs=1e-3)


def test_a_joint_of_which_nobody_cares_any_more_keeps_its_rotation(blending: Blending) -> None:
    settle(blending, row({SPINE: 0.3}, spine=1.0))
    settle(blending, row({SPINE: -0.5}, head=1.0))
    assert angle(blending, SPINE) == pytest.approx(0.3, abs=1e-6)
    settle(blending)
    assert blending.resting
    assert angle(blending, SPINE) == pytest.approx(0.3, abs=1e-6)


def test_two_owners_of_the_root_share_its_way_and_not_its_place(blending: Blending) -> None:
    near, far = Contribution(1, _root(0.0)), Contribution(2, _root(5.0))
    blending.step([near, far])
    for k in range(1, 61):
        near.advance(_root(0.01 * k))
        far.advance(_root(5.0 + 0.03 * k))
        blending.step([near, far])
    assert blending.root[0] - ROOT[0] == pytest.approx(60 * 0.02, abs=1e-6)


def _root(x: float) -> Array:
    made = row(root=ROOT + np.array([x, 0.0, 0.0]))
    made[219] = 1.0
    return made


def test_one_owner_alone_is_followed_to_its_place(blending: Blending) -> None:
    settle(blending, _root(0.4))
    assert blending.root[0] - ROOT[0] == pytest.approx(0.4, abs=1e-9)


def test_a_new_source_begins_where_the_body_is(blending: Blending) -> None:
    settle(blending, row({SPINE: 0.2}, spine=1.0))
    before = angle(blending, SPINE)
    blending.step([Contribution(9, row({SPINE: -0.4}, spine=1.0))])
    assert angle(blending, SPINE) == pytest.approx(before, abs=1e-6)


def with_target(made: Array, end: int, target: Array, weight: float = 1.0) -> Array:
    """The row with a target (7,) for one end."""
    made[220 + 8 * end : 227 + 8 * end] = target
    made[227 + 8 * end] = weight
    return made


def test_a_target_of_one_motion_is_not_diluted_by_another_that_has_none(blending: Blending) -> None:
    place = blending.grips[0].copy()
    place[:3] += [0.2, 0.0, 0.25]
    settle(blending, with_target(row(right_hand=1.0), 0, place), row({SPINE: 0.05}, spine=1.0, right_hand=1.0))
    assert np.abs(blending.grips[0, :3] - place[:3]).max() < 1e-6


def test_two_targets_of_one_hand_meet_by_weight_and_importance(blending: Blending) -> None:
    place = blending.grips[0].copy()
    low, high = place.copy(), place.copy()
    low[:3] += [0.2, 0.0, 0.2]
    high[:3] += [0.2, 0.0, 0.3]
    settle(blending, with_target(row(right_hand=3.0), 0, low), with_target(row(right_hand=1.0), 0, high))
    assert np.abs(blending.grips[0, :3] - (0.75 * low[:3] + 0.25 * high[:3])).max() < 1e-6


def test_planted_feet_stay_while_the_hips_sink(blending: Blending) -> None:
    feet = ends(SKELETON, ROTATIONS, ROOT)[2:]
    sunk = row(root=ROOT - [0.0, 0.0, 0.1])
    sunk[219] = 1.0
    settle(blending, with_target(with_target(sunk, 2, feet[0]), 3, feet[1]))
    assert blending.root[2] == pytest.approx(ROOT[2] - 0.1)
    assert np.abs(ends(SKELETON, blending.rotations, blending.root)[2:, :3] - feet[:, :3]).max() < 1e-6


def test_a_limb_that_loses_its_target_goes_back_without_a_jump(blending: Blending) -> None:
    place = blending.grips[0].copy()
    place[:3] += [0.2, 0.0, 0.25]
    settle(blending, with_target(row(right_hand=1.0), 0, place))
    before = blending.grips[0, :3].copy()
    motion = Contribution(1, row(right_upper_arm=1.0, right_lower_arm=1.0, right_hand=1.0))
    steps = []
    for _ in range(60):
        blending.step([motion])
        steps.append(float(np.abs(blending.grips[0, :3] - before).max()))
        before = blending.grips[0, :3].copy()
    assert steps[0] < 1e-6
    assert max(steps) < 0.03
    assert np.abs(blending.rotations - ROTATIONS).max() < 1e-6


def test_limbs_that_lose_their_targets_one_after_the_other_stay_where_they_are_seen(blending: Blending) -> None:
    """A hand stands still on its target, then a motion holds it there without one, then another motion's hand goes."""
    right, left = blending.grips.copy()
    right[:3] += [0.2, 0.0, 0.25]
    left[:3] += [0.2, 0.0, 0.25]
    arm = {"right_upper_arm": 1.0, "right_lower_arm": 1.0, "right_hand": 1.0}
    other = with_target(row(left_hand=1.0), 1, left)
    settle(blending, with_target(row(**arm), 0, right), other)
    stood = blending.grips[0, :3].copy()
    held = row(**arm)
    held[4:176] = blending.rotations.reshape(172)
    holds, gone = Contribution(3, held), Contribution(2, row(left_hand=1.0))
    again = Contribution(4, held.copy())
    blending.step([holds, Contribution(2, other)])
    blending.step([again, gone])
    for _ in range(40):
        blending.step([again, gone])
        assert np.abs(blending.grips[0, :3] - stood).max() < 0.002


def test_a_gaze_that_goes_on_is_not_solved_twice_when_another_motion_joins(blending: Blending) -> None:
    place = np.array([1.0, 0.8, 1.3, 0.0, 0.0, 0.0, 0.0])
    first = with_target(row(head=0.2, spine=0.2), 4, place, 0.5)
    settle(blending, first)
    before = blending.rotations[HEAD].copy()
    motions = [Contribution(1, first), Contribution(2, with_target(row(head=1.0), 4, place, 0.5))]
    for _ in range(40):
        blending.step(motions)
        assert np.abs(blending.rotations[HEAD] - before).max() < 1e-6
