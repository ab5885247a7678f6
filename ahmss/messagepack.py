"""Messages in msgpack, read as one of the structs of a protocol; whatever else comes is said to be none."""

from __future__ import annotations

from typing import Any, Generic, TypeVar

import msgspec

from ahmss.errors import ProtocolError

__all__ = ["Reading"]

M = TypeVar("M")


class Reading(Generic[M]):
    """Reads messages of one type, or of a union told apart by their tags.

    Args:
        kind: the struct, or the union of structs.
        otherwise: the sentence that says what the bytes are not; what is wrong with them comes after it.
        see: what may be said after that.
    """

    def __init__(self, kind: Any, otherwise: str, see: str = "") -> None:
        self._decoder: msgspec.msgpack.Decoder[M] = msgspec.msgpack.Decoder(kind)
        self._otherwise, self._see = otherwise, see

    def __call__(self, data: bytes) -> M:
        """The message; ProtocolError where the bytes are none."""
        try:
            return self._decoder.decode(data)
        except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
            raise ProtocolError(f"{self._otherwise}: {error}{self._see}") from error
