"""A motion slowed down where a joint would turn too fast."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, slerp
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.pacing import slowed

X = np.array([1.0, 0.0, 0.0])
MOST = np.radians(5.0)


def turning(degrees: float, frames: int, still: int = 30) -> Array:
    """Two joints (n, 2, 4): one stands still, the other turns so far in so many frames, and stands before and after."""
    time = np.concatenate([np.zeros(still), np.arange(frames + 1) / frames, np.ones(still)])
    angle = np.radians(degrees) * minimum_jerk(time)
    return np.stack(
        [np.tile([1.0, 0.0, 0.0, 0.0], (len(time), 1)), from_axis_angle(np.tile(X, (len(time), 1)), angle)], 1
    )


def steps(rotations: Array) -> Array:
    """Degrees (n - 1) of the joint that turns most."""
    cosine = np.abs((rotations[1:] * rotations[:-1]).sum(axis=-1)).min(axis=-1)
    return np.degrees(2.0 * np.arccos(np.clip(cosine, 0.0, 1.0)))


def shown(rotations: Array, at: Array) -> Array:
    first = np.minimum(at.astype(int), len(rotations) - 2)
    return slerp(rotations[first], rotations[first + 1], (at - first)[:, None])


@pytest.mark.parametrize(("degrees", "frames"), [(90.0, 20), (40.0, 12), (150.0, 40)])
def test_no_joint_is_faster_than_asked_and_it_comes_to_the_same_end(degrees: float, frames: int) -> None:
    rotations = turning(degrees, frames)
    assert steps(rotations).max() > 5.5
    at = slowed(rotations, MOST)
    slower = shown(rotations, at)
    assert 4.5 < steps(slower).max() < 5.05
    assert (at[0], at[-1]) == (0.0, len(rotations) - 1.0)
    assert (np.diff(at) > 0.0).all()
    assert np.abs(np.diff(steps(slower))).max() < np.abs(np.diff(steps(rotations))).max()  # more softly than it was


def test_only_what_is_near_is_slowed_down() -> None:
    at = slowed(turning(90.0, 20), MOST)
    assert np.diff(at)[:15] == pytest.approx(1.0, abs=0.02)
    assert np.diff(at)[-15:] == pytest.approx(1.0, abs=0.02)
    assert len(at) < 81 + 25


def test_what_is_slow_is_shown_as_it_is() -> None:
    assert np.array_equal(slowed(turning(40.0, 30), MOST), np.arange(91.0))
    assert np.array_equal(slowed(turning(90.0, 20)[:1], MOST), [0.0])


def test_what_may_not_be_slowed_down_is_not() -> None:
    rotations = turning(90.0, 20)
    free = np.arange(len(rotations)) < 25
    assert np.array_equal(slowed(rotations, MOST, free), np.arange(float(len(rotations))))
