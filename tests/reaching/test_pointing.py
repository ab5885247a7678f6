"""A hand that points touches with its finger's skin what it is to touch, however it comes, and comes no deeper."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from ahmss.algorithm import Transform
from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import from_axis_angle, rotate
from ahmss.reaching.pointing import palms_pointing, pointing
from tests.algorithms.scene import WORKSPACE
from tests.algorithms.touching import skin_of, touched

X, Y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
PLACE = np.array([0.4, -0.2, 1.1])


@cache
def skin_of_hand(name: str, side: str) -> Array:
    """The skin of a pointing hand, triangles (n, 3, 3) in the palm's frame."""
    skin, (rotations, root) = skin_of(name), WORKSPACE.humans.get(name).skeleton.upright()
    rotations = rotations.copy()
    rotations[list(fingers(side))] = pointing(side)
    hand = np.isin(skin.link, [*fingers(side), INDEX[f"{side}_hand"]])
    posed = skin.posed(rotations, root, np.arange(len(skin.vertices)))[skin.faces[hand[skin.faces].any(axis=1)]]
    palm = Transform.of(grips(skin.skeleton, rotations, root)[0 if side == "right" else 1])
    return palm.inverse().apply(posed)


@pytest.mark.parametrize("slope", [0.0, 20.0, 45.0, 70.0, 90.0])
@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_the_skin_of_every_palm_is_at_the_place_and_no_deeper(name: str, side: str, slope: float) -> None:
    """A face that slopes, 90 degrees: upright. Where the tip of the bone was there, skin was up to 3 mm in it."""
    out = rotate(from_axis_angle(Y, np.radians(slope - 90.0)), X)
    palms = palms_pointing(WORKSPACE.humans.get(name).skeleton, side, PLACE, -out, -X)
    places = np.array([touched(Transform.of(palm).apply(skin_of_hand(name, side)), -out) for palm in palms]) - PLACE
    depth = -places @ out
    assert depth.max() < 0.0007
    assert depth.min() > -0.0012  # a shown skin has flat faces, some of which cut off a part of the pad
    assert np.linalg.norm(places + depth[:, None] * out, axis=1).max() < 0.002
