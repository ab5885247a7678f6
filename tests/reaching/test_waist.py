"""The waist bends as far as the arm asks."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.waist import bent_towards, wanted_stretch

HUMAN = Skeleton.of(1.7)
ROTATIONS, ROOT = HUMAN.upright()
SPINE = INDEX["spine"]


def bent(side: str, shares: float, direction: tuple[float, float, float]) -> tuple[float, float]:
    """The stretch that is left, and the degrees bent, for a wrist so many arm's lengths from the shoulder."""
    reacher = Reacher.of(HUMAN, side)
    shoulder = reacher.shoulder(seat(HUMAN, ROTATIONS, ROOT))
    wrist = shoulder + shares * reacher.length * np.array(direction) / np.linalg.norm(direction)
    rotations = ROTATIONS.copy()
    rotations[SPINE] = bent_towards(reacher, ROTATIONS[0], ROOT, ROTATIONS[SPINE], wrist)
    after = reacher.shoulder(seat(HUMAN, rotations, ROOT))
    turned = to_rotation_vector(multiply(conjugate(ROTATIONS[SPINE]), rotations[SPINE]))
    return float(np.linalg.norm(wrist - after)) / reacher.length, float(np.degrees(np.linalg.norm(turned)))


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize("direction", [(1.0, 0.0, -0.3), (1.0, 0.5, 0.0), (0.8, -0.6, -0.5)])
def test_the_arm_is_stretched_as_wanted(side: str, direction: tuple[float, float, float]) -> None:
    for shares in (0.5, 0.8, 0.95, 1.1, 1.3):
        left, degrees = bent(side, shares, direction)
        assert left == pytest.approx(float(wanted_stretch(np.array(shares))), abs=1e-6)
        assert (degrees > 0.5) == (shares > 0.9)


def test_it_bends_no_further_than_it_can() -> None:
    left, degrees = bent("right", 4.0, (1.0, 0.0, 0.0))
    assert 40.0 < degrees < 48.1
    assert left > 2.0


def test_help_begins_without_a_step() -> None:
    stretched = np.linspace(0.7, 1.5, 200)
    kept = wanted_stretch(stretched)
    assert (np.diff(kept) > 0.0).all()
    assert np.abs(np.diff(kept, n=2)).max() < 2e-4
    assert kept[-1] < 0.956
