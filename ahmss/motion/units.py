"""What a file's unit of length is: guessed from how tall the person would be."""

from __future__ import annotations

import math

__all__ = ["UNITS", "guess_unit"]

UNITS: dict[str, float] = {
    "m": 1.0,
    "cm": 0.01,
    "mm": 0.001,
    "inch": 0.0254,
    "foot": 0.3048,
    "cmu": 0.0254 / 0.45,  # CMU's skeletons: inches times 0.45
}
"""Metres of one unit."""

_LEG = 0.491  # thigh and shank in shares of stature (Drillis & Contini 1966)
_USUAL = 1.70
_LOWEST, _HIGHEST = 1.1, 2.3


def guess_unit(leg: float) -> tuple[str, float, float]:
    """The unit in which a person with thigh and shank of this length together is nearest to 1.70 m.

    Args:
        leg: thigh and shank together, in the file's unit.

    Returns:
        the unit's name ("" where none gives a person of 1.1 to 2.3 m), metres of one unit, and the stature in metres.
    """
    stature = leg / _LEG
    name = min(UNITS, key=lambda unit: abs(math.log(max(stature, 1e-9) * UNITS[unit] / _USUAL)))
    tall = stature * UNITS[name]
    if _LOWEST < tall < _HIGHEST:
        return name, UNITS[name], tall
    return "", _USUAL / max(stature, 1e-9), _USUAL
