"""A hand beside the head: its elbow is found outside of the trunk, and goes there without a leap."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.quaternion import from_axis_angle, multiply, rotate, slerp
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.smoothness import worst_pop
from ahmss.reaching.elbow import hangs, swung
from ahmss.reaching.reacher import Reacher, seat


@pytest.mark.parametrize("side", ["right", "left"])
def test_the_elbow_of_a_hand_at_the_ear_is_out_of_the_trunk(side: str) -> None:
    skeleton = Skeleton.of(1.70, "male")
    rotations, root = skeleton.relaxed()
    reacher, spine = Reacher.of(skeleton, side), seat(skeleton, rotations, root)
    present = reacher.arm.from_pose(rotations[reacher.links])
    begin = reacher.palm(present, spine)
    palm_in = np.array([0.0, -reacher.sign, 0.0])  # to the head
    up = from_axis_angle(np.array([0.0, 0.0, 1.0]), float(np.arctan2(palm_in[1], palm_in[0])))
    tilts = from_axis_angle(palm_in, -reacher.sign * np.radians([0.0, 25.0, 50.0, 75.0]))
    ends = np.concatenate([np.tile([0.09, reacher.sign * 0.13, 1.55], (4, 1)), multiply(tilts, up)], axis=1)
    cost, _ = hangs(reacher, ends, spine, present)
    end = ends[int(cost.argmin())]
    share = minimum_jerk(np.arange(1, 91) / 90)
    places = begin[:3] + share[:, None] * (end[:3] - begin[:3]) + 0.3 * np.sin(np.pi * share)[:, None] * [1.0, 0.0, 0.0]
    palms = np.concatenate([places, slerp(np.tile(begin[3:], (90, 1)), end[3:], share)], axis=1)
    many = np.repeat(spine[0][None], 90, axis=0), np.repeat(spine[1][None], 90, axis=0)
    arm = swung(reacher, palms, many, present)
    links = reacher.arm.from_pose(arm)
    assert np.abs(reacher.palm(links, many)[:, :3] - palms[:, :3]).max() < 1e-6
    assert worst_pop(arm).degrees < 1.0
    elbow = rotate(multiply(reacher.arm.rotation, links[-1, 0]), np.array([reacher.arm.lengths[0], 0.0, 0.0]))
    at_spine = reacher.arm.place + elbow
    assert np.hypot(at_spine[1] / 0.17, at_spine[2] / 0.13) > 1.0
