"""Others who tell where they will be are where they tell, and who tells nothing is guessed."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.motion.way import AHEAD, staying
from ahmss.walking.walkers import LOOKED, Walker

STILL = np.zeros((40, 2))
SINCE = np.arange(40) / 60.0


def telling(at: Callable[[Array], Array]) -> Walker:
    """Somebody who has stood at (0, 0), and tells that they will be at `at` (n, 2) of seconds (n,)."""
    return Walker.of(SINCE, STILL, "aiko", way=at(AHEAD))


def curve(seconds: Array) -> Array:
    """A bend that is walked, with the hips' sway."""
    x = 1.2 * np.sin(seconds) + 0.1 * np.sin(0.9 * seconds)
    return np.stack([x, 1.2 * (1.0 - np.cos(seconds)) + 0.02 * np.sin(5.7 * seconds)], axis=-1)


def test_who_tells_is_where_they_tell_and_not_where_they_were_seen_to_go() -> None:
    other = telling(curve)
    np.testing.assert_allclose(other.after(AHEAD), curve(AHEAD), atol=1e-9)
    np.testing.assert_allclose(other.after(np.array(0.0)), [0.0, 0.0], atol=1e-9)
    assert np.linalg.norm(other.after(LOOKED) - curve(LOOKED), axis=-1).max() < 0.04
    np.testing.assert_allclose(other.after(LOOKED), other.after(LOOKED.copy()), atol=1e-12)
    assert other.name == "aiko"
    assert not other.stays


def test_who_tells_nothing_stands_where_they_are_seen_to_stand() -> None:
    assert Walker.of(SINCE, STILL).stays
    assert not Walker.of(SINCE, SINCE[:, None] * [1.0, 0.0]).stays
    assert telling(lambda seconds: np.zeros((len(seconds), 2))).stays


def test_nobody_guesses_what_is_told() -> None:
    other = telling(lambda seconds: seconds[:, None] * [0.4, 0.0])
    assert [*other.may_go()] == [other]
    assert len([*Walker(other.place, other.velocity).may_go()]) > 1


def test_later_they_tell_the_rest_of_it() -> None:
    other = telling(lambda seconds: seconds[:, None] * [0.6, -0.9]).later(0.3)
    np.testing.assert_allclose(other.place, [0.18, -0.27], atol=1e-9)
    np.testing.assert_allclose(other.after(LOOKED), other.place + LOOKED[:, None] * [0.6, -0.9], atol=1e-9)
    guessed = Walker(np.zeros(2), np.array([0.6, -0.9])).later(0.3)
    np.testing.assert_allclose(guessed.place, [0.18, -0.27])


@pytest.mark.parametrize(
    ("speeds", "then"),
    [
        ((1.0, 1.0, 1.0, 1.0, 1.0, 1.0), 1.0),
        ((0.0, 0.0, 0.0, 0.0, 0.2, 0.6), 1.1),  # they have turned, and set out
        ((1.2, 1.2, 1.2, 1.0, 0.6, 0.1), 0.0),  # they arrive
        ((0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.0),
    ],
)
def test_beyond_what_they_tell_they_go_on_as_at_its_end(speeds: tuple[float, ...], then: float) -> None:
    along = np.cumsum(np.array(speeds) * 0.4)
    other = Walker(np.zeros(2), np.zeros(2), way=along[:, None] * [0.0, 1.0])
    on = other.after(np.array([2.4, 6.4, 8.4]))[:, 1]
    assert on[0] == pytest.approx(along[-1])
    assert (on[2] - on[1]) / 2.0 == pytest.approx(then, abs=0.01)


def test_of_two_just_one_goes_first() -> None:
    here, there = Walker(np.array([1.0, 2.0]), np.zeros(2)), Walker(np.array([1.6, 1.2]), np.zeros(2))
    assert here.precedes(there.place) != there.precedes(here.place)
    assert here.precedes(there.place, 1.0)
    assert there.precedes(here.place, 1.0)  # both, if either may be


def test_who_stays_tells_one_place() -> None:
    way = staying(np.array([1.0, 2.0]))
    np.testing.assert_array_equal(way, [[1.0, 2.0]] * len(AHEAD))
