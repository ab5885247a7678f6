"""The humans of the world as objects: of the kind `human`, with sites that go where their bodies go."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

import numpy as np

from ahmss.algorithm.messages import Start
from ahmss.body.array import Array
from ahmss.body.floor_frame import floor_frame
from ahmss.body.skeleton import Skeleton
from ahmss.database.workspace import Workspace
from ahmss.main.body_parts import Parts
from ahmss.world.schema import ObjectRecord
from ahmss.world.view import World

__all__ = [
    "HOLDS",
    "KIND",
    "Everything",
    "Humans",
    "MovingSites",
    "beside",
    "met",
    "numbers",
    "place_of",
    "site_number",
]

KIND = "human"
"""The kind of object that says what a human affords."""

HOLDS = "holds"
"""The state of a human that says whether it has something in a hand: "nothing" or "something"."""

_SITES = 1 << 40  # beyond all ids of objects, which have 32 bits; a float64 holds it
_MOST_SITES = 64


class Humans(Mapping[str, ObjectRecord]):
    """The humans of a world by name, each as an object; ids are the world's with a minus, as algorithms know them."""

    def __init__(self, world: World) -> None:
        self._world = world

    def __getitem__(self, name: str) -> ObjectRecord:
        """One of them. KeyError: no such human."""
        record = self._world.humans[name]
        pose = place_of(self._world, name)
        x, y, z, *rotation = pose.tolist()
        held = any(thing.holder == name and thing.hand for thing in self._world.objects.values())
        states = {HOLDS: "something" if held else "nothing"}
        return ObjectRecord(-record.id, name, KIND, (x, y, z), tuple(rotation), states=dict(states), movable=False)

    def __iter__(self) -> Iterator[str]:
        """Those that have a pose."""
        shown = set(self._world.human_ids.tolist())
        return iter([name for name, record in self._world.humans.items() if record.id in shown])

    def __len__(self) -> int:
        """How many."""
        return len(list(iter(self)))

    def __contains__(self, name: object) -> bool:
        """Whether somebody of that name is there."""
        record = self._world.humans.get(name) if isinstance(name, str) else None
        return record is not None and bool((self._world.human_ids == record.id).any())


class Everything(Mapping[str, ObjectRecord]):
    """Objects and humans by name; an object that is called like a human hides it.

    called: the objects that are parts of others, by the last part of their names.
    """

    def __init__(
        self, objects: Mapping[str, ObjectRecord], humans: Humans, called: Callable[[str], Sequence[str]]
    ) -> None:
        self._objects, self._humans, self.called = objects, humans, called

    def __getitem__(self, name: str) -> ObjectRecord:
        """One of them. KeyError: neither object nor human."""
        return self._objects[name] if name in self._objects else self._humans[name]

    def __iter__(self) -> Iterator[str]:
        """Objects first."""
        yield from self._objects
        yield from (name for name in self._humans if name not in self._objects)

    def __len__(self) -> int:
        """How many."""
        return len(list(iter(self)))

    def __contains__(self, name: object) -> bool:
        """Whether there is one of that name."""
        return name in self._objects or name in self._humans


def met(start: Start) -> tuple[str, ...]:
    """Names of the humans that a motion is about: what it is told to act on, or its goal."""
    return tuple(thing.name for thing in (start.object, start.goal.object) if thing is not None and thing.kind == KIND)


def numbers(start: Start) -> tuple[int, ...]:
    """The ids by which a motion is told of what moves of humans: of the object and the goal, where one of them is a
    human, and of their sites and those of who is beside.
    """
    things = [thing for thing in (start.object, start.goal.object) if thing is not None and met(start)]
    told = [thing for thing in start.world if thing.name in beside(start)]
    sites = [site.id for thing in (*things, *told) for site in thing.sites.values() if site.id]
    return (*(thing.id for thing in things), *sites)


def beside(start: Start) -> tuple[str, ...]:
    """Names of the other humans whose sites a motion is told of."""
    return tuple(thing.name for thing in start.world if thing.kind == KIND and thing.sites)


class MovingSites:
    """The sites of humans that move with their bodies, as the kind has them when it is made.

    Raises:
        AhmssError: the kind is broken.
    """

    def __init__(self, workspace: Workspace) -> None:
        sites = workspace.objects.get(KIND).sites
        self._moving = [index for index, site in enumerate(sites.values()) if site.part]
        self._parts = Parts(site for site in sites.values() if site.part)

    def rows(self, humans: Iterable[tuple[int, Skeleton, list[float]]]) -> Array:
        """Rows (n, 8) of id, place, rotation of the sites of some humans: the world's number, who, and the pose."""
        rows = [
            [site_number(human, index), *row]
            for human, skeleton, pose in humans
            for index, row in zip(self._moving, self._parts.of(skeleton, pose), strict=True)
        ]
        return np.array(rows, float).reshape(-1, 8)


def place_of(world: World, name: str) -> Array:
    """(7,) where a human stands on the floor and which way it faces. KeyError: no such human."""
    root, rotations = world.human(name)
    return np.concatenate(floor_frame(rotations, root))


def site_number(human: int, index: int) -> int:
    """The number by which FRAME calls a site: of the human with that id in the world, the site's place in its kind."""
    return _SITES + human * _MOST_SITES + index
