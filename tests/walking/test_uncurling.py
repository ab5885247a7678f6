"""A foot's way through the air: it is left as it is, or goes straighter and more evenly where it would be too fast."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.motion.easing import minimum_jerk
from ahmss.walking.library import RATE
from ahmss.walking.uncurling import uncurled

FAST = 4.5  # m/s


def way(length: float, aside: float, frames: int = 24) -> Array:
    """From the origin along x, on an arc that goes aside, metres."""
    share = minimum_jerk(np.linspace(0.0, 1.0, frames + 1))
    return np.stack([length * share, 4.0 * aside * share * (1.0 - share)], axis=-1)


def speed(places: Array) -> float:
    return float(np.linalg.norm(np.diff(places, axis=0), axis=1).max()) * RATE


def test_a_foot_that_is_slow_enough_keeps_its_way() -> None:
    for kept in (way(0.9, 0.1), way(0.0, 0.1), way(0.9, 0.1)[:2]):
        assert uncurled(kept) is kept


@pytest.mark.parametrize("aside", [0.4, -0.5, 0.8])
def test_a_foot_that_curls_goes_straighter_and_no_faster_than_a_foot_does(aside: float) -> None:
    curled = way(1.1, aside)
    made = uncurled(curled)
    np.testing.assert_allclose(made[[0, -1]], curled[[0, -1]], atol=1e-12)
    assert speed(curled) > FAST + 0.3
    assert speed(made) <= FAST
    assert np.abs(made[:, 1]).max() < 0.8 * abs(aside)
    assert np.linalg.norm(np.diff(made, n=2, axis=0), axis=1).max() * RATE**2 < 90.0  # m/s2: it sets out softly


def test_a_step_too_long_for_that_is_as_fast_as_it_must_be() -> None:
    long = way(2.0, 0.3)
    assert speed(uncurled(long)) < 0.75 * speed(long)
    assert np.abs(uncurled(long)[:, 1]).max() < 0.05
