"""A keyboard's table of keys, and a text as strokes: which finger presses which key, when.

A stroke after one of the other hand comes soonest, after one of the same finger latest: 150 to 250 ms, a typist's rate
at ease (Dhakal 2018: 239 ms at the mean of 168,000 people, 120 ms of fast ones).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ahmss.body.array import Array
from ahmss.errors import AlgorithmError

__all__ = ["BACK", "CLICK", "HOMES", "Key", "Stroke", "clicks", "keys_of", "pushed", "strokes_of"]

HOMES = {
    "left_little": "A", "left_ring": "S", "left_middle": "D", "left_index": "F",
    "right_index": "J", "right_middle": "K", "right_ring": "L", "right_little": ";",
}  # fmt: skip
"""What the key writes over which a finger rests."""

CLICK, BACK = 0.9, 0.5
"""Of the travel of a key: where it writes, and from where it can again."""

DEEPEST = 0.02  # metres under the tops from which on a finger is somewhere else
OTHER_HAND, SAME_HAND, SAME_FINGER = 0.165, 0.195, 0.23  # seconds from a stroke to the next
VARIES, LEAST, MOST = 0.012, 0.15, 0.25  # seconds
FAR = 0.04  # seconds more for a key two rows or more from the one before by the same hand
NAMED = {"<enter>": "enter", "<back>": "back", "<space>": "space"}


@dataclass(frozen=True, eq=False)
class Key:
    """A key: its middle at (2,), metres from the keyboard's to who types and to their right; its size (2,); the finger
    that has it, as "left_ring", or "thumb"."""

    name: str
    at: Array
    size: Array
    writes: str
    finger: str


@dataclass(frozen=True, eq=False)
class Stroke:
    """A key pressed all the way at a time, seconds, by the finger of a hand."""

    key: Key
    side: str
    finger: str
    time: float


def keys_of(properties: Mapping[str, Any], name: str) -> dict[str, Key]:
    """The keys by name, of an object's property `keys`.

    Raises:
        AlgorithmError: it has none, or fingers have no home there.
    """
    table: Mapping[str, Mapping[str, Any]] = properties.get("keys", {})
    keys = {
        key: Key(key, np.array(row["at"], float), np.array(row["size"], float), row.get("writes", ""), row["finger"])
        for key, row in table.items()
    }
    written = {key.writes for key in keys.values()}
    if missing := sorted(set(HOMES.values()) - written):
        raise AlgorithmError(
            f"{name} has no keys to rest the fingers on: its property `keys` lacks {' '.join(missing)}"
        )
    return keys


def pushed(pads: Array, keys: Mapping[str, Key], travel: float) -> dict[str, Array]:
    """How deep (F,) keys are pushed at each frame, of their travel, by name; those that nothing pushes are left out.

    pads: (F, n, 3) of fingers, in the frame of the keys' tops, metres.
    """
    share = np.clip(-pads[..., 2] / travel, 0.0, 1.0) * (pads[..., 2] > -DEEPEST)
    found: dict[str, Array] = {}
    for name, key in keys.items():
        over = (np.abs(pads[..., :2] - key.at) <= 0.5 * key.size).all(axis=-1)
        depth = (share * over).max(axis=-1)
        if depth.any():
            found[name] = depth
    return found


def clicks(pads: Array, keys: Mapping[str, Key], travel: float) -> list[tuple[int, str]]:
    """When, in frames from 0, and which keys write under pads (F, n, 3): as `pushed`."""
    found: list[tuple[int, str]] = []
    for name, depth in pushed(pads, keys, travel).items():
        down = False
        for frame, share in enumerate(depth.tolist()):
            if share >= CLICK and not down:
                found.append((frame, name))
            down = share > BACK if down else share >= CLICK
    return sorted(found)


def strokes_of(text: str, keys: Mapping[str, Key], random: np.random.Generator, begins: float) -> list[Stroke]:
    """The strokes of a text, the first at `begins` seconds; `<enter>` and `<back>` stand for these keys.

    Raises:
        AlgorithmError: a character that the keyboard has not; says which it has.
    """
    strokes: list[Stroke] = []
    for key in _spelt(text, keys):
        side, finger = _whose(key, strokes)
        time = begins
        if strokes:
            before = strokes[-1]
            gap = OTHER_HAND if side != before.side else SAME_FINGER if finger == before.finger else SAME_HAND
            if side == before.side and float(np.abs(key.at - before.key.at).max()) > 2.0 * float(key.size.min()):
                gap += FAR
            time = before.time + float(np.clip(gap + VARIES * random.standard_normal(), LEAST, MOST))
        strokes.append(Stroke(key, side, finger, time))
    return strokes


def _spelt(text: str, keys: Mapping[str, Key]) -> list[Key]:
    """The keys of a text; small letters are written by the keys of capitals where there are no others."""
    by_character = {key.writes: key for key in keys.values() if key.writes}
    found: list[Key] = []
    while text:
        named = next((name for name in NAMED if text.startswith(name)), "")
        character = text[0]
        key = keys.get(NAMED[named]) if named else by_character.get(character) or by_character.get(character.upper())
        if key is None:
            have = "".join(sorted(by_character)).strip()
            raise AlgorithmError(
                f'the keyboard has no key for "{named or character}"; it has: {have}, the space, <enter>'
            )
        found.append(key)
        text = text[len(named) or 1 :]
    return found


def _whose(key: Key, before: list[Stroke]) -> tuple[str, str]:
    """The hand and the finger; the space is the thumb's of the hand that did not write last."""
    if key.finger == "thumb":
        return ("right" if before and before[-1].side == "left" else "left"), "thumb"
    side, _, finger = key.finger.partition("_")
    return side, finger
