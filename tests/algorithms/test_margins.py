"""Margins of something flat: other edges than the one at which it is held, where a hand can take it."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.algorithm import HumanTask, Transform
from ahmss.skills.margins import margins

from .devices import at, begun, device
from .scene import Body


@pytest.mark.parametrize(("name", "side"), [("ken", "right"), ("aiko", "left")])
def test_a_manual_is_taken_at_the_other_margins(name: str, side: str) -> None:
    body, frame = Body(name, 0.0, 0.0, 0.0), at(0.5, 0.0, 1.05, np.pi)
    task = HumanTask(begun(body, device("manual", frame, shaped=True), "", {}))
    found = margins(task, side)
    assert found
    for margin in found:
        x, y, z = margin.site.position
        assert (x, y) in [pytest.approx(one, abs=1e-6) for one in ((-0.103, 0.0), (0.0, 0.068), (0.0, -0.068))]
        assert z == pytest.approx(0.0017)
        inward = Transform(np.zeros(3), np.array(margin.site.rotation)).apply(np.array([1.0, 0.0, 0.0]))
        assert inward @ np.array([x, y, 0.0]) < -0.05  # the hand comes from outside
        own = frame.inverse().apply(margin.palms[:, :3])
        assert (own @ inward < -0.12).all()
        assert np.linalg.norm(own - np.array([x, y, z]), axis=1).max() < 0.2


def test_what_has_no_edge_to_take_has_no_margins() -> None:
    body = Body("ken")
    assert margins(HumanTask(begun(body, device("cup", at(0.5, 0.0, 1.0), shaped=True), "", {})), "right") == []
