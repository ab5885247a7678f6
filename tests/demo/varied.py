"""The scenario's script with something else than in the room as it is shipped."""

from __future__ import annotations

import math
import re
import shutil
from dataclasses import dataclass, replace
from pathlib import Path

from .conftest import CUP, ROOT

CHAIR = "room/chair"
WIDER = 1.25  # times as wide as the room's cup: 90 mm
TABLE, ON_TABLE = (0.77, 0.2), (-0.35, -0.35)
TABLE_TURNED = {"table turned": 40, "table turned less": 20}  # degrees
AIKO = "aiko, table turned"
VARIATIONS = ("chair moved", "chair turned", *TABLE_TURNED, "wider cup", "starts elsewhere", "aiko", AIKO)


@dataclass(frozen=True)
class Varied:
    """A script, the workspace that it is played in, and who and what it is about."""

    script: Path
    workspace: Path = ROOT
    human: str = "ken"
    cup: str = CUP
    chair: str = CHAIR


def varied(name: str, folder: Path) -> Varied:
    """One of VARIATIONS, its files in a folder."""
    text = (ROOT / "examples" / "scenario.txt").read_text()
    change = Varied(folder / "scenario.txt")
    if name.startswith("chair"):
        where = "1.98 0.7 0 facing 150" if name == "chair turned" else "2.13 0.45 0 facing 180"
        text = after_room(text, "remove room/chair", f"add chair at {where}")
        change = replace(change, chair="chair")
    elif name in TABLE_TURNED or name == AIKO:
        turned = TABLE_TURNED.get(name, 40)
        turn = math.radians(turned)
        x = TABLE[0] + math.cos(turn) * ON_TABLE[0] - math.sin(turn) * ON_TABLE[1]
        y = TABLE[1] + math.sin(turn) * ON_TABLE[0] + math.cos(turn) * ON_TABLE[1]
        text = after_room(
            text, "remove room/table", f"add table at {TABLE[0]} {TABLE[1]} 0 facing {turned}", "remove room/cup",
            f"add cup at {x:.3f} {y:.3f} 0.88",
        )  # fmt: skip
        change = replace(change, cup="cup")
    elif name == "wider cup":
        change = replace(change, workspace=with_wider_cup(folder / "workspace", WIDER))
    elif name == "starts elsewhere":
        text = re.sub(r"at \S+ \S+ facing \S+\nwait", "at -1.2 1.8 facing 30\nwait", text)
    if name.startswith("aiko"):
        text = text.replace("human ken body ken", "human aiko body aiko")
        change = replace(change, human="aiko")
    change.script.write_text(text)
    return change


def after_room(text: str, *lines: str) -> str:
    """A script with lines put in after that which adds the room."""
    assert "add room\n" in text
    return text.replace("add room\n", "\n".join(["add room", *lines, ""]))


def with_wider_cup(workspace: Path, wider: float) -> Path:
    """A copy of the workspace in which the cup is so many times as wide."""
    for part in ("objectdb", "humandb", "algorithms"):
        shutil.copytree(ROOT / part, workspace / part)
    shape = workspace / "objectdb" / "cup" / "cup.dxf"
    lines = shape.read_text().split("\n")
    for i in range(0, len(lines) - 1, 2):  # a group code, and its value
        if lines[i].strip() in ("10", "20") and lines[i + 1].strip():
            lines[i + 1] = f"{wider * float(lines[i + 1]):.6f}"
    shape.write_text("\n".join(lines))
    file = workspace / "objectdb" / "cup" / "properties.toml"
    file.write_text(file.read_text().replace("diameter = 0.072", f"diameter = {0.072 * wider:.4f}"))
    return workspace
