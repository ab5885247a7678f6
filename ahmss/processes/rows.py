"""The rows that an algorithm answers a frame with: bytes as numbers, checked, of the frame that was asked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ahmss.algorithm.messages import OBJECT, POSE, WAY, Kind, size
from ahmss.body.array import Array
from ahmss.errors import ProtocolError
from ahmss.processes.check import check_human, check_object

__all__ = ["OF_HUMAN", "OF_OBJECT", "Rows"]


@dataclass(frozen=True)
class Rows:
    """What one kind of algorithm answers with: the kind of its message, the bytes it may have, and what is checked."""

    kind: Kind
    sizes: tuple[int, ...]
    check: Callable[[Array, int], None]

    def read(self, payload: memoryview, pending: int) -> Array:
        """The row of a message, where frame `pending` was asked for (0: none was).

        Raises:
            ProtocolError: names what is wrong.
        """
        if len(payload) not in self.sizes:
            allowed = " or ".join(map(str, self.sizes))
            raise ProtocolError(f"its {self.kind.name} is {len(payload)} bytes long, not {allowed}")
        if not pending:
            raise ProtocolError("it sent a frame though none was asked for")
        row = np.frombuffer(payload, "<f8").copy()
        self.check(row, pending)
        return row


OF_HUMAN = Rows(Kind.POSE, (8 * size(POSE), 8 * size(POSE + WAY)), check_human)
OF_OBJECT = Rows(Kind.OBJECT, (8 * size(OBJECT),), check_object)
