"""A foot on its way goes round the leg that bears, on its own side, and only where the legs would brush."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.walking.passing import around

U = np.linspace(0.0, 1.0, 25)
STOOD = np.array([0.4, 0.0])


def swung(
    aside: float, *, sign: float = 1.0, turned: float = 0.0, faces: float = 0.0, way: float = 0.8
) -> tuple[np.ndarray, np.ndarray]:
    """The ankle of a straight swing along +x, so far to the foot's own side, past a foot that stands; and as moved."""
    ankle = np.stack([way * U, np.full(len(U), sign * aside)], axis=-1)
    heading = np.full(len(U), -sign * np.radians(turned))
    return ankle, ankle + around(ankle, U, heading, (STOOD, np.radians(faces)), np.array([way, 0.0]), sign)


def test_who_has_room_goes_straight() -> None:
    ankle, moved = swung(0.115)
    assert (ankle == moved).all()


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("aside", [0.05, 0.0, -0.03])
def test_who_would_brush_the_other_leg_goes_round_on_its_own_side(aside: float, sign: float) -> None:
    ankle, moved = swung(aside, sign=sign)
    by = moved - ankle
    assert sign * moved[12, 1] >= 0.09 - 1e-12
    assert (sign * by[1:-1, 1] > 0.0).all()
    assert np.abs(by[:, 0]).max() < 1e-12
    assert np.abs(by[[0, -1]]).max() == 0.0
    assert np.abs(np.diff(by[:3], axis=0)).max() < 0.003  # it leaves and lands softly
    assert np.abs(np.diff(by[-3:], axis=0)).max() < 0.003


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_leg_that_is_turned_in_goes_further_round_and_sooner(sign: float) -> None:
    straight, turned = (sign * (swung(0.1, sign=sign, turned=angle)[1][:, 1] - sign * 0.1) for angle in (0.0, 30.0))
    assert turned.max() > straight.max() + 0.05
    assert (turned[:10] > straight[:10] - 1e-12).all()
    assert np.argmax(turned) < 12  # its knee, ahead of its foot, passes the other leg before the foot does


def test_a_leg_that_is_turned_out_is_left_alone() -> None:
    ankle, moved = swung(0.1, turned=-30.0)
    assert (ankle == moved).all()


def test_who_turns_on_the_spot_or_does_not_pass_is_left_alone() -> None:
    for ankle, moved in (swung(0.0, faces=80.0), swung(0.0, way=0.3)):  # the last ends before the other foot
        assert (ankle == moved).all()
