"""Shapes out of glTF, GLB, OBJ, STL and PLY, read by trimesh."""

from __future__ import annotations

import io
import logging
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
import trimesh.resolvers

from ahmss.database.soup import Soup
from ahmss.database.workspace import Workspace
from ahmss.errors import DataError, WorkspaceError

__all__ = ["read_mesh"]

logging.getLogger("trimesh").setLevel(logging.CRITICAL)  # what is wrong is said once, by us


def read_mesh(workspace: Workspace, path: Path, label: str) -> Soup:
    """The triangles of a mesh file in its own units and axes.

    Raises:
        DataError: it can't be read, holds no faces, or names a file outside the workspace.
    """
    resolver = _Inside(workspace, path.parent)
    try:
        with path.open("rb") as file, warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")  # what is not finite is refused later, with a count
            scene = trimesh.load_scene(file, file_type=path.suffix[1:].lower(), resolver=resolver, process=False)
            soup = _soup([m for m in scene.dump() if isinstance(m, trimesh.Trimesh) and len(m.faces)])
    except WorkspaceError as error:
        raise DataError(label, "", str(error)) from None
    except Exception as error:  # noqa: BLE001 - trimesh fails in its own many ways on a broken file
        said = str(error).splitlines()[0][:120] if str(error) else type(error).__name__
        raise DataError(label, "", f"no {path.suffix[1:].upper()} file that can be read ({said})") from None
    if soup is None:
        raise DataError(label, "", "no faces: it holds no triangles")
    return soup


def _soup(meshes: list[Any]) -> Soup | None:
    """All meshes as one, each a layer; None where there are none."""
    if not meshes:
        return None
    for mesh in meshes:
        if mesh.vertices.shape[1:] != (3,) or mesh.faces.shape[1:] != (3,):
            raise ValueError(f"corners of {mesh.vertices.shape[-1]} numbers, faces of {mesh.faces.shape[-1]} corners")
        if mesh.faces.min() < 0 or mesh.faces.max() >= len(mesh.vertices):
            raise ValueError(f"a face names corner {int(mesh.faces.max())} of {len(mesh.vertices)}")
    layers = tuple(Path(str(m.metadata.get("name", f"part {i + 1}"))).name for i, m in enumerate(meshes))
    picture = _picture(meshes)
    return Soup(
        np.concatenate([np.asarray(m.triangles, float) for m in meshes]),
        np.concatenate([_colors(m) for m in meshes]),
        np.repeat(np.arange(len(meshes)), [len(m.faces) for m in meshes]),
        layers,
        np.concatenate([_uv(m) for m in meshes]) if any(_has_uv(m) for m in meshes) else None,
        picture,
    )


def _has_uv(mesh: Any) -> bool:
    uv = getattr(mesh.visual, "uv", None)
    return uv is not None and len(uv) == len(mesh.vertices)


def _uv(mesh: Any) -> Any:
    return np.asarray(mesh.visual.uv, float)[mesh.faces] if _has_uv(mesh) else np.zeros((len(mesh.faces), 3, 2))


def _image(mesh: Any) -> Any:
    material = getattr(mesh.visual, "material", None)
    return getattr(material, "baseColorTexture", None) or getattr(material, "image", None)


def _picture(meshes: list[Any]) -> bytes | None:
    """The one picture of the file, as PNG; where it has several, colours must do."""
    images = [_image(mesh) for mesh in meshes if _has_uv(mesh)]
    if len(images) != len(meshes) or any(image is not images[0] for image in images) or images[0] is None:
        return None
    out = io.BytesIO()
    images[0].convert("RGB").save(out, "PNG")
    return out.getvalue()


def _colors(mesh: Any) -> Any:
    """A colour for each face (n, 3)."""
    visual = mesh.visual.to_color() if mesh.visual.kind == "texture" else mesh.visual
    if visual.kind == "vertex":
        return np.round(visual.vertex_colors[mesh.faces][:, :, :3].mean(axis=1)).astype(np.uint8)
    if visual.kind == "face":
        return np.asarray(visual.face_colors)[:, :3].astype(np.uint8)
    return np.full((len(mesh.faces), 3), 200, np.uint8)


class _Inside(trimesh.resolvers.Resolver):
    """Opens what a shape file names (materials, buffers, pictures), if it lies in the workspace."""

    def __init__(self, workspace: Workspace, folder: Path) -> None:
        self.workspace, self.folder = workspace, folder

    def get(self, key: str) -> bytes:
        return self.workspace.inside(self.folder, key).read_bytes()

    def keys(self) -> list[str]:
        return [p.name for p in self.folder.iterdir()]

    def write(self, name: str, data: bytes) -> None:
        raise OSError(f"{name}: shape files are only read, {len(data)} bytes came")

    def namespaced(self, namespace: str) -> _Inside:
        return _Inside(self.workspace, self.workspace.inside(self.folder, namespace))
