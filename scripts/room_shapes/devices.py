"""Keyboard, touch panel, manual and telephone as solids. Centimetres, z up, front at +x."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from room_shapes.lettering import lettering
from room_shapes.solids import Piece, bevelled, box, lathe, loft, rectangle, rounded, slab, tube

Color = tuple[int, int, int]
Model = tuple[list[Piece], dict[str, Color]]

PITCH, CAP, TOP, TRAVEL = 1.9, 1.5, 2.0, 0.35  # of keys: from middle to middle, width, height of their tops, travel
GREY, DARK, PALE, INK = (70, 74, 80), (44, 47, 52), (214, 216, 212), (30, 32, 36)


@dataclass(frozen=True)
class Key:
    """A key: its name, what it writes, the finger that has it, its middle (x, y) and size, cm."""

    name: str
    writes: str
    finger: str
    at: tuple[float, float]
    size: tuple[float, float] = (CAP, CAP)
    legend: str = ""


NAMES = {
    "-": "minus", "=": "equals", "[": "opening", "]": "closing", ";": "semicolon", "'": "quote", ",": "comma",
    ".": "period", "/": "slash",
}  # fmt: skip
ROWS = ((-2, 1.5, "1234567890-="), (-1, 2.0, "QWERTYUIOP[]"), (0, 2.25, "ASDFGHJKL;'"), (1, 2.75, "ZXCVBNM,./"))
FINGERS = (  # touch typing: columns of each finger
    ("left_little", "1QAZ"), ("left_ring", "2WSX"), ("left_middle", "3EDC"), ("left_index", "45RTFGVB"),
    ("right_index", "67YUHJNM"), ("right_middle", "8IK,"), ("right_ring", "9OL."), ("right_little", "0P;/-=[]'"),
)  # fmt: skip
MIDDLE = 7.5  # of the keyboard, in keys from its left edge


def keys() -> list[Key]:
    """All keys that write or do something."""
    finger = {letter: name for name, letters in FINGERS for letter in letters}
    made = [
        Key(_name(letter), letter, finger[letter], _at(row, first + i), legend=letter)
        for row, first, letters in ROWS
        for i, letter in enumerate(letters)
    ]
    made.append(Key("space", " ", "thumb", _at(2, 7.0), (CAP, 5.8 * PITCH)))
    made.append(Key("enter", "", "right_little", _at(0, 13.87), (CAP, 2.0 * PITCH), "ENTER"))
    made.append(Key("back", "", "right_little", _at(-2, 13.97), (CAP, 1.75 * PITCH), "BACK"))
    return made


def _name(letter: str) -> str:
    return f"digit_{letter}" if letter.isdigit() else NAMES.get(letter, letter.lower())


def _at(row: float, column: float) -> tuple[float, float]:
    return (round(PITCH * row, 3), round(PITCH * (column - MIDDLE), 3))


def keyboard() -> Model:
    """32 cm wide; keys stand 0.6 cm out of the case, each on a layer of its own, its legend on another."""
    pieces = [slab("case", rounded(13.2, 31.0, 1.2, 3), [(0.0, 0.0), (1.2, 0.0), (1.4, 0.25)])]
    pieces.append(box("well", (-5.0, -14.6, 1.4), (5.0, 14.6, 1.45), bottom=False))
    for key in keys():
        pieces += _cap(f"key_{key.name}", key.at, key.size)
        if key.legend:
            height = 0.62 if len(key.legend) < 2 else 0.4
            turned = lettering(f"legend_{key.name}", key.legend, (0.0, 0.0), height).turned("z", 90)
            pieces.append(turned.moved(*key.at, TOP + 0.012))
    for row, column, wide in ((-2, 0.45, 0.8), (-1, 0.7, 1.3), (-1, 14.2, 1.3), (0, 0.82, 1.55), (1, 1.1, 2.0)):
        pieces += _cap("blank", _at(row, column), (CAP, wide * PITCH))
    pieces += _cap("blank", _at(1, 13.55), (CAP, 2.55 * PITCH))
    pieces += _cap("blank", _at(2, 2.0), (CAP, 2.5 * PITCH)) + _cap("blank", _at(2, 12.2), (CAP, 2.5 * PITCH))
    colors = {"case": DARK, "well": (24, 26, 30), "blank": GREY}
    for key in keys():
        colors |= {f"key_{key.name}": PALE} | ({f"legend_{key.name}": INK} if key.legend else {})
    return pieces, colors


def _cap(layer: str, at: tuple[float, float], size: tuple[float, float]) -> list[Piece]:
    """A key: its sides narrow a little to the top."""
    (x, y), (depth, wide) = at, (0.5 * size[0], 0.5 * size[1])
    rings = [
        rectangle((x - depth - e, y - wide - e), (x + depth + e, y + wide + e), z) for z, e in ((1.3, 0.12), (TOP, 0.0))
    ]
    return [loft(layer, rings, bottom=False)]


def face(piece: Piece, x: float) -> Piece:
    """What lies in the plane of x and y, stood up at x so that it is seen from +x: x to the right, y up."""
    flat = piece.corners
    return Piece(
        piece.layer, np.stack([np.full(len(flat), x) + flat[:, 2], flat[:, 0], flat[:, 1]], axis=-1), piece.faces
    )


def plate(layer: str, middle: tuple[float, float], size: tuple[float, float], z: float = 0.0) -> Piece:
    """A rectangle in the plane of x and y."""
    (x, y), (w, h) = middle, (0.5 * size[0], 0.5 * size[1])
    return Piece(
        layer, np.array([[x - w, y - h, z], [x + w, y - h, z], [x + w, y + h, z], [x - w, y + h, z]]), [[0, 1, 2, 3]]
    )


SCREEN = (36.0, 24.0)  # of the touch panel, cm
GLASS = 1.6  # cm before its back
BARS = ((70, 150, 120), (96, 132, 190))


def touch_panel() -> Model:
    """A display of 36 x 24 cm that hangs by its back; each page is a layer, and each field that lights another."""
    pieces = [bevelled("body", (-2.5, -20.5, -14.5), (GLASS - 0.1, 20.5, 14.5), 0.6)]
    pieces.append(face(plate("glass", (0.0, 0.0), SCREEN), GLASS - 0.08))
    flat = _overview() + _pump()
    pieces += [face(piece, GLASS - 0.06) for piece in flat]
    colors: dict[str, Color] = {"body": (58, 62, 68), "glass": (18, 26, 36)}
    inks: dict[str, Color] = {
        "overview": (206, 214, 220), "pump_page": (206, 214, 220), "to_pump": (52, 92, 132), "to_tank": (52, 92, 132),
        "home": (52, 92, 132), "start": (38, 112, 66), "stop": (140, 50, 46), "running": (92, 230, 130),
        "track": (74, 84, 96), "knob": (232, 236, 240), "pipe": (84, 150, 196),
    }  # fmt: skip
    return pieces, colors | inks


def _overview() -> list[Piece]:
    """The page that one begins with."""
    out = [
        plate("overview", (0.0, 8.6), (34.0, 0.12), 0.01),
        lettering("overview", "PLANT OVERVIEW", (-6.0, 10.1), 1.2),
    ]
    out += [plate("pipe", (0.0, 1.5), (16.0, 0.7), 0.005), plate("pipe", (8.0, 3.3), (0.7, 4.3), 0.005)]
    for layer, x, text in (("to_pump", -9.0, "PUMP 1"), ("to_tank", 9.0, "TANK")):
        out += [plate(layer, (x, -5.0), (11.0, 5.0), 0.01)]
        out.append(lettering("overview", text, (x, -5.0), 1.3).moved(z=0.03))
    for x in (-8.0, 8.0):
        out.append(plate("overview", (x, 2.4), (5.0, 5.0), 0.015))
        out.append(plate("pipe", (x, 2.4), (4.4, 4.4), 0.025))
    return out


def _pump() -> list[Piece]:
    """The page of the pump: start, stop, a slider for its speed."""
    out = [plate("pump_page", (0.0, 8.6), (34.0, 0.12), 0.01), lettering("pump_page", "PUMP 1", (-11.0, 10.1), 1.2)]
    out.append(plate("running", (0.5, 10.1), (3.0, 1.2), 0.01))
    for layer, at, size, text in (
        ("home", (14.0, 10.3), (6.0, 2.6), "BACK"),
        ("start", (-9.0, 3.5), (11.0, 5.0), "START"),
        ("stop", (9.0, 3.5), (11.0, 5.0), "STOP"),
    ):
        out += [plate(layer, at, size, 0.01)]
        out.append(lettering("pump_page", text, at, 1.2).moved(z=0.03))
    out.append(lettering("pump_page", "SPEED", (-13.0, -4.2), 1.0))
    out += [plate("track", (0.0, -8.0), (26.0, 0.8), 0.01), plate("knob", (-12.0, -8.0), (1.6, 3.4), 0.05)]
    return out


LEAVES = 5  # of the manual: its cover and four pages that turn
HINGE, PAPER = (-9.0, 0.75), 0.03  # cm: where the rings are, aside and up; thickness of a page


def manual() -> Model:
    """A ring-bound manual on a board of 18 x 25 cm; its lower margin is for the hand, who reads is at +x."""
    pieces = [slab("board", rounded(25.0, 18.0, 0.6, 2), [(0.0, 0.0), (0.35, 0.0)])]
    pieces.append(_sheet("block", 0.35, 0.55))
    colors: dict[str, Color] = {"board": (52, 60, 74), "block": (244, 242, 234), "rings": (120, 124, 130)}
    for k in range(12):
        x = -11.2 + 1.75 * k
        turns = np.linspace(0.35, 2.0 * np.pi - 0.35, 9) + 0.5 * np.pi
        ring = [[x, HINGE[0] + 0.62 * np.sin(a), 0.45 + 0.62 * np.cos(a)] for a in turns]
        pieces.append(tube("rings", ring, 0.09, 4))
    top = 0.55 + PAPER * LEAVES
    for leaf in range(LEAVES):
        z = top - PAPER * leaf
        pieces.append(_sheet(f"leaf_{leaf}", z, z + 0.6 * PAPER))
        pieces += [piece.turned("z", 90).moved(-2.0, 0.3, z + PAPER) for piece in _written(leaf)]
        colors |= {f"leaf_{leaf}": (250, 249, 244), f"ink_{leaf}": (48, 52, 60)}
    colors |= {"leaf_0": (178, 56, 44), "ink_0": (250, 240, 226), "photo": (120, 156, 186)}
    pieces.append(lettering(f"ink_{LEAVES}", "END", (0.0, 0.0), 1.0).turned("z", 90).moved(-2.0, 0.3, 0.56))
    return pieces, colors | {f"ink_{LEAVES}": (48, 52, 60)}


def _sheet(layer: str, low: float, high: float) -> Piece:
    """What lies between the rings and the right edge, above the margin."""
    return box(layer, (-12.0, -8.6, low), (8.0, 8.4, high))


def _written(leaf: int) -> list[Piece]:
    """The lines of a page, seen with x to the right and y up, about its middle."""
    layer = f"ink_{leaf}"
    if leaf == 0:
        return [lettering(layer, "PUMP 1", (0.0, 3.6), 1.7), lettering(layer, "START UP", (0.0, 0.6), 1.2)]
    lines = [lettering(layer, f"STEP {leaf}", (-3.6, 7.0), 1.1)]
    wide = np.random.default_rng(leaf).uniform(7.0, 13.0, 9)
    lines += [plate(layer, (-6.6 + 0.5 * w, 4.8 - 1.35 * i), (float(w), 0.28)) for i, w in enumerate(wide)]
    return lines


def telephone() -> Model:
    """The base: 22 x 18 cm, a cradle on top at the far side and keys before it; who calls is at +x."""
    rings = [rectangle((-9, -10, 0), (9, 10, 0), 0.0), rectangle((-9, -10, 0), (9, 10, 0), 2.2)]
    wedge = loft("base", rings)
    wedge.corners[wedge.corners[:, 2] > 1.0] += np.where(
        wedge.corners[wedge.corners[:, 2] > 1.0][:, :1] < 0, (0, 0, 2.6), 0
    )
    pieces = [wedge]
    for side in (-1.0, 1.0):
        for low, high in ((-8.8, -7.6), (-2.4, -1.2)):
            y0, y1 = sorted((side * 5.6, side * 8.6))
            pieces.append(box("base", (low, y0, 3.4), (high, y1, 5.6)))
    for row in range(4):
        for column in range(3):
            x = 0.8 + 1.9 * row
            z = 2.2 + 2.6 * (9.0 - x) / 18.0
            pieces.append(
                box("keys", (x - 0.6, -3.0 + 2.2 * column, z - 0.3), (x + 0.6, -1.4 + 2.2 * column, z + 0.25))
            )
    return pieces, {"base": (66, 70, 78), "keys": (222, 222, 216)}


def handset() -> Model:
    """20 cm along y, two cups that look down and a grip between them; its origin is under its middle."""
    path = [[0.0, -7.4, 4.1], [0.0, -5.2, 4.7], [0.0, -2.4, 4.9], [0.0, 2.4, 4.9], [0.0, 5.2, 4.7], [0.0, 7.4, 4.1]]
    pieces = [tube("grip", path, [1.3, 1.35, 1.3, 1.3, 1.35, 1.3], 10)]
    for side in (-1.0, 1.0):
        cup = lathe("cups", [(0.0, 0.0), (2.1, 0.0), (2.4, 0.5), (2.2, 2.6), (1.4, 4.2), (0.0, 4.6)], 14)
        pieces.append(cup.moved(0.0, side * 7.4, 0.6))
    return pieces, {"grip": (52, 56, 64), "cups": (46, 50, 58)}
