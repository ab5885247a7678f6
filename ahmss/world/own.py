"""The humans that a client moves, with what it must say to come back with them after a break."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

import msgspec

from ahmss.body.array import Array
from ahmss.world import frame as frames
from ahmss.world import schema
from ahmss.world.schema import CHUNK, ObjectPose, Request
from ahmss.world.view import World

__all__ = ["Own", "OwnHumans"]


@dataclass
class Own:
    """One of them: how it joined, its last frame, what it holds in which hand, and where that was."""

    join: schema.Join
    id: int
    assets: dict[str, bytes]
    last: bytes = b""
    holds: dict[str, str] = field(default_factory=dict[str, str])
    places: dict[int, Array] = field(default_factory=dict[int, Array])

    def again(self, world: World) -> schema.Join:
        """The request to join again as it last was, with what it holds."""
        pose = self.last[frames.HEADER.size :][: frames.POSE_BYTES] or self.join.pose
        holds: list[ObjectPose] = []
        for name in self.holds:
            record = world.objects.get(name)
            if record is not None:
                x, y, z, *rotation = self.places.get(record.id, world.pose(name)).tolist()
                holds.append(ObjectPose(name, (x, y, z), tuple(rotation)))
        return msgspec.structs.replace(self.join, pose=pose, holds=holds, hands=dict(self.holds))


class OwnHumans(dict[str, Own]):
    """All of them by name."""

    def to_return(self, world: World) -> Iterator[Request]:
        """What brings each of them back; a server that was restarted may lack their assets."""
        for own in self.values():
            for name, data in own.assets.items():
                for offset in range(0, len(data), CHUNK):
                    yield schema.PutAsset(name, len(data), offset, data[offset : offset + CHUNK])
            yield own.again(world)

    def joined(self, request: schema.Join, reply: schema.Joined) -> list[str]:
        """One of them is in the world; says what it no longer holds."""
        own = self.get(request.name)
        if own is None:
            return []
        own.id = reply.id
        for name in reply.lost:
            own.holds.pop(name, None)
        return [f"{request.name} no longer holds {name}: somebody else does, or it is gone" for name in reply.lost]

    def granted(self, request: Request) -> None:
        """Keep in mind what a granted request means for what they hold."""
        match request:
            case schema.Claim(human=human, waits=False) if human in self:
                self[human].holds.update(dict.fromkeys(request.objects, request.hand))
            case schema.Release(human=human) if human in self:
                for name in request.objects:
                    self[human].holds.pop(name, None)
            case schema.Transfer():
                if request.giver in self:
                    self[request.giver].holds.pop(request.object, None)
                if request.taker in self:
                    self[request.taker].holds[request.object] = request.hand
            case schema.Leave(human=human):
                self.pop(human, None)
            case _:
                pass
