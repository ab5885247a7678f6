"""objectdb/<kind>/object.toml: its schema, and the checks that turn it into an ObjectKind."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, Literal

import msgspec
import numpy as np

from ahmss.body.links import LINKS
from ahmss.body.quaternion import from_axis_angle, multiply
from ahmss.database.document import Document, one_of
from ahmss.database.freshness import Watched
from ahmss.database.records import Affordance, Contained, ObjectKind, Quaternion, Site, State, Vector
from ahmss.database.statefile import affording, read_appearances, read_condition, read_consequences, read_states
from ahmss.database.workspace import Workspace
from ahmss.errors import WorkspaceError

__all__ = [
    "EVERYTHING",
    "NAME",
    "AffordanceEntry",
    "ContainedEntry",
    "ForwardEntry",
    "ObjectFile",
    "SiteEntry",
    "read_object",
]

EVERYTHING = "everything.toml"
"""The file in objectdb/ that says what all kinds with a shape afford; there need not be one."""

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")
Place = tuple[str | int, ...]
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "km": 1000.0, "inch": 0.0254, "foot": 0.3048}
_NEEDS = {"reach", "stature", "free_hands", "full_hands", "standing"}
_PARTS = ("eyes", "right_palm", "left_palm", *LINKS)


class _Turn(msgspec.Struct, forbid_unknown_fields=True, kw_only=True):
    orientation: Quaternion | None = None
    orientation_deg: Vector | None = None
    facing_deg: float | None = None


class SiteEntry(_Turn):
    """[sites.NAME]."""

    position: Vector = (0.0, 0.0, 0.0)
    free_axis: Literal["", "z"] = ""
    grip: Literal["", "power", "precision"] = ""
    part: str = ""


class ContainedEntry(_Turn):
    """[[contains]]."""

    kind: str
    name: str = ""
    position: Vector = (0.0, 0.0, 0.0)


class AffordanceEntry(msgspec.Struct, forbid_unknown_fields=True):
    """[affordances.NAME]."""

    human_algorithm: str
    object_algorithm: str | None = None
    sentence: str = ""
    motion: str | None = None
    site: str | None = None
    asks: list[Literal["goal_position", "facing", "goal_posture", "hand"]] = []
    parameters: dict[str, Any] = {}
    when: str | None = None
    needs: dict[str, float] = {}
    frames: int = 60
    hold: Literal["", "take", "keep", "release", "give", "receive"] = ""
    first: str = ""


class ForwardEntry(msgspec.Struct, forbid_unknown_fields=True):
    """[affordances.NAME] of what the object contains."""

    of: str
    sentence: str = ""


class ObjectFile(msgspec.Struct, forbid_unknown_fields=True):
    """The top of object.toml."""

    name: str | None = None
    sentence: str = ""
    shape: str | None = None
    unit: Literal["m", "cm", "mm", "km", "inch", "foot"] = "m"
    up: Literal["", "y", "z"] = ""
    two_sided: bool | None = None
    color: tuple[int, int, int] | None = None
    texture: str | None = None
    texture_layers: list[str] = []
    texture_size: float = 0.0
    properties: str | dict[str, Any] = {}
    sites: dict[str, dict[str, Any]] = {}
    affordances: dict[str, dict[str, Any]] = {}
    states: dict[str, dict[str, Any]] = {}
    appearances: list[dict[str, Any]] = []
    consequences: list[dict[str, Any]] = []
    falls: bool = True
    contains: list[dict[str, Any]] = []


class _EverythingFile(msgspec.Struct, forbid_unknown_fields=True):
    """The top of everything.toml."""

    affordances: dict[str, dict[str, Any]] = {}


def read_object(workspace: Workspace, path: Path, files: Watched) -> ObjectKind:
    """The kind that object.toml at `path` describes; every file read is added to `files`.

    Raises:
        DataError: names the file, the key with its line, and what is allowed.
    """
    kind = _Reader(workspace, Document(path, workspace.label(path))).kind(files)
    common = workspace.root / "objectdb" / EVERYTHING
    files.add(common)
    if kind.shape is None or not common.is_file():
        return kind
    shared = _Reader(workspace, Document(common, workspace.label(common))).common()
    affordances = {**kind.affordances, **{name: one for name, one in shared.items() if name not in kind.affordances}}
    return msgspec.structs.replace(kind, affordances=affordances)


class _Reader:
    """Turns one object.toml into an ObjectKind."""

    def __init__(self, workspace: Workspace, document: Document) -> None:
        self.workspace, self.document = workspace, document
        self.folder = document.path.parent
        self.error = document.error

    def kind(self, files: Watched) -> ObjectKind:
        top = self.document.convert(self.document.data, ObjectFile)
        name = self.folder.name
        if top.name is not None and top.name != name:
            raise self.error(("name",), f'"{top.name}" is not the name of its folder, "{name}"; make them the same')
        if top.texture_size < 0.0:
            raise self.error(("texture_size",), "is negative; give metres a picture, or 0 to fit it once")
        if top.color and not all(0 <= c <= 255 for c in top.color):
            raise self.error(("color",), "is [red, green, blue], each 0 to 255")
        for state in top.states:
            self._name(state, ("states", state))
        states = read_states(self.document, top.states)
        contains = self._contains(top)
        for name_of, raw in top.affordances.items():
            of = raw.get("of", "")
            if of and of not in [entry.name for entry in contains]:
                have = ", ".join(entry.name for entry in contains) or "nothing"
                raise self.error(("affordances", name_of, "of"), f'contains no "{of}"; this object contains: {have}')
            if (first := raw.get("first", "")) and first not in top.affordances:
                have = ", ".join(top.affordances)
                raise self.error(("affordances", name_of, "first"), f'no action "{first}"; this object has: {have}')
        sites = {n: self._site(v, ("sites", n)) for n, v in top.sites.items()}
        return ObjectKind(
            name=name,
            directory=self.folder,
            sentence=top.sentence,
            shape=self._path(top.shape, ("shape",)),
            unit=top.unit,
            up=top.up,
            two_sided=top.two_sided,
            color=top.color,
            texture=self._path(top.texture, ("texture",)),
            texture_layers=tuple(top.texture_layers),
            texture_size=top.texture_size,
            properties=self._properties(top.properties, files),
            sites=sites,
            states=states,
            appearances=read_appearances(self.document, top.appearances, states),
            consequences=read_consequences(self.document, top.consequences, states, [one.name for one in contains]),
            falls=top.falls,
            affordances={n: self._affordance(n, v, sites, states) for n, v in top.affordances.items()},
            contains=contains,
        )

    def common(self) -> dict[str, Affordance]:
        """What everything.toml has."""
        top = self.document.convert(self.document.data, _EverythingFile)
        return {name: self._affordance(name, raw, {}, {}) for name, raw in top.affordances.items()}

    def _path(self, text: str | None, place: Place) -> Path | None:
        if text is None:
            return None
        try:
            return self.workspace.inside(self.folder, text)
        except WorkspaceError as error:
            raise self.error(place, str(error)) from None

    def _properties(self, value: str | dict[str, Any], files: Watched) -> dict[str, Any]:
        if isinstance(value, dict):
            return value
        path = self._path(value, ("properties",))
        assert path is not None
        files.add(path)
        if not path.exists():
            raise self.error(("properties",), f'no file "{value}"')
        return Document(path, self.workspace.label(path)).data

    def _name(self, name: str, place: Place) -> str:
        if not NAME.fullmatch(name):
            raise self.error(place, f'"{name}" is no name; use letters, digits, _ and -, a letter first')
        return name

    def _rotation(self, entry: _Turn, place: Place) -> Quaternion:
        """The one of orientation (wxyz), orientation_deg (about x, then y, then z) and facing_deg that is given."""
        given = [key for key in ("orientation", "orientation_deg", "facing_deg") if getattr(entry, key) is not None]
        if len(given) > 1:
            raise self.error((*place, given[1]), f"{given[0]} says it already; give one of them")
        if entry.orientation is not None:
            q = np.array(entry.orientation, float)
            length = float(np.linalg.norm(q))
            if abs(length - 1.0) > 1e-3:
                raise self.error(
                    (*place, "orientation"), f"has length {length:.4g}; a rotation is [w, x, y, z] of length 1"
                )
            q = q / length
        else:
            turns = entry.orientation_deg or (0.0, 0.0, entry.facing_deg or 0.0)
            x, y, z = (from_axis_angle(axis, np.radians(turn)) for axis, turn in zip(np.eye(3), turns, strict=True))
            q = multiply(z, multiply(y, x))
        return (float(q[0]), float(q[1]), float(q[2]), float(q[3]))

    def _site(self, raw: dict[str, Any], place: Place) -> Site:
        self._name(str(place[-1]), place)
        entry = self.document.convert(raw, SiteEntry, place)
        if entry.part and entry.part not in _PARTS:
            raise self.error((*place, "part"), f'no part of a human "{entry.part}"{one_of(entry.part, _PARTS)}')
        return Site(entry.position, self._rotation(entry, place), entry.free_axis, entry.grip, entry.part)

    def _contains(self, top: ObjectFile) -> tuple[Contained, ...]:
        out: dict[str, Contained] = {}
        for i, raw in enumerate(top.contains):
            place: Place = ("contains", i)
            entry = self.document.convert(raw, ContainedEntry, place)
            self._name(entry.kind, (*place, "kind"))
            name = self._name(entry.name or entry.kind, (*place, "name"))
            if name in out:
                raise self.error((*place, "name"), f'there is a "{name}" already; give each its own name')
            out[name] = Contained(entry.kind, name, entry.position, self._rotation(entry, place))
        return tuple(out.values())

    def _affordance(
        self, name: str, raw: dict[str, Any], sites: dict[str, Site], states: dict[str, State]
    ) -> Affordance:
        place: Place = ("affordances", self._name(name, ("affordances", name)))
        if "of" in raw:
            forward = self.document.convert(raw, ForwardEntry, place)
            return Affordance(name, "", sentence=forward.sentence, of=forward.of)
        entry = self.document.convert(raw, AffordanceEntry, place)
        if entry.site is not None and entry.site not in sites:
            have = ", ".join(sites) or "none"
            raise self.error((*place, "site"), f'no site "{entry.site}"; this object has: {have}')
        if not 0 <= entry.frames <= 100_000:
            allowed = "1 to 100000, or 0 for as many as it needs"
            raise self.error((*place, "frames"), f"{entry.frames} frames; allowed: {allowed}")
        for need in entry.needs:
            if need not in _NEEDS:
                raise self.error((*place, "needs", need), f'no need "{need}"{one_of(need, _NEEDS)}')
        if entry.hold == "take" and entry.object_algorithm is None:
            raise self.error((*place, "hold"), '"take" wants an object_algorithm that moves what is held')
        for key in ("human_algorithm", "object_algorithm"):
            if getattr(entry, key) is not None:
                self._name(getattr(entry, key), (*place, key))
        return Affordance(
            name=name,
            human_algorithm=entry.human_algorithm,
            object_algorithm=entry.object_algorithm,
            sentence=entry.sentence,
            motion=self._path(entry.motion, (*place, "motion")),
            site=entry.site,
            asks=tuple(entry.asks),
            parameters=entry.parameters,
            when=read_condition(self.document, entry.when, affording(states), (*place, "when")),
            needs=entry.needs,
            frames=entry.frames,
            hold=entry.hold,
            first=entry.first,
        )
