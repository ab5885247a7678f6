"""What main hears of an algorithm's process: where it stands, and what came from it."""

from __future__ import annotations

from enum import Enum
from typing import NamedTuple

from ahmss.algorithm.messages import Meant, State
from ahmss.body.array import Array

__all__ = ["Answer", "Arrived", "Done", "Message", "Note", "Phase"]


class Phase(Enum):
    """Where a process stands."""

    STARTING = "starting"  # nothing heard yet
    RUNNING = "running"
    DONE = "done"  # it said that its motion is over
    FAILED = "failed"  # `failure` says why
    STOPPED = "stopped"  # main asked it to end


class Answer(NamedTuple):
    """A frame that was asked for: k, and its row, checked, the caller's to keep.

    A POSE row is (260,), with a way (272,); an OBJECT row (8,).
    """

    k: int
    row: Array


class Done(NamedTuple):
    """The motion is over; `k` is its last frame."""

    k: int


class Note(NamedTuple):
    """Something to tell the person that is no failure, in one line; each is told once."""

    text: str


class Arrived(NamedTuple):
    """The motion is where it acts: what it moves is claimed from now on."""


Message = Answer | State | Note | Meant | Arrived | Done
