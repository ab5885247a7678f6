"""A foot that turns far in one swing: how fast it and its leg turn, and how suddenly a knee does."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.motion.easing import minimum_jerk
from ahmss.walking.evening import evened
from ahmss.walking.library import RATE

from . import measures as m
from .measures import Goal

LEGS = [INDEX[f"{side}_{link}"] for side in ("right", "left") for link in ("upper_leg", "lower_leg", "foot")]
FASTEST = 9.0  # degrees in a frame, of a leg in a step that turns by up to 130
QUICKEST = 4.85  # m/s, of a foot: a straight step at an ordinary pace has 4.7 at the most
SUDDEN = 5.5  # degrees in a frame more than in the one before, of a knee
WALKS = [
    (1.4, 45.0, 180.0), (1.5, 170.0, 90.0), (2.0, -90.0, -150.0), (0.6, -120.0, -120.0), (0.9, 135.0, 135.0),
    (2.2, 103.0, 103.0),
]  # fmt: skip


def turn(degrees: float, frames: int = 22) -> Array:
    return np.radians(degrees) * minimum_jerk(np.linspace(0.0, 1.0, frames + 1))


def test_a_small_turn_stays_as_it_is() -> None:
    heading = turn(50.0)
    assert evened(heading) is heading


@pytest.mark.parametrize("degrees", [-80.0, 90.0, 130.0])
def test_a_great_turn_is_as_great_and_at_a_more_even_pace(degrees: float) -> None:
    heading = turn(degrees)
    made = evened(heading)
    np.testing.assert_allclose(made[[0, -1]], heading[[0, -1]])
    pace = np.degrees(np.diff(made)) * np.sign(degrees)
    assert pace.min() >= 0.0
    assert pace.max() < max(5.6, 1.35 * abs(degrees) / 22.0)
    assert pace.max() < 0.8 * np.degrees(np.abs(np.diff(heading))).max()
    assert np.abs(np.diff(pace, prepend=0.0, append=0.0)).max() < 0.35 * pace.max()  # it begins and ends softly


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize("way", WALKS)
def test_no_leg_turns_too_fast_in_a_walk_that_turns(name: str, way: tuple[float, float, float]) -> None:
    walk, _ = m.walked(Goal(name, 0.0, *way))
    for rotations in (walk.world[:, LEGS], walk.rotations[:, LEGS]):  # in the world, and at the joint
        cos = np.abs((rotations[1:] * rotations[:-1]).sum(axis=-1))
        assert 2.0 * np.degrees(np.arccos(np.clip(cos, 0.0, 1.0))).max() < FASTEST
    assert np.abs(np.diff(m.knee_flexion(walk), 2, axis=0)).max() < SUDDEN
    assert np.linalg.norm(np.diff(walk.ankles, axis=0), axis=-1).max() * RATE < QUICKEST
