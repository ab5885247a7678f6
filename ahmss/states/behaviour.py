"""How a kind of object behaves in the world: what of it travels to the server and to viewers, one record a kind.

An object's file says it, the main that adds the object sends it as an asset (JSON), and every object of the kind names
that asset: forty buttons share one.
"""

from __future__ import annotations

from functools import cached_property

import msgspec

from ahmss.errors import ProtocolError
from ahmss.states.condition import Condition
from ahmss.states.state import State

__all__ = ["PART", "Appearance", "Behaviour", "Consequence", "decode_behaviour"]

PART = "part/"
"""Before its name, what the mesh of a part is called in a shape as it travels."""

Vector = tuple[float, float, float]


class Appearance(msgspec.Struct, frozen=True, omit_defaults=True):
    """How parts of the shape look while the object is in some states.

    parts: layers of the shape. when: None: always. shown, color (sRGB, 0 to 255), lit (how much of its light is its
    own, 0 to 1): None: as before. move: metres, in the object's frame. turn: radians about `axis` through `pivot`.
    by: a state that is a number; move, turn and lit grow with it, from nothing at the low end of its range.
    """

    parts: tuple[str, ...]
    when: Condition | None = None
    shown: bool | None = None
    color: tuple[int, int, int] | None = None
    lit: float | None = None
    move: Vector = (0.0, 0.0, 0.0)
    turn: float = 0.0
    axis: Vector = (0.0, 0.0, 1.0)
    pivot: Vector = (0.0, 0.0, 0.0)
    by: str = ""


class Consequence(msgspec.Struct, frozen=True, omit_defaults=True):
    """What a change of an object's own states brings about, or of the states of what it contains.

    at: what it contains by this name, whose states `when` and `source` are; "": its own. when: it happens when this
    comes true; None: at each change of the state `source`. of: whose state is set: "" its own, ".." of what contains
    it, `lamp` of what it contains, `../lamp` of what is beside it. to: the value, or "toggle" for the next. source: a
    state whose value is taken over instead, from range to range.
    """

    state: str
    of: str = ""
    when: Condition | None = None
    to: str | float | None = None
    source: str = ""
    at: str = ""


class Behaviour(msgspec.Struct, frozen=True, omit_defaults=True, dict=True):
    """What is the same for all objects of a kind; falls: let go, it comes to rest on what is under it."""

    states: dict[str, State] = {}
    appearances: tuple[Appearance, ...] = ()
    consequences: tuple[Consequence, ...] = ()
    falls: bool = True

    @cached_property
    def parts(self) -> tuple[str, ...]:
        """The parts of the shape whose look depends on states, each once, in order."""
        return tuple(dict.fromkeys(part for one in self.appearances for part in one.parts))

    @cached_property
    def wired(self) -> dict[str, tuple[Consequence, ...]]:
        """The consequences by what they are `at`: "" those of its own states."""
        out: dict[str, tuple[Consequence, ...]] = {}
        for one in self.consequences:
            out[one.at] = (*out.get(one.at, ()), one)
        return out

    @cached_property
    def unsteady(self) -> frozenset[str]:
        """Parts that are not there in every state, as the water of a tap: nothing rests on them."""
        return frozenset(part for one in self.appearances if one.shown is not None for part in one.parts)

    def encode(self) -> bytes:
        """The asset; no bytes for a kind of which nothing is to be said."""
        return b"" if self == Behaviour() else msgspec.json.encode(self)


_decoder = msgspec.json.Decoder(Behaviour)


def decode_behaviour(data: bytes) -> Behaviour:
    """The behaviour that an asset holds, fields that are not known left out.

    Raises:
        ProtocolError: it holds none.
    """
    try:
        return _decoder.decode(data)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise ProtocolError(f"the behaviour of a kind of object can't be read: {error}") from None
