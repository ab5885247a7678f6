"""What the tests of the viewer draw with; left out where the machine can draw nothing."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np
import pytest
from ahmss_viewer.graphics import find_headless, use_headless

if find_headless() is None:
    collect_ignore_glob = ["test_[!g]*.py"]  # test_graphics.py says why
else:
    use_headless()

from ahmss_viewer.camera import View
from ahmss_viewer.graphics import Offscreen
from ahmss_viewer.painter import Painter
from ahmss_viewer.stage import Stage
from ahmss_viewer.target import Target

Draw = Callable[..., np.ndarray]


@pytest.fixture(scope="module")
def painter() -> Iterator[Painter]:
    """A painter in a context of its own, for one module: to end a context of EGL ends all others of the process."""
    with Offscreen():
        yield Painter()


@pytest.fixture
def draw(painter: Painter) -> Draw:
    """Draws a stage: (height, width, 3) as signed integers, so that differences are what they seem."""

    def picture(stage: Stage, view: View, size: tuple[int, int] = (320, 240)) -> np.ndarray:
        target = Target(*size)
        painter.draw(stage, view, size, target)
        stage.tick()
        pixels = target.read().astype(int)
        target.delete()
        return pixels

    return picture
