"""What algorithms are shown at each frame: the human's pose, and what has moved, of what each knows."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from ahmss.algorithm.messages import FRAME_HUMAN, HEADER, Kind, size
from ahmss.body.array import Array
from ahmss.database.records import AlgorithmEntry
from ahmss.database.workspace import Workspace
from ahmss.main.blending import Blending
from ahmss.main.communication import Communication
from ahmss.main.company import MovingSites
from ahmss.main.motion import Motion, Mover, Shown
from ahmss.main.people import People
from ahmss.main.surroundings import NOTHING, Surroundings

__all__ = ["Showing"]

_SELDOM = 4  # frames in which the arms of who is beside are told once: a plan keeps clear of them for a second


class Showing:
    """The human as it was last, and what has moved since the frame before.

    human: (190,) the numbers of a FRAME. changes: (n, 8) numbers and poses of objects, of other humans, and of the
    sites of those whom a motion is about.
    """

    def __init__(self, workspace: Workspace, communication: Communication) -> None:
        self._workspace, self._communication = workspace, communication
        self._surroundings, self._people = Surroundings(), People()
        self._company: tuple[str, ...] = ()
        self._sites: MovingSites | None = None
        self._turn = 0
        self.human = np.zeros(size(FRAME_HUMAN))
        self.changes = NOTHING

    def see(self, blending: Blending, own: Array, motions: Collection[Motion], movers: Collection[Mover]) -> None:
        """Take in the human's pose and what moved.

        Args:
            blending: has the pose. own: (m, 8) of the objects that this human has moved.
            motions, movers: who will ask.
        """
        self.human[1:4] = blending.root
        self.human[4:176] = blending.rotations.reshape(172)
        self.human[176:190] = blending.grips.reshape(14)
        if motions or movers:
            self.changes = self._surroundings.moved(self._communication.world, own)
        else:
            self._surroundings.forget()
        if _asked_for_humans(motions, movers):
            others = self._people.moved(self._communication.world, self._communication.human)
            self.changes = np.concatenate([self.changes, others, self._sites_of(motions)])
        else:
            self._people.forget()

    def _sites_of(self, motions: Collection[Motion]) -> Array:
        """Rows (n, 8) of the sites of whom a motion is about; of others beside, each in its turn."""
        about = dict.fromkeys(name for one in motions for name in one.company)
        company = tuple(dict.fromkeys((*about, *(name for one in motions for name in one.beside))))
        if not company:
            return NOTHING
        if company != self._company or self._sites is None:  # which sites a human has is asked when others are with us
            self._company, self._sites = company, MovingSites(self._workspace)
        self._turn += 1
        now = [name for k, name in enumerate(company) if k < len(about) or (k + self._turn) % _SELDOM == 0]
        return self._sites.rows(self._communication.poses(now))

    def frame(self, k: int, moved: Array, entry: AlgorithmEntry) -> bytes:
        """A human algorithm's FRAME k: the human, and what moved, rows (n, 8)."""
        return _frame(k, self.human, b"", self._told(moved, entry))

    def shown(self, frame: Shown, k: int, pose: Array, entry: AlgorithmEntry | None) -> bytes:
        """An object algorithm's FRAME k: the human, the object's pose (7,), and what moved."""
        return _frame(k, frame.human, pose.tobytes(), self._told(frame.moved, entry))

    def _told(self, moved: Array, entry: AlgorithmEntry | None) -> bytes:
        """What a FRAME says of what moved, rows (n, 8): to who asks for ways humans come first, each with its way."""
        if not len(moved) or entry is None or not entry.ways:
            return moved.tobytes()
        people = moved[:, 0] < 0.0
        humans = moved[people]
        return np.concatenate([humans, self._people.ways(humans[:, 0])], axis=1).tobytes() + moved[~people].tobytes()


def _frame(k: int, human: Array, pose: bytes, moved: bytes) -> bytes:
    human[0] = k
    payload = human.tobytes() + pose + moved
    return HEADER.pack(len(payload), Kind.FRAME) + payload


def _asked_for_humans(motions: Collection[Motion], movers: Collection[Mover]) -> bool:
    """Whether an algorithm wants to know where the other humans are."""
    if any(one.process is not None and (one.company or one.order.human_algorithm.humans) for one in motions):
        return True
    entries = [mover.order.object_algorithm for mover in movers if mover.process is not None]
    return any(entry is not None and entry.humans for entry in entries)
