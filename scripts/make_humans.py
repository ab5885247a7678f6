"""Make the shipped humans: humandb/<name>/human.toml and shape.glb. Needs the packages of the extra `make`.

python scripts/make_humans.py [NAME ...]
"""

from __future__ import annotations

import sys
from pathlib import Path

import tomli_w

sys.path.insert(0, str(Path(__file__).parent))

from humans.build import build
from humans.figure import Figure
from humans.gltf import write
from humans.people import PEOPLE
from humans.record import record

HUMANDB = Path(__file__).parent.parent / "humandb"


def make(figure: Figure) -> None:
    """Write one human's folder."""
    folder = HUMANDB / figure.skeleton.name
    folder.mkdir(parents=True, exist_ok=True)
    body = build(figure)
    (folder / "shape.glb").write_bytes(write(body, figure.skeleton.name))
    (folder / "human.toml").write_text(tomli_w.dumps(record(figure)))
    print(f"{folder.name}: {len(body.faces)} faces, {len(body.positions)} vertices")


def main() -> None:
    """Make those named, or all."""
    for name in sys.argv[1:] or PEOPLE:
        make(PEOPLE[name]())


if __name__ == "__main__":
    main()
