"""Thumb and index finger alone: the fist of the others keeps out of what they hold."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.grasping.hand import Hand
from ahmss.grasping.key_grip import CURLED, curled
from ahmss.grasping.rolling import rolled

from .shapes import WORKSPACE, field, thing
from .test_grips import held

LEANS = np.radians([(tilt, roll) for tilt in (-60.0, -40.0, 0.0, 40.0, 60.0) for roll in (-40.0, 0.0, 40.0)])
X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


def leant(site: Array, palm: Array, tilt: float, roll: float) -> Array:
    """A palm (7,) turned about what it holds."""
    across, into = rotate(site[3:], Z), rotate(site[3:], X)
    turn = multiply(from_axis_angle(across, np.array(tilt)), from_axis_angle(into, np.array(roll)))
    return np.concatenate([site[:3] + rotate(turn, palm[:3] - site[:3]), multiply(turn, palm[3:])])


@pytest.mark.parametrize("side", ["right", "left"])
def test_a_finger_that_would_be_in_what_is_held_makes_a_closer_fist(side: str) -> None:
    """A knob's bar was up to 4 mm in the middle finger of who turned it with the hand aslant."""
    holding, solid, site = held("knob", "aiko", side), field("knob"), thing("knob").site
    assert holding is not None
    hand = Hand.of(WORKSPACE.humans.get("aiko").skeleton, side)
    loose, close = list[float](), list[float]()
    for tilt, roll in LEANS:
        palm = leant(site, holding.palm, tilt, roll)[None]
        grip = rolled(hand, solid, palm, holding)[0]
        for gaps, made in ((loose, curled(hand, grip)), (close, curled(hand, grip, solid, palm))):
            gaps.append(float(hand.gaps(solid, palm, made.shape[None])[0, 5:].min()))
            np.testing.assert_allclose(made.flexion[3], CURLED[2])  # the little finger is nowhere near
            np.testing.assert_allclose(made.flexion[0], grip.flexion[0])
    assert min(loose) < -0.0015
    assert min(close) > -0.0005
