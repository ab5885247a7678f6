"""A foot on its way goes round the leg that bears, on its own side, and only where it would brush it."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.walking.passing import around

U = np.linspace(0.0, 1.0, 25)
STOOD = np.array([0.4, 0.0])


def swung(aside: float, *, sign: float = 1.0, turned_in: bool = False, heading: float = 0.0) -> np.ndarray:
    """A straight swing along +x, so far to the foot's own side, past a foot that stands in its middle."""
    ankle = np.stack([0.8 * U, np.full(len(U), sign * aside)], axis=-1)
    return around(ankle, U, (STOOD, heading), np.array([0.8, 0.0]), sign, turned_in=turned_in)


def test_who_has_room_goes_straight() -> None:
    assert not swung(0.1).any()


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("aside", [0.05, 0.0, -0.03])
def test_who_would_brush_the_other_leg_goes_round_on_its_own_side(aside: float, sign: float) -> None:
    by = swung(aside, sign=sign)
    assert sign * (by[12, 1] + sign * aside) == pytest.approx(0.09)
    assert np.abs(by[:, 0]).max() < 1e-12
    assert np.abs(by[[0, -1]]).max() == 0.0
    assert np.abs(np.diff(by[:3], axis=0)).max() < 0.003  # it leaves and lands softly


def test_a_leg_that_is_turned_in_goes_further_round() -> None:
    assert swung(0.05, turned_in=True)[12, 1] == pytest.approx(0.07)


def test_who_turns_on_the_spot_or_does_not_pass_is_left_alone() -> None:
    assert not swung(0.0, heading=np.radians(80.0)).any()
    ankle = np.stack([0.3 * U, np.zeros(len(U))], axis=-1)  # ends before the other foot
    assert not around(ankle, U, (STOOD, 0.0), np.array([0.3, 0.0]), 1.0, turned_in=False).any()
