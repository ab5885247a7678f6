"""Make the shapes and tables of keyboard, touch panel, manual and telephone in objectdb/.

The same bytes each time.

python scripts/make_devices.py [WORKSPACE]
"""

from __future__ import annotations

import sys
import textwrap
from pathlib import Path

from room_shapes import devices
from room_shapes.dxf_out import write_dxf

MODELS = ("keyboard", "touch_panel", "manual", "telephone", "handset")


def main(workspace: Path) -> None:
    """Write everything below `workspace`/objectdb."""
    objectdb = workspace / "objectdb"
    for name in MODELS:
        pieces, colors = getattr(devices, name)()
        write_dxf(objectdb / name / f"{name}.dxf", pieces, colors)
        print(f"{name:12} {sum(piece.triangles() for piece in pieces):6} triangles")
    _keyboard(objectdb / "keyboard")


def _keyboard(folder: Path) -> None:
    """The table of its keys, and how each of them looks while it is pressed."""
    keys = devices.keys()
    (folder / "keys.toml").write_text(_table(keys))
    (folder / "object.toml").write_text(_object(keys))


def _table(keys: list[devices.Key]) -> str:
    """Where each key is, what it writes, whose it is."""
    lines = [
        "# Written by scripts/make_devices.py. Keys by name: their middle, metres from the keyboard's to who types and",
        "# to their right; how deep and wide they are; what they write; the finger that has them.",
        f"travel = {0.01 * devices.TRAVEL:g}",
        f"top = {0.01 * devices.TOP:g}                  # metres: how high the tops of the keys are",
        "size = [0.132, 0.31, 0.02]",
        "mass = 0.9",
    ]
    for key in keys:
        x, y, deep, wide = (round(0.01 * value, 5) for value in (*key.at, *key.size))
        lines += ["", f"[keys.{key.name}]", f"at = [{x}, {y}]", f"size = [{deep}, {wide}]"]
        lines += [f'writes = "{key.writes}"', f'finger = "{key.finger}"']
    return "\n".join(lines) + "\n"


def _object(keys: list[devices.Key]) -> str:
    """The object's file: its own lines, and an appearance for each key."""
    names = ", ".join(f'"{name}"' for name in ["none", *(key.name for key in keys)])
    text = KEYBOARD.replace("NAMES", _wrapped(names))
    for key in keys:
        text += f"""
[[appearances]]
parts = [{_parts(key)}]
when = "key == {key.name}"
by = "depth"
move = [0.0, 0.0, {-0.01 * devices.TRAVEL:g}]
lit = 0.5
"""
    return text


def _parts(key: devices.Key) -> str:
    """What of the shape goes down with it."""
    return f'"key_{key.name}"' + (f', "legend_{key.name}"' if key.legend else "")


def _wrapped(names: str) -> str:
    return "\n    " + "\n    ".join(textwrap.wrap(names, 110, break_long_words=False)) + ",\n"


KEYBOARD = """# Written by scripts/make_devices.py, which has the places of the keys.
name = "keyboard"
sentence = "A keyboard: it writes capitals, digits and signs, as one who touch-types presses its keys."
shape = "keyboard.dxf"
unit = "cm"
properties = "keys.toml"

[sites.keys]                 # the middle of the tops of its keys: x to who types, z up
position = [0.0, 0.0, 0.02]

[sites.stand]                # before the desk that it lies on, for one who stands there
position = [0.40, 0.0, -0.88]
facing_deg = 180

[states.text]                # what has been typed since the line was begun
text = 200

[states.entered]             # the line that was sent last, by the key enter
text = 200

[states.key]                 # the key that is being pressed
values = [NAMES]

[states.depth]               # how deep it is, of its travel
range = [0.0, 1.0]

[affordances.type]
sentence = "Type a text, finger by finger, both hands over the home row; who stands elsewhere steps there."
human_algorithm = "touch_type"
object_algorithm = "typed"
motion = "../floor/walk.npz"
site = "keys"
needs = { free_hands = 2 }
frames = 0

[affordances.look]
sentence = "Turn the head to it."
human_algorithm = "look"
motion = "../floor/walk.npz"
site = "keys"
frames = 60
"""


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent)
