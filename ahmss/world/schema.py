"""What travels between the virtual-space server and its clients, and what a recording holds.

Every message but the pose of a human (frame.py) is msgpack of one of these structs, told apart by the tag `type`:
records.py, requests.py, replies.py. Fields are only ever added, with defaults, and never change their type. Poses are
`place xyz, rotation wxyz` in the world's frame, metres; `frames`, `poses`, `places` and `*_ids` are packed
little-endian arrays (unpacked by view.py). What comes by the thousand has `gc=False`: it holds no circles, and the
collector would cost more than the decoding.
"""

from __future__ import annotations

import msgspec
import numpy as np

from ahmss.messagepack import Reading
from ahmss.world.records import (
    CHUNK,
    POSE_WIDTH,
    VERSION,
    WAY_SHAPE,
    WAY_WIDTH,
    HumanRecord,
    ObjectChange,
    ObjectRecord,
    Scene,
    Snapshot,
    StateValue,
    content_hash,
)
from ahmss.world.replies import (
    Added,
    AssetPart,
    Done,
    Joined,
    JoinFirst,
    Refused,
    Reply,
    Stats,
    Ticked,
    Welcome,
)
from ahmss.world.requests import (
    Add,
    Claim,
    GetAsset,
    GetScene,
    GetSnapshot,
    GetStats,
    Heartbeat,
    Hello,
    Join,
    Leave,
    Move,
    NewObject,
    ObjectPose,
    PutAsset,
    Release,
    Remove,
    Request,
    SetState,
    StateChange,
    Sync,
    Transfer,
)

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


def _plain(value: object) -> object:
    """A numpy number or array in a place or a state, as a plain one."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise NotImplementedError(f"{type(value).__name__} can't be sent")


_encoder = msgspec.msgpack.Encoder(enc_hook=_plain)
_requests: Reading[Request] = Reading(Request, "world protocol: this is no request")
_replies: Reading[Reply] = Reading(Reply, "world protocol: this is no answer of a server")
_snapshots: Reading[Snapshot] = Reading(Snapshot, "world protocol: this is no snapshot")


def encode(message: Request | Reply) -> bytes:
    """The bytes of a message."""
    return _encoder.encode(message)


def decode_request(data: bytes) -> Request:
    """A client's request; ProtocolError where the bytes are none."""
    return _requests(data)


def decode_reply(data: bytes) -> Reply:
    """A server's answer; ProtocolError where the bytes are none."""
    return _replies(data)


def decode_snapshot(data: bytes) -> Snapshot:
    """A published snapshot; ProtocolError where the bytes are none."""
    return _snapshots(data)
