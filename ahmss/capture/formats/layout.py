"""What a record holds: the output list that the device was given, and its units."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from ahmss.errors import CommandError

__all__ = ["METRES", "Kind", "Layout", "Units"]

Kind = Literal["fastrak", "liberty", "patriot", "ultratrak"]
Units = Literal["inch", "cm"]

METRES: dict[Units, float] = {"inch": 0.0254, "cm": 0.01}


@dataclass(frozen=True)
class Layout:
    """An output list and its units.

    items: the device's numbers, in their order. FASTRAK: 0 space, 1 CR LF, 2 position, 4 Euler angles, 11 quaternion.
        Liberty and Patriot: 0, 1, 2 the same, 4 or 5 Euler angles, 7 quaternion, 8 time stamp, 9 frame count.
    units: of positions. Angles are degrees always.
    stations: how many the device has; a record of a higher one is damage.
    """

    items: tuple[int, ...]
    units: Units = "inch"
    stations: int = 16

    def check(self, known: dict[int, str], device: str) -> None:
        """Refuse an item that the format does not know.

        Raises:
            CommandError: names the item and those that are known.
        """
        for item in self.items:
            if item not in known:
                allowed = ", ".join(f"{number} {name}" for number, name in sorted(known.items()))
                raise CommandError(f"output list of {device}: no item {item}; there are: {allowed}")
