"""Both hands at once, sitting: one bends only as far as people do, whatever is too far for that."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.inverse import grips
from ahmss.body.links import INDEX
from ahmss.body.quaternion import multiply, rotate
from ahmss.reaching.both import Between, posture_for_both
from ahmss.reaching.plan import Reaching
from tests.algorithms.scene import Body


@pytest.mark.parametrize(("ahead", "least", "most"), [(0.4, 0.0, 11.0), (1.1, 19.0, 26.0)])
def test_who_sits_bends_towards_it_and_no_further_than_people_do(ahead: float, least: float, most: float) -> None:
    body = Body("ken")
    reaching = Reaching(body.skeleton, body.rotations, body.root, carried=True)
    hands: dict[str, Between] = {}
    for side, palm in zip(("right", "left"), grips(body.skeleton, body.rotations, body.root), strict=True):
        forward = np.array([np.cos(reaching.heading), np.sin(reaching.heading), 0.0])
        place = palm[:3] + (ahead - (palm[:3] - body.root) @ forward) * forward + np.array([0.0, 0.0, 0.3])
        hands[side] = Between(np.concatenate([place, palm[3:]])[None], np.zeros((1, 3)))
    steps = posture_for_both(reaching, hands, body.root + np.array([1.0, 0.0, 0.0]), ())
    while True:
        try:
            next(steps)
        except StopIteration as end:
            posture, _, _ = end.value["right"]
            break
    up = rotate(multiply(posture.rotations[0], posture.rotations[INDEX["spine"]]), np.array([1.0, 0.0, 0.0]))
    assert least <= np.degrees(np.arccos(np.clip(up[2], -1.0, 1.0))) < most
