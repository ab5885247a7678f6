"""What FASTRAK's two record formats share: a record's head, and the items of the output list (manual rev. G, 9)."""

from __future__ import annotations

from ahmss.capture.formats.decode import BINARY, Columns
from ahmss.capture.formats.layout import Layout
from ahmss.errors import CommandError

__all__ = ["CR_LF", "EULER", "HEAD", "ITEMS", "POSITION", "QUATERNION", "SPACE", "STATIONS", "columns", "head"]

SPACE, CR_LF, POSITION, EULER, QUATERNION = 0, 1, 2, 4, 11
ITEMS = {SPACE: "space", CR_LF: "CR LF", POSITION: "position", EULER: "Euler angles", QUATERNION: "quaternion"}
NUMBERS = {POSITION: 3, EULER: 3, QUATERNION: 4}

STATIONS = "123456789ABCDEFG"
"""The station character: FASTRAK itself has 1 to 4; systems of more go on with letters."""

HEAD = rb"0([%s])([ A-Za-z])"
"""Record type, station, error character (a space when all is well)."""


def head(station: int, status: str) -> bytes:
    """The first three bytes of a record."""
    return b"0" + STATIONS[station - 1].encode() + (status or " ").encode()


def columns(layout: Layout, unit: float = BINARY) -> Columns:
    """Where position and orientation stand in a record of this output list; `unit` as in `Columns`.

    Raises:
        CommandError: the list has no position or no orientation, or an item that is not known.
    """
    layout.check(ITEMS, "FASTRAK")
    orientation = next((item for item in layout.items if item in (EULER, QUATERNION)), None)
    if POSITION not in layout.items or orientation is None:
        raise CommandError(
            f"output list {layout.items}: needs 2 (position) and one of 4 (Euler angles), 11 (quaternion)"
        )
    before = {item: sum(NUMBERS.get(other, 0) for other in layout.items[:at]) for at, item in enumerate(layout.items)}
    return Columns(before[POSITION], before[orientation], orientation == EULER, unit)
