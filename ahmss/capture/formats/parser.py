"""The incremental parser of all serial formats: a pattern finds whole records, whatever stands between them."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Protocol

from ahmss.capture.formats.losses import Losses
from ahmss.capture.stations import Reading

__all__ = ["Decode", "Parser", "PatternParser"]

Decode = Callable[[list[re.Match[bytes]], Losses, float], list[Reading]]
"""Makes readings of the matches of a format's pattern."""


class Parser(Protocol):
    """What every format's parser does."""

    losses: Losses

    def feed(self, data: bytes, arrival: float = 0.0) -> list[Reading]:
        """The readings that these bytes complete, in their order; never raises, whatever the bytes are."""
        ...


class PatternParser:
    """Searches a stream for whole records.

    A record that lost a byte no longer matches, since its end stands at the wrong place; the search goes on behind its
    first byte and finds the next whole one. So one damage costs one record, and half a record waits for its rest.
    """

    def __init__(self, pattern: re.Pattern[bytes], length: int, decode: Decode) -> None:
        """Args: pattern of one whole record; its length in bytes; what makes readings of the matches."""
        self.losses = Losses()
        self._pattern = pattern
        self._length = length
        self._decode = decode
        self._rest = b""
        self._in_step = True

    def feed(self, data: bytes, arrival: float = 0.0) -> list[Reading]:
        """The readings that these bytes complete, in their order.

        Args:
            data: any number of bytes.
            arrival: when they came, monotonic seconds; the readings carry it.
        """
        buffer = self._rest + data
        matches = list(self._pattern.finditer(buffer))
        end = 0
        for match in matches:
            self._skip(match.start() - end)
            self._in_step = True
            end = match.end()
        keep = max(end, len(buffer) - self._length + 1)
        self._skip(keep - end)
        self._rest = buffer[keep:]
        return self._decode(matches, self.losses, arrival) if matches else []

    def _skip(self, count: int) -> None:
        if count:
            self.losses.skipped_bytes += count
            self.losses.resyncs += self._in_step
            self._in_step = False
