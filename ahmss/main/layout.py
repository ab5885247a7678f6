"""Objects made of objects whose file changes while the world runs: new and moved entries follow the file."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
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
from ahmss.main.standing_in import standing_in
from ahmss.world.schema import ObjectPose
from ahmss.world.view import World

__all__ = ["Layout"]

_EVERY = 60  # frames between two looks at the files
_LOOKS = 8  # for which what has a part in use waits until that is let go


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
    """What this main has follow its files, and what these say of it now.

    That is what it has added, and what it was given as the main that had added it was gone (`ahmss.world.keeping`):
    the server says whose main follows what, and refuses what others say of it. Files are read and the server is told in
    a thread: no frame waits for that. Objects that somebody has carried elsewhere since stay there; those in use follow
    when they are let go. What has a part in use, as a panel whose button is pressed, waits for that some seconds; then
    it is moved, and the part follows it when it is let go.
    """

    def __init__(self, workspace: Workspace, communication: Communication, say: Callable[[str], None]) -> None:
        self._workspace, self._communication, self._say = workspace, communication, say
        self._followed: dict[str, _Followed] = {}
        self._look: Future[_Seen] | None = None
        self._complaints: list[str] = []
        self._waited: dict[str, int] = {}  # looks, of what has a part in use
        self._late: set[str] = set()  # parts whose whole was moved without them

    def remember(self, placed: Sequence[Placed]) -> None:
        """An object was added, with all that it contains."""
        if len(placed) > 1:
            self._followed[placed[0].name] = _Followed(tuple(placed))

    def follow(self, frame: int) -> None:
        """Look at the files once in a second and carry out what has changed in them."""
        if self._look is not None and self._look.done():
            self._take(self._look.result())
            self._look = None
        if frame % _EVERY or self._look is not None:
            return
        kept = self._kept()
        self._followed = {name: followed for name, followed in self._followed.items() if name in kept}
        if kept:
            known = {name: self._followed.get(name) for name in kept}
            self._look = aside(lambda: self._look_at(known))

    def _kept(self) -> list[str]:
        """What this main has follow its file now."""
        objects, human = self._communication.world.objects, self._communication.human
        kept = [name for name, record in objects.items() if record.keeper == human]
        if not kept:
            return kept
        wholes = {record.parent for record in objects.values()}
        return [name for name in kept if name in wholes]

    def _take(self, seen: _Seen) -> None:
        """Keep what a look has found; a file that stays wrong, as one half-written, is complained of once."""
        self._followed |= seen.placed
        for complaint in seen.complaints:
            if complaint not in self._complaints:
                self._say(complaint)
        self._complaints = seen.complaints

    # In the thread

    def _look_at(self, known: Mapping[str, _Followed | None]) -> _Seen:
        """Compare each object with its files; None: it is looked at first, as it is in the world."""
        seen = _Seen()
        if self._late:
            self._fetch({one.name: one for was in known.values() if was is not None for one in was.placed})
        for name, remembered in known.items():
            try:
                was = remembered or self._taken_over(name)
                kinds = {kind: self._workspace.objects.get(kind) for kind in {one.kind for one in was.placed}}
                if kinds.keys() == was.kinds.keys() and all(kinds[kind] is was.kinds[kind] for kind in kinds):
                    continue
                top = was.placed[0]
                now = self._workspace.objects.place(top.kind, name, top.position, top.rotation)
                waiting: frozenset[str] = frozenset()
                if now != was.placed:
                    refusals, waiting = self._change(was.placed, now)
                    seen.complaints += refusals
                # What waits is as it was before, and without kinds the next look compares again.
                seen.placed[name] = _Followed(now, kinds) if not waiting else _Followed(_but(now, was.placed, waiting))
            except AhmssError as error:
                seen.complaints.append(str(error))
        return seen

    def _taken_over(self, name: str) -> _Followed:
        """What another main had follow its file until now, as it is."""
        with self._communication.errand() as client:
            world = client.refresh()
        if name not in world.objects:
            return _Followed(())
        top = world.objects[name]
        x, y, z, w, i, j, k = world.pose(name).tolist()
        return _Followed(standing_in(world, self._workspace.objects.place(top.kind, name, (x, y, z), (w, i, j, k))))

    def _change(self, before: tuple[Placed, ...], now: tuple[Placed, ...]) -> tuple[list[str], frozenset[str]]:
        """Tell the server what changed; its refusals, and what can't be done until it is let go."""
        refusals: dict[str, None] = {}
        waiting: set[str] = set()

        def attempt(change: Callable[[], None]) -> bool:
            try:
                change()
            except Unreachable:  # the next look tries again
                raise
            except WorldError as error:
                refusals[str(error)] = None
                return False
            return True

        changes, human = difference(before, now), self._communication.human
        with self._communication.errand() as client:
            for name in changes.removed:  # children first, and with a child its parents wait
                if not attempt(lambda name=name: client.remove(name, human)):
                    waiting.add(name)
            added = tuple(one for one in changes.added if not _within(one.name, waiting))
            if added:
                attempt(lambda: deliver(client, added, self._workspace, human))
            moved = tuple(one for one in changes.moved if not _within(one.name, waiting))
            world = client.refresh() if moved else None
            for one in moved:
                record = world.objects.get(one.name) if world is not None else None
                if record is None or world is None:
                    continue
                if record.holder:
                    waiting.add(one.name)
                used = _in_use(world, one.name)
                looks = self._waited.get(one.name, 0)
                if used and looks < _LOOKS:
                    self._waited[one.name] = looks + 1
                    waiting.add(one.name)
                    part, holder = used[0], world.objects[used[0]].holder
                    refusals[f"{part} is held by {holder}; {one.name} can be moved when it is let go"] = None
                    continue
                self._waited.pop(one.name, None)
                self._late.update(used)
                attempt(lambda one=one, world=world: client.move([_pose(world, one)], layout=True, keeper=human))
        return list(refusals), frozenset(waiting)

    def _fetch(self, placed: Mapping[str, Placed]) -> None:
        """Put parts that were in use when their whole was moved where they belong, as soon as they are let go."""
        human = self._communication.human
        with self._communication.errand() as client:
            world = client.refresh()
            for name in sorted(self._late):
                record = world.objects.get(name)
                if record is not None and record.holder:
                    continue
                self._late.discard(name)
                if record is not None and name in placed and not record.moved:
                    client.move([_pose(world, placed[name])], layout=True, keeper=human)


def _in_use(world: World, name: str) -> list[str]:
    """The parts of an object that somebody uses where they are."""
    within = ((part, record) for part, record in world.objects.items() if _within(part, {name}) and part != name)
    return [part for part, record in within if record.holder and record.attached]


def _within(name: str, names: Set[str]) -> bool:
    """Whether an object is one of those, or in one of them."""
    return any(name == other or name.startswith(f"{other}/") for other in names)


def _but(now: Sequence[Placed], before: Sequence[Placed], names: Set[str]) -> tuple[Placed, ...]:
    """Entries as they are now, but for those of some names, which are as they were before; parents first.

    What is in one that is only to be moved is as it is now, what is in one that is to be removed is gone.
    """
    kept = {one.name: one for one in before if one.name in names}
    going = names - {one.name for one in now if one.name in kept and kept[one.name].kind == one.kind}
    kept |= {one.name: one for one in now if one.name not in names and not _within(one.name, going)}
    return tuple(sorted(kept.values(), key=lambda one: one.name.count("/")))


def _pose(world: World, placed: Placed) -> ObjectPose:
    """Where an entry belongs in the world, its parent being where it is now."""
    parent = world.pose(placed.parent)
    place = parent[:3] + rotate(parent[3:], np.array(placed.local_position))
    turn = multiply(parent[3:], np.array(placed.local_rotation))
    x, y, z = place.tolist()
    w, i, j, k = turn.tolist()
    return ObjectPose(placed.name, (x, y, z), (w, i, j, k))
