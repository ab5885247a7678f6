"""Each object of the room as solids: its pieces and the colours of its layers. Centimetres, z up, front at +x."""

from __future__ import annotations

import numpy as np

from room_shapes.solids import Piece, bevelled, box, lathe, loft, rectangle, rounded, slab, tube

Color = tuple[int, int, int]
Model = tuple[list[Piece], dict[str, Color]]

OAK, DARK_OAK, WHITE, STEEL, BLACK = (172, 128, 82), (118, 82, 52), (236, 234, 228), (176, 182, 188), (38, 40, 44)


def cup() -> Model:
    """7.2 cm wide, 9.5 cm high, 18 segments; the wall is straight where a hand takes it."""
    profile = [
        (0.0, 0.0),
        (3.2, 0.0),
        (3.6, 0.5),
        (3.6, 9.35),
        (3.42, 9.5),
        (3.25, 9.35),
        (3.25, 0.9),
        (0.0, 0.7),
    ]
    piece = lathe("glaze", profile, 18)
    widest = [np.hypot(*piece.corners[f][:, :2].T).max() for f in piece.faces]
    raised = [piece.corners[f][:, 2].max() > 0.6 for f in piece.faces]
    inside = [f for f, r, up in zip(piece.faces, widest, raised, strict=True) if r < 3.3 and up]
    outside = [f for f in piece.faces if f not in inside]
    return [Piece("glaze", piece.corners, outside), Piece("inside", piece.corners, inside)], {
        "glaze": (206, 84, 52),
        "inside": (244, 238, 226),
    }


def table() -> Model:
    """A top with rounded corners on four tapering legs; 100 x 120 cm, 88 cm high, to stand at."""
    top = slab("top", rounded(100, 120, 6, 3), [(85.0, 0.6), (85.6, 0.0), (87.4, 0.0), (88.0, 0.6)])
    pieces = [top]
    for sx in (-1, 1):
        for sy in (-1, 1):
            x, y = sx * 41, sy * 51
            levels = [(0.0, 2.0), (76.0, 3.6), (85.0, 3.6)]
            pieces.append(loft("frame", [_octagon(x, y, z, r) for z, r in levels], top=False))
    for sx in (-1, 1):
        pieces.append(box("frame", (sx * 41 - 1.2, -48, 76), (sx * 41 + 1.2, 48, 85), top=False))
        pieces.append(box("frame", (-38, sx * 51 - 1.2, 76), (38, sx * 51 + 1.2, 85), top=False))
    return pieces, {"top": OAK, "frame": DARK_OAK}


def _octagon(x: float, y: float, z: float, r: float) -> list[list[float]]:
    turns = np.pi / 8 + np.pi / 4 * np.arange(8)
    return [[x + r * np.cos(a), y + r * np.sin(a), z] for a in turns]


def chair() -> Model:
    """Seat 43 cm high, back to 86 cm; a sitter looks along +x."""
    pieces = [_cushioned("seat", (-21, -21, 40), (22, 21, 43), 0.8)]
    for sy in (-1, 1):
        front = [_square(18, sy * 17.5, 0, 1.3), _square(17.5, sy * 17.5, 40.5, 1.8)]
        pieces.append(loft("wood", front, top=False))
        back = [_square(z_x, sy * 18, z, r) for z, z_x, r in ((0, -20, 1.4), (42, -18.5, 1.8), (86, -24, 1.3))]
        pieces.append(loft("wood", back))
    for low, high in ((74, 84), (60, 65)):
        slope = (high + low) / 2
        x = -18.5 - 5.5 * (slope - 42) / 44
        pieces.append(box("seat", (x - 0.9, -17, low), (x + 0.9, 17, high)))
    return pieces, {"seat": (84, 118, 122), "wood": OAK}


def _cushioned(layer: str, low: tuple[float, ...], high: tuple[float, ...], bevel: float) -> Piece:
    """A box whose upper edges are cut off: 20 triangles."""
    levels = [(low[2], 0.0), (high[2] - bevel, 0.0), (high[2], bevel)]
    return loft(layer, [rectangle(low, high, z, inset) for z, inset in levels])


def _square(x: float, y: float, z: float, half: float) -> list[list[float]]:
    return [[x - half, y - half, z], [x + half, y - half, z], [x + half, y + half, z], [x - half, y + half, z]]


def door() -> Model:
    """The leaf: hinge at the origin, 80 cm along x, 4 cm thick, 2 m high, panels and a lever on both faces."""
    pieces = [_panelled_leaf()]
    for side in (-1.0, 1.0):
        pieces += _lever(side)
    for z in (25.0, 100.0, 175.0):
        pieces.append(lathe("metal", [(0.9, -4.5), (0.9, 4.5), (0.0, 4.7)], 5).moved(0.0, 0.0, z))
    return pieces, {"leaf": (176, 134, 92), "metal": STEEL}


def _panelled_leaf() -> Piece:
    """The leaf with two sunk panels a face."""
    corners: list[list[float]] = []
    faces: list[list[int]] = []

    def add(points: list[list[float]], order: list[list[int]]) -> None:
        start = len(corners)
        corners.extend(points)
        faces.extend([[start + i for i in f] for f in order])

    xs, zs = [0.5, 13.0, 67.0, 80.0], [0.0, 16.0, 86.0, 102.0, 186.0, 200.0]
    for side in (-1.0, 1.0):
        y = 2.0 * side
        for i in range(3):
            for k in range(5):
                x0, x1, z0, z1 = xs[i], xs[i + 1], zs[k], zs[k + 1]
                outer = [[x0, y, z0], [x1, y, z0], [x1, y, z1], [x0, y, z1]]
                if i == 1 and k in (1, 3):
                    inner = [
                        [x0 + 1, y - 0.9 * side, z0 + 1],
                        [x1 - 1, y - 0.9 * side, z0 + 1],
                        [x1 - 1, y - 0.9 * side, z1 - 1],
                        [x0 + 1, y - 0.9 * side, z1 - 1],
                    ]
                    order = [[j, (j + 1) % 4, 4 + (j + 1) % 4, 4 + j] for j in range(4)] + [[4, 5, 6, 7]]
                    add(outer + inner, order if side < 0 else [f[::-1] for f in order])
                else:
                    add(outer, [[0, 1, 2, 3] if side < 0 else [3, 2, 1, 0]])
    for k in range(5):  # the two edges, in the steps of the faces so that the surface is closed
        for x, flip in ((xs[0], True), (xs[3], False)):
            edge = [[x, -2, zs[k]], [x, 2, zs[k]], [x, 2, zs[k + 1]], [x, -2, zs[k + 1]]]
            add(edge, [[3, 2, 1, 0] if flip else [0, 1, 2, 3]])
    for i in range(3):
        for z, flip in ((zs[0], True), (zs[5], False)):
            edge = [[xs[i], -2, z], [xs[i + 1], -2, z], [xs[i + 1], 2, z], [xs[i], 2, z]]
            add(edge, [[3, 2, 1, 0] if flip else [0, 1, 2, 3]])
    return Piece("leaf", np.array(corners), faces)


def _lever(side: float) -> list[Piece]:
    """A lever handle on one face: rose, spindle at x = 74, z = 102, and a bar of 1.1 cm radius back to x = 62."""
    rose = lathe("metal", [(2.6, 0.0), (2.6, 0.7), (0.0, 0.9)], 8).turned("x", 90)
    path = [[74.0, 0.0, 0.0], [74.0, -4.2, 0.0], [73.1, -5.2, 0.0], [71.8, -5.5, 0.0], [62.0, -5.5, 0.0]]
    bar = tube("metal", path, [0.9, 0.95, 1.05, 1.1, 1.1], 6)
    pieces = [rose.moved(74.0, 0.0, 0.0), bar]
    pieces = [p.moved(0.0, -2.0, 102.0) for p in pieces]
    return pieces if side < 0 else [p.mirrored("y") for p in pieces]


def doorway() -> Model:
    """The frame about a leaf of 80 x 200 cm: jambs, head and architraves; the opening's middle is the origin."""
    pieces = []
    for sx in (-1, 1):
        inner, outer = sx * 40.4, sx * 44.0
        low, high = min(inner, outer), max(inner, outer)
        pieces.append(box("frame", (low, -6, 0), (high, 6, 204), bottom=False))
        for sy in (-1, 1):
            y0, y1 = sorted((sy * 6.0, sy * 7.5))
            a, b = sorted((sx * 40.9, sx * 47.5))
            pieces.append(box("frame", (a, y0, 0), (b, y1, 207.5), bottom=False))
    pieces.append(box("frame", (-40.4, -6, 201), (40.4, 6, 204)))
    for sy in (-1, 1):
        y0, y1 = sorted((sy * 6.0, sy * 7.5))
        pieces.append(box("frame", (-40.9, y0, 201.5), (40.9, y1, 207.5)))
    pieces.append(box("sill", (-40.4, -6, 0.0), (40.4, 6, 0.1), bottom=False))
    return pieces, {"frame": (246, 244, 238), "sill": DARK_OAK}


def television() -> Model:
    """A flat television on a cabinet; the screen looks along +x, its middle 82 cm up."""
    pieces = [
        _cushioned("cabinet", (-22, -48, 6), (18, 48, 44), 0.6),
        box("plinth", (-18, -44, 0), (14, 44, 6), top=False),
        box("front", (18, -46.5, 8), (18.6, -0.4, 42)),
        box("front", (18, 0.4, 8), (18.6, 46.5, 42)),
        slab("body", rounded(26, 44, 6, 2), [(44.0, 0.0), (45.0, 0.0), (45.6, 0.6)]),
        loft("body", [_neck(-2, 8, z) for z in (45.6, 53.0)], bottom=False, top=False),
        bevelled("body", (-5, -45, 50), (5.5, 45, 111), 1.5),
    ]
    pieces.append(_screen())
    return pieces, {
        "cabinet": (96, 70, 50),
        "plinth": BLACK,
        "front": (126, 94, 66),
        "body": BLACK,
        "screen": (90, 130, 180),
    }


def _neck(x: float, half: float, z: float) -> list[list[float]]:
    """A rectangle of a stand at height z."""
    return [[x - 2.5, -half, z], [x + 2.5, -half, z], [x + 2.5, half, z], [x - 2.5, half, z]]


def _screen() -> Piece:
    """The bright field, 84 x 52 cm, just in front of the body."""
    x = 5.6
    return _quad("screen", [(x, -42, 56), (x, 42, 56), (x, 42, 108), (x, -42, 108)])


def switch() -> Model:
    """A round push switch on a plate; pressed along -x, its face 1.2 cm out."""
    plate = slab("plate", rounded(4, 4, 1, 2), [(0.0, 0.0), (0.3, 0.0), (0.4, 0.2)])
    button = lathe("button", [(1.2, 0.2), (1.2, 1.0), (1.0, 1.2), (0.0, 1.2)], 12)
    return [p.turned("y", 90) for p in (plate, button)], {"plate": STEEL, "button": (196, 40, 36)}


def sink() -> Model:
    """A cabinet with a steel top and a basin, 60 x 120 cm, 86 cm high; one stands in front at +x."""
    pieces = [
        box("cabinet", (-28, -59, 10), (28, 59, 82), top=False),
        box("plinth", (-26, -57, 0), (23, 57, 10), top=False, bottom=False),
    ]
    for i in range(3):
        y = -59 + 39.5 * i
        front = _cushioned("front", (-0.0, 0.4, 0.0), (69.0, 38.6, 2.0), 0.5)  # lying; stood up to look along +x
        pieces.append(front.turned("y", 90).moved(28.0, y, 80.0))
    pieces += _worktop()
    return pieces, {
        "cabinet": (206, 204, 196),
        "plinth": (70, 70, 72),
        "front": (150, 174, 172),
        "steel": STEEL,
        "basin": (150, 156, 162),
    }


def _worktop() -> list[Piece]:
    """A steel top with a rounded basin sunk into it: the hole's ring is joined to the border's."""
    n = 12
    outline = rounded(40, 52, 8, 2)
    border = [
        (30, -60),
        (30, -20),
        (30, 20),
        (30, 60),
        (10, 60),
        (-10, 60),
        (-30, 60),
        (-30, 20),
        (-30, -20),
        (-30, -60),
        (-10, -60),
        (10, -60),
    ]
    hole = [(x + 4, y) for x, y in outline]
    rings = [[[x, y, 82.0] for x, y in border], [[x, y, 86.0] for x, y in border]]
    sides = loft("steel", rings, bottom=False, top=False)  # a bottom would close the basin
    top = Piece(
        "steel",
        np.array([[x, y, 86.0] for x, y in border] + [[x, y, 86.0] for x, y in hole]),
        [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)],
    )
    inset = [(4 + 0.86 * (x - 4), 0.9 * y) for x, y in hole]
    walls = [[[x, y, 68.0] for x, y in inset], [[x, y, 86.0] for x, y in hole]]
    basin = loft("basin", walls, top=False)
    basin = Piece("basin", basin.corners, [f[::-1] for f in basin.faces])
    return [sides, top, basin]


def tap() -> Model:
    """A tap whose spout reaches 18 cm forward, the lever on top well over it; the water falls 18 cm below its foot."""
    profile = [(0.0, 0.0), (2.8, 0.0), (2.8, 0.6), (2.1, 1.2), (1.9, 17.0), (2.1, 17.4), (2.1, 19.6), (0.0, 20.2)]
    post = lathe("chrome", profile, 12)
    turns = np.radians(np.linspace(0.0, 150.0, 7))
    arc = [[9.0 - 9.0 * np.cos(a), 0.0, 12.6 + 5.6 * np.sin(a)] for a in turns]
    spout = tube("chrome", [[0.5, 0.0, 9.0], *arc[1:], [17.6, 0.0, 14.0]], 1.0, 8)
    bar = [[0.0, 0.0, 19.6], [0.3, 0.0, 21.4], [1.6, 0.0, 22.6], [10.0, 0.0, 25.0]]
    lever = tube("lever", bar, [0.7, 0.7, 0.7, 0.9], 6)
    stream = lathe("water", [(0.0, -17.8), (0.38, -17.8), (0.42, -2.0), (0.6, 14.3), (0.0, 14.3)], 8).moved(17.7)
    splash = lathe("water", [(0.0, -17.9), (3.4, -17.9), (2.6, -17.5), (0.0, -17.3)], 10).moved(17.7)
    return [post, spout, lever, stream, splash], {
        "chrome": (190, 196, 202),
        "lever": (150, 156, 162),
        "water": (176, 212, 236),
    }


def bed() -> Model:
    """A bed along x, its head at -x; 205 x 98 cm, the mattress 48 cm high."""
    pieces = [
        box("frame", (-100, -48, 14), (100, 48, 28)),
        box("frame", (-102.5, -49, 0), (-98, 49, 80)),
        box("frame", (98, -49, 0), (102.5, 49, 40)),
        _cushioned("sheet", (-97.5, -46, 28), (97.5, 46, 46), 3.0),
        box("quilt", (-45, -47.5, 27), (97.8, 47.5, 48), bottom=False),
    ]
    pillow = slab("sheet", rounded(40, 62, 10, 1), [(46.0, 3.0), (50.0, 0.0), (54.0, 3.5)]).moved(-72.0, 0.0, 0.0)
    return [*pieces, pillow], {"frame": DARK_OAK, "sheet": WHITE, "quilt": (110, 134, 166)}


def lamp() -> Model:
    """A standing lamp with a cloth shade, 155 cm high."""
    profile = [(0.0, 0.0), (14.0, 0.0), (14.0, 1.4), (12.5, 2.2), (2.0, 3.0), (1.1, 4.5), (1.1, 126.0), (0.0, 126.0)]
    base = lathe("metal", profile, 20)
    shade = lathe("shade", [(21.0, 123.0), (13.5, 155.0), (13.1, 155.0), (20.6, 123.0), (21.0, 123.0)], 24)
    bulb = lathe("bulb", [(1.6, 125.0), (1.6, 128.0), (4.0, 133.0), (4.2, 137.0), (2.4, 140.5), (0.0, 141.2)], 12)
    return [base, shade, bulb], {"metal": (70, 62, 54), "shade": (238, 214, 168), "bulb": (255, 246, 220)}


def bookshelf() -> Model:
    """Boards between two sides, 90 cm wide and 1.8 m high, three rows of books 57 cm apart; its front is +x."""
    pieces = [box("wood", (-16, -45, 0), (16, -42.5, 180)), box("wood", (-16, 42.5, 0), (16, 45, 180))]
    pieces.append(_quad("back", [(-15, -42.5, 0), (-15, 42.5, 0), (-15, 42.5, 180), (-15, -42.5, 180)]))
    pieces.append(_quad("back", [(-16, 42.5, 0), (-16, -42.5, 0), (-16, -42.5, 180), (-16, 42.5, 180)]))
    for z in (5.0, 62.0, 119.0, 177.5):
        pieces.append(box("wood", (-15, -42.5, z), (15, 42.5, z + 2.5)))
    for z, y0, y1, height, front in (
        (7.5, -42, -5, 34, 9),
        (7.5, -5, 26, 28, 7),
        (64.5, -34, 4, 30, 8),
        (64.5, 4, 42, 35, 10),
        (121.5, -42, -8, 29, 8),
        (121.5, -8, 12, 34, 9),
    ):
        block = box("pages", (-12, y0, z), (front, y1, z + height), bottom=False)
        pieces.append(Piece("pages", block.corners, [f for f in block.faces if f != [1, 2, 6, 5]]))
        spines = [(front, y0, z), (front, y1, z), (front, y1, z + height), (front, y0, z + height)]
        pieces.append(_quad("books", spines))
    return pieces, {"wood": OAK, "back": (140, 102, 64), "pages": (206, 198, 180), "books": (128, 90, 80)}


def _quad(layer: str, corners: list[tuple[float, float, float]]) -> Piece:
    return Piece(layer, np.array(corners, float), [[0, 1, 2, 3]])


def carton() -> Model:
    """A closed cardboard box, 28 x 36 cm and 28 cm high, taped along the top; carried with a hand at either side."""
    body = bevelled("cardboard", (-14, -18, 0), (14, 18, 28), 0.4)
    tape = box("tape", (-2.5, -17.5, 27.9), (2.5, 17.5, 28.1), bottom=False)
    return [body, tape], {"cardboard": (186, 148, 104), "tape": (206, 190, 150)}
