"""What the subject performs: balanced, feet planted, in the times and angles that people were measured to take."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.inverse import LEFT_HAND, RIGHT_HAND, grips
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.capture.performance import Performance, of_clip
from ahmss.capture.subject import PERFORMANCES, Box, Door, Seat, perform
from ahmss.capture.subject.chair import seated_hips, sit, stand_up
from ahmss.capture.subject.door import on_lever
from ahmss.motion.clip import Clip
from ahmss.motion.contact import foot_points
from ahmss.motion.poser import centre_of_mass
from ahmss.motion.quality import measure

BODIES = {"ken": Skeleton.of(1.76, "male", "ken"), "aiko": Skeleton.of(1.62, "female", "aiko")}
KEN = BODIES["ken"]
RATE = 30.0  # half of what a tracker sees, to be quick
READY = 87  # frames before the motion: two seconds upright, then ready
WALKS_REAL = 259.0  # rad/s2: what joints accelerate at most in the calmest of the real walks measured


@cache
def performed(name: str, body: str = "ken") -> Performance:
    return perform(name, BODIES[body], rate=RATE)


@cache
def played(move: str) -> tuple[Array, Array, Array]:
    """Times, rotations and root of a motion at the chair by itself."""
    time = np.arange(0.0, 2.3, 1.0 / RATE)
    return time, *{"sit": sit, "stand_up": stand_up}[move](KEN, Seat(), time)


def trunk(rotations: Array, root: Array) -> Array:
    """Degrees (F,) that the line from the hips to the neck is ahead of upright."""
    places, _ = forward(rotations, root, KEN.offsets)
    line = places[:, INDEX["head"]] - root
    return np.degrees(np.arctan2(line[:, 0], line[:, 2]))


def knee(rotations: Array) -> Array:
    return np.degrees(np.linalg.norm(to_rotation_vector(rotations[:, INDEX["right_lower_leg"]]), axis=-1))


@pytest.mark.parametrize(
    ("name", "body"),
    [*((name, "ken") for name in PERFORMANCES), ("door_open", "aiko"), ("sit", "aiko"), ("lift", "aiko")],
)
def test_it_moves_as_smoothly_as_people_and_its_feet_stand(name: str, body: str) -> None:
    performance = performed(name, body)
    quality = measure(performance.rotations, performance.root, performance.rate, performance.skeleton)
    assert 5.0 < quality.joints.acceleration_max < WALKS_REAL
    assert quality.pop.degrees < 4.0  # at 60 Hz a quarter of that
    points = foot_points(performance.skeleton, performance.rotations, performance.root)
    assert np.ptp(points, axis=0).max() < 0.002
    assert np.abs(points[..., 2]).max() < 0.002


@pytest.mark.parametrize("name", PERFORMANCES)
def test_it_begins_with_the_still_upright_pose(name: str) -> None:
    performance = performed(name)
    first, end = performance.upright
    assert (first, end) == (0, 60)
    upright, root = KEN.upright()
    np.testing.assert_allclose(performance.rotations[first:end], np.broadcast_to(upright, (60, 43, 4)), atol=1e-12)
    np.testing.assert_allclose(performance.root[first:end, 2], root[2], atol=1e-12)
    assert np.abs(performance.rotations[end + 15] - upright).max() > 0.01


@pytest.mark.parametrize("name", ["door_open", "door_close", "lift"])
def test_the_weight_stays_over_the_feet(name: str) -> None:
    performance = performed(name)
    weight = centre_of_mass(KEN, performance.rotations, performance.root)
    sole = foot_points(KEN, performance.rotations[0], performance.root[0]).reshape(-1, 3)
    assert (weight[:, :2] > sole[:, :2].min(axis=0)).all()
    assert (weight[:, :2] < sole[:, :2].max(axis=0)).all()


def test_who_gets_up_has_the_weight_over_the_feet_when_the_seat_is_left_or_is_on_the_way_there() -> None:
    """Hof's extrapolated centre of mass: where it will be by its speed, which is what balance needs."""
    time, rotations, root = played("stand_up")
    weight = centre_of_mass(KEN, rotations, root)
    speed = np.gradient(weight, time, axis=0)
    bound = weight[:, 0] + speed[:, 0] * np.sqrt(weight[:, 2] / 9.81)
    heel, toe = float(KEN.soles[0, 0]), float(KEN.soles[2, 0])
    off = int(np.argmax(root[:, 2] > root[0, 2] + 0.005))
    assert (bound[off:] > heel).all()
    assert (weight[off:, 0] < toe - 0.05).all()


def test_it_stands_up_as_people_do() -> None:
    time, rotations, root = played("stand_up")
    moving = np.flatnonzero(np.linalg.norm(np.gradient(root, time, axis=0), axis=-1) > 0.02)
    seconds = PERFORMANCES["stand_up"].seconds - 3.0
    off = time[int(np.argmax(root[:, 2] > root[0, 2] + 0.005))]
    lean = trunk(rotations, root)
    assert 1.5 <= seconds <= 2.0
    assert 0.30 <= off / seconds <= 0.40
    assert 35.0 < lean.max() < 45.0
    assert abs(time[lean.argmax()] - off) < 0.2
    assert time[moving[-1]] < seconds
    assert knee(rotations)[-1] < 10.0


def test_it_sits_down_in_the_order_reversed_and_a_little_slower() -> None:
    time, rotations, root = played("sit")
    on = time[int(np.argmax(root[:, 2] < root[-1, 2] + 0.005))]
    lean, bend = trunk(rotations, root), knee(rotations)
    assert 1.1 <= PERFORMANCES["sit"].seconds / (PERFORMANCES["stand_up"].seconds - 3.0) <= 1.2
    assert 0.60 <= on / PERFORMANCES["sit"].seconds <= 0.75
    assert 35.0 < lean.max() < 45.0
    assert time[np.argmax(lean > 0.5 * lean.max())] <= time[np.argmax(bend > 0.6 * bend.max())]  # the trunk leans first


def test_the_ankles_are_behind_the_knees_and_the_hands_on_the_thighs_of_who_sits() -> None:
    _, rotations, root = played("sit")
    places, world = forward(rotations[-1], root[-1], KEN.offsets)
    palms = grips(KEN, rotations[-1], root[-1])
    for side, row in (("right", RIGHT_HAND), ("left", LEFT_HAND)):
        behind = places[INDEX[f"{side}_lower_leg"], 0] - places[INDEX[f"{side}_foot"], 0]
        assert 0.05 < behind < 0.10
        thigh = INDEX[f"{side}_upper_leg"]
        on_thigh = rotate(conjugate(world[thigh]), palms[row, :3] - places[thigh])
        assert 0.5 < on_thigh[0] / KEN.tips[thigh, 0] < 0.7
        assert abs(on_thigh[1]) < 0.02
        assert on_thigh[2] > 0.05
        assert rotate(palms[row, 3:], np.array([1.0, 0.0, 0.0]))[2] < -0.9  # the palm looks down
    assert abs(trunk(rotations, root)[-1]) < 5.0


@pytest.mark.parametrize("height", [0.38, 0.43, 0.50])
@pytest.mark.parametrize("body", BODIES)
def test_it_sits_on_chairs_of_any_usual_height(body: str, height: float) -> None:
    skeleton, seat = BODIES[body], Seat(height)
    rotations, root = sit(skeleton, seat, np.array([5.0]))
    np.testing.assert_allclose(root[0], seated_hips(skeleton, seat))
    points = foot_points(skeleton, rotations[0], root[0])
    assert np.abs(points[..., 2]).max() < 1e-3


def test_bending_to_lift_the_trunk_comes_first_and_the_knees_last() -> None:
    performance = performed("lift")
    rotations, root = performance.rotations[READY:], performance.root[READY:]
    lean, bend = trunk(rotations, root), knee(rotations)
    down = slice(0, int(1.45 * RATE))

    def half_way(values: Array) -> int:
        begin, end = values[0], values[down][-1]
        return int(np.argmax((values - begin) / (end - begin) > 0.5))

    _, world = forward(rotations, root, KEN.offsets)
    nod = -rotate(world[:, INDEX["head"]], np.array([0.0, 0.0, -1.0]))[:, 2]
    assert half_way(nod) < half_way(lean) < half_way(bend)
    assert 55.0 < lean.max() < 75.0
    assert 80.0 < bend.max() < 140.0
    hands = grips(KEN, rotations, root)[:, :2, 2].mean(axis=1)
    drop = (root[0, 2] - root[:, 2].min()) / (hands[0] - hands.min())
    assert 0.6 < drop < 0.85
    up = slice(int(1.7 * RATE), None)
    assert np.argmax(bend[up] < 0.5 * bend.max()) < np.argmax(lean[up] < 0.5 * lean.max())  # up again: legs first


def test_the_hands_take_the_box_at_its_sides_and_bring_it_before_the_belly() -> None:
    performance, box = performed("lift"), Box()
    palms = grips(KEN, performance.rotations, performance.root)
    held = READY + int(1.55 * RATE)
    for row, side in ((RIGHT_HAND, -1.0), (LEFT_HAND, 1.0)):
        at = np.array([box.ahead, side * 0.5 * box.width, box.grasp])
        np.testing.assert_allclose(palms[held, row, :3], at, atol=0.006)
    apart = np.linalg.norm(palms[held:, RIGHT_HAND, :3] - palms[held:, LEFT_HAND, :3], axis=-1)
    np.testing.assert_allclose(apart, box.width, atol=0.01)
    assert 0.0 < palms[-1, 0, 2] - performance.root[-1, 2] < 0.25


def test_the_gaze_goes_to_the_lever_before_the_hand_does() -> None:
    performance = performed("door_open")
    rotations, root = performance.rotations[READY:], performance.root[READY:]
    places, world = forward(rotations, root, KEN.offsets)
    head = INDEX["head"]
    to_lever = on_lever(Door()).place - places[:, head]
    to_lever /= np.linalg.norm(to_lever, axis=-1, keepdims=True)
    off = np.degrees(np.arccos(np.sum(to_lever * rotate(world[:, head], np.array([0.0, 0.0, -1.0])), axis=-1)))
    palm = grips(KEN, rotations, root)[:, RIGHT_HAND, :3]
    gone = np.linalg.norm(palm - palm[0], axis=-1)
    looks, reaches = np.argmax(off < 0.5 * (off[0] + off[:30].min())), np.argmax(gone > 0.5 * gone[:38].max())
    assert 0.2 < (reaches - looks) / RATE < 0.8


def test_the_hand_stays_on_the_lever_along_its_arc() -> None:
    performance, door = performed("door_open"), Door()
    palm = grips(KEN, performance.rotations, performance.root)[READY:, RIGHT_HAND, :3]
    moving = palm[int(1.6 * RATE) : int(2.8 * RATE)] - door.hinge.place
    radius = np.linalg.norm(moving[:, :2], axis=-1)
    assert np.ptp(radius) < 0.002
    assert np.ptp(moving[:, 2]) < 0.002
    turned = np.degrees(np.arctan2(moving[:, 1], moving[:, 0]))
    assert 27.0 < abs(turned[-1] - turned[0]) < 30.5
    np.testing.assert_allclose(palm[int(1.3 * RATE)], on_lever(door).place, atol=0.002)


def test_the_hand_is_fastest_before_half_the_way_and_comes_slowly() -> None:
    """Minimum jerk (peak 1.875 times the mean, half way) and the way round in front of the lever, which is slow."""
    performance, begin, end = performed("door_open"), READY + int(0.3 * RATE), READY + int(1.26 * RATE)
    palm = grips(KEN, performance.rotations, performance.root)[begin:end, RIGHT_HAND, :3]
    speed = np.linalg.norm(np.diff(palm, axis=0), axis=-1)
    assert 1.7 < speed.max() / speed.mean() < 2.5
    assert 0.3 < np.argmax(speed) / len(speed) < 0.55
    assert speed.max() * RATE < 1.2


def test_an_unknown_performance_is_told_what_there_is() -> None:
    with pytest.raises(KeyError, match="no performance 'fly'; the subject performs: door_open, door_close, sit"):
        perform("fly", KEN)


def test_a_clip_is_performed_from_upright_without_a_pop() -> None:
    """A clip that begins in full swing, turned away: upright stands where it begins and faces as it does."""
    time = np.arange(0.0, 1.0, 1.0 / RATE)
    rotations, root = sit(KEN, Seat(), 0.6 + time)
    turn = np.array([np.cos(0.6), 0.0, 0.0, np.sin(0.6)])
    rotations, root = rotations.copy(), rotate(turn, root) + np.array([0.4, -0.3, 0.0])
    rotations[:, 0] = multiply(turn, rotations[:, 0])
    clip = Clip(rotations, root, np.ones((len(time), 44)), np.ones((len(time), 2)), RATE)
    performance = of_clip(clip, KEN, 1.5)
    assert performance.upright == (0, 45)
    np.testing.assert_allclose(performance.rotations[-len(time) :], rotations, atol=1e-12)
    assert measure(performance.rotations, performance.root, RATE, KEN).pop.degrees < 0.5
    points = foot_points(KEN, performance.rotations, performance.root)
    assert np.abs(points[0] - points[-1]).max() < 0.03
    assert np.abs(performance.links()[0][0, 0] - performance.root[0]).max() < 1e-12
