"""What is held to be read: where the other hand comes to it nowhere, it is brought where that misses it least."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
import pytest

from ahmss.algorithm import HumanTask, Transform
from ahmss.body.array import Array
from ahmss.reaching.standing import Posture
from ahmss.skills.reading import brought

from .devices import begun
from .test_taking_up import Scene


@pytest.mark.parametrize("aside", [-1.0, 1.0])
def test_it_is_brought_where_the_other_hand_misses_it_least(aside: float) -> None:
    scene = Scene("ken", "left", "manual", "edge", "eyes")
    missed: list[tuple[float, Array]] = []

    def misses(frame: Transform, posture: Posture) -> float:
        """Never none, and less the farther it is to a side."""
        by = 1.0 + aside * float(frame.place[1])
        missed.append((by, frame.place))
        return by

    def shown(task: HumanTask) -> Generator[Array, None, None]:
        yield from brought(task, "left", misses)

    frame = Transform(scene.held.place, scene.held.rotation)
    in_palm = scene.body.grip(1).inverse().then(frame)
    held = scene.named(frame, {"page": 1.0, "cover": "open"})
    scene.body.do(shown, begun(scene.body, held, scene.site, {}, hand="left", hold="keep"))
    ended = scene.body.grip(1).then(in_palm).place
    least = min(by for by, _ in missed)
    nearest = min(float(np.linalg.norm(ended - place)) for by, place in missed if by == least)
    assert least < max(by for by, _ in missed) - 0.03
    assert nearest < 0.01
