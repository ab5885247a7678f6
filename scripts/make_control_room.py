"""Make the control room's shapes: DXF files in objectdb/, the same bytes each time.

python scripts/make_control_room.py [WORKSPACE]
"""

from __future__ import annotations

import sys
from pathlib import Path

from room_shapes import controls
from room_shapes.dxf_out import write_dxf

MODELS = (
    "push_button", "latching_button", "lever", "rotary_switch", "key_switch", "gauge", "annunciator", "pump", "desk",
    "castor_chair",
)  # fmt: skip


def main(workspace: Path) -> None:
    """Write everything below `workspace`/objectdb."""
    for name in MODELS:
        pieces, colors = getattr(controls, name)()
        write_dxf(workspace / "objectdb" / name / f"{name}.dxf", pieces, colors)
        print(f"{name:16} {sum(piece.triangles() for piece in pieces):6} triangles")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).resolve().parent.parent)
