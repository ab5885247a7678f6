"""How long an algorithm's process may take."""

from __future__ import annotations

import msgspec

__all__ = ["Deadlines"]


class Deadlines(msgspec.Struct, frozen=True):
    """How long a process may take, in seconds; until it answers, without those in which it has no processor."""

    start: float = 10.0  # until its first word
    first: float = 5.0  # from that to its first pose, for which it may have much to read and to compute
    frame: float = 1.0  # until it answers a FRAME
    stop: float = 0.5  # from STOP to SIGTERM, and from that to SIGKILL
