"""A hand is not driven into what it closes on, as its own arm brings it there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.algorithm import HumanTask, Transform
from ahmss.body.quaternion import rotate
from ahmss.errors import AlgorithmError
from ahmss.motion.steps import finished
from ahmss.skills import grasping
from ahmss.skills.closing_depth import closing_depth
from ahmss.skills.grasping import closing, field_at
from tests.algorithms.test_grasp import before_a_box

SIZE, MOST = (0.05, 0.06, 0.12), 0.12


@pytest.mark.parametrize("side", ["right", "left"])
def test_a_palm_that_comes_on_too_far_drives_its_fingers_into_a_box(side: str, tmp_path: Path) -> None:
    _, start, frame, _ = before_a_box("ken", side, tmp_path, SIZE)
    task = HumanTask(start)
    made = finished(closing(task, side, MOST))
    field = field_at(task, np.array([0.0, 0.0, 0.07]))
    across = rotate(frame.rotation, np.array([0.0, 0.008, 0.0]))
    depths = [
        float(closing_depth(task, side, field, Transform(made.palm.place + by * across, made.palm.rotation).row(),
                            (made.shape, made.wide), made.spine, made.out, made.by)[-1])
        for by in (-1.0, 0.0, 1.0)
    ]  # fmt: skip
    assert depths[1] < 0.002
    assert depths[0] == pytest.approx(0.008, abs=0.002)
    assert depths[2] == pytest.approx(0.008, abs=0.002)


def test_a_closing_that_drives_a_finger_into_it_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _, start, _, _ = before_a_box("ken", "right", tmp_path, SIZE)
    monkeypatch.setattr(grasping, "closing_depth", lambda *_: np.array([-0.01, 0.0044, 0.0]))
    with pytest.raises(AlgorithmError, match=r"the right hand would be 4 mm in box as it closes; reach for it"):
        finished(closing(HumanTask(start), "right", MOST))


def test_one_that_keeps_out_when_it_opens_wider_is_taken(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _, start, _, _ = before_a_box("ken", "right", tmp_path, SIZE)
    seen: list[float] = []

    def depth(*given: object) -> np.ndarray:
        out = given[6]
        assert isinstance(out, float)
        seen.append(out)
        return np.array([0.006, -0.01, 0.004 if len(seen) < 4 else 0.001])  # in it already at first

    monkeypatch.setattr(grasping, "closing_depth", depth)
    made = finished(closing(HumanTask(start), "right", MOST))
    assert made.out == seen[3] == 0.08
    assert made.wide is not None
