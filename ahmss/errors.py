"""Every error that AHMSS raises on purpose.

    AhmssError
    |- DataError         a file that a user wrote: names the file, the place in it and what is allowed
    |- WorkspaceError    no workspace here, or a path that leads out of it
    |- CommandError      what a person or a script typed
    |- AlgorithmError    an algorithm process that failed: names it and quotes the last of its log
    |- ProtocolError     bytes that the algorithm or world protocol does not allow
    |- WorldError        the virtual-space server refused, with its reason
    |  `- Unreachable    no server answers at that address
    |- PortError         a human model and the main that moves its human
    |  |- PortRefused    the main refused a request, with its reason
    |  |- ActionFailed   what was accepted failed or was given up, with the reason
    |  `- NoAnswer       no main answers at that address
    |- DependencyError   something the machine lacks, with the command that mends it
    `- ShapeError        arrays whose shapes disagree (also a ValueError)

Each message is one sentence: what, where, what to do. The command line prints it and exits with 1.
"""

from __future__ import annotations

from pathlib import Path

__all__ = [
    "ActionFailed",
    "AhmssError",
    "AlgorithmError",
    "CommandError",
    "DataError",
    "DependencyError",
    "NoAnswer",
    "PortError",
    "PortRefused",
    "ProtocolError",
    "ShapeError",
    "Unreachable",
    "WorkspaceError",
    "WorldError",
]


class AhmssError(Exception):
    """The root of the tree; catching it catches all that AHMSS raises on purpose."""


class DataError(AhmssError):
    """A data file is wrong: `file: place: what, and what is allowed`."""

    def __init__(self, file: Path | str, place: str, message: str) -> None:
        self.file = str(file)
        self.place = place
        self.message = message
        where = f"{file}: {place}" if place else f"{file}"
        super().__init__(f"{where}: {message}")


class WorkspaceError(AhmssError):
    """There is no workspace, or a path leads out of it."""


class CommandError(AhmssError):
    """A command that was typed can't be carried out."""


class AlgorithmError(AhmssError):
    """An algorithm process crashed, hung, or sent what the protocol forbids.

    said: the reason alone, where it gave one itself; "" where it did not, and who and when is all that helps.
    """

    def __init__(self, message: str = "", said: str = "") -> None:
        super().__init__(message)
        self.said = said


class ProtocolError(AhmssError):
    """A message breaks the algorithm protocol or the world protocol."""


class WorldError(AhmssError):
    """The virtual-space server refused a request; the message is its reason."""


class Unreachable(WorldError):
    """No server answers at the address."""


class PortError(AhmssError):
    """Something between a human model and a main."""


class PortRefused(PortError):
    """The main refused a request; the message is its reason."""


class ActionFailed(PortError):
    """What was accepted failed, or was given up; the message says why."""


class NoAnswer(PortError):
    """No main answers at the address."""


class DependencyError(AhmssError):
    """The machine lacks a library or a device; the message says how to get it."""


class ShapeError(AhmssError, ValueError):
    """Arrays whose shapes disagree."""
