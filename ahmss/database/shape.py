"""The shape of a kind as it travels, converted once for each state of its files, and kept on disk between runs."""

from __future__ import annotations

import hashlib
from pathlib import Path

import msgspec

from ahmss.database import store
from ahmss.database.freshness import Fresh
from ahmss.database.records import ObjectKind, Vector
from ahmss.database.texture import Texture
from ahmss.database.workspace import Workspace

__all__ = ["Shape", "ShapeLoader"]

_VERSION = b"1"  # of what the conversion makes: a new one leaves what was kept aside
_ALONE = (".dxf", ".stl", ".ply", ".glb")  # formats that name no other file
_NAMES_ANOTHER = b"mtllib"  # how a line of an OBJ does


class Shape(msgspec.Struct, frozen=True):
    """A shape as it travels: GLB in the object's frame (metres, z up), SHA-256 of it, triangles, bounds, picture."""

    glb: bytes
    hash: str
    faces: int
    bounds: tuple[Vector, Vector]
    texture: Texture | None = None


class ShapeLoader:
    """Loads shapes once for each state of their files."""

    def __init__(self, workspace: Workspace) -> None:
        self.workspace = workspace
        self._shapes: Fresh[Shape] = Fresh()

    def get(self, kind: ObjectKind) -> Shape | None:
        """The shape of a kind, or None where it has none (see `ObjectDatabase.shape`)."""
        if kind.shape is None:
            return None
        files = [kind.shape] + ([kind.texture] if kind.texture else [])
        key = (
            kind.shape,
            kind.unit,
            kind.up,
            kind.two_sided,
            kind.color,
            kind.texture,
            kind.texture_layers,
            kind.texture_size,
            kind.behaviour.parts,
        )
        return self._shapes.get(key, files, lambda _: self._load(kind, files))

    def _load(self, kind: ObjectKind, files: list[Path]) -> Shape:
        """From the disk's store where it has it: the libraries that read shapes take most of a second to load."""
        kept = _kept_at(kind, files)
        if kept is not None:
            shape = _take(kept)
            if shape is not None:
                return shape
        from ahmss.database.convert import convert_shape

        shape = convert_shape(self.workspace, kind)
        if kept is not None:
            store.keep(kept, msgspec.msgpack.encode(shape))
        return shape


def _kept_at(kind: ObjectKind, files: list[Path]) -> Path | None:
    """Where the converted shape of these very bytes is kept; None for one that must be read."""
    assert kind.shape is not None
    if not _alone(kind.shape):
        return None
    options = (
        kind.shape.suffix.lower(),
        kind.unit,
        kind.up,
        kind.two_sided,
        kind.color,
        kind.texture_layers,
        kind.texture_size,
        *kind.behaviour.parts,
    )
    digest = hashlib.sha256(_VERSION + repr(options).encode())
    for file in files:
        try:
            with file.open("rb") as stream:
                digest.update(hashlib.file_digest(stream, "sha256").digest())
        except OSError:
            return None  # the conversion says what is the matter with it
    return store.place("shapes", digest.hexdigest())


def _alone(shape: Path) -> bool:
    """Whether a shape is all in its file: what another file says of it may change unseen."""
    if shape.suffix.lower() != ".obj":
        return shape.suffix.lower() in _ALONE
    try:
        return _NAMES_ANOTHER not in shape.read_bytes()
    except OSError:
        return False  # the conversion says what is the matter with it


def _take(path: Path) -> Shape | None:
    data = store.take(path)
    if data is None:
        return None
    try:
        shape = msgspec.msgpack.decode(data, type=Shape)
    except msgspec.DecodeError:
        return None
    return shape if hashlib.sha256(shape.glb).hexdigest() == shape.hash else None
