"""The lines that human models have sent: what becomes of each, and what happened in which order."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ahmss.errors import CommandError
from ahmss.main.command import Do
from ahmss.main.script import Step
from ahmss.port.schema import Event, Part, Result

if TYPE_CHECKING:
    from ahmss.main.process import MainProcess

__all__ = ["OVER", "Entry", "Ledger"]

OVER = ("done", "failed", "cancelled")
_MOST_WAITING = 32  # lines; a mind that sends more does not look at what comes of them
_REMEMBERED = 256  # lines that are over, and events
_MOST_TEXT = 2000  # characters of a reason, and of all notes


@dataclass
class Entry:
    """One line: its number, how it was understood, and what has become of it."""

    number: int
    text: str
    step: Step
    status: str = "waiting"
    reason: str = ""
    notes: list[str] = field(default_factory=list[str])
    began: int = 0
    ended: int = 0
    marks: tuple[int, int] = (0, 0)


class Ledger:
    """Follows the agenda; belongs to the frame loop. Old lines and events are forgotten."""

    def __init__(self, main: MainProcess) -> None:
        self._main = main
        self._entries: dict[int, Entry] = {}
        self._over: deque[int] = deque()
        self._events: deque[Event] = deque(maxlen=_REMEMBERED)
        self._next_number = self._next_event = 1
        main.agenda.follower = self

    @property
    def open(self) -> list[Entry]:
        """The lines that are not over, in their order."""
        return [entry for entry in self._entries.values() if entry.status not in OVER]

    def check_room(self) -> None:
        """CommandError: too many lines wait."""
        if len(self.open) > _MOST_WAITING:
            raise CommandError(
                f"{_MOST_WAITING} lines wait already, which is the most; wait for the result of one, cancel it, or stop"
            )

    def accept(self, line: Do, text: str) -> Entry:
        """Enter a line, to be carried out after those before it."""
        entry = Entry(self._next_number, text, Step(line, self._next_number, ""))
        self._next_number += 1
        self._entries[entry.number] = entry
        self._note("accepted", entry, text)
        self._main.agenda.add(entry.step)
        return entry

    def get(self, number: int) -> Entry:
        """A line by its number. CommandError: there is none."""
        entry = self._entries.get(number)
        if entry is None:
            known = ", ".join(str(known) for known in list(self._entries)[-8:]) or "none yet"
            forgotten = "it was forgotten" if 0 < number < self._next_number else "none was accepted under it"
            raise CommandError(f"no line has number {number}: {forgotten}; the last are: {known}")
        return entry

    def result(self, entry: Entry, request: int) -> Result:
        """What has become of a line until now."""
        running = entry.status == "running"
        end = self._main.report.frames if running else entry.ended
        parts = [Part(*part) for part in self._main.control.progress] if running else []
        notes = self._notes(entry) if running else entry.notes
        return Result(
            request, entry.number, entry.text, entry.status, entry.reason, max(0, end - entry.began), parts, notes
        )

    def events(self, since: int) -> tuple[list[Event], int, int]:
        """Events from a number on, the number of the next one, and how many of those asked for are forgotten."""
        found = [event for event in self._events if event.event >= since]
        first = found[0].event if found else self._next_event
        return found, self._next_event, max(0, first - max(since, 1))

    # What the agenda tells

    def began(self, step: Step) -> None:
        """A line is being carried out."""
        entry = self._of(step)
        if entry is not None:
            report = self._main.report
            entry.status, entry.began = "running", report.frames
            entry.marks = (len(report.messages), len(report.notes))
            self._note("began", entry, entry.text)

    def ended(self, step: Step, *, failed: bool) -> None:
        """A line is over."""
        entry = self._of(step)
        if entry is not None:
            entry.notes = self._notes(entry)
            if failed:
                said = "; ".join(self._main.report.messages[entry.marks[0] :])
                entry.reason = said[:_MOST_TEXT] or "it could not be done"
            self._close(entry, "failed" if failed else "done")

    def dropped(self, step: Step) -> None:
        """A line was given up."""
        entry = self._of(step)
        if entry is not None:
            entry.notes = self._notes(entry) if entry.status == "running" else []
            self._close(entry, "cancelled")

    def _of(self, step: Step) -> Entry | None:
        """The entry of a step; None for one of the console or of a script."""
        entry = self._entries.get(step.number)
        return entry if entry is not None and entry.step is step else None

    def _notes(self, entry: Entry) -> list[str]:
        kept: list[str] = []
        for note in self._main.report.notes[entry.marks[1] :]:
            if sum(map(len, kept)) + len(note) > _MOST_TEXT:
                break
            kept.append(note)
        return kept

    def _close(self, entry: Entry, status: str) -> None:
        if entry.status == "waiting":
            entry.began = self._main.report.frames
        entry.status, entry.ended = status, self._main.report.frames
        self._note(status, entry, entry.reason or entry.text)
        self._over.append(entry.number)
        if len(self._over) > _REMEMBERED:
            del self._entries[self._over.popleft()]

    def _note(self, kind: str, entry: Entry, text: str) -> None:
        self._events.append(Event(self._next_event, kind, entry.number, self._main.report.frames, text))
        self._next_event += 1
