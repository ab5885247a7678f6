"""humandb/: the humans, each a skeleton and a skinned shape.

humandb/<name>/human.toml:

    name = "ken"                     # may be left out; else the folder's name
    sentence = "A tall operator."
    stature = 1.76                   # metres
    sex = "male"                     # or "female"
    shape = "ken.glb"                # GLB, skinned to the 43 links in their order
    texture = "ken.png"              # optional
    eye = [0.12, 0.0, 0.09]          # optional, in the head's frame; like soles and grips else as `Skeleton.of` has it
    soles = [[...], [...], [...]]    # optional: heel, ball, toe tip in the right foot's frame
    grips = [[...], [...]]           # optional: right and left palm frame in the hand's frame, x y z w x y z

    [links.hips]                     # one table for each of the 43 links
    offset = [0.0, 0.0, 0.0]         # the joint in its parent's frame, metres
    tip = [0.1, 0.0, 0.0]            # the link's end in its own frame
    mass = 8.1                       # kilograms
    radius = 0.14                    # optional: the skin's mean radius around the link, metres
    limits_deg = [[-180, 180], [-180, 180], [-180, 180]]   # about the link's x, y, z, from upright
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import msgspec
import numpy as np

from ahmss.body.links import LINKS
from ahmss.body.skeleton import Skeleton
from ahmss.database.document import Document, one_of
from ahmss.database.freshness import Fresh
from ahmss.database.objectfile import NAME
from ahmss.database.objects import Listing
from ahmss.database.records import HumanModel, Vector
from ahmss.database.shape import Shape
from ahmss.database.texture import read_texture
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, CommandError, DataError, WorkspaceError

__all__ = ["HumanDatabase", "HumanFile", "LinkEntry"]

_MOST_BYTES = 64_000_000
Pose7 = tuple[float, float, float, float, float, float, float]


class LinkEntry(msgspec.Struct, forbid_unknown_fields=True):
    """[links.NAME]."""

    offset: Vector
    tip: Vector
    mass: float
    limits_deg: tuple[tuple[float, float], tuple[float, float], tuple[float, float]]
    radius: float | None = None


class HumanFile(msgspec.Struct, forbid_unknown_fields=True):
    """The top of human.toml."""

    stature: float
    sex: Literal["male", "female"]
    shape: str
    links: dict[str, dict[str, Any]]
    name: str | None = None
    sentence: str = ""
    texture: str | None = None
    eye: Vector | None = None
    soles: tuple[Vector, Vector, Vector] | None = None
    grips: tuple[Pose7, Pose7] | None = None


class HumanDatabase:
    """The humans of a workspace, read anew when a file changes."""

    def __init__(self, workspace: Workspace) -> None:
        self.workspace = workspace
        self.root = workspace.root / "humandb"
        self._humans: Fresh[HumanModel] = Fresh()
        self._shapes: Fresh[Shape] = Fresh()

    def names(self) -> list[str]:
        """All humans, broken ones too, in alphabetical order."""
        if not self.root.is_dir():
            return []
        return sorted(p.name for p in self.root.iterdir() if NAME.fullmatch(p.name) and (p / "human.toml").is_file())

    def get(self, name: str) -> HumanModel:
        """The human `name`.

        Raises:
            CommandError: there is none of that name.
            DataError: its file is wrong.
        """
        path = self.root / name / "human.toml"
        if not NAME.fullmatch(name) or not path.is_file():
            raise CommandError(f'no human "{name}" in humandb/{one_of(name, self.names())}')
        return self._humans.get(name, (path,), lambda _: self._read(path))

    def list(self) -> Sequence[Listing]:
        """Every human with its sentence, a broken one with what is wrong."""
        out: list[Listing] = []
        for name in self.names():
            try:
                human = self.get(name)
                missing = f"humandb/{name}/human.toml: shape: no file {human.shape.name}"
                out.append(Listing(name, human.sentence, "" if human.shape.is_file() else missing))
            except AhmssError as error:
                out.append(Listing(name, error=str(error)))
        return out

    def shape(self, name: str) -> Shape:
        """The human's skinned GLB as it is in its file, with its texture.

        Raises:
            DataError: it is missing, or not a GLB with a skin of the 43 links in their order.
        """
        human = self.get(name)
        files = [human.shape] + ([human.texture] if human.texture else [])
        return self._shapes.get(name, files, lambda _: self._load(human))

    def _read(self, path: Path) -> HumanModel:
        document = Document(path, self.workspace.label(path))
        top = document.convert(document.data, HumanFile)
        folder = path.parent
        if top.name is not None and top.name != folder.name:
            raise document.error(("name",), f'"{top.name}" is not the name of its folder, "{folder.name}"')
        if not 0.5 <= top.stature <= 2.5:
            raise document.error(("stature",), f"{top.stature:g} m; allowed: 0.5 to 2.5")
        shape = self._path(document, "shape", top.shape)
        texture = None if top.texture is None else self._path(document, "texture", top.texture)
        skeleton = _skeleton(document, top, folder.name)
        return HumanModel(folder.name, skeleton, shape, folder, texture, top.sentence)

    def _path(self, document: Document, key: str, text: str) -> Path:
        try:
            return self.workspace.inside(document.path.parent, text)
        except WorkspaceError as error:
            raise document.error((key,), str(error)) from None

    def _load(self, human: HumanModel) -> Shape:
        label = self.workspace.label(human.shape)
        try:
            if human.shape.stat().st_size > _MOST_BYTES:
                raise DataError(label, "", f"larger than {_MOST_BYTES // 1_000_000} MB")
            data = human.shape.read_bytes()
        except OSError as error:
            raise DataError(label, "", f"can't be read: {error.strerror}") from None
        faces = _check_skin(data, label)
        picture = read_texture(human.texture, self.workspace.label(human.texture)) if human.texture else None
        return Shape(data, hashlib.sha256(data).hexdigest(), faces, ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0)), picture)


def _skeleton(document: Document, top: HumanFile, name: str) -> Skeleton:
    """The skeleton of the file; eye, soles and grips that it leaves out are those of usual proportions."""
    for link in top.links:
        if link not in LINKS:
            raise document.error(("links", link), f'no link "{link}"{one_of(link, LINKS)}')
    missing = [link for link in LINKS if link not in top.links]
    if missing:
        raise document.error(("links",), f"{len(missing)} of the 43 links are missing: {', '.join(missing[:5])} ...")
    entries = [document.convert(top.links[link], LinkEntry, ("links", link)) for link in LINKS]
    for link, entry in zip(LINKS, entries, strict=True):
        if entry.mass <= 0.0:
            raise document.error(("links", link, "mass"), f"{entry.mass:g} kg; a mass is more than 0")
        if any(low > high for low, high in entry.limits_deg):
            raise document.error(("links", link, "limits_deg"), "each pair is [lowest, highest]")
    usual = Skeleton.of(top.stature, top.sex, name)
    return Skeleton(
        name=name,
        stature=top.stature,
        sex=top.sex,
        offsets=np.array([e.offset for e in entries], float),
        tips=np.array([e.tip for e in entries], float),
        mass=np.array([e.mass for e in entries], float),
        radii=np.array([u if e.radius is None else e.radius for e, u in zip(entries, usual.radii, strict=True)], float),
        limits=np.radians(np.array([e.limits_deg for e in entries], float)),
        grips=usual.grips if top.grips is None else np.array(top.grips, float),
        soles=usual.soles if top.soles is None else np.array(top.soles, float),
        eye=usual.eye if top.eye is None else np.array(top.eye, float),
    )


def _check_skin(data: bytes, label: str) -> int:
    """The number of faces of a GLB whose skin has the 43 links in their order."""
    if data[:4] != b"glTF" or len(data) < 20:
        raise DataError(label, "", "no GLB file; a human's shape is a GLB skinned to the 43 links")
    try:
        header = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
        joints = [header["nodes"][i].get("name", "") for i in header["skins"][0]["joints"]]
        primitives = [p for mesh in header["meshes"] for p in mesh["primitives"]]
        faces = sum(header["accessors"][p["indices"]]["count"] // 3 for p in primitives)
    except (ValueError, KeyError, IndexError, TypeError):
        raise DataError(label, "", "its GLB header has no skinned, indexed mesh; export it with its skin") from None
    if tuple(joints) != LINKS:
        raise DataError(label, "", f"its skin has {len(joints)} joints; it must have the 43 links in their order")
    return faces
