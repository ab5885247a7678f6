"""How many polygons the human and the things of the room have (table 5.7)."""

from __future__ import annotations

from ahmss.database.workspace import Workspace

__all__ = ["ROWS", "polygons"]

ROWS = {
    "human": ("ken",), "chair": ("chair",), "table": ("table",), "door": ("doorway", "door"), "floor": ("floor",),
    "sink": ("sink", "tap"), "television": ("television", "switch"), "wall 1": ("wall_1",), "wall 2": ("wall_2",),
    "bed": ("bed",), "lamp": ("lamp",), "bookshelf": ("bookshelf",), "cup": ("cup",),
}  # fmt: skip
"""The models of the table, and the kinds that they are made of here; the first is a body of humandb/."""


def polygons(workspace: Workspace) -> dict[str, int]:
    """Triangles of each model as it is shown; what a workspace lacks is left out."""
    humans, kinds = workspace.humans.names(), workspace.objects.names()
    counts: dict[str, int] = {}
    for model, parts in ROWS.items():
        if model == "human" and parts[0] in humans:
            counts[model] = workspace.humans.shape(parts[0]).faces
        elif set(parts) <= set(kinds):
            shapes = [workspace.objects.shape(part) for part in parts]
            counts[model] = sum(shape.faces for shape in shapes if shape is not None)
    return counts
