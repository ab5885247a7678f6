"""Capitals, digits and signs as strokes, drawn by ourselves, so that lettering is the same bytes on every computer.

A glyph is polylines on a grid 4 wide and 6 high, digits of x and y in turn, polylines apart by a space.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator

import numpy as np

from room_shapes.solids import Piece

GLYPHS = {
    "A": "0004264440 0242", "B": "0006364544330333414030 3000", "C": "4536160501103041", "D": "00062645414020 2000",
    "E": "46060040 0333", "F": "460600 0333", "G": "4536160501103041433323", "H": "0006 4046 0343",
    "I": "1030 1636 2026", "J": "010010304146", "K": "0006 4603 1440", "L": "060040", "M": "0006234640",
    "N": "00064046", "O": "1001051636454130 1030", "P": "00063645443303", "Q": "1001051636454130 1030 2240",
    "R": "00063645443303 2340", "S": "4536160504133342413010 1001", "T": "0646 2026", "U": "060110304146",
    "V": "062046", "W": "0610233046", "X": "0046 0640", "Y": "062346 2320", "Z": "06460040",
    "0": "1001051636454130 1030 1135", "1": "052620 1030", "2": "0516364544 440040",
    "3": "0516364544331333424130 3010 1001", "4": "30360242", "5": "46060434434130 301001",
    "6": "3616050110304142 4233 3302", "7": "064610", "8": "130405163645443313 1302 0201 0110 1030 3041 4142 4233",
    "9": "4413 1304 0405 0516 1636 3645 4541 4130 3010", "-": "0343", "=": "0242 0444", "[": "36161030",
    "]": "16363010", ";": "2324 2211", "'": "2625", ",": "2110", ".": "2021", "/": "0046", ":": "2122 2425",
    "%": "0046 0605 4041", "+": "0343 2125", "<": "460340", ">": "064300", " ": "",
}  # fmt: skip
WIDE, HIGH, APART = 4.0, 6.0, 1.6  # of the grid; between letters


def strokes(text: str) -> Iterator[list[tuple[float, float]]]:
    """Polylines of a line of text, the first letter's foot at the origin, on the grid."""
    for i, letter in enumerate(text):
        for line in GLYPHS[letter].split():
            pairs = [(int(line[k]), int(line[k + 1])) for k in range(0, len(line) - 1, 2)]
            yield [(x + i * (WIDE + APART), float(y)) for x, y in pairs]


def width(text: str, height: float) -> float:
    """Of a line of text so high."""
    return (len(text) * (WIDE + APART) - APART) * height / HIGH


def lettering(layer: str, text: str, middle: tuple[float, float], height: float) -> Piece:
    """A line of text as flat strokes in the plane of x and y, seen from +z, its middle there."""
    corners: list[list[float]] = []
    faces: list[list[int]] = []
    scale, half = height / HIGH, 0.065 * height
    left, foot = middle[0] - 0.5 * width(text, height), middle[1] - 0.5 * height
    for line in strokes(text):
        points = np.array(line) * scale + (left, foot)
        for a, b in itertools.pairwise(points):
            along = (b - a) / np.linalg.norm(b - a)
            aside, a, b = half * np.array([-along[1], along[0]]), a - half * along, b + half * along
            faces.append([len(corners) + k for k in range(4)])
            corners += [[*p, 0.0] for p in (a - aside, b - aside, b + aside, a + aside)]
    return Piece(layer, np.array(corners), faces)
