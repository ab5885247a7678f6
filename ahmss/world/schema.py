"""What travels between the virtual-space server and its clients, and what a recording holds.

Every message but the pose of a human (frame.py) is msgpack of one of these structs, told apart by the tag `type`.
Fields are only ever added, with defaults, and never change their type. Poses are `place xyz, rotation wxyz` in the
world's frame, metres; `frames`, `poses`, `places` and `*_ids` are packed little-endian arrays (unpacked by view.py).
What comes by the thousand has `gc=False`: it holds no circles, and the collector would cost more than the decoding.
"""

from __future__ import annotations

import hashlib

import msgspec
import numpy as np

from ahmss.errors import ProtocolError

__all__ = [
    "CHUNK",
    "POSE_WIDTH",
    "VERSION",
    "WAY_SHAPE",
    "WAY_WIDTH",
    "Add",
    "Added",
    "AssetPart",
    "Claim",
    "Done",
    "GetAsset",
    "GetScene",
    "GetSnapshot",
    "GetStats",
    "Heartbeat",
    "Hello",
    "HumanRecord",
    "Join",
    "JoinFirst",
    "Joined",
    "Leave",
    "Move",
    "NewObject",
    "ObjectChange",
    "ObjectPose",
    "ObjectRecord",
    "PutAsset",
    "Refused",
    "Release",
    "Remove",
    "Reply",
    "Request",
    "Scene",
    "SetState",
    "Snapshot",
    "StateChange",
    "StateValue",
    "Stats",
    "Sync",
    "Ticked",
    "Transfer",
    "Welcome",
    "content_hash",
    "decode_reply",
    "decode_request",
    "decode_snapshot",
    "encode",
]  # fmt: skip

VERSION = 1
POSE_WIDTH = 175
"""One human's pose: root 3, then 43 rotations of 4."""

WAY_SHAPE = (6, 2)
WAY_WIDTH = 12
"""Where a human means to be: x and y, metres, at six moments from the frame (`ahmss.motion.way`); NaN: not known."""

CHUNK = 1 << 20
"""Assets travel in parts of at most this many bytes."""

StateValue = str | float | bool
Place = tuple[float, float, float]
Rotation = tuple[float, float, float, float]


def content_hash(data: bytes) -> str:
    """The name of a shape, texture or skeleton: SHA-256 of its bytes, in hexadecimal."""
    return hashlib.sha256(data).hexdigest()


# What the world is made of


class ObjectRecord(msgspec.Struct, frozen=True, gc=False):
    """One object of the world, as it is at the revision of the scene that holds it.

    `parent` is the name of the object that contains it. An `attached` object is carried by its parent; one that was
    taken in the hand is loose from then on. `moved`: somebody has moved it since it was added. `behaviour`: the hash of
    what its kind shows and sets by its states (`ahmss.states.behaviour`), JSON, kept like a shape. `keeper`: the human
    whose main has it follow its file; "": nobody's does, or it is contained in what has one.
    """

    id: int
    name: str
    kind: str
    place: Place
    rotation: Rotation
    parent: str = ""
    shape: str = ""
    texture: str = ""
    states: dict[str, StateValue] = {}
    holder: str = ""
    hand: str = ""
    movable: bool = True
    attached: bool = True
    moved: bool = False
    behaviour: str = ""
    keeper: str = ""


class HumanRecord(msgspec.Struct, frozen=True):
    """One human of the world; `skeleton` is the hash of its skeleton record, JSON, kept like a shape."""

    id: int
    name: str
    body: str
    skeleton: str = ""
    shape: str = ""
    texture: str = ""


class Scene(msgspec.Struct, frozen=True, tag="scene"):
    """All that stands still between two revisions; a snapshot says what differs from it."""

    revision: int
    objects: list[ObjectRecord]
    humans: list[HumanRecord]
    rate: float = 60.0
    request: int = 0
    version: int = VERSION


class ObjectChange(msgspec.Struct, frozen=True, array_like=True, gc=False):
    """The states and the holder of an object where they differ from the scene's."""

    id: int
    states: dict[str, StateValue]
    holder: str = ""
    hand: str = ""
    attached: bool = True
    moved: bool = False
    keeper: str = ""


class Snapshot(msgspec.Struct, frozen=True, tag="snapshot"):
    """The whole world at one moment, less what the scene of `revision` already says.

    human_ids: n uint32. frames: n uint32, the frame number shown of each. poses: n x 175 float32.
    object_ids: m uint32, the objects that are not where the scene has them. places: m x 7 float64.
    time: seconds since 1970 at the server; in a recording, tick / rate.
    ways: n x 6 x 2 float32, where each human means to be (`ahmss.motion.way`), NaN where it is not told; empty where
    nobody tells it.
    """

    tick: int
    time: float
    revision: int
    human_ids: bytes = b""
    frames: bytes = b""
    poses: bytes = b""
    object_ids: bytes = b""
    places: bytes = b""
    changes: list[ObjectChange] = []
    request: int = 0
    sequence: int = 0
    ways: bytes = b""


# What clients ask. `request` numbers them; the reply repeats the number, 0 asks for no reply.


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


# What the server answers


class Welcome(msgspec.Struct, frozen=True, tag="welcome"):
    """The server's present: the port of its snapshots on the same host, its rate, whether it runs in lockstep.

    `alone`: in lockstep with one main only, which may then send its frames several in a message.
    """

    request: int
    snapshots: int
    rate: float
    lockstep: bool = False
    tick: int = 0
    version: int = VERSION
    alone: bool = False


class Done(msgspec.Struct, frozen=True, tag="done"):
    """It was carried out. `ticks`: for so many from now on the server itself moves something, as what falls."""

    request: int
    ticks: int = 0


class Joined(msgspec.Struct, frozen=True, tag="joined"):
    """The human is in the world. `lost`: what it said it holds and does not: somebody else has it, or it is gone."""

    request: int
    id: int
    tick: int = 0
    lost: list[str] = []


class Added(msgspec.Struct, frozen=True, tag="added"):
    """The objects as they stand now, in the order of the request."""

    request: int
    objects: list[ObjectRecord]


class Refused(msgspec.Struct, frozen=True, tag="refused"):
    """Nothing was changed; `reason` is one sentence. `frame` > 0: that frame's update was refused (request is 0)."""

    request: int
    reason: str
    human: int = 0
    frame: int = 0


class AssetPart(msgspec.Struct, frozen=True, tag="asset_part"):
    """A part of an asset of `size` bytes."""

    request: int
    hash: str
    size: int
    offset: int
    data: bytes


class JoinFirst(msgspec.Struct, frozen=True, tag="join_first"):
    """The server does not know the sender's human (it was restarted, or the lease ran out): join again."""

    human: int = 0


class Ticked(msgspec.Struct, frozen=True, tag="ticked"):
    """Lockstep: the world is complete up to frame `tick`. Says what others than the receiver have changed in it.

    human_ids: n uint32. poses: n x 175 float64. object_ids: m uint32. places: m x 7 float64. `put` are records whose
    states, holder or existence changed (by anybody, in the order of names), `gone` ids of what was removed.
    ways: n x 6 x 2 float64, as a snapshot's.
    """

    tick: int
    revision: int
    human_ids: bytes = b""
    poses: bytes = b""
    object_ids: bytes = b""
    places: bytes = b""
    put: list[ObjectRecord] = []
    gone: list[int] = []
    humans_put: list[HumanRecord] = []
    humans_gone: list[int] = []
    ways: bytes = b""


class Stats(msgspec.Struct, frozen=True, tag="stats"):
    """The server's last ticks, at most 4096. busy_ms: work of each tick, frames taken in and snapshots out.

    late_ms: how long after its time each tick was done, work included. malformed: messages that were none.
    """

    request: int
    busy_ms: list[float]
    late_ms: list[float]
    humans: int = 0
    frames: int = 0
    missed: int = 0
    malformed: int = 0
    sessions: int = 0


Reply = Welcome | Done | Joined | Added | Refused | AssetPart | JoinFirst | Ticked | Scene | Snapshot | Stats


def _plain(value: object) -> object:
    """A numpy number or array in a place or a state, as a plain one."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise NotImplementedError(f"{type(value).__name__} can't be sent")


_encoder = msgspec.msgpack.Encoder(enc_hook=_plain)
_request_decoder: msgspec.msgpack.Decoder[Request] = msgspec.msgpack.Decoder(Request)
_reply_decoder: msgspec.msgpack.Decoder[Reply] = msgspec.msgpack.Decoder(Reply)
_snapshot_decoder: msgspec.msgpack.Decoder[Snapshot] = msgspec.msgpack.Decoder(Snapshot)


def encode(message: Request | Reply) -> bytes:
    """The bytes of a message."""
    return _encoder.encode(message)


def decode_request(data: bytes) -> Request:
    """A client's request; ProtocolError where the bytes are none."""
    try:
        return _request_decoder.decode(data)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise ProtocolError(f"world protocol: this is no request: {error}") from error


def decode_reply(data: bytes) -> Reply:
    """A server's answer; ProtocolError where the bytes are none."""
    try:
        return _reply_decoder.decode(data)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise ProtocolError(f"world protocol: this is no answer of a server: {error}") from error


def decode_snapshot(data: bytes) -> Snapshot:
    """A published snapshot; ProtocolError where the bytes are none."""
    try:
        return _snapshot_decoder.decode(data)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise ProtocolError(f"world protocol: this is no snapshot: {error}") from error
