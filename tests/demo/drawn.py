"""The scenario's script with everything elsewhere at once, drawn by a seed: who acts, from where, chair, table, cup."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np

from .conftest import ROOT
from .varied import ON_TABLE, TABLE, Varied, after_room, with_wider_cup

__all__ = ["drawn"]

_CHAIR = (1.98, 2.16), (0.2, 0.65), (165.0, 195.0)  # metres, metres, degrees
_TURNED, _WIDER = 40.0, 1.25  # degrees that the table is turned by at the most; times as wide a cup is
_START = (-1.3, -0.5), (0.4, 1.9)  # metres: the free floor before the door


def drawn(seed: int, folder: Path) -> Varied:
    """A variation, its files in a folder."""
    rng = np.random.default_rng(seed)
    name = ("ken", "aiko")[seed % 2]
    turned = float(rng.uniform(0.0, _TURNED))
    turn = math.radians(turned)
    cup = (
        TABLE[0] + math.cos(turn) * ON_TABLE[0] - math.sin(turn) * ON_TABLE[1],
        TABLE[1] + math.sin(turn) * ON_TABLE[0] + math.cos(turn) * ON_TABLE[1],
    )
    chair = [float(rng.uniform(*span)) for span in _CHAIR]
    start = [float(rng.uniform(*span)) for span in _START]
    wider = float(rng.uniform(1.0, _WIDER))
    text = (ROOT / "examples" / "scenario.txt").read_text()
    text = after_room(
        text, "remove room/chair", f"add chair at {chair[0]:.3f} {chair[1]:.3f} 0 facing {chair[2]:.0f}",
        "remove room/table", f"add table at {TABLE[0]} {TABLE[1]} 0 facing {turned:.1f}",
        "remove room/cup", f"add cup at {cup[0]:.3f} {cup[1]:.3f} 0.88",
    )  # fmt: skip
    who = f"human {name} body {name} at {start[0]:.3f} {start[1]:.3f} facing {rng.uniform(-180.0, 180.0):.0f}"
    text, found = re.subn(r"human ken body ken at \S+ \S+ facing \S+", who, text)
    assert found == 1
    script = folder / "scenario.txt"
    script.write_text(text)
    return Varied(script, with_wider_cup(folder / "workspace", wider), name, "cup", "chair")
