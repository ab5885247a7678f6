"""Make the room's shapes and pictures: DXF and PNG files in objectdb/, the same bytes each time.

python scripts/make_room.py [WORKSPACE]
"""

from __future__ import annotations

import sys
from pathlib import Path

from room_shapes import furniture
from room_shapes.dxf_out import write_dxf, write_grid
from room_shapes.pictures import write_pictures
from room_shapes.solids import Piece

MODELS = (
    "cup", "table", "chair", "door", "doorway", "television", "switch", "sink", "tap", "bed", "lamp", "bookshelf",
    "carton",
)  # fmt: skip


def main(workspace: Path) -> None:
    """Write everything below `workspace`/objectdb."""
    objectdb = workspace / "objectdb"
    for name in MODELS:
        pieces, colors = getattr(furniture, name)()
        write_dxf(objectdb / name / f"{name}.dxf", pieces, colors)
        print(f"{name:12} {sum(piece.triangles() for piece in pieces):6} triangles")
    write_grid(objectdb / "floor" / "floor.dxf", "floor", (186, 160, 128), (-300.0, -300.0), (300.0, 300.0), 72)
    wall_1 = [[0, -210, 0], [0, 210, 0], [0, 210, 250], [0, -210, 250]]  # seen from -x
    wall_2 = [[-168, 0, 0], [168, 0, 0], [168, 0, 250], [-168, 0, 250]]  # seen from +y
    for name, corners in (("wall_1", wall_1), ("wall_2", wall_2)):
        piece = Piece("wall", _array(corners), [[3, 2, 1, 0]])
        write_dxf(objectdb / name / f"{name}.dxf", [piece], {"wall": (232, 226, 212)})
    write_pictures(objectdb)


def _array(corners: list[list[int]]):
    import numpy as np

    return np.array(corners, float)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent)
