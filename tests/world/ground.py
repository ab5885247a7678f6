"""What the tests of the world have in common: one skeleton, one way in, patience."""

from __future__ import annotations

import time
from collections.abc import Callable

import numpy as np

from ahmss.body.skeleton import Skeleton
from ahmss.world.client import WorldClient

KEN = Skeleton.of(1.75, "male", "ken")
ROTATIONS, ROOT = KEN.upright()


def join(client: WorldClient, name: str, *, group: str = "") -> int:
    """A human of that name enters."""
    return client.join(name, "ken", ROOT, ROTATIONS, skeleton=KEN.to_record(), group=group)


def row(number: int, place: tuple[float, float, float]) -> np.ndarray:
    """An object's row of a frame."""
    return np.array([[number, *place, 1.0, 0.0, 0.0, 0.0]])


def eventually(condition: Callable[[], object], seconds: float = 20.0) -> object:
    """Wait until the condition holds; what it gave."""
    limit = time.monotonic() + seconds
    while True:
        if result := condition():
            return result
        assert time.monotonic() < limit, "it never came true"
        time.sleep(0.01)
