"""A score: numbers of a posture that move by minimum jerk, overlapping movements adding up."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.capture.subject.score import Move, Score
from ahmss.motion.poser import STANDING, Posture


def test_a_number_goes_from_rest_to_rest_by_minimum_jerk() -> None:
    score = Score(STANDING, Move(1.0, 2.0, {"lean": 20.0}))
    assert score.at(0.5).lean == score.at(1.0).lean == STANDING.lean
    assert score.at(1.5).lean == pytest.approx(10.0)
    assert score.at(3.0).lean == pytest.approx(20.0)
    speed = (score.at(1.501).lean - score.at(1.499).lean) / 0.002
    assert speed == pytest.approx(1.875 * 20.0, rel=1e-4)


def test_movements_that_overlap_add_up_and_do_not_stop_between() -> None:
    score = Score(STANDING, Move(0.0, 1.0, {"lean": 30.0}), Move(0.7, 1.7, {"lean": 0.0}))
    lean = np.array([score.at(t).lean for t in np.linspace(0.0, 1.7, 171)])
    alone = Score(STANDING, Move(0.0, 1.0, {"lean": 30.0}))
    back = Score(Posture(lean=30.0), Move(0.7, 1.7, {"lean": 0.0}))
    assert lean[80] == pytest.approx(alone.at(0.8).lean + back.at(0.8).lean - 30.0)
    assert 25.0 < lean.max() < 30.0  # it turns round before it is there
    assert lean[-1] == pytest.approx(0.0, abs=1e-9)


def test_numbers_of_arms_and_places_are_named_too() -> None:
    posture = Posture(hips=(0.0, 0.0, 0.9))
    score = Score(posture, Move(0.0, 1.0, {"arms.elbow": 90.0, "right_arm.forward": 40.0, "hips.2": 0.5}))
    at_end = score.at(1.0)
    assert at_end.right_arm.elbow == at_end.left_arm.elbow == pytest.approx(90.0)
    assert at_end.right_arm.forward == pytest.approx(40.0)
    assert at_end.left_arm.forward == posture.left_arm.forward
    assert at_end.hips == pytest.approx((0.0, 0.0, 0.5))
    assert at_end.lean == posture.lean


def test_a_number_that_there_is_not() -> None:
    with pytest.raises(AttributeError, match="wings"):
        Score(STANDING, Move(0.0, 1.0, {"wings": 1.0}))
