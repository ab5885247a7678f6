"""`ahmss new panel NAME`: a sloped console with controls in rows, as one object.toml with a line for each."""

from __future__ import annotations

import itertools
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ahmss.database.objectfile import NAME
from ahmss.database.records import ObjectKind
from ahmss.database.workspace import Workspace
from ahmss.errors import CommandError

__all__ = ["new_panel"]

_GAP = 0.035  # metres between controls,
_ASLANT = 0.8  # or, between rows, so much of how far one stands out
_EDGE = 0.05  # metres between the outer ones and the plate's border
_FOOT, _BACK, _LIP = 0.2, 0.34, 0.05  # metres: room for the toes, least depth, height of the plate's front
_LIP_BACK = 0.02  # metres: from the plate's front to where its foot begins
_STAND = 0.3  # metres before the plate's front
_MOST = 400

_TOML = """\
# {name}: {count} controls. One line each: move, tilt, add or remove them while everything runs.
# x is towards who stands before it, y to their right, z up; the origin is on the floor under the plate's front.
# A control's own x is out of the plate, its z up along it: orientation_deg turns it about x, then y, then z.
name = "{name}"
sentence = "A panel of {count} controls."
shape = "{name}.dxf"
unit = "m"
color = [132, 142, 146]
falls = false

contains = [
{lines}
]

[properties]
size = [{depth:.3f}, {width:.3f}, {top:.3f}]
blocks = [                   # what is in a hand's way: its outline, x and z, drawn out along y
{blocks}
]

[sites.stand]
position = [{stand:.2f}, 0.0, 0.0]
facing_deg = 180
"""


@dataclass(frozen=True)
class _Control:
    """A control of a kind, how wide (y) and high (z) it is on the plate, how far up from its origin and out, metres."""

    kind: str
    width: float
    height: float
    up: float
    out: float

    @property
    def room(self) -> float:
        """How far from it the next row is, metres: a hand comes aslant past what stands out far."""
        return max(_GAP, _ASLANT * self.out)


def new_panel(
    workspace: Workspace, name: str, kinds: Sequence[str], rows: int, columns: int, slope_deg: float, height: float
) -> Path:
    """Write objectdb/NAME/ with a console and rows of controls; returns the object.toml.

    Args:
        workspace: where to.
        name: of the panel's kind.
        kinds: of the controls, one for each row, from the top; they are repeated.
        rows, columns: how many. slope_deg: of the plate, 90 upright. height: of the plate's middle, metres.

    Raises:
        CommandError: the name is taken or no name, a number is out of range, a kind is none, it can't be written.
    """
    folder = _folder(workspace, name)
    if rows < 1 or columns < 1 or rows * columns > _MOST:
        raise CommandError(f"{rows} rows of {columns}; allowed: 1 to {_MOST} controls")
    if not 0.0 <= slope_deg <= 90.0:
        raise CommandError(f"--slope {slope_deg:g}; allowed: 0 (flat) to 90 (upright)")
    found = [_control(workspace, kind) for kind in kinds]
    used = [found[row % len(found)] for row in range(rows)]
    length = sum(control.height for control in used) + sum(_rooms(used)) + 2.0 * _EDGE
    width = columns * (max(control.width for control in used) + _GAP) - _GAP + 2.0 * _EDGE
    slope = math.radians(slope_deg)
    low = height - 0.5 * length * math.sin(slope)
    if low < 0.2 or height + 0.5 * length * math.sin(slope) > 2.5:
        raise CommandError(
            f"a plate {length:.2f} m long at --height {height:g} goes from {low:.2f} to "
            f"{2.0 * height - low:.2f} m; allowed: 0.2 to 2.5, so choose another height, slope or fewer rows"
        )
    plate = _Plate(length, width, slope, low)
    text = _TOML.format(
        name=name, count=rows * columns, lines="\n".join(_lines(plate, used, columns)), depth=plate.depth,
        width=width, top=plate.top, blocks="\n".join(plate.blocks()), stand=_STAND,
    )  # fmt: skip
    try:
        folder.mkdir()
        (folder / f"{name}.dxf").write_text(plate.dxf(), encoding="ascii")
        file = folder / "object.toml"
        file.write_text(text, encoding="utf-8")
    except OSError as error:
        raise CommandError(f"{workspace.label(folder)}: can't be written ({error.strerror or error})") from None
    return file


def _folder(workspace: Workspace, name: str) -> Path:
    if not NAME.fullmatch(name):
        raise CommandError(f'"{name}" is no name for a panel; use letters, digits, _ and -, a letter first')
    folder = workspace.root / "objectdb" / name
    if folder.exists():
        raise CommandError(f"{workspace.label(folder)} exists already; choose another name or change what is there")
    return folder


def _control(workspace: Workspace, kind: str) -> _Control:
    """A kind of control, as large as its property `box` says."""
    if kind not in workspace.objects.names():
        raise CommandError(f"--of {kind}: no such object; of controls there are: {_controls(workspace)}")
    size = _size(workspace.objects.get(kind))
    if size is None:
        raise CommandError(
            f"--of {kind}: no control, for its file has no property `box`, what it fills on a plate; of controls there "
            f"are: {_controls(workspace)}"
        )
    return _Control(kind, *size)


def _size(kind: ObjectKind) -> tuple[float, float, float, float] | None:
    """How wide and high a control is on a plate, how far up from its origin and out; None of what is none."""
    box: Any = kind.properties.get("box")
    try:
        low, high = box
        return float(high[1] - low[1]), float(high[2] - low[2]), float(high[2]), float(high[0])
    except (TypeError, ValueError, IndexError):
        return None


def _controls(workspace: Workspace) -> str:
    """The kinds of control that there are, in words."""
    kinds = [workspace.objects.get(entry.name) for entry in workspace.objects.list() if not entry.error]
    return ", ".join(kind.name for kind in kinds if _size(kind) is not None) or "none"


def _rooms(rows: Sequence[_Control]) -> list[float]:
    """How far rows are from each other, metres."""
    return [max(one.room, other.room) for one, other in itertools.pairwise(rows)]


def _lines(plate: _Plate, rows: Sequence[_Control], columns: int) -> list[str]:
    """One line for each control, row by row from the top, from the left as one who stands before it sees them."""
    pitch = (plate.width - 2.0 * _EDGE + _GAP) / columns
    numbers: Counter[str] = Counter()
    out: list[str] = []
    along = plate.length - _EDGE
    for control, room in zip(rows, [*_rooms(rows), 0.0], strict=True):
        short = control.kind.rpartition("_")[2]
        at = along - control.up
        for column in range(columns):
            numbers[short] += 1
            y = (column - 0.5 * (columns - 1)) * pitch
            x, z = plate.at(at)
            turned = f", orientation_deg = [0, {_short(math.degrees(plate.slope) - 90.0)}, 0]"
            out.append(
                f'  {{ kind = "{control.kind}", name = "{short}_{numbers[short]}", '
                f"position = [{_short(x)}, {_short(y)}, {_short(z)}]{turned} }},"
            )
        along -= control.height + room
    return out


@dataclass(frozen=True)
class _Plate:
    """A sloped plate on its console: length up along it, width, slope in radians, height of its front; metres."""

    length: float
    width: float
    slope: float
    low: float

    @property
    def top(self) -> float:
        """The height of its upper border."""
        return self.low + self.length * math.sin(self.slope)

    @property
    def depth(self) -> float:
        """From the front to the back of the console."""
        return max(self.length * math.cos(self.slope) + 0.03, _BACK)

    def at(self, along: float) -> tuple[float, float]:
        """x and z of what is so far up along the plate."""
        return -along * math.cos(self.slope), self.low + along * math.sin(self.slope)

    def outlines(self) -> tuple[list[tuple[float, float]], list[tuple[float, float]]]:
        """The foot and the desk on it seen from the side, x and z, each convex, counter-clockwise."""
        (top_x, top_z), back, under = self.at(self.length), -self.depth, self.low - _LIP
        foot = [(back, 0.0), (-_FOOT, 0.0), (-_LIP_BACK, under), (back, under)]
        return foot, [(back, under), (-_LIP_BACK, under), (0.0, self.low), (top_x, top_z), (back, top_z)]

    def blocks(self) -> list[str]:
        """The same, drawn out along the console's width, as lines of the file."""
        ends = f"[{_short(-0.5 * self.width)}, {_short(0.5 * self.width)}]"
        told = [", ".join(f"[{_short(x)}, {_short(z)}]" for x, z in outline) for outline in self.outlines()]
        return [f"  {{ outline = [{points}], y = {ends} }}," for points in told]

    def dxf(self) -> str:
        """The console as 3DFACEs, metres: its outline seen from the side, drawn out along y."""
        foot, desk = self.outlines()
        outline = [*foot[:-1], *desk[2:]]
        right, left = ([(x, y, z) for x, z in outline] for y in (0.5 * self.width, -0.5 * self.width))
        faces = [[left[i], left[i - 1], right[i - 1], right[i]] for i in range(len(outline))]
        for i in range(1, len(outline) - 1):
            faces += [[left[0], left[i], left[i + 1], left[i + 1]], [right[0], right[i + 1], right[i], right[i]]]
        lines: list[object] = [0, "SECTION", 2, "ENTITIES"]
        for face in faces:
            lines += [0, "3DFACE", 8, "console"]
            for corner, point in enumerate(face):
                for axis, value in enumerate(point):
                    lines += [10 * (axis + 1) + corner, f"{round(value, 4) + 0.0:g}"]
        return "\n".join(str(line) for line in [*lines, 0, "ENDSEC", 0, "EOF", ""])


def _short(value: float) -> str:
    return f"{round(value, 4) + 0.0:g}"
