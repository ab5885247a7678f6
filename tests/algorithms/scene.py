"""The shipped room as START messages tell it, and the shipped programs as functions."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from ahmss.algorithm import HumanPose, Transform, frames
from ahmss.algorithm.messages import Goal, ObjectRecord, PoseRecord, ShapeRecord, SiteRecord, Start
from ahmss.body.array import Array
from ahmss.body.inverse import grips, solve
from ahmss.database import Workspace
from ahmss.main.stance import standing

ROOT = Path(__file__).resolve().parents[2]
WORKSPACE = Workspace(ROOT)
CUP, DOOR, TELEVISION, FLOOR = "room/cup", "room/doorway/door", "room/television", "room/floor"


@cache
def module(name: str) -> ModuleType:
    """A shipped program, not run."""
    directory = ROOT / "algorithms" / name
    spec = spec_from_file_location(f"shipped_{name}", directory / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    made = module_from_spec(spec)
    sys.modules[spec.name] = made
    sys.path.insert(0, str(directory))
    try:
        spec.loader.exec_module(made)
    finally:
        sys.path.remove(str(directory))
    return made


def program(name: str) -> Callable[[Any], Any]:
    return getattr(module(name), name)


@cache
def _placed() -> dict[str, Any]:
    return {placed.name: placed for placed in WORKSPACE.objects.place("room", "room")}


def record(
    name: str, frame: Transform | None = None, states: dict[str, Any] | None = None, *, shaped: bool = False
) -> ObjectRecord:
    """An object of the room, where it stands or at a frame."""
    placed = _placed()[name]
    kind = WORKSPACE.objects.get(placed.kind)
    sites = {
        key: SiteRecord(site.position, site.rotation, "z" if site.free_axis else "", site.grip)  # type: ignore[arg-type]
        for key, site in kind.sites.items()
    }
    place, rotation = placed.position, placed.rotation
    if frame is not None:
        place, rotation = tuple(frame.place.tolist()), tuple(frame.rotation.tolist())
    kept = WORKSPACE.objects.kept_shape(placed.kind) if shaped else None
    shape = ShapeRecord(str(kept[0]), kept[1]) if kept is not None else None
    states = states or kind.initial_states
    return ObjectRecord(3, name, placed.kind, place, rotation, sites, kind.properties, states, shape=shape)


def frame_of(name: str) -> Transform:
    placed = _placed()[name]
    return Transform(np.array(placed.position), np.array(placed.rotation))


class Body:
    """A human of humandb/ that stands, and does one motion after another as main would show it."""

    def __init__(self, name: str = "ken", x: float = 0.0, y: float = 0.0, facing: float = -20.0) -> None:
        model, self.name = WORKSPACE.humans.get(name), name
        self.skeleton = model.skeleton
        self.rotations, self.root = standing(model, (x, y), facing)

    def start(self, name: str, action: str, kind: str = "human", frame: Transform | None = None, **given: Any) -> Start:
        """START of an action that an object of the room affords."""
        affordance = WORKSPACE.objects.get(_placed()[name].kind).affordances[action]
        fields: dict[str, Any] = {
            "frames": affordance.frames, "site": affordance.site or "", "hold": affordance.hold, "hand": "right",
            "goal": Goal(), "motion": str(affordance.motion) if affordance.motion else None,
            "parameters": dict(affordance.parameters) if kind == "human" else {},
        }  # fmt: skip
        states = given.pop("states", None)
        named = affordance.human_algorithm if kind == "human" else affordance.object_algorithm or ""
        shaped = bool(named) and WORKSPACE.algorithms.find(named).shape
        return Start(
            kind=kind, human=self.skeleton.to_record(), pose=PoseRecord.of(self.rotations, self.root),
            object=record(name, frame, states, shaped=shaped), **(fields | given),
        )  # fmt: skip

    def do(self, algorithm: str | Callable[[Any], Any], start: Start) -> list[HumanPose]:
        """Play a motion to its end, the limbs solved onto its targets; the poses as they are shown."""
        shown: list[HumanPose] = []
        kept, root = self.rotations, self.root  # what nobody drives stays as it was last
        for pose in frames(program(algorithm) if isinstance(algorithm, str) else algorithm, start):
            driven = pose.importance > 0.0
            kept = rotations = np.where(driven[:43, None], pose.rotations, kept)
            root = pose.root if driven[43] else root
            rotations = solve(self.skeleton, rotations, root, pose.targets)
            shown.append(HumanPose(rotations, root, pose.importance, pose.targets))
        self.rotations, self.root = shown[-1].rotations, shown[-1].root
        return shown

    def grip(self, side: int = 0) -> Transform:
        """Where the right (0) or left (1) palm is."""
        return Transform.of(grips(self.skeleton, self.rotations, self.root)[side])

    def row(self, k: int = 1) -> Array:
        """The numbers of FRAME k of this human as it is now."""
        palms = grips(self.skeleton, self.rotations, self.root).reshape(14)
        return np.concatenate([[k], self.root, self.rotations.reshape(172), palms])

    def rows(self, shown: Iterable[HumanPose]) -> list[Array]:
        """The numbers of the FRAMEs in which these poses are shown, 1 for the first."""
        made: list[Array] = []
        for k, pose in enumerate(shown, 1):
            palms = grips(self.skeleton, pose.rotations, pose.root).reshape(14)
            made.append(np.concatenate([[k], pose.root, pose.rotations.reshape(172), palms]))
        return made
