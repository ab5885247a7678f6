"""Kinds of objects made for a play: shapes that no shipped kind has, taken and put down as a cup is."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import trimesh

from ahmss.body.array import Array

from .conftest import ROOT

KIND = """
name = "{name}"
sentence = "Something to be taken."
shape = "shape.stl"
unit = "m"

[sites.wall]
{site}

[affordances.reach]
human_algorithm = "reach"
site = "wall"
needs = {{ free_hands = 1 }}
frames = 0

[affordances.grasp]
human_algorithm = "grasp"
object_algorithm = "follow_hand"
site = "wall"
hold = "take"
first = "reach"
needs = {{ free_hands = 1 }}
frames = 30

[affordances.put]
human_algorithm = "lay_down"
motion = "../floor/walk.npz"
site = "wall"
parameters = {{ let_go = false }}
asks = ["goal_position"]
hold = "keep"
frames = 0

[affordances.release]
human_algorithm = "grasp"
site = "wall"
parameters = {{ open = true }}
hold = "release"
frames = 45
"""


def workspace_with(folder: Path, name: str, triangles: Array, site: str) -> None:
    """A workspace with floor, table, humans and a kind of triangles (n, 3, 3), metres; its site `wall` as said."""
    for part in ("humandb", "algorithms"):
        shutil.copytree(ROOT / part, folder / part)
    for kind in ("floor", "table", "human", "textures"):
        shutil.copytree(ROOT / "objectdb" / kind, folder / "objectdb" / kind)
    kind = folder / "objectdb" / name
    kind.mkdir()
    faces = np.arange(3 * len(triangles)).reshape(-1, 3)
    trimesh.Trimesh(triangles.reshape(-1, 3), faces).export(kind / "shape.stl")
    (kind / "object.toml").write_text(KIND.format(name=name, site=site))
