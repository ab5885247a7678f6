"""Fingers are bent so that their pads come where they shall; what is too far they are bent towards."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.links import INDEX, fingers
from ahmss.body.skeleton import Skeleton
from ahmss.grasping.fingertips import Fingertips
from ahmss.grasping.hand import FINGERS


def hand(side: str) -> tuple[Fingertips, Array]:
    """A hand, and its palm's frame with the hand itself at the origin."""
    skeleton = Skeleton.of(1.66, "female")
    return Fingertips.of(skeleton, side), skeleton.grips[0 if side == "right" else 1]


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize("which", FINGERS)
def test_a_pad_comes_to_its_place(side: str, which: str) -> None:
    tips, grip = hand(side)
    towards, i = tips.hand.towards, FINGERS.index(which)
    random = np.random.default_rng(i)
    off = np.stack([random.uniform(0.045, 0.06, 40), towards * random.uniform(0.02, 0.04, 40),
                    random.uniform(-0.008, 0.008, 40)], axis=-1)  # fmt: skip
    places, into = tips.hand.roots[i] + off, np.tile([0.2, 0.98 * towards, 0.0], (40, 1))
    into /= np.linalg.norm(into, axis=1, keepdims=True)
    rotations = np.tile([1.0, 0.0, 0.0, 0.0], (40, 14, 1))
    start = INDEX[f"{side}_{which}_proximal"] - fingers(side)[0]
    rotations[:, start : start + 3] = tips.finger(which, places, into)
    pads = tips.pads(rotations, np.tile(grip, (40, 1)), into[0])[:, 1 + i]
    assert np.linalg.norm(pads - places, axis=1).max() < 3e-4


@pytest.mark.parametrize("side", ["right", "left"])
def test_a_thumb_comes_to_its_place(side: str) -> None:
    tips, grip = hand(side)
    towards = tips.hand.towards
    places = np.array([[0.095, 0.04 * towards, -0.035], [0.09, 0.05 * towards, -0.03]])
    into = np.tile([0.0, towards, 0.0], (2, 1))
    rotations = np.tile([1.0, 0.0, 0.0, 0.0], (2, 14, 1))
    rotations[:, :2] = tips.thumb(places, into)
    pads = tips.pads(rotations, np.tile(grip, (2, 1)), into[0])[:, 0]
    assert np.linalg.norm(pads - places, axis=1).max() < 1e-3


def test_too_far_it_is_stretched_towards_it() -> None:
    tips, _ = hand("right")
    place, into = tips.hand.roots[1] + np.array([[0.2, -0.02, 0.0]]), np.array([[0.0, -1.0, 0.0]])
    apart = np.linalg.norm(tips.pad_of("middle", place, into)[0] - tips.hand.roots[1])
    assert 0.9 * tips.hand.lengths[1].sum() < apart < 1.02 * tips.hand.lengths[1].sum()
