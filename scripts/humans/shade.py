"""Colours of the vertices: the painted colour, a little blush, and less light where the body shades itself."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from humans.distance import Field
from humans.figure import Figure
from humans.head import Drawing

__all__ = ["shaded"]

_REACH = ((0.010, 0.40), (0.024, 0.30), (0.045, 0.20), (0.075, 0.14))  # metres along the normal, share of the light
_BLUSH = ((6.6, 4.3, -2.9, 1.7, 0.30), (6.6, -4.3, -2.9, 1.7, 0.30), (9.9, 0.0, -3.6, 1.0, 0.16))


def shaded(
    figure: Figure, points: Array, normals: Array, names: Sequence[str], fields: Sequence[Field | None]
) -> NDArray[np.uint8]:
    """Colours (n, 4), sRGB, of points (n, 3) with unit normals and the names of their colours."""
    base = np.array([figure.colours[name] for name in names], float)
    bare = np.array([name in ("skin", "lips") for name in names])
    drawn = (points - Drawing.of(figure).origin) / Drawing.of(figure).scale
    for x, y, z, size, strength in _BLUSH:
        near = np.exp(-0.5 * np.sum(((drawn - (x, y, z)) / size) ** 2, axis=1)) * bare * strength
        base += near[:, None] * (np.array(figure.colours["blush"]) - base)
    eyes = np.array([name in ("white", "iris", "pupil", "glint") for name in names])
    light = np.where(eyes, 1.0, 1.0 - 0.62 * _hidden(points, normals, fields))
    # Shade is warm on skin: red fades least.
    tint = np.where(bare[:, None], np.array([0.75, 1.0, 1.08]), 1.0)
    colours = base * light[:, None] ** tint
    return np.column_stack([np.clip(np.round(colours), 0, 255), np.full(len(points), 255)]).astype(np.uint8)


def _hidden(points: Array, normals: Array, fields: Sequence[Field | None]) -> Array:
    """The share of the light (n,) that other parts of the body keep away, from the distances along the normal."""
    hidden = np.zeros(len(points))
    for reach, share in _REACH:
        at = points + reach * normals
        free = np.full(len(points), reach)
        for field in fields:
            if field is not None:
                free = np.minimum(free, field(at))
        hidden += share * np.clip(1.0 - free / reach, 0.0, 1.0)
    return np.clip(hidden - 0.06, 0.0, 1.0)
