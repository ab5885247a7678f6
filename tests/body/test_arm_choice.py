"""The arm chosen: within limits, nearest to the present one, never missed where one can be reached."""

import numpy as np
import pytest

from ahmss.body.arm import Arm, Wrist, angles_of, excess, links_of, wrist_of
from ahmss.body.arm_choice import change, choose, present_side, solutions
from ahmss.body.quaternion import conjugate, multiply, rotate, to_rotation_vector

from .strategies import random_rotations
from .test_arm import HUMANS, KEN, SIDES, random_links, same
from .test_arm_cases import different


def check(arm, chosen, wrist):
    """What was found is within limits and has its wrist where it was asked for."""
    links = links_of(chosen.angles[chosen.found])
    assert excess(arm, links).max() < 1e-8
    got = wrist_of(arm, links)
    assert np.abs(got.place - wrist.place[chosen.found]).max() < 1e-9
    off = to_rotation_vector(multiply(conjugate(got.rotation), wrist.rotation[chosen.found]))
    assert np.abs(off).max() < 1e-9


def arms_and_present(arm, seed, n):
    rng = np.random.default_rng(seed)
    links, present = random_links(rng, arm, 2 * n), random_links(rng, arm, 2 * n)
    least = min(len(links), len(present), n)
    return wrist_of(arm, links[:least]), angles_of(links[:least]), angles_of(present[:least])


@pytest.mark.parametrize("side", SIDES)
def test_each_pose_that_an_arm_can_take_is_found(side):
    arm = Arm.of(HUMANS["aiko"], side)
    wrist, _, present = arms_and_present(arm, 1, 1500)
    chosen = choose(arm, wrist, present)
    assert chosen.found.all()
    assert np.abs(chosen.missing).max() < 1e-12
    assert 0.05 < chosen.swung.mean() < 0.3  # so many poses none of the 24 reaches within the limits
    check(arm, chosen, wrist)


@pytest.mark.parametrize("side", SIDES)
def test_an_elbow_that_is_straightened_beyond_the_line_is_found_as_well(side):
    """Limits allow 5 degrees of it: one in fifty such poses is within the limits so only."""
    arm = Arm.of(HUMANS["ken"], side)
    links = random_links(np.random.default_rng(3), arm, 3000, beyond=True)
    wrist = wrist_of(arm, links)
    chosen = choose(arm, wrist, np.zeros((len(links), 7)))
    assert chosen.found.all()
    assert (chosen.angles[chosen.swung, 3] < 0.0).any()
    check(arm, chosen, wrist)


@pytest.mark.long
@pytest.mark.parametrize("name", HUMANS)
@pytest.mark.parametrize("side", SIDES)
def test_ten_thousand_poses(name, side):
    arm = Arm.of(HUMANS[name], side)
    wrist, _, present = arms_and_present(arm, 2, 10000)
    assert len(wrist.place) == 10000
    chosen = choose(arm, wrist, present)
    assert chosen.found.all()
    check(arm, chosen, wrist)
    away = Wrist(wrist.place * 3.0, wrist.rotation)
    far = choose(arm, away, present)
    distance = np.linalg.norm(away.place, axis=-1) - arm.lengths.sum()
    out = distance > 1e-9
    assert not far.found[out].any()
    assert np.allclose(far.missing[out], distance[out], atol=1e-12)


def test_the_present_arm_stays_where_it_is_asked_for():
    wrist, angles, _ = arms_and_present(KEN, 3, 500)
    chosen = choose(KEN, wrist, angles)
    assert chosen.found.all()
    assert not chosen.swung.any()
    assert np.abs(np.exp(1j * chosen.angles) - np.exp(1j * angles)).max() < 1e-6


def test_no_allowed_one_of_the_24_changes_less():
    wrist, _, present = arms_and_present(KEN, 4, 500)
    chosen = choose(KEN, wrist, present)
    cases = solutions(KEN, wrist, present)
    within = cases.real & (excess(KEN, links_of(cases.angles)) <= 1e-9)
    for i in range(len(present)):
        costs = [sum(np.angle(np.exp(1j * (a - present[i]))) ** 2) for a in cases.angles[i][within[i]]]
        if costs:
            assert change(chosen.angles[i], present[i]) == pytest.approx(min(costs))
        else:
            assert chosen.swung[i]


def test_a_change_is_taken_the_short_way_round():
    present = np.array([3.1, 0, 0, 0, 0, 0, -3.0])
    angles = np.array([-3.1, 0.1, 0, 0.2, 0, 0, 3.0])
    gap = 2.0 * np.pi - 6.2, 2.0 * np.pi - 6.0
    assert change(angles, present) == pytest.approx(gap[0] ** 2 + gap[1] ** 2 + 0.05)


def test_all_24_in_our_axes():
    wrist, angles, _ = arms_and_present(KEN, 5, 200)
    cases = solutions(KEN, wrist, angles)
    assert cases.real.all()
    got = wrist_of(KEN, links_of(cases.angles))
    assert np.abs(got.place - wrist.place[:, None]).max() < 1e-9
    assert same(got.rotation, np.broadcast_to(wrist.rotation[:, None], got.rotation.shape))
    assert different(cases.angles[0]) == 15


def test_what_is_not_found_leaves_the_arm_and_says_why():
    wrist, _, present = arms_and_present(KEN, 6, 300)
    reach = KEN.lengths.sum()
    size = np.linalg.norm(wrist.place, axis=-1)
    far = choose(KEN, Wrist(wrist.place * ((reach + 0.07) / size)[:, None], wrist.rotation), present)
    assert not far.found.any()
    assert np.allclose(far.missing, 0.07)
    assert np.array_equal(far.angles, present)
    near = choose(KEN, Wrist(wrist.place * (0.05 / size)[:, None], wrist.rotation), present)
    assert not near.found.any()
    assert np.all(near.missing < -0.05)
    turned = choose(KEN, Wrist(wrist.place, random_rotations(np.random.default_rng(7), len(size))), present)
    assert 0 < turned.found.sum() < len(size)
    assert np.abs(turned.missing).max() < 1e-12
    check(KEN, turned, Wrist(wrist.place, random_rotations(np.random.default_rng(7), len(size))))


def test_what_swings_swings_no_further_than_it_must():
    """From the present elbow's side to the nearest end of an arc, where a joint is at its limit."""
    wrist, _, present = arms_and_present(KEN, 8, 1000)
    chosen = choose(KEN, wrist, present)
    some = chosen.swung
    line = wrist.place[some] / np.linalg.norm(wrist.place[some], axis=-1, keepdims=True)
    before = present_side(KEN, links_of(present[some]), wrist.place[some])
    links = links_of(chosen.angles[some])
    elbow = rotate(links[:, 0], np.array([1.0, 0.0, 0.0]))
    after = elbow - (elbow * line).sum(-1)[:, None] * line
    phi = np.arctan2((np.cross(before, after) * line).sum(-1), (before * after).sum(-1))
    wide = Arm(KEN.lengths, KEN.limits + np.array([-1e-4, 1e-4]), KEN.place, KEN.rotation)
    narrow = Arm(KEN.lengths, KEN.limits - np.array([-1e-4, 1e-4]), KEN.place, KEN.rotation)
    at_rest = np.abs(phi) < 1e-6  # the present side itself serves
    assert np.all((excess(narrow, links) > 0.0) | at_rest)
    assert np.all(excess(wide, links) == 0.0)


def test_one_pose_and_batches_of_any_shape():
    wrist, _, present = arms_and_present(KEN, 9, 12)
    n = len(present) // 2 * 2
    many = choose(KEN, Wrist(wrist.place[:n], wrist.rotation[:n]), present[:n])
    place, rotation = wrist.place[:n].reshape(2, -1, 3), wrist.rotation[:n].reshape(2, -1, 4)
    shaped = choose(KEN, Wrist(place, rotation), present[:n].reshape(2, -1, 7))
    assert np.allclose(shaped.angles.reshape(n, 7), many.angles, rtol=0, atol=1e-9)
    one = choose(KEN, Wrist(wrist.place[3], wrist.rotation[3]), present[3])
    assert one.angles.shape == (7,)
    assert np.allclose(one.angles, many.angles[3], rtol=0, atol=1e-9)
    assert bool(one.found)


def test_from_a_hanging_arm_singular_as_it_is():
    wrist, _, _ = arms_and_present(KEN, 10, 300)
    chosen = choose(KEN, wrist, np.zeros((len(wrist.place), 7)))
    assert chosen.found.all()
    check(KEN, chosen, wrist)
    hanging = wrist_of(KEN, links_of(np.zeros(7)))
    assert np.allclose(choose(KEN, hanging, np.zeros(7)).angles, 0.0, atol=1e-7)
