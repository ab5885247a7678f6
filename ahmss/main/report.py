"""What a main has done, told at its end."""

from __future__ import annotations

from dataclasses import dataclass, field

__all__ = ["Report"]


@dataclass
class Report:
    """What a main has done: frames, those that began late, those that a motion missed, seconds, failures.

    messages: what went wrong. notes: what else algorithms had to say.
    """

    human: str
    frames: int = 0
    late: int = 0
    held: int = 0
    seconds: float = 0.0
    failures: int = 0
    messages: list[str] = field(default_factory=list[str])
    notes: list[str] = field(default_factory=list[str])
