"""Tries views by looking: the stage is drawn, small, and what matters in it is hidden by what is drawn before it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss_viewer.camera import View, project
from ahmss_viewer.framing import Interest
from ahmss_viewer.painter import Painter
from ahmss_viewer.stage import Stage
from ahmss_viewer.target import Target

__all__ = ["Looking"]

_SMALL = 96  # pixels high
_NEAR_COST = 0.8


class Looking:
    """Looks at a stage from here and there; to be closed.

    Args:
        aspect: of the picture, width over height.
        before: metres that something must be before a point to hide it; None: as deep as it lies inside.
    """

    def __init__(self, stage: Stage, painter: Painter, aspect: float, before: float | None = None) -> None:
        self._stage, self._painter, self._before = stage, painter, before
        self._target = Target(round(_SMALL * aspect), _SMALL)

    def look(self, view: View, moment: Interest) -> tuple[NDArray[np.bool_], float]:
        """Which points of a moment on the stage are hidden (n,), and how bad the view is: the share of what matters
        that is hidden, and for what fills the picture from close by."""
        self._painter.draw_depth(self._stage, view, self._target)
        metres = self._metres(view)
        before = moment.inside if self._before is None else self._before
        hidden = self._clearance(moment.points, view, metres) < -before
        near = metres < 0.45 * view.distance
        return hidden, float(np.average(hidden, weights=moment.weights) + _NEAR_COST * near.mean())

    def close(self) -> None:
        """Give its picture back."""
        self._target.delete()

    def _metres(self, view: View) -> Array:
        """How far away each pixel is."""
        width, height = self._target.drawn
        P = view.projection(width / height)
        return P[2, 3] / (2.0 * self._target.read_depth().astype(float) - 1.0 + P[2, 2])

    def _clearance(self, points: Array, view: View, metres: Array) -> Array:
        """How far points (n, 3) lie before what was drawn there (n,), metres; behind it is negative."""
        width, height = self._target.drawn
        seen = project(points, view, (width, height))
        column = np.clip(seen[:, 0].astype(int), 0, width - 1)
        row = np.clip(seen[:, 1].astype(int), 0, height - 1)
        return metres[row, column] - seen[:, 2]
