"""The objects that one human moves, frame by frame: their algorithms see the human, and say where they are."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np

from ahmss.algorithm.messages import State
from ahmss.body.array import Array
from ahmss.errors import AhmssError
from ahmss.main.blending import Blending
from ahmss.main.claims import Claims
from ahmss.main.communication import Communication
from ahmss.main.hearing import Hearing, in_words
from ahmss.main.motion import Motion, Mover, Shown
from ahmss.main.showing import Showing
from ahmss.main.surroundings import NOTHING, among
from ahmss.processes.answers import Answer, Note
from ahmss.processes.launcher import Launcher

__all__ = ["Moving"]


class Moving:
    """Shows each frame to the algorithms of what is moved, and takes where it is.

    Attributes:
        moved: rows (m, 8) of what moved in the last frame.
    """

    def __init__(
        self, claims: Claims, showing: Showing, communication: Communication, launcher: Launcher, hearing: Hearing
    ) -> None:
        self._claims, self._showing, self._communication = claims, showing, communication
        self._launcher, self._hearing = launcher, hearing
        self.moved = NOTHING

    def show(self, blending: Blending, motions: Sequence[Motion]) -> None:
        """Show the human's new frame; an algorithm that is late is shown it later, none left out."""
        closing = [motion.mover for motion in motions if motion.closing]
        for mover in self._claims.movers:
            if mover.process is not None and mover.process.pending:  # an answer to an older frame, if it has come
                self._collect(mover, motions)
            if mover.watches and mover not in closing:
                moved = among(self._showing.changes, mover.knows)
                mover.show(Shown(self._showing.human.copy(), blending.grips, moved, mover.closed))
            self._show_next(mover)

    def collect(self, blending: Blending, motions: Sequence[Motion], patience: float) -> Array | None:
        """Take where the objects are now; rows (m, 8) of those that moved, for the world."""
        if not self._claims.movers:
            self.moved = self.moved[:0]
            return None
        until = time.monotonic() + patience
        goes_on = True
        while goes_on:
            asked = [mover.process for mover in self._claims.movers if mover.process is not None]
            self._launcher.wait(asked, until - time.monotonic())
            for mover in self._claims.movers:
                self._collect(mover, motions)
            goes_on = any(mover.awaited for mover in self._claims.movers) and time.monotonic() < until
        rows: list[list[float]] = []
        for mover in self._claims.movers:
            mover.stay(blending.grips)
            if mover.granted and mover.fresh:
                rows.append([mover.id, *mover.pose])
                self._communication.put(mover.name, mover.pose)
                mover.fresh = False
        self.moved = np.array(rows).reshape(-1, 8)
        return self.moved if rows else None

    def _show_next(self, mover: Mover) -> None:
        """Ask an object algorithm for the next of the frames that wait for it."""
        process = mover.process
        if process is not None and process.active and mover.frames and not process.pending:
            frame = mover.next()
            if mover.tells(frame):
                process.closed()
            process.ask(self._showing.shown(frame, mover.k, mover.pose, mover.order.object_algorithm))

    def _collect(self, mover: Mover, motions: Sequence[Motion]) -> None:
        """Take what an object algorithm says, and show it the next frame that waits."""
        if mover.process is None:
            return
        try:
            for message in mover.process.receive():
                if isinstance(message, Answer):
                    mover.put(message.row[1:8])
                elif isinstance(message, State):
                    self._hearing.change_states(message)
                elif isinstance(message, Note):
                    self._hearing.tell(mover.order, message.text)
        except AhmssError as error:
            self._lose(mover, motions, in_words(error))
        self._show_next(mover)

    def _lose(self, mover: Mover, motions: Sequence[Motion], reason: str) -> None:
        """An object algorithm has failed: what is in the hand stays fixed to it, anything else stays where it is."""
        mover.process = None
        mover.frames.clear()
        caught = mover.caught or (mover.takes and not any(motion.mover is mover for motion in motions))
        end = "stays fixed to the hand until it is released" if caught else "stays where it is"
        self._hearing.fail(f"{mover.order.title}: {reason}; {mover.name} {end}")
