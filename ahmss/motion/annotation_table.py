"""The table that is written by hand beside a captured clip: its keys, and how it is read.

A TOML file; docs/annotation.md lists what it may hold. All its times are seconds of the clip that is kept.
"""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import msgspec

from ahmss.body.links import INDEX, LINKS, fingers
from ahmss.errors import DataError

__all__ = [
    "LIMBS",
    "SIDES",
    "Contact",
    "Gaze",
    "Grip",
    "Importance",
    "Kept",
    "Row",
    "Shape",
    "Side",
    "Site",
    "Table",
    "Whereabouts",
    "load_table",
]

Side = Literal["right", "left"]
SIDES: tuple[Side, Side] = ("right", "left")


def _limbs() -> dict[str, tuple[int, ...]]:
    """Names for several links at once."""
    limbs = {"all": tuple(range(len(LINKS) + 1)), "root": (len(LINKS),), "trunk": (INDEX["hips"], INDEX["spine"])}
    for side in SIDES:
        hand = tuple(fingers(side))
        limbs[f"{side}_fingers"] = hand
        limbs[f"{side}_arm"] = (*(INDEX[f"{side}_{part}"] for part in ("upper_arm", "lower_arm", "hand")), *hand)
        limbs[f"{side}_leg"] = tuple(INDEX[f"{side}_{part}"] for part in ("upper_leg", "lower_leg", "foot"))
    return limbs


LIMBS = _limbs()
"""The names that stand for several links, or for the root, in `[[importance]] joints`."""


class Row(msgspec.Struct, forbid_unknown_fields=True, kw_only=True, rename={"begin": "from", "end": "to"}):
    """From one second to another; left out: from the beginning, to the end."""

    begin: float = 0.0
    end: float | None = None


class Kept(Row):
    """[keep]: the part of the captured clip that is wanted, in seconds of the captured clip."""


class Importance(Row):
    """[[importance]]: joints or limbs and their importance meanwhile; it comes and goes over `ease` seconds."""

    joints: dict[str, float]
    ease: float = 0.2


class Shape(Row):
    """[[fingers]]: a hand that takes a shape between two times, and keeps it; `around` needs a diameter in metres."""

    hand: Side
    shape: Literal["relaxed", "open", "fist", "around"]
    diameter: float = 0.0


class Grip(Row):
    """[[hand]]: a hand that is on the site between two times; its palm is then first at `at`, metres, in the site's
    frame. It comes to the captured path over `ease` seconds before, and leaves it over as many after."""

    hand: Side
    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ease: float = 0.5


class Gaze(Row):
    """[[gaze]]: the gaze is on a place of the site, or on what a hand is on; `weight`: how far the head goes to it."""

    at: tuple[float, float, float] = (0.0, 0.0, 0.0)
    on: Side | None = None
    weight: float = 1.0
    ease: float = 0.4


class Contact(Row):
    """[[contact]]: a foot that bears weight between two times, or does not."""

    foot: Side
    bears: bool = True


class Whereabouts(msgspec.Struct, forbid_unknown_fields=True):
    """[object]: the clip is made relative to the object: which way that faced, seen from where the human faced at the
    clip's beginning, and where in its frame the hips are at a time."""

    hips: tuple[float, float]
    at: float
    facing_deg: float = 0.0


class Site(msgspec.Struct, forbid_unknown_fields=True):
    """[site]: which way the site's x points, seen from where the human faces at the clip's beginning."""

    facing_deg: float = 0.0


class Table(msgspec.Struct, forbid_unknown_fields=True):
    """The whole table."""

    keep: Kept = msgspec.field(default_factory=Kept)
    site: Site = msgspec.field(default_factory=Site)
    object: Whereabouts | None = None
    importance: list[Importance] = []
    fingers: list[Shape] = []
    hand: list[Grip] = []
    gaze: list[Gaze] = []
    contact: list[Contact] = []


def load_table(path: Path) -> Table:
    """The table in a file.

    Raises:
        DataError: it is missing or wrong; says where and what is allowed.
    """
    try:
        table = msgspec.toml.decode(path.read_bytes(), type=Table)
    except OSError as error:
        raise DataError(path, "", f"can't be read: {error.strerror}") from None
    except msgspec.DecodeError as error:
        raise DataError(path, "", str(error)) from None
    for i, row in enumerate(table.importance):
        for name, value in row.joints.items():
            if name not in LIMBS and name not in INDEX:
                raise DataError(path, f"importance[{i}].joints", f"no {name!r}; {', '.join(LIMBS)} or a link's name")
            if value < 0.0:
                raise DataError(path, f"importance[{i}].joints.{name}", f"{value}; it must not be negative")
    for i, row in enumerate(table.fingers):
        if (row.shape == "around") != (row.diameter > 0.0):
            raise DataError(path, f"fingers[{i}]", 'a diameter > 0 goes with shape "around", and with no other')
    return table
