"""What is asked of the virtual-space server and waited for: each method gives the answer, or raises its refusal."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any, TypeVar

from ahmss.errors import ProtocolError, WorldError
from ahmss.world import schema
from ahmss.world.address import Address
from ahmss.world.schema import (
    CHUNK,
    HumanRecord,
    NewObject,
    ObjectPose,
    ObjectRecord,
    Reply,
    Request,
    StateValue,
    content_hash,
)

__all__ = ["Asking"]

R = TypeVar("R")


class Asking:
    """The requests of a client by name; what it asks them through is `call`.

    Raises:
        WorldError: the server refuses; with its reason. Unreachable: it gives no answer.
    """

    address: Address

    def __init__(self) -> None:
        self._skeletons: dict[str, dict[str, Any]] = {}

    def call(self, request: Request) -> Reply:
        """Ask, and wait for the answer."""
        raise NotImplementedError

    def ask(self, request: Request, expected: type[R]) -> R:
        """Ask, and wait for an answer of this type; ProtocolError where it is another."""
        reply = self.call(request)
        if not isinstance(reply, expected):
            raise ProtocolError(f"world protocol: {type(request).__name__} was answered by {type(reply).__name__}")
        return reply

    def hello(self) -> schema.Welcome:
        """The server's present. Raises Unreachable where none answers."""
        return self.ask(schema.Hello(), schema.Welcome)

    def stats(self) -> schema.Stats:
        """How busy the server is."""
        return self.ask(schema.GetStats(), schema.Stats)

    def leave(self, name: str, *, stay: bool = False) -> None:
        """The human leaves the world (`stay`: its body stays standing); what it holds rests where it is."""
        self.ask(schema.Leave(name, stay), schema.Done)

    def add(self, objects: Sequence[NewObject], keeper: str = "") -> list[ObjectRecord]:
        """Add objects, parents before what they contain, all or none; `keeper`: whose main follows their file."""
        return self.ask(schema.Add(list(objects), keeper=keeper), schema.Added).objects

    def remove(self, name: str, keeper: str = "") -> None:
        """Remove an object and what it carries; `keeper`: as its file says, which that human's main follows."""
        self.ask(schema.Remove(name, keeper=keeper), schema.Done)

    def move(self, poses: Sequence[ObjectPose], *, layout: bool = False, keeper: str = "") -> None:
        """Put objects elsewhere at once, all or none (`layout`: only while nobody has touched them)."""
        self.ask(schema.Move(list(poses), layout, keeper=keeper), schema.Done)

    def claim(self, human: str, objects: Sequence[str], hand: str = "") -> None:
        """The human alone moves these objects from now on, all or none; `hand`: it takes them in that hand."""
        self.ask(schema.Claim(human, list(objects), hand), schema.Done)

    def release(self, human: str, objects: Sequence[str]) -> None:
        """The human lets these objects go."""
        self.ask(schema.Release(human, list(objects)), schema.Done)

    def transfer(self, name: str, giver: str, taker: str, hand: str = "") -> None:
        """Give an object from hand to hand in one step; only the giver's main may ask."""
        self.ask(schema.Transfer(name, giver, taker, hand), schema.Done)

    def set_state(self, name: str, state: str, value: StateValue) -> None:
        """Set one state of one object."""
        self.ask(schema.SetState([schema.StateChange(name, state, value)]), schema.Done)

    def put_asset(self, data: bytes) -> str:
        """Give the server a shape, texture or skeleton record; returns its hash ("" for no bytes)."""
        if not data:
            return ""
        name, size, offset = content_hash(data), len(data), 0
        have = self.ask(schema.PutAsset(name, size, 0, b""), schema.AssetPart).offset
        while have < size:
            offset = have
            part = schema.PutAsset(name, size, offset, data[offset : offset + CHUNK])
            have = self.ask(part, schema.AssetPart).offset
            if have <= offset:
                raise WorldError(f"the server takes no more of asset {name[:12]}; try again")
        return name

    def get_asset(self, name: str) -> bytes:
        """A shape, texture or skeleton record by its hash. WorldError where the server has none of that name."""
        parts: list[bytes] = []
        have, size = 0, 1
        while have < size:
            part = self.ask(schema.GetAsset(name, have), schema.AssetPart)
            parts.append(part.data)
            size, have = part.size, have + len(part.data)
            if not part.data:
                break
        data = b"".join(parts)
        if content_hash(data) != name:
            raise WorldError(f"asset {name[:12]} came damaged from the server at {self.address}; ask again")
        return data

    def skeleton(self, human: HumanRecord) -> dict[str, Any]:
        """The skeleton record of a human (for `Skeleton.from_record`); kept after the first time."""
        if human.skeleton not in self._skeletons:
            self._skeletons[human.skeleton] = json.loads(self.get_asset(human.skeleton))
        return self._skeletons[human.skeleton]
