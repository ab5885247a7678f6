"""Objects made of objects whose file changes while the world runs: new and moved entries follow the file."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ahmss.body.quaternion import multiply, rotate
from ahmss.database.placement import Placed, difference
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError
from ahmss.main.communication import Communication
from ahmss.world.schema import Add, Move, ObjectPose, Remove

__all__ = ["Layout"]

_EVERY = 60  # frames between two looks at the files


class Layout:
    """What this main has added, and what the files say of it now.

    Objects that somebody has moved since stay where they are: the server knows.
    """

    def __init__(self, workspace: Workspace, communication: Communication, say: Callable[[str], None]) -> None:
        self._workspace, self._communication, self._say = workspace, communication, say
        self._added: dict[str, tuple[Placed, ...]] = {}
        self._complaint = ""

    def remember(self, placed: Sequence[Placed]) -> None:
        """An object was added, with all that it contains."""
        if len(placed) > 1:
            self._added[placed[0].name] = tuple(placed)

    def follow(self, frame: int) -> None:
        """Look at the files once in a second and carry out what has changed in them."""
        if frame % _EVERY or not self._added:
            return
        try:
            for name, before in list(self._added.items()):
                if name not in self._communication.objects:
                    del self._added[name]
                    continue
                top = before[0]
                now = self._workspace.objects.place(top.kind, name, top.position, top.rotation)
                if now != before:
                    self._change(before, now)
                    self._added[name] = now
            self._complaint = ""
        except AhmssError as error:  # a file half-written: said once, and looked at again
            if str(error) != self._complaint:
                self._complaint = str(error)
                self._say(self._complaint)

    def _change(self, before: tuple[Placed, ...], now: tuple[Placed, ...]) -> None:
        """Tell the server; shapes go first. A refusal is said like any other that nobody waits for."""
        changes = difference(before, now)
        client = self._communication.client
        for name in changes.removed:
            client.begin(Remove(name))
        if changes.added:
            client.begin(Add([self._communication.describe(placed, self._workspace) for placed in changes.added]))
        if changes.moved:
            client.begin(Move([self._pose(placed) for placed in changes.moved], layout=True))

    def _pose(self, placed: Placed) -> ObjectPose:
        """Where an entry belongs in the world, its parent being where it is now."""
        parent = self._communication.pose(placed.parent)
        place = parent[:3] + rotate(parent[3:], np.array(placed.local_position))
        turn = multiply(parent[3:], np.array(placed.local_rotation))
        x, y, z = place.tolist()
        w, i, j, k = turn.tolist()
        return ObjectPose(placed.name, (x, y, z), (w, i, j, k))
