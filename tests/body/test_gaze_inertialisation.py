"""Spine and head look somewhere, elsewhere, and nowhere: never fast, never with a jerk, never back."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.gaze_inertialisation import TURNED, GazeInertialiser
from ahmss.body.inverse import GAZE, solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, from_rotation_vector, multiply, rotate, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk

RATE = 60.0
SKELETON = Skeleton.of(1.7, "male")
HEAD = INDEX["head"]
NOWHERE = np.zeros(3)
LEFT, RIGHT, CUP = np.array([2.0, 1.5, 1.4]), np.array([2.0, -1.5, 1.2]), np.array([0.5, -0.3, 1.0])


def looked(*places: tuple[Array, int]) -> Array:
    """Poses (n, 43, 4) of who stands and looks at places for so many frames each, nobody turning the head else."""
    pose, root = SKELETON.upright()
    inertialiser, shown = GazeInertialiser(RATE), [pose, pose]
    inertialiser.place(pose)
    for place, count in places:
        looks, source = place.any(), pose.copy()
        if not looks:
            source[TURNED] = inertialiser.rest(shown[-2], shown[-1])
        targets = np.zeros((5, 8))
        targets[GAZE, :3], targets[GAZE, 7] = place, float(looks)
        for k in range(count):
            switched = np.full(2, k == 0)
            out = solve(SKELETON, source, root, targets)
            out[TURNED] = inertialiser.step(out, switched)
            inertialiser.settle(out)
            shown.append(out)
    return np.array(shown[1:])


def steps(shown: Array) -> Array:
    """The head's turns (n - 1, 3) from frame to frame, degrees."""
    return np.degrees(to_rotation_vector(multiply(conjugate(shown[:-1, HEAD]), shown[1:, HEAD])))


def fastest(shown: Array) -> float:
    return float(np.linalg.norm(steps(shown), axis=-1).max())


def pop(shown: Array) -> float:
    """The largest step against its neighbours' mean, degrees."""
    s = steps(shown)
    return float(np.linalg.norm(s[1:-1] - 0.5 * (s[:-2] + s[2:]), axis=-1).max())


def yaw(shown: Array) -> Array:
    """Degrees (n,) to the left."""
    return np.degrees(to_rotation_vector(shown[:, HEAD])[:, 0])


def test_the_gaze_comes_moves_over_and_stays_without_a_jerk() -> None:
    out = looked((LEFT, 60), (RIGHT, 60), (NOWHERE, 60))
    assert pop(out) < 1.0
    assert fastest(out) < 5.0
    assert yaw(out)[60] > 25.0
    assert yaw(out)[120] < -25.0
    assert yaw(out)[-1] == pytest.approx(yaw(out)[120], abs=1e-6)
    _, world = forward(out[60], SKELETON.upright()[1], SKELETON.offsets)
    assert rotate(world[HEAD], np.array([0.0, 0.0, -1.0]))[1] > 0.4


def test_from_one_side_to_the_other_right_before_the_body_is_not_fast() -> None:
    """A place led over from one to the other would pass through the head."""
    left, right = np.array([-0.05, 0.5, 1.5]), np.array([-0.05, -0.5, 1.3])
    out = looked((left, 80), (right, 80))
    assert yaw(out)[80] > 60.0
    assert yaw(out)[-1] < -60.0
    assert fastest(out) < 3.5
    assert pop(out) < 1.0


@pytest.mark.parametrize("cut", [3, 8, 12, 16, 20])
def test_who_ceases_to_look_on_the_way_comes_to_rest_farther_on(cut: int) -> None:
    out = looked((LEFT, 60), (RIGHT, cut), (NOWHERE, 30))
    speed = np.diff(yaw(out))
    before, after = speed[59 + cut], speed[60 + cut :]
    assert before < -0.05
    assert (after < 1e-6).all()  # never back
    assert (np.diff(after[1:]) > -1e-6).all()  # slower and slower
    assert after[0] == pytest.approx(before, abs=1e-3)
    assert np.abs(after[13:]).max() < 1e-6  # 0.2 s and the frame in which it goes on
    assert pop(out) < 1.0


@pytest.mark.parametrize("after", range(1, 40, 6))
def test_a_gaze_that_goes_on_to_the_same_place_goes_on(after: int) -> None:
    """The next motion looks at the same thing while the head is still turning there: as if nothing had changed."""
    once = looked((LEFT, 60), (CUP, 60))
    again = looked((LEFT, 60), (CUP, after), (CUP, 60 - after))
    assert np.abs(yaw(again) - yaw(once)).max() < 1e-9


@pytest.mark.parametrize("cut", range(1, 30, 4))
def test_one_who_looks_here_and_there_too_soon_is_not_fast(cut: int) -> None:
    out = looked((LEFT, 60), (RIGHT, cut), (LEFT, cut), (RIGHT, cut), (CUP, 60))
    assert fastest(out) < 5.0
    assert pop(out) < 1.0


@pytest.mark.parametrize("cut", [8, 11, 14])
def test_a_head_on_its_way_that_is_to_turn_back_is_little_faster_than_its_gazes(cut: int) -> None:
    """Each gaze begins where the last was cut, at rest: what the head still went on then adds three tenths at most."""
    frames, degrees = 30, 4.0 * 30 / 1.875  # at most 4 degrees a frame
    pose, _ = SKELETON.upright()
    inertialiser, shown = GazeInertialiser(RATE), [pose, pose]
    inertialiser.place(pose)
    for way in (1.0, -1.0, 1.0, -1.0):
        begun = shown[-1][HEAD]
        for k in range(cut if way > 0.0 else frames):
            out = pose.copy()
            turn = np.radians([way * degrees * minimum_jerk((k + 1) / frames), 0.0, 0.0])
            out[HEAD] = multiply(begun, from_rotation_vector(turn))
            out[TURNED] = inertialiser.step(out, np.full(2, k == 0))
            inertialiser.settle(out)
            shown.append(out)
    speed = np.diff(yaw(np.array(shown[1:])))
    assert speed.max() > 1.5, "on its way"
    assert 4.0 < -speed.min() < 4.0 / (1.0 - 0.3)
    assert pop(np.array(shown[1:])) < 1.0


def test_a_spine_that_another_holds_a_little_turned_does_not_leap_there() -> None:
    """A stretched arm that hangs on it would turn its elbow by many times as much."""
    pose, _ = SKELETON.upright()
    inertialiser, shown = GazeInertialiser(RATE), [pose, pose]
    inertialiser.place(pose)
    spine = TURNED[0]
    for k in range(80):
        out = pose.copy()
        out[HEAD] = from_rotation_vector(np.radians([20.0, 0.0, 0.0]))
        if k >= 10:
            out[spine] = multiply(out[spine], from_rotation_vector(np.radians([0.3, 0.0, 0.0])))
        out[TURNED] = inertialiser.step(out, np.full(2, k in (0, 10)))
        inertialiser.settle(out)
        shown.append(out)
    turned = np.degrees(to_rotation_vector(multiply(conjugate(pose[spine]), np.array(shown)[:, spine])))[:, 0]
    assert turned[-1] == pytest.approx(0.3)
    assert np.diff(turned).max() < 0.04
