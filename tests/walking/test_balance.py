"""The pendulum: what holds of it whatever is pushed at."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.walking.balance import pendulum

RATE, W = 60.0, 3.4


def steps() -> np.ndarray:
    """A few places pushed at, one after another, with a slide between two of them."""
    push = np.zeros((400, 2))
    push[100:180] = [0.3, 0.09]
    push[180:260] = [0.9, -0.09]
    push[260:300] = np.linspace([0.9, -0.09], [1.4, 0.0], 40)
    push[300:] = [1.4, 0.0]
    return push


def test_who_pushes_at_one_place_stays_over_it() -> None:
    push = np.tile([0.4, -0.2], (120, 1))
    np.testing.assert_allclose(pendulum(push, W, RATE), push, atol=1e-12)


@pytest.mark.parametrize("stiffness", [2.0, 3.4, 4.6])
def test_the_weight_falls_away_from_where_is_pushed(stiffness: float) -> None:
    push = steps()
    c = pendulum(push, stiffness, RATE)
    accelerates = np.diff(c, 2, axis=0) * RATE**2
    np.testing.assert_allclose(accelerates, stiffness**2 * (c - push)[1:-1], atol=1e-6)


def test_it_begins_and_ends_at_rest_over_what_is_pushed() -> None:
    push = np.concatenate([np.repeat(steps()[:1], 200, 0), steps(), np.repeat(steps()[-1:], 200, 0)])
    c = pendulum(push, W, RATE)
    np.testing.assert_allclose(c[[0, -1]], push[[0, -1]], atol=1e-4)
    np.testing.assert_allclose(np.diff(c, axis=0)[[0, -1]], 0.0, atol=1e-5)


def test_backwards_in_time_it_is_the_same() -> None:
    np.testing.assert_allclose(pendulum(steps()[::-1], W, RATE)[::-1], pendulum(steps(), W, RATE), atol=1e-9)


def test_the_weight_goes_over_the_foot_before_it_is_pushed_at() -> None:
    c = pendulum(steps(), W, RATE)
    assert c[99, 1] > 0.02  # already on its way to the left, where is pushed from frame 100 on
    assert c[90, 1] > c[80, 1] > c[60, 1] > 0.0


def test_a_step_in_the_push_is_the_known_curve() -> None:
    """p = 0, then 1: c = exp(w t) / 2 before and 1 - exp(-w t) / 2 after (Kajita et al. 2001)."""
    push = np.zeros((1200, 2))
    push[600:] = 1.0
    t = (np.arange(1200) - 599.5) / RATE
    known = np.where(t < 0.0, 0.5 * np.exp(W * t), 1.0 - 0.5 * np.exp(-W * t))
    np.testing.assert_allclose(pendulum(push, W, RATE)[:, 0], known, atol=2e-3)


def test_the_softer_the_smoother() -> None:
    assert np.ptp(pendulum(steps(), 2.0, RATE)[:, 1]) < np.ptp(pendulum(steps(), 4.6, RATE)[:, 1]) < 0.18
