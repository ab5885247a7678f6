"""Draws pictures without a window: context, stage, painter and the frames that it draws into."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from types import TracebackType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ahmss.world.schema import HumanRecord
from ahmss_viewer.camera import View
from ahmss_viewer.caption import Flat, Writer
from ahmss_viewer.graphics import Offscreen
from ahmss_viewer.mirror import Mirror
from ahmss_viewer.names import name_flats
from ahmss_viewer.painter import Painter
from ahmss_viewer.stage import Stage
from ahmss_viewer.target import Target

__all__ = ["Studio"]


class Studio:
    """Use as a context manager; `fine` draws smooth edges and soft shadows, several times slower."""

    def __init__(self, *, fine: bool = False) -> None:
        self.context = Offscreen()
        self.fine = fine
        self.stage = Stage()
        self.painter = Painter(fine=fine)
        self.writer = Writer()
        self._targets: dict[tuple[tuple[int, int], bool], Target] = {}

    def mirror(self, asset: Callable[[str], bytes], skeleton: Callable[[HumanRecord], dict[str, Any]]) -> Mirror:
        """A mirror that shows a world on this studio's stage."""
        return Mirror(self.stage, asset, skeleton)

    def picture(
        self, view: View, size: tuple[int, int], flats: Sequence[Flat] = (), *, names: bool = False, best: bool = False
    ) -> NDArray[np.uint8]:
        """The stage now, (height, width, 3); `best` smooths edges all the way. The next of this size writes over it."""
        key = (size, best)
        if key not in self._targets:
            samples = 4 if self.fine and not best else 0
            self._targets[key] = Target(*size, supersampling=2 if best else 1, samples=samples)
        target = self._targets[key]
        shown = [*flats, *(name_flats(self.stage, view, size, self.writer) if names else ())]
        self.painter.draw(self.stage, view, size, target, shown, soft=best)
        self.stage.tick()
        return target.read()

    def __enter__(self) -> Studio:
        """The studio itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Free everything."""
        self.close()

    def close(self) -> None:
        """Free everything."""
        for target in self._targets.values():
            target.delete()
        self.painter.delete()
        self.context.close()
