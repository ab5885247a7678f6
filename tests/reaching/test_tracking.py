"""An arm after a palm from frame to frame: there in the end, never beyond its limits, never with a jerk."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from ahmss.body.arm import excess
from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.smoothness import angular_steps, pops
from ahmss.reaching.comfort import palms_at
from ahmss.reaching.prism import Prism
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.tracking import Tracking, speed_towards

HUMAN = Skeleton.of(1.7)
ROTATIONS, ROOT = HUMAN.relaxed()
SEAT = seat(HUMAN, ROTATIONS, ROOT)
GIVES = 3.0  # degrees
# Hands are mirror images: the other one is seen to in the long tests.
SIDES = ["right", pytest.param("left", marks=pytest.mark.long)]
MIRRORED = ["left", pytest.param("right", marks=pytest.mark.long)]


class Arm:
    """One that hangs, and then tracks."""

    def __init__(self, side: str) -> None:
        self.reacher = Reacher.of(HUMAN, side)
        self.tracking = Tracking(self.reacher, self.reacher.arm.from_pose(ROTATIONS[self.reacher.links]))
        self.links = [self.tracking.links]

    def go(self, palm: Array, frames: int, time: float = 0.5, near: Sequence[Prism] = ()) -> Array:
        """The palm (7,) that it has after so many frames."""
        for _ in range(frames):
            had = self.tracking.step(palm, SEAT, time, near)
            self.links.append(self.tracking.links)
        return had

    def easy(self, ahead: float, up: float) -> Array:
        """A palm so far ahead of the shoulder and above it, turned naturally."""
        shoulder = self.reacher.shoulder(SEAT)
        place = shoulder + np.array([ahead, 0.0, up])
        return np.append(place, palms_at(shoulder, place, self.reacher.sign)[40])

    def elbow(self) -> Array:
        """Where the elbow is (3,), world."""
        upper = multiply(SEAT[1], multiply(self.reacher.arm.rotation, self.tracking.links[0]))
        return self.reacher.shoulder(SEAT) + self.reacher.arm.lengths[0] * rotate(upper, np.array([1.0, 0.0, 0.0]))

    @property
    def jerk(self) -> float:
        """The worst pop, degrees."""
        return float(pops(np.array(self.links)).max())

    @property
    def over(self) -> Array:
        """Degrees over the limits, frame by frame."""
        return np.degrees(excess(self.reacher.arm, np.array(self.links)))


@pytest.mark.parametrize("side", MIRRORED)
def test_it_comes_to_a_place_that_leaps_without_a_jerk(side: str) -> None:
    arm = Arm(side)
    for palm in (arm.easy(0.35, -0.2), arm.easy(0.3, 0.1)):
        had = arm.go(palm, 120)
        np.testing.assert_allclose(had[:3], palm[:3], atol=1e-4)
        assert abs(had[3:] @ palm[3:]) > 1.0 - 1e-6
    assert 0.3 < arm.jerk < 1.3


@pytest.mark.parametrize("side", ["right", "left"])
def test_the_palm_it_tells_is_the_one_it_has(side: str) -> None:
    arm = Arm(side)
    had = arm.go(arm.easy(0.35, -0.2), 20)
    pose = ROTATIONS.copy()
    pose[arm.reacher.links] = arm.reacher.arm.into_pose(arm.tracking.links)
    np.testing.assert_allclose(grips(HUMAN, pose, ROOT)[arm.reacher.row][:3], had[:3], atol=1e-9)


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("degrees", [-150.0, -80.0, 80.0, 150.0])
def test_a_turn_that_the_joints_forbid_is_left_out_and_the_place_is_kept(side: str, degrees: float) -> None:
    arm = Arm(side)
    palm = arm.easy(0.35, -0.2)
    out = rotate(palm[3:], np.array([1.0, 0.0, 0.0]))
    palm[3:] = multiply(from_axis_angle(out, np.radians(degrees)), palm[3:])
    had = arm.go(palm, 150)
    assert np.linalg.norm(had[:3] - palm[:3]) < 0.01
    assert arm.over[-1] < GIVES + 0.5
    assert arm.over.max() < 10.0  # on the way
    assert arm.jerk < 1.3


@pytest.mark.parametrize("side", MIRRORED)
def test_what_is_too_far_away_is_stretched_for_and_stiffly_only_at_the_ends(side: str) -> None:
    arm = Arm(side)
    for time, least, most in ((0.0, 0.99, 0.9996), (0.5, 0.91, 0.9201), (1.0, 0.99, 0.9996)):
        palm = arm.easy(1.2, 0.0)
        had = arm.go(palm, 150, time)
        wrist, _ = arm.reacher.hand(had)
        stretched = np.linalg.norm(wrist - arm.reacher.shoulder(SEAT)) / arm.reacher.length
        assert least < stretched < most


@pytest.mark.parametrize("side", MIRRORED)
def test_no_joint_is_fast_at_first_when_what_is_shown_still_catches_up(side: str) -> None:
    for time, least, most in ((0.0, 4.0, 4.41), (0.3, 4.0, 4.41), (0.4, 4.9, 5.21), (0.5, 5.5, 6.01)):
        arm = Arm(side)
        arm.go(arm.easy(0.2, 0.25), 40, time)
        assert least < np.degrees(np.linalg.norm(angular_steps(np.array(arm.links)), axis=-1)).max() < most


def test_a_joint_gains_speed_and_brakes_as_told() -> None:
    now, speed, turned = np.array([1.0, 0.0, 0.0, 0.0]), np.zeros(3), [0.0]
    end = from_axis_angle(np.array([0.0, 0.0, 1.0]), 1.5)
    for _ in range(60):
        speed = speed_towards(now, end, speed, 0.1, 0.02)
        now = multiply(now, from_axis_angle(np.array([0.0, 0.0, 1.0]), speed[2]))
        turned.append(float(speed[2]))
    assert abs(now @ end) > 1.0 - 1e-9
    assert 0.09 < max(turned) < 0.1 + 1e-9
    assert np.abs(np.diff(turned)).max() < 0.02 + 1e-9
    assert min(turned) > -0.05


@pytest.mark.parametrize("side", SIDES)
def test_the_elbow_swings_out_of_what_it_would_be_in(side: str) -> None:
    """Beside it stands a block whose top is as high as the elbow hangs: it comes up, and the palm stays."""
    free, arm = Arm(side), Arm(side)
    palm = free.easy(0.3, -0.1)
    free.go(palm, 150)
    elbow = free.elbow()
    low, high = elbow[:2] - 0.2, elbow[:2] + 0.2
    ring = np.array([low, [high[0], low[1]], high, [low[0], high[1]]])
    block = Prism(ring, 0.0, float(elbow[2]) - 0.02)
    had = arm.go(palm, 150, near=[block])
    assert block.signed(elbow) == pytest.approx(0.02)
    assert block.signed(arm.elbow()) > 0.04
    np.testing.assert_allclose(had[:3], palm[:3], atol=2e-3)
    assert arm.jerk < 2.0
