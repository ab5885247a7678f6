"""The balls that stand for a body end where its skin does."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.reaching.whole_body import body_points
from tests.algorithms.scene import Body
from tests.algorithms.solids import skin


@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_shins_feet_hips_and_head_end_where_skin_does(name: str) -> None:
    body, seen = Body(name, 0.0, 0.0, 0.0), skin(name)
    points, radii = body_points(body.skeleton, body.rotations, body.root)
    shown = seen.posed(body.rotations, body.root, np.arange(len(seen.vertices)))
    arms = [INDEX[f"{side}_{part}"] for side in ("right", "left") for part in ("hand", "lower_arm")]
    seen_of_it = ~np.isin(seen.link, arms) & (seen.link < 15)  # neither forearms nor fingers
    for low, high in ((0.0, 0.05), (0.15, 0.45), (0.9, 1.05), (1.2, 1.4), (1.5, 1.6)):  # of the hips' height
        skin_in, balls_in = (
            (at[:, 2] > low * body.root[2]) & (at[:, 2] < high * body.root[2]) for at in (shown, points)
        )
        real, told = shown[skin_in & seen_of_it][:, 0].max(), (points[balls_in][:, 0] + radii[balls_in]).max()
        assert real - told == pytest.approx(0.0, abs=0.015)
