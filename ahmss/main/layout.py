"""Objects made of objects whose file changes while the world runs: new and moved entries follow the file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field

import numpy as np

from ahmss.body.quaternion import multiply, rotate
from ahmss.database.placement import Placed, difference
from ahmss.database.records import ObjectKind
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, Unreachable, WorldError
from ahmss.main.aside import aside
from ahmss.main.communication import Communication
from ahmss.main.delivery import deliver
from ahmss.world.client import WorldClient
from ahmss.world.schema import ObjectPose
from ahmss.world.view import World

__all__ = ["Layout"]

_EVERY = 60  # frames between two looks at the files


@dataclass(frozen=True)
class _Followed:
    """An object as it was placed, and the records of all the kinds in it as they were then."""

    placed: tuple[Placed, ...]
    kinds: Mapping[str, ObjectKind] = field(default_factory=dict[str, ObjectKind])


@dataclass
class _Seen:
    """What one look has found: objects that were placed anew, and what could not be done, in sentences."""

    placed: dict[str, _Followed] = field(default_factory=dict[str, _Followed])
    complaints: list[str] = field(default_factory=list[str])


class Layout:
    """What this main has added, and what the files say of it now.

    Files are read and the server is told in a thread: no frame waits for that. Objects that somebody has moved since
    stay where they are.
    """

    def __init__(self, workspace: Workspace, communication: Communication, say: Callable[[str], None]) -> None:
        self._workspace, self._communication, self._say = workspace, communication, say
        self._added: dict[str, _Followed] = {}
        self._look: Future[_Seen] | None = None
        self._complaints: list[str] = []

    def remember(self, placed: Sequence[Placed]) -> None:
        """An object was added, with all that it contains."""
        if len(placed) > 1:
            self._added[placed[0].name] = _Followed(tuple(placed))

    def follow(self, frame: int) -> None:
        """Look at the files once in a second and carry out what has changed in them."""
        if self._look is not None and self._look.done():
            self._take(self._look.result())
            self._look = None
        if frame % _EVERY or self._look is not None:
            return
        objects = self._communication.world.objects
        self._added = {name: followed for name, followed in self._added.items() if name in objects}
        if self._added:
            added = self._added
            self._look = aside(lambda: self._look_at(added))

    def _take(self, seen: _Seen) -> None:
        """Keep what a look has found; a file that stays wrong, as one half-written, is complained of once."""
        for name, followed in seen.placed.items():
            if name in self._added:
                self._added[name] = followed
        for complaint in seen.complaints:
            if complaint not in self._complaints:
                self._say(complaint)
        self._complaints = seen.complaints

    # In the thread

    def _look_at(self, added: Mapping[str, _Followed]) -> _Seen:
        """Compare each object with its files."""
        seen = _Seen()
        for name, was in added.items():
            try:
                kinds = {kind: self._workspace.objects.get(kind) for kind in {one.kind for one in was.placed}}
                if kinds.keys() == was.kinds.keys() and all(kinds[kind] is was.kinds[kind] for kind in kinds):
                    continue
                top = was.placed[0]
                now = self._workspace.objects.place(top.kind, name, top.position, top.rotation)
                if now != was.placed:
                    seen.complaints += self._change(was.placed, now)
                seen.placed[name] = _Followed(now, kinds)
            except AhmssError as error:
                seen.complaints.append(str(error))
        return seen

    def _change(self, before: tuple[Placed, ...], now: tuple[Placed, ...]) -> list[str]:
        """Tell the server what changed; its refusals."""
        refusals: list[str] = []

        def attempt(change: Callable[[], None]) -> None:
            try:
                change()
            except Unreachable:  # the next look tries again
                raise
            except WorldError as error:
                refusals.append(str(error))

        changes = difference(before, now)
        with self._communication.errand() as client:
            for name in changes.removed:
                attempt(lambda name=name: client.remove(name))
            if changes.added:
                attempt(lambda: deliver(client, changes.added, self._workspace))
            if changes.moved:
                attempt(lambda: _move(client, changes.moved))
        return refusals


def _move(client: WorldClient, entries: Sequence[Placed]) -> None:
    """Put entries where their file says, but for those that somebody holds or has moved."""
    world = client.refresh()
    records = world.objects
    still = [one for one in entries if (record := records.get(one.name)) and not (record.moved or record.holder)]
    client.move([_pose(world, one) for one in still], layout=True)


def _pose(world: World, placed: Placed) -> ObjectPose:
    """Where an entry belongs in the world, its parent being where it is now."""
    parent = world.pose(placed.parent)
    place = parent[:3] + rotate(parent[3:], np.array(placed.local_position))
    turn = multiply(parent[3:], np.array(placed.local_rotation))
    x, y, z = place.tolist()
    w, i, j, k = turn.tolist()
    return ObjectPose(placed.name, (x, y, z), (w, i, j, k))
