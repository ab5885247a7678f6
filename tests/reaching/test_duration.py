"""How long a reach takes."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.reaching.duration import reach_time


@pytest.mark.parametrize("distance", [0.30, 0.40])
def test_a_relaxed_reach_takes_what_people_take(distance: float) -> None:
    assert 0.7 < reach_time(distance, 0.0, 0.0) < 1.0


def test_twice_as_far_or_half_as_wide_is_one_bit_more() -> None:
    bit = reach_time(0.2, 0.0, 0.0) - reach_time(0.1, 0.0, 0.0)
    assert bit == pytest.approx(0.12)
    assert reach_time(0.1, 0.0, 0.0, 0.02) - reach_time(0.1, 0.0, 0.0, 0.04) == pytest.approx(bit)


def test_no_palm_and_no_trunk_is_faster_than_it_can_be() -> None:
    assert 1.875 * 1.2 / reach_time(1.2, 0.0, 0.0) <= 0.951
    assert 1.875 * np.radians(60.0) / reach_time(0.3, 0.0, np.radians(60.0)) <= 1.301
    assert 1.875 * np.pi / reach_time(0.3, np.pi, 0.0) <= 4.501
