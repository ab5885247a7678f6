"""C3D, read: places of markers as optical systems record them, by the library ezc3d."""

from __future__ import annotations

import importlib
from pathlib import Path
from typing import Any

import numpy as np

from ahmss.errors import DataError, DependencyError
from ahmss.motion.markers import Markers

__all__ = ["read_c3d"]

_METRES = {"mm": 0.001, "cm": 0.01, "m": 1.0, "in": 0.0254, "inch": 0.0254}


def read_c3d(path: Path) -> Markers:
    """The markers in a C3D file, metres, hidden ones not a number.

    Raises:
        DependencyError: ezc3d is not installed.
        DataError: the file is missing or damaged, or has no markers.
    """
    try:
        ezc3d: Any = importlib.import_module("ezc3d")
    except ImportError:
        raise DependencyError("C3D files are read by ezc3d, which is missing; pip install 'ahmss[c3d]'") from None
    if not path.is_file():
        raise DataError(path, "", "no such file")
    try:
        content = ezc3d.c3d(str(path))
        parameters = content["parameters"]["POINT"]
        points = np.array(content["data"]["points"], float)
        names = tuple(str(name).strip() for name in parameters["LABELS"]["value"])
        rate = float(parameters["RATE"]["value"][0])
    except (OSError, RuntimeError, ValueError, IndexError, KeyError, TypeError, MemoryError) as error:
        reason = " ".join(str(error).split())[:120]
        raise DataError(path, "", f"not a C3D file that can be read ({reason}); is it cut short?") from error
    count = min(len(names), points.shape[1])
    if count == 0 or points.shape[2] == 0 or not rate > 0.0:
        raise DataError(path, "POINT", "there are no markers in it, or no frames")
    unit = next(iter(parameters["UNITS"]["value"]), "mm") if "UNITS" in parameters else "mm"
    if unit.strip().lower() not in _METRES:
        raise DataError(path, "POINT.UNITS", f'unknown unit "{unit}"; known are {", ".join(_METRES)}')
    places = points[:3].transpose(2, 1, 0)[:, :count] * _METRES[unit.strip().lower()]
    places[(places == 0.0).all(axis=-1)] = np.nan  # older files have a hidden marker at the origin
    return Markers(path, names[:count], places, rate)
