"""The arcs of the elbow's swing: against dense sampling, at the limits themselves, where sampling misses."""

import numpy as np
import pytest

from ahmss.body.arm import Wrist, excess, wrist_of
from ahmss.body.arm_swing import SHOULDER, Swing, allowed, elbow_side, limits_of, nearest_swing, swing_of
from ahmss.body.quaternion import rotate

from .strategies import random_rotations
from .test_arm import KEN, random_links, same

LIMITS = limits_of(KEN)


def swings_of(links):
    """The swings of arms (n, 3, 4), their own elbows at swing 0, and their wrists."""
    wrist = wrist_of(KEN, links)
    line = wrist.place / np.linalg.norm(wrist.place, axis=-1, keepdims=True)
    return swing_of(KEN, wrist, elbow_side(line, links[:, 0])), wrist


def at_many(swing, phi):
    """The excess (n, m) of n arms at swings phi (n, m) or (m)."""
    parts = (swing.line, swing.bend, swing.missing, swing.upper, swing.rotation)
    one = Swing(*(part[:, None] for part in parts))
    return excess(KEN, one.links(np.broadcast_to(phi, (len(swing.line), np.shape(phi)[-1]))))


def on_arcs(arcs, phi):
    """Whether swings phi (m) lie on arcs (n, k, 2): (n, m)."""
    begin, end = arcs[..., 0, None], arcs[..., 1, None]
    return (np.mod(phi - begin, 2.0 * np.pi) <= end - begin).any(axis=-2)


def test_swing_0_is_the_arm_itself_and_no_swing_moves_the_wrist():
    rng = np.random.default_rng(1)
    links = random_links(rng, KEN, 1000)
    swing, wrist = swings_of(links)
    assert same(swing.links(np.zeros(len(links))), links)
    assert np.abs(swing.missing).max() < 1e-12
    phi = rng.uniform(-np.pi, np.pi, len(links))
    swung = swing.links(phi)
    again = wrist_of(KEN, swung)
    assert np.allclose(again.place, wrist.place, rtol=0, atol=1e-12)
    assert same(again.rotation, wrist.rotation)
    # The elbow goes round the line by phi, right-handed.
    before, after = rotate(links[:, 0], np.array([1.0, 0, 0])), rotate(swung[:, 0], np.array([1.0, 0, 0]))
    across, turned = before - (before * swing.line).sum(-1)[:, None] * swing.line, np.cross(swing.line, before)
    expected = np.cos(phi)[:, None] * across + np.sin(phi)[:, None] * turned
    assert np.allclose(after - (after * swing.line).sum(-1)[:, None] * swing.line, expected, atol=1e-9)


def test_the_arcs_are_where_dense_sampling_finds_all_joints_within_limits():
    links = random_links(np.random.default_rng(2), KEN, 500, spread=1.3)
    swing, _ = swings_of(links)
    phi = np.linspace(-np.pi, np.pi, 720, endpoint=False)
    over = at_many(swing, phi)
    inside = on_arcs(allowed(swing.measures(), LIMITS), phi)
    assert 0.05 < inside.mean() < 0.6
    assert not (inside & (over > 1e-8)).any()
    assert not (~inside & (over == 0.0)).any()


def test_each_end_of_an_arc_is_a_joint_at_its_limit():
    links = random_links(np.random.default_rng(3), KEN, 400)
    swing, _ = swings_of(links)
    arcs = allowed(swing.measures(), LIMITS)
    for i, outward in ((0, -1.0), (1, 1.0)):
        ends = np.where(np.isnan(arcs[..., i]), 0.0, arcs[..., i])
        real = ~np.isnan(arcs[..., i]) & (arcs[..., 1] - arcs[..., 0] < 2.0 * np.pi - 1e-6)
        assert real.sum() > 300
        assert at_many(swing, ends)[real].max() < 1e-7
        assert at_many(swing, ends + 1e-5 * outward)[real].min() > 1e-8


def test_what_sampling_misses_is_found():
    """Reachable poses, near the limits of several joints: a search in steps passes over some of them."""
    rng = np.random.default_rng(4)
    links = random_links(rng, KEN, 20000)
    swing, wrist = swings_of(links)
    phi = np.linspace(-np.pi, np.pi, 36, endpoint=False) + 0.123
    missed = ~(at_many(swing, phi) == 0.0).any(axis=-1)
    assert 20 < missed.sum() < 200
    found, there = nearest_swing(allowed(swing.measures(), LIMITS), np.full(len(links), 2.0))
    assert there.all()
    arms = swing.links(found)
    assert excess(KEN, arms).max() < 1e-9
    assert np.allclose(wrist_of(KEN, arms).place, wrist.place, rtol=0, atol=1e-12)


def test_a_very_short_arc_is_found():
    """Limits drawn in until the arm that is known to be there has hardly any room left."""
    links = random_links(np.random.default_rng(5), KEN, 300)
    swing, _ = swings_of(links)
    measures = swing.measures()
    at_0 = measures[..., 0] + measures[..., 2]  # square and product at swing 0
    angles = 2.0 * np.arctan2(at_0[..., 1], at_0[..., 0])
    angles -= 2.0 * np.pi * np.round(angles / (2.0 * np.pi))
    for i, angle in enumerate(angles):
        room = np.stack([angle - 1e-6, angle + 1e-6], axis=-1)
        arcs = allowed(measures[i], room)
        swung, there = nearest_swing(arcs, np.array(3.0))
        assert there
        assert abs(np.angle(np.exp(1j * swung))) < 1e-4


def test_no_swing_where_the_hand_is_turned_too_far():
    place = np.tile([0.35, 0.1, -0.2], (500, 1))
    rotation = random_rotations(np.random.default_rng(6), 500)
    swing = swing_of(KEN, Wrist(place, rotation), np.array([0.0, -1.0, 0.0]))
    arcs = allowed(swing.measures(), LIMITS)
    none = np.isnan(arcs[:, 0, 0])
    assert 100 < none.sum() < 450
    over = at_many(swing, np.linspace(-np.pi, np.pi, 720))
    assert over[none].min() > 0.0
    phi, there = nearest_swing(arcs, np.full(500, 0.7))
    assert np.array_equal(there, ~none)
    assert np.all(phi[none] == 0.7)


def test_the_whole_circle_is_one_arc():
    links = random_links(np.random.default_rng(7), KEN, 50)
    swing, _ = swings_of(links)
    arcs = allowed(swing.measures(), np.tile([-np.pi, np.pi], (6, 1)))
    assert np.array_equal(arcs[:, 0], np.tile([-np.pi, np.pi], (len(links), 1)))
    assert np.isnan(arcs[:, 1:]).all()
    phi, there = nearest_swing(arcs, np.full(len(links), 2.5))
    assert there.all()
    assert np.all(phi == 2.5)


def test_half_a_turn_of_a_joint_passes_for_no_limit_met():
    """Where a shoulder is turned by half a turn its measure is 0 / 0: no arc begins there."""
    square, product = np.array([0.5, 0.0, 0.5]), np.array([0.0, 0.5, 0.0])  # cos^2 and cos sin of phi / 2
    measures = np.stack([square, product])[None]
    arcs = allowed(measures, np.array([[-1.0, 1.0]]))
    assert np.allclose(arcs[0], [-1.0, 1.0])
    assert np.isnan(arcs[1]).all()


@pytest.mark.parametrize(("wanted", "got"), [(0.5, 0.5), (1.4, 1.0), (-1.7, -1.0), (7.0, 7.0), (6.0, 6.0), (4.9, 5.28)])
def test_the_nearest_swing_is_the_short_way_round(wanted, got):
    arcs = np.array([[-1.0, 1.0], [np.nan, np.nan]])
    phi, there = nearest_swing(arcs, np.array(wanted))
    assert there
    assert phi == pytest.approx(got, abs=0.01)


def test_the_nearest_of_two_arcs():
    arcs = np.array([[-1.0, 0.0], [1.0, 2.0], [np.nan, np.nan]])
    for wanted, got in ((0.4, 0.0), (0.6, 1.0), (2.2, 2.0), (-2.5, -1.0), (-3.5, -4.283)):
        assert nearest_swing(arcs, np.array(wanted))[0] == pytest.approx(got, abs=0.001)


def test_the_shoulder_alone():
    links = random_links(np.random.default_rng(8), KEN, 50)
    swing, _ = swings_of(links)
    wide = allowed(swing.measures()[..., SHOULDER, :, :], LIMITS[SHOULDER])
    narrow = allowed(swing.measures(), LIMITS)
    phi = np.linspace(-np.pi, np.pi, 360)
    assert np.all(on_arcs(wide, phi) | ~on_arcs(narrow, phi))


@pytest.mark.parametrize("far", [0.0, 0.05, 0.3, 0.6, 1.0])
def test_too_far_and_too_near_are_named_with_their_distance(far):
    L1, L2 = KEN.lengths
    most = KEN.limits[1, 1, 1]
    shortest = np.sqrt(L1**2 + L2**2 + 2 * L1 * L2 * np.cos(most))
    place = np.array([0.6, 0.48, -0.64]) * far
    swing = swing_of(KEN, Wrist(place, np.array([1.0, 0, 0, 0])), np.array([0.0, 0.0, 1.0]))
    expected = min(far - shortest, 0.0) + max(far - L1 - L2, 0.0)
    assert swing.missing == pytest.approx(expected, abs=1e-9)
    got = wrist_of(KEN, swing.links(np.array(0.4))).place
    assert np.linalg.norm(got) == pytest.approx(far - expected, abs=1e-9)
    if far:
        assert np.allclose(np.cross(got, place), 0.0, atol=1e-9)
    assert swing.bend <= most + 1e-12


def test_a_side_along_the_line_is_no_side_and_any_serves():
    place = np.array([[0.4, 0.0, 0.0], [0.0, 0.4, 0.0], [0.0, 0.0, 0.4]])
    swing = swing_of(KEN, Wrist(place, np.tile([1.0, 0, 0, 0], (3, 1))), place)
    assert np.allclose(wrist_of(KEN, swing.links(np.zeros(3))).place, place, atol=1e-12)
