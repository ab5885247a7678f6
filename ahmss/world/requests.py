"""What clients ask of the virtual-space server. `request` numbers them; the reply repeats it, 0 asks for no reply."""

from __future__ import annotations

import msgspec

from ahmss.world.records import VERSION, Place, Rotation, StateValue

__all__ = [
    "Add",
    "Claim",
    "GetAsset",
    "GetScene",
    "GetSnapshot",
    "GetStats",
    "Heartbeat",
    "Hello",
    "Join",
    "Leave",
    "Move",
    "NewObject",
    "ObjectPose",
    "PutAsset",
    "Release",
    "Remove",
    "Request",
    "SetState",
    "StateChange",
    "Sync",
    "Transfer",
]


class Hello(msgspec.Struct, frozen=True, tag="hello"):
    """Who is there? Answered by Welcome."""

    request: int = 0
    version: int = VERSION


class Heartbeat(msgspec.Struct, frozen=True, tag="heartbeat"):
    """The sender lives; answered by Done."""

    request: int = 0


class ObjectPose(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """Where the named object is, in the world."""

    name: str
    place: Place
    rotation: Rotation


class Join(msgspec.Struct, frozen=True, tag="join"):
    """A human enters the world, or comes back (after a break) with what it holds; answered by Joined.

    `pose` is 175 float64, its first pose. `group` names the run of a script that it belongs to.
    """

    name: str
    body: str
    pose: bytes
    skeleton: str = ""
    shape: str = ""
    texture: str = ""
    holds: list[ObjectPose] = []
    hands: dict[str, str] = {}
    group: str = ""
    request: int = 0
    version: int = VERSION


class Leave(msgspec.Struct, frozen=True, tag="leave"):
    """The human leaves; what it holds rests where it is. `stay`: its body stays standing, owned by nobody."""

    human: str
    stay: bool = False
    request: int = 0


class NewObject(msgspec.Struct, frozen=True, gc=False):
    """An object to add. Place and rotation are in the parent's frame where `parent` is named, else the world's."""

    name: str
    kind: str
    place: Place = (0.0, 0.0, 0.0)
    rotation: Rotation = (1.0, 0.0, 0.0, 0.0)
    parent: str = ""
    shape: str = ""
    texture: str = ""
    states: dict[str, StateValue] = {}
    movable: bool = True
    behaviour: str = ""


class Add(msgspec.Struct, frozen=True, tag="add"):
    """Add objects, parents before what they contain, all or none; answered by Added.

    `keeper`: the human whose main has them follow their file from now on; refused where that is another's already.
    """

    objects: list[NewObject]
    request: int = 0
    keeper: str = ""


class Remove(msgspec.Struct, frozen=True, tag="remove"):
    """Remove an object and what it carries. `keeper`: as its file says, which this human's main follows."""

    name: str
    request: int = 0
    keeper: str = ""


class Move(msgspec.Struct, frozen=True, tag="move"):
    """Put objects elsewhere at once, all or none. `layout`: the file says so, nobody has touched them.

    `keeper`: the human whose main follows that file.
    """

    poses: list[ObjectPose]
    layout: bool = False
    request: int = 0
    keeper: str = ""


class Claim(msgspec.Struct, frozen=True, tag="claim"):
    """The human alone moves these objects from now on, all or none. `hand`: it takes them in that hand.

    `waits`: it only waits for them, as somebody else has them, and has them before those who come later.
    """

    human: str
    objects: list[str]
    hand: str = ""
    request: int = 0
    waits: bool = False


class Release(msgspec.Struct, frozen=True, tag="release"):
    """The human lets these objects go; what hands have held falls and comes to rest on what is under it."""

    human: str
    objects: list[str]
    request: int = 0


class Transfer(msgspec.Struct, frozen=True, tag="transfer"):
    """From hand to hand in one step, asked by the giver's main: nobody else can claim the object in between."""

    object: str
    giver: str
    taker: str
    hand: str = ""
    request: int = 0


class StateChange(msgspec.Struct, frozen=True, array_like=True):
    """One state of one object."""

    object: str
    state: str
    value: StateValue


class SetState(msgspec.Struct, frozen=True, tag="set"):
    """Set states and what follows from them, all or none. Refused where another main's human holds the object."""

    changes: list[StateChange]
    request: int = 0


class GetScene(msgspec.Struct, frozen=True, tag="get_scene"):
    """Answered by Scene."""

    request: int = 0


class GetSnapshot(msgspec.Struct, frozen=True, tag="get_snapshot"):
    """Answered by Snapshot, made now."""

    request: int = 0


class PutAsset(msgspec.Struct, frozen=True, tag="put_asset"):
    """A part of an asset of `size` bytes, in order from offset 0; answered by Done, also when it is known already."""

    hash: str
    size: int
    offset: int
    data: bytes
    request: int = 0


class GetAsset(msgspec.Struct, frozen=True, tag="get_asset"):
    """Answered by AssetPart: at most CHUNK bytes from `offset`."""

    hash: str
    offset: int = 0
    request: int = 0


class Sync(msgspec.Struct, frozen=True, tag="sync"):
    """Answered by Done when every named human of the group has come to this line, or has left."""

    human: str
    line: str
    names: list[str]
    request: int = 0


class GetStats(msgspec.Struct, frozen=True, tag="get_stats"):
    """How busy is the server? Answered by Stats."""

    request: int = 0


Request = (
    Hello | Heartbeat | Join | Leave | Add | Remove | Move | Claim | Release | Transfer | SetState
    | GetScene | GetSnapshot | PutAsset | GetAsset | Sync | GetStats
)  # fmt: skip
