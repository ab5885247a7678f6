"""A played scenario as arrays: what `Recorded` has, and the states of things; and how deep the skin is in them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ahmss.bench.skin import Skin
from ahmss.bench.solids import Solids
from ahmss.body.array import Array
from ahmss.body.links import LINKS
from ahmss.body.quaternion import normalize
from ahmss.database.workspace import Workspace
from ahmss.motion.contact import foot_points
from ahmss.world.recording import Reader
from ahmss.world.view import World

from .recorded import Recorded

NEAR = 1.9  # metres beyond which a thing is not touched
LOW = 0.002  # metres over the floor: a point of a foot so low bears


@dataclass(frozen=True)
class Met:
    """Skin in a thing: metres, the thing, the link, the frame."""

    depth: float
    thing: str
    link: str
    frame: int


def states_of(path: Path, names: Iterable[str]) -> Mapping[str, list[Mapping[str, object]]]:
    """The states of things at each tick from the first in which they are all there."""
    names, world = tuple(names), World()
    found: dict[str, list[Mapping[str, object]]] = {name: [] for name in names}
    with Reader(path) as reader:
        for tick in range(len(reader)):
            reader.show(tick, world)
            if set(names) <= set(world.objects):
                for name in names:
                    found[name].append(dict(world.objects[name].states))
    return found


def met(
    path: Path, human: str, workspace: Path, every: int, least: float = 0.003, ticks: range | None = None,
    filled: str = "", ends: str | tuple[str, ...] = "",
) -> list[Met]:  # fmt: skip
    """Where the skin of a human is in a thing by more than `least` metres, deepest first; every so many frames.

    A round thing that nobody has counts as filled, and one of a name. ticks: those that are looked at; left out: all.
    ends: of the names of the links that are looked at.
    """
    kinds = Workspace(workspace)
    skin, solids, world = Skin.read(kinds.humans.shape(human).glb), Solids(kinds), World()
    looked = np.array([LINKS[link].endswith(ends) for link in skin.link])
    skin = replace(skin, vertices=skin.vertices[looked], links=skin.links[looked], weights=skin.weights[looked])
    skeleton, found = kinds.humans.get(human).skeleton, list[Met]()
    with Reader(path) as reader:
        for tick in ticks or range(0, len(reader), every):
            reader.show(tick, world)
            if human not in world.humans or not world.objects:
                continue
            root, rotations = world.human(human)
            points = skin.posed(skeleton, normalize(rotations), root)
            for name, record in world.objects.items():
                pose = world.pose(name)
                if np.linalg.norm(pose[:2] - root[:2]) > NEAR:
                    continue
                depth = solids.depth(record.kind, pose, record.states, points)
                if not record.holder or name == filled:
                    depth = np.maximum(depth, solids.filled(record.kind, pose, points))
                if depth.max() > least:
                    found.append(Met(float(depth.max()), name, LINKS[skin.link[depth.argmax()]], tick))
    return sorted(found, key=lambda one: -one.depth)


def drift(played: Recorded) -> float:
    """How far a point of a foot moves at the most while it bears, metres."""
    points = foot_points(played.skeleton, played.rotations, played.root)
    worst = 0.0
    for track in points.reshape(len(points), -1, 3).swapaxes(0, 1):
        low = np.concatenate([[False], track[:, 2] < LOW, [False]])
        edges = np.flatnonzero(np.diff(low.astype(int)))
        for begin, end in edges.reshape(-1, 2):
            worst = max(worst, float(np.ptp(track[begin:end, :2], axis=0).max()))
    return worst


def caught_at(cup: Array) -> int:
    """The frame from which on a thing (F, 7) goes with the hand."""
    return int(np.flatnonzero(np.linalg.norm(np.diff(cup[:, :3], axis=0), axis=1) > 1e-6)[0]) + 1
