"""Each thing of the control room as solids. Centimetres; a control has x out of its panel and z up along it."""

from __future__ import annotations

import numpy as np

from room_shapes.solids import Piece, bevelled, box, lathe, rounded, slab, tube

Color = tuple[int, int, int]
Model = tuple[list[Piece], dict[str, Color]]

STEEL, BLACK, GREY, CREAM = (176, 182, 188), (34, 36, 40), (96, 102, 108), (236, 232, 218)
OPENS = 100.0  # degrees by which the cover of the key switch is open; the shape has it so
HINGE = (0.7, 0.0, 3.9)


def push_button() -> Model:
    """A round cap in a ring; its face is 1.2 cm out."""
    plate = slab("plate", rounded(4, 4, 0.8, 1), [(0.0, 0.0), (0.3, 0.0), (0.4, 0.1)])
    ring = lathe("ring", [(1.6, 0.3), (1.6, 0.7), (1.35, 0.8), (1.3, 0.3)], 12)
    cap = lathe("button", [(1.2, 0.2), (1.2, 1.05), (1.05, 1.2), (0.0, 1.2)], 12)
    return [_out(p) for p in (plate, ring, cap)], {"plate": GREY, "ring": STEEL, "button": (58, 122, 76)}


def latching_button() -> Model:
    """A square cap in a frame; its face is 1.4 cm out."""
    plate = slab("plate", rounded(4.2, 4.2, 0.5, 1), [(0.0, 0.0), (0.3, 0.0), (0.4, 0.1)])
    cap = slab("button", rounded(2.6, 2.6, 0.4, 1), [(0.3, 0.0), (1.25, 0.0), (1.4, 0.15)])
    return [_out(p) for p in (plate, cap)], {"plate": BLACK, "button": (150, 104, 40)}


def lever() -> Model:
    """A knob on a stem in a slot 10 cm long; it stands at the lower end."""
    plate = slab("plate", rounded(15.6, 5.6, 0.8, 1), [(0.0, 0.0), (0.4, 0.0), (0.5, 0.1)])
    slot = box("slot", (0.5, -0.35, -5.8), (0.56, 0.35, 5.8), bottom=False)
    stem = tube("lever", [[0.3, 0.0, -5.0], [3.6, 0.0, -5.0]], 0.35, 6)
    knob = slab("lever", rounded(2.2, 2.0, 0.5, 1), [(3.2, 0.3), (3.6, 0.0), (5.6, 0.0), (6.0, 0.3)])
    pieces = [_out(plate), slot, stem, _out(knob).moved(0.0, 0.0, -5.0)]
    pieces += [box("marks", (0.5, 1.0, z - 0.08), (0.54, 1.9, z + 0.08), bottom=False) for z in np.linspace(-5, 5, 5)]
    return pieces, {"plate": GREY, "slot": BLACK, "lever": (44, 46, 52), "marks": CREAM}


def rotary_switch() -> Model:
    """A bar on a round knob, from the first of its three positions: up and to the left."""
    plate = slab("plate", rounded(5.6, 5.6, 0.8, 1), [(0.0, 0.0), (0.3, 0.0), (0.4, 0.1)])
    base = lathe("knob", [(1.9, 0.3), (1.9, 1.0), (1.7, 1.2), (0.0, 1.2)], 14)
    bar = slab("knob", rounded(4.2, 1.1, 0.4, 1), [(1.1, 0.0), (3.0, 0.0), (3.3, 0.2)])
    mark = box("mark", (3.3, -0.12, 0.6), (3.35, 0.12, 1.9), bottom=False)
    pieces = [_out(plate), *(p.turned("x", 45.0) for p in (_out(base), _out(bar), mark))]
    for degrees in (45.0, 0.0, -45.0):
        pieces.append(box("marks", (0.4, -0.1, 2.05), (0.44, 0.1, 2.6), bottom=False).turned("x", degrees))
    return pieces, {"plate": GREY, "knob": BLACK, "mark": CREAM, "marks": CREAM}


def key_switch() -> Model:
    """A key in its lock under a hood, which is open; the key stands upright."""
    plate = slab("plate", rounded(9.4, 7.0, 0.8, 1), [(0.0, 0.0), (0.3, 0.0), (0.4, 0.1)])
    lock = lathe("lock", [(1.2, 0.3), (1.2, 1.0), (1.0, 1.2), (0.0, 1.2)], 12)
    blade = box("key", (1.0, -0.12, -0.4), (2.2, 0.12, 0.4))
    head = slab("key", rounded(2.4, 0.8, 0.3, 1), [(2.0, 0.1), (2.2, 0.0), (4.2, 0.0), (4.5, 0.2)])
    pieces = [_out(plate), _out(lock), blade, _out(head)]
    hood = [
        box("cover", (0.6, -3.1, 3.6), (5.6, 3.1, 3.9)),
        box("cover", (5.3, -3.1, -3.4), (5.6, 3.1, 3.6)),
        box("cover", (5.6, -1.3, -3.4), (9.2, 1.3, -2.8)),
    ]
    pieces += [_about_hinge(p) for p in hood]
    return pieces, {"plate": GREY, "lock": STEEL, "key": (196, 60, 48), "cover": (214, 176, 60)}


def gauge() -> Model:
    """A round dial of 10 cm; the needle stands at its beginning, down and to the left."""
    case = lathe("case", [(5.4, 0.0), (5.4, 2.6), (5.0, 2.9), (4.9, 2.5)], 20)
    dial = lathe("dial", [(4.9, 2.5), (0.0, 2.5)], 20)
    needle = Piece("needle", np.array([[0.0, -0.28, -0.6], [0.0, 0.28, -0.6], [0.0, 0.0, 4.1]]), [[0, 1, 2]])
    pieces = [_out(case), _out(dial), needle.moved(2.75).turned("x", 135.0)]
    pieces.append(_out(lathe("hub", [(0.5, 2.5), (0.5, 2.9), (0.0, 2.9)], 8)))
    for k, degrees in enumerate(np.linspace(135.0, -135.0, 11)):
        layer = "red" if k >= 9 else "marks"
        pieces.append(box(layer, (2.5, -0.1, 3.9), (2.56, 0.1, 4.7), bottom=False).turned("x", float(degrees)))
    colors = {"case": BLACK, "dial": CREAM, "needle": (190, 40, 34), "hub": BLACK, "marks": BLACK, "red": (206, 60, 40)}
    return pieces, colors


def annunciator() -> Model:
    """A window of 9 x 5 cm in a frame."""
    frame = bevelled("frame", (0.0, -4.8, -2.8), (1.2, 4.8, 2.8), 0.2)
    window = box("window", (1.1, -4.3, -2.3), (1.4, 4.3, 2.3))
    lines = [
        box("text", (1.4, -3.4, z - 0.18), (1.42, w, z + 0.18), bottom=False) for z, w in ((0.7, 3.4), (-0.7, 1.6))
    ]
    return [frame, window, *lines], {"frame": BLACK, "window": (118, 112, 96), "text": (40, 40, 40)}


def pump() -> Model:
    """A pump on its base, the motor along x; 80 x 45 cm, 70 cm high, a lamp on top."""
    pieces = [
        bevelled("base", (-42, -22, 0), (38, 22, 10), 1.0),
        lathe("motor", [(0.0, 0.0), (14.0, 0.0), (15.0, 1.0), (15.0, 38.0), (14.0, 39.0), (0.0, 39.0)], 16),
        lathe("house", [(0.0, 0.0), (17.0, 0.0), (19.0, 3.0), (19.0, 11.0), (17.0, 14.0), (0.0, 14.0)], 16),
        tube("shaft", [[0.0, 0.0, 30.0], [10.0, 0.0, 30.0]], 3.0, 8),
        tube("pipe", [[17.0, 0.0, 45.0], [17.0, 0.0, 68.0]], 5.0, 10),
        tube("pipe", [[20.0, 0.0, 30.0], [37.0, 0.0, 30.0]], 5.0, 10),
        lathe("flange", [(8.0, 66.0), (8.0, 70.0), (0.0, 70.0)], 12).moved(17.0),
        lathe("lamp", [(2.5, 45.0), (2.5, 48.0), (1.6, 49.4), (0.0, 49.8)], 8).moved(-22.0),
    ]
    pieces[1] = _out(pieces[1]).moved(-38.0, 0.0, 30.0)
    pieces[2] = _out(pieces[2]).moved(10.0, 0.0, 30.0)
    pieces += [box("base", (x, -12, 10), (x + 6, 12, 18), bottom=False) for x in (-34, -10)]
    return pieces, {
        "base": GREY, "motor": (54, 96, 138), "house": (60, 128, 116), "shaft": STEEL, "pipe": STEEL,
        "flange": STEEL, "lamp": (92, 110, 92),
    }  # fmt: skip


def desk() -> Model:
    """A top of 140 x 70 cm at 72 cm on two sides and a back; one sits at +x."""
    pieces = [slab("top", rounded(70, 140, 2, 1), [(69.0, 0.0), (71.6, 0.0), (72.0, 0.3)])]
    pieces += [box("side", (-31, y - 1.5, 0), (29, y + 1.5, 69), top=False) for y in (-64.0, 64.0)]
    pieces.append(box("side", (-31, -62.5, 22), (-29, 62.5, 69), top=False))
    return pieces, {"top": (188, 178, 160), "side": (112, 116, 122)}


def castor_chair() -> Model:
    """A chair on five castors, the seat 46 cm high; a sitter looks along +x."""
    seat = slab("seat", rounded(44, 46, 8, 2), [(40.0, 2.0), (41.0, 0.0), (45.0, 0.0), (46.0, 1.0)])
    back = slab("seat", rounded(34, 42, 8, 2), [(0.0, 1.0), (1.0, 0.0), (3.5, 0.0), (4.5, 1.0)])
    pieces = [seat.moved(0.5), _out(back).turned("y", -8.0).moved(-24.0, 0.0, 74.0)]
    pieces.append(tube("metal", [[-19.0, 0.0, 42.0], [-24.0, 0.0, 46.0], [-25.0, 0.0, 66.0]], [1.6, 1.8, 1.6], 6))
    pieces.append(lathe("metal", [(2.6, 8.0), (2.6, 24.0), (1.8, 24.0), (1.8, 40.5)], 8))
    for k in range(5):
        arm = tube("metal", [[0.0, 0.0, 9.5], [25.0, 0.0, 6.5]], [2.2, 1.4], 5)
        wheel = lathe("wheel", [(0.0, -1.4), (2.8, -1.4), (2.8, 1.4), (0.0, 1.4)], 8).turned("x", 90)
        pieces += [p.turned("z", 36.0 + 72.0 * k) for p in (arm, wheel.moved(25.0, 0.0, 2.8))]
    return pieces, {"seat": (52, 84, 110), "metal": (70, 74, 80), "wheel": BLACK}


def _out(piece: Piece) -> Piece:
    """What was built upwards, lying so that up is x."""
    return piece.turned("y", 90)


def _about_hinge(piece: Piece) -> Piece:
    """A part of the hood, opened."""
    x, y, z = HINGE
    return piece.moved(-x, -y, -z).turned("y", -OPENS).moved(x, y, z)
