"""When thumb and index finger have hold of a part, and when they lose it."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.skills.leading import _Fingers, stays_held

PINCH, BENT = 1, 85.0


@pytest.mark.parametrize(
    ("opened", "closed", "takes"),
    [(0.0996, 0.0805, True), (0.05, 0.03, True), (0.03, 0.023, True), (0.03, 0.026, False), (0.0996, 0.09, False)],
)
def test_it_is_taken_by_a_fifth_less_or_about_what_is_thick_by_12_mm(
    opened: float, closed: float, *, takes: bool
) -> None:
    hand = _Fingers(150.0)
    hand.seen(150.0, np.full(4, opened), near=True)
    for _ in range(2):  # it comes, and is still
        hand.seen(152.0, np.full(4, closed), near=True)
    assert hand.closes(PINCH, BENT) is takes


@pytest.mark.parametrize(
    ("openings", "stays"),
    [([31.0, 31.0, 30.0], True), ([31.0, 40.0, 47.0], True), ([31.0, 54.0, 65.0], False), ([31.0, 60.0, 31.0], False),
     ([20.4, 16.0, 38.0], False)],
)  # fmt: skip
def test_what_rolls_slowly_stays_held_and_what_comes_apart_is_lost(openings: list[float], *, stays: bool) -> None:
    of_each = 1e-3 * (np.array(openings)[:, None] + np.array([9.0, 0.0, 7.0, 30.0]))  # the nearest finger holds it
    assert stays_held(of_each, np.array([100, 110, 120])) is stays
