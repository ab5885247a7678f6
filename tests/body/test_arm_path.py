"""An arm along a path: no flips, within limits, and a jump only where there is no other way."""

import numpy as np
import pytest

from ahmss.body.arm import Arm, Wrist, excess, hand_angles, links_of, wrist_of
from ahmss.body.arm_path import STEP, SWINGS, carried_sides, follow
from ahmss.body.arm_swing import Swing, limits_of, swing_of
from ahmss.body.arm_swing import allowed as arcs_within
from ahmss.body.quaternion import conjugate, multiply, slerp, to_rotation_vector

from .test_arm import HUMANS, KEN, random_links, same


def path(before, after, frames):
    """Wrist poses (frames, ...) straight from one arm's to another's, minimum jerk and slerp."""
    first, last = wrist_of(KEN, before), wrist_of(KEN, after)
    t = np.linspace(0.0, 1.0, frames)
    t = (t**3 * (10.0 - 15.0 * t + 6.0 * t**2)).reshape(-1, *[1] * (before.ndim - 2))
    place = first.place + t[..., None] * (last.place - first.place)
    shape = (frames, *first.rotation.shape)
    rotation = slerp(
        np.broadcast_to(first.rotation, shape), np.broadcast_to(last.rotation, shape), t * np.ones(shape[:-1])
    )
    return Wrist(place, rotation)


def angle(p, q):
    return np.linalg.norm(to_rotation_vector(multiply(conjugate(p), q)), axis=-1)


def steps(way, before):
    """Radians that each link's rotation changes from frame to frame (F, ..., 3)."""
    links = np.concatenate([before[None], way.links])
    return angle(links[:-1], links[1:])


@pytest.fixture(scope="module")
def many():
    """80 paths of 120 frames and the arms along them."""
    links = random_links(np.random.default_rng(1), KEN, 400)
    before, after = links[:80], links[80:160]
    wrist = path(before, after, 120)
    return before, wrist, follow(KEN, wrist, before)


def met(way):
    """Where the wrist is as asked for (F, ...)."""
    return (np.abs(way.missing) < 1e-12) & (way.turned == 0.0)


def test_the_wrist_is_where_it_was_asked_for_and_all_joints_within_limits(many):
    _, wrist, way = many
    got = wrist_of(KEN, way.links)
    fine = met(way)
    assert 0.7 < fine.mean() < 0.99
    assert np.abs(got.place - wrist.place)[fine].max() < 1e-9
    assert same(got.rotation[fine], wrist.rotation[fine])
    assert excess(KEN, way.links).max() < 1e-7
    assert np.array_equal(way.beyond, excess(KEN, way.links))


def test_no_flip(many):
    before, wrist, way = many
    turned = steps(way, before)
    hand = np.concatenate([wrist_of(KEN, before).rotation[None], wrist.rotation])
    asked = angle(hand[:-1], hand[1:])
    calm = ~way.jumps.any(axis=0)
    assert calm.sum() > 60
    assert turned[:, calm].max() < np.radians(18.0)
    assert turned[..., 0][:, calm].max() < 3.0 * STEP
    assert (turned[..., 2] - 3.0 * asked[..., None].max())[:, calm].max() < STEP
    # Signs too: what is blended never changes hemisphere.
    full = np.concatenate([before[None], way.links])
    assert ((full[1:] * full[:-1]).sum(axis=-1) >= 0.0).all()


def test_a_jump_only_where_a_search_finds_no_way_either(many):
    """Dense swings, two turns of them, frame by frame: the search dies no later than the jump."""
    before, wrist, way = many
    swing = swing_of(KEN, wrist, carried_sides(KEN, wrist.place, before))
    whole = met(way).all(axis=0)
    jumping = np.flatnonzero(way.jumps.any(axis=0) & whole)
    assert 1 <= len(jumping) < 10
    cell = STEP / 8.0
    grid = np.arange(-int(2.0 * np.pi / cell), int(2.0 * np.pi / cell) + 1) * cell
    for item in jumping:
        parts = (swing.line, swing.bend, swing.missing, swing.upper, swing.rotation)
        one = Swing(*(part[:, item][:, None] for part in parts))
        fine = excess(KEN, one.links(np.broadcast_to(grid, (len(way.links), len(grid))))) == 0.0
        at = np.abs(grid) < 0.5 * cell
        died = len(fine)
        for frame, allowed in enumerate(fine):
            at = (np.convolve(at, np.ones(17), "same") > 0.5) & allowed
            if not at.any():
                died = frame
                break
        assert died <= np.flatnonzero(way.jumps[:, item])[0]


def test_at_a_thousand_frames_a_second_nothing_ever_flips():
    links = random_links(np.random.default_rng(2), KEN, 60)
    before, after = links[:6], links[6:12]
    wrist = path(before, after, 1000)
    way = follow(KEN, wrist, before, step=STEP * 0.06)
    calm = ~way.jumps.any(axis=0)
    assert calm.sum() >= 4
    assert steps(way, before)[:, calm].max() < np.radians(3.0)


def test_an_arm_that_need_not_swing_does_not():
    """The elbow keeps its side: level path, the hand turning with the forearm."""
    before = links_of(np.array([0.4, 0.6, -0.5, 1.2, 0.0, 0.1, 0.2]))
    start = wrist_of(KEN, before)
    wrist = Wrist(start.place * np.linspace(1.0, 0.9, 30)[:, None], np.tile(start.rotation, (30, 1)))
    way = follow(KEN, wrist, before)
    swing = swing_of(KEN, wrist, carried_sides(KEN, wrist.place, before))
    assert same(way.links, swing.links(np.zeros(30)))
    assert not way.jumps.any()


def test_an_arm_that_is_asked_for_where_it_is_stays():
    links = random_links(np.random.default_rng(3), KEN, 30)
    wrist = wrist_of(KEN, links)
    still = Wrist(np.stack([wrist.place] * 4), np.stack([wrist.rotation] * 4))
    way = follow(KEN, still, links)
    assert np.allclose(way.links, links, rtol=0, atol=1e-8)
    assert not way.jumps.any()


def test_out_of_reach_the_arm_stretches_and_says_by_how_much():
    before = links_of(np.array([0.0, 0.9, 0.0, 0.8, 0.0, 0.0, 0.0]))
    start = wrist_of(KEN, before)
    scale = np.linspace(1.0, 1.5, 60)[:, None]
    way = follow(KEN, Wrist(start.place * scale, np.tile(start.rotation, (60, 1))), before)
    distance = np.linalg.norm(start.place) * scale[:, 0]
    assert np.allclose(way.missing, np.maximum(distance - KEN.lengths.sum(), 0.0), atol=1e-12)
    assert way.missing[-1] > 0.1
    got = wrist_of(KEN, way.links).place
    assert np.allclose(np.cross(got, start.place), 0.0, atol=1e-9)
    assert excess(KEN, way.links).max() < 1e-7
    assert steps(way, before).max() < np.radians(20.0)


def test_a_hand_turned_too_far_turns_as_far_as_it_can_and_comes_back_on_the_other_side_without_a_leap():
    """Half a turn and more about the forearm, there and, the other way round, back."""
    before = links_of(np.array([0.0, 0.3, 0.0, 1.4, 0.0, 0.0, 0.0]))
    start = wrist_of(KEN, before)
    along = multiply(before[0], before[1])
    around = np.linspace(0.0, 2.0 * np.pi, 200)
    half = 0.5 * around
    spin = np.stack([np.cos(half), np.sin(half), 0.0 * half, 0.0 * half], axis=-1)
    rotation = multiply(multiply(np.broadcast_to(along, spin.shape), spin), multiply(conjugate(along), start.rotation))
    way = follow(KEN, Wrist(np.tile(start.place, (200, 1)), rotation), before)
    assert excess(KEN, way.links).max() < 1e-7
    assert way.turned.max() > np.radians(30.0)
    assert way.turned[0] == way.turned[-1] == 0.0
    assert np.allclose(wrist_of(KEN, way.links).place, start.place, atol=1e-9)
    assert not way.jumps.any()
    turns = hand_angles(way.links)[:, 0]
    assert turns.max() > np.radians(60.0)
    assert turns.min() < np.radians(-60.0)
    assert np.abs(np.diff(turns)).max() < 2.5 * STEP


def test_a_wrist_that_passes_the_shoulder_itself_is_no_trouble():
    before = links_of(np.array([0.0, 0.3, 0.0, 1.4, 0.0, 0.0, 0.0]))
    start = wrist_of(KEN, before)
    place = start.place * np.linspace(1.0, -0.5, 31)[:, None]
    place[20] = 0.0
    way = follow(KEN, Wrist(place, np.tile(start.rotation, (31, 1))), before)
    assert np.isfinite(way.links).all()
    assert way.missing[20] < -0.05


def test_a_shoulder_that_no_swing_serves_says_by_how_much_it_is_beyond():
    limits = KEN.limits.copy()
    limits[0, 1] = (-0.5, 0.5)  # the arm hardly swings forward
    stiff = Arm(KEN.lengths, limits, KEN.place, KEN.rotation)
    before = links_of(np.zeros(7))
    place = np.array([[0.0, 0.0, -0.5]])  # straight ahead
    way = follow(stiff, Wrist(place, np.array([[1.0, 0.0, 0.0, 0.0]])), before)
    assert way.beyond[0] > 0.1
    assert np.allclose(wrist_of(stiff, way.links).place, place, atol=1e-9)


def test_angles_along_a_path_are_continuous_and_the_same_arm(many):
    _, _, way = many
    angles = way.angles
    assert same(links_of(angles), way.links, atol=1e-8)
    assert np.abs(np.diff(angles, axis=0)).max() <= np.pi + 1e-9


def test_one_path_and_a_batch():
    arm = Arm.of(HUMANS["aiko"], "left")
    links = random_links(np.random.default_rng(4), arm, 40)
    before, after = links[:4], links[4:8]
    wrist = path(before, after, 20)
    batch = follow(arm, wrist, before)
    one = follow(arm, Wrist(wrist.place[:, 2], wrist.rotation[:, 2]), before[2])
    assert one.links.shape == (20, 3, 4)
    assert np.allclose(one.links, batch.links[:, 2], atol=1e-12)
    shaped = follow(
        arm, Wrist(wrist.place.reshape(20, 2, 2, 3), wrist.rotation.reshape(20, 2, 2, 4)), before.reshape(2, 2, 3, 4)
    )
    assert np.allclose(shaped.links.reshape(20, 4, 3, 4), batch.links, atol=1e-12)


def test_an_elbow_keeps_to_the_swings_that_serve_where_its_limits_allow_one(many):
    before, wrist, _ = many
    serve = np.ones((120, len(SWINGS)), bool)
    serve[60:] = (SWINGS > 0.3) & (SWINGS < 1.5)
    fine = np.linspace(-np.pi, np.pi, 721)
    kept = 0
    for i in range(12):
        own = Wrist(wrist.place[:, i], wrist.rotation[:, i])
        swing = swing_of(KEN, own, carried_sides(KEN, own.place, before[i]))
        arcs = arcs_within(swing.measures(), limits_of(KEN))
        off = np.mod(SWINGS - arcs[..., :1], 2.0 * np.pi)
        serves = (serve & (off <= arcs[..., 1:] - arcs[..., :1]).any(axis=1)).any(axis=-1)
        way = follow(KEN, own, before[i], serves=serve)
        for frame in np.flatnonzero(serves & ~way.jumps)[::7]:
            if frame < 75:  # it has come there
                continue
            one = Swing(
                *(np.broadcast_to(part[frame], (len(fine), *part[frame].shape)) for part in vars(swing).values())
            )
            phi = fine[angle(one.links(fine)[:, 0], way.links[frame, 0]).argmin()]
            assert 0.2 < phi < 1.6, (i, frame)
            kept += 1
    assert kept > 20
