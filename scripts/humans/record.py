"""What human.toml says of a figure."""

from __future__ import annotations

from typing import Any

import numpy as np

from ahmss.body.links import LINKS
from humans.figure import Figure

__all__ = ["record"]


def record(figure: Figure) -> dict[str, Any]:
    """The file as a tree of plain values."""
    skeleton = figure.skeleton

    def plain(values: Any, digits: int = 6) -> Any:
        return (np.round(np.asarray(values, float), digits) + 0.0).tolist()

    links = {
        name: {
            "offset": plain(skeleton.offsets[i]),
            "tip": plain(skeleton.tips[i]),
            "mass": plain(skeleton.mass[i]),
            "radius": plain(skeleton.radii[i]),
            "limits_deg": plain(np.degrees(skeleton.limits[i]), 3),
        }
        for i, name in enumerate(LINKS)
    }
    return {
        "name": skeleton.name, "sentence": figure.sentence, "stature": skeleton.stature, "sex": skeleton.sex,
        "shape": "shape.glb", "eye": plain(skeleton.eye), "soles": plain(skeleton.soles),
        "grips": plain(skeleton.grips, 9), "links": links,
    }  # fmt: skip
