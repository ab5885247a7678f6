"""The algorithm protocol, version 1: every message between main and an algorithm process, in one place.

    length u32 | kind u8 | payload          little-endian; length is the payload's, at most 16 MB

Main writes START once, then FRAME k for each frame it wants, then STOP, or REST first where the motion is to come to
rest, and CLOSED before the frame in which a hand has closed on an object; the algorithm answers READY to START and
POSE k (an object algorithm OBJECT k) to FRAME k. STATE, NOTE, ARRIVED, MEANT, DONE and ERROR come from it when there
is something to say.
START, READY, STATE and MEANT are JSON, NOTE and ERROR are text; FRAME, POSE and OBJECT are blocks of float64, laid
out by the tables below. docs/protocol.md is written from this module.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass
from enum import IntEnum
from typing import Annotated, Any, Literal

import msgspec
from msgspec import UNSET, Meta, UnsetType

from ahmss.body.array import Array
from ahmss.errors import ProtocolError
from ahmss.motion.way import AHEAD, WAY_WIDTH

__all__ = [
    "FRAME_HUMAN",
    "FRAME_OBJECT",
    "HEADER",
    "MAX_PAYLOAD",
    "MOVED",
    "OBJECT",
    "POSE",
    "TARGETS",
    "VERSION",
    "WAY",
    "Field",
    "Goal",
    "Kind",
    "Meant",
    "ObjectRecord",
    "PoseRecord",
    "Ready",
    "ShapeRecord",
    "SiteRecord",
    "Start",
    "State",
    "decode_meant",
    "decode_ready",
    "decode_start",
    "decode_state",
    "encode",
    "encode_frame",
    "encode_meant",
    "encode_start",
    "encode_state",
    "size",
]

VERSION = 1
HEADER = struct.Struct("<IB")
_K = struct.Struct("<d")
MAX_PAYLOAD = 16 * 1024 * 1024


class Kind(IntEnum):
    """The kinds of message: below 16 from main, from 16 on from the algorithm."""

    START = 1
    FRAME = 2
    STOP = 3
    REST = 4
    CLOSED = 5
    READY = 16
    POSE = 17
    OBJECT = 18
    STATE = 19
    DONE = 20
    ERROR = 21
    NOTE = 22
    ARRIVED = 23
    MEANT = 24


# --- blocks of float64 ------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Field:
    """A run of `count` float64 in a block."""

    name: str
    count: int
    meaning: str


TARGETS = ("right_hand", "left_hand", "right_foot", "left_foot", "gaze")

FRAME_HUMAN = (
    Field("k", 1, "the frame asked for, 1 for the first"),
    Field("root", 3, "place of the hips' joint in the world, metres"),
    Field("rotations", 172, "43 quaternions wxyz, parent <- child; the first is world <- hips"),
    Field("right_grip", 7, "the right palm's frame in the world: place, then quaternion"),
    Field("left_grip", 7, "the left palm's frame in the world: place, then quaternion"),
)
FRAME_OBJECT = (
    *FRAME_HUMAN,
    Field("place", 3, "the object's place in the world, metres, before this frame"),
    Field("rotation", 4, "the object's rotation, quaternion wxyz, world <- object"),
)
MOVED = (
    Field("object", 1, "id of an object or human of START's `world` (or the target) that moved since the last FRAME"),
    Field("place", 3, "its place in the world, metres; of a human on the floor"),
    Field("rotation", 4, "its rotation, quaternion wxyz, world <- object; of a human about z, x where it faces"),
)
POSE = (
    Field("k", 1, "the frame this is, as asked"),
    Field("root", 3, "place of the hips' joint in the world, metres"),
    Field("rotations", 172, "43 unit quaternions wxyz, parent <- child; the first is world <- hips"),
    Field("importance", 44, "how much this motion cares for each joint, >= 0; the last is the root's"),
    Field("targets", 40, f"5 rows ({', '.join(TARGETS)}) of place 3, quaternion 4 (zeros: free), weight 0 to 1"),
)
_SOON = ", ".join(f"{seconds:g}" for seconds in AHEAD)
WAY = (
    Field("way", WAY_WIDTH, f"x and y in the world, metres, where the hips will be in {_SOON} s; all NaN: not known"),
)
OBJECT = (
    Field("k", 1, "the frame this is, as asked"),
    Field("place", 3, "the object's place in the world, metres"),
    Field("rotation", 4, "the object's rotation, unit quaternion wxyz, world <- object"),
)


def size(block: tuple[Field, ...]) -> int:
    """The number of float64 in a block."""
    return sum(field.count for field in block)


# --- JSON messages ----------------------------------------------------------------------------------------------------

Vector = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
Point = tuple[float, float]


class SiteRecord(msgspec.Struct, frozen=True, omit_defaults=True):
    """A named frame on an object."""

    position: Annotated[Vector, Meta(description="in the object's frame, metres")]
    rotation: Annotated[Quaternion, Meta(description="object <- site, wxyz")] = (1.0, 0.0, 0.0, 0.0)
    free_axis: Annotated[
        Literal["", "z"], Meta(description='"z": the yaw is free; turn the site\'s x away from the human')
    ] = ""
    grip: Annotated[
        Literal["", "power", "precision"],
        Meta(description='how a hand takes it: "power", wrapped about its z; "precision", thumb and tips along its z'),
    ] = ""
    id: Annotated[
        int, Meta(description="of a human: the number by which FRAME tells where it is in the world; 0: it stays")
    ] = 0


class ShapeRecord(msgspec.Struct, frozen=True):
    """Where the shape of an object is kept."""

    path: Annotated[str, Meta(description="path of its GLB: metres, z up, in the object's frame")]
    hash: Annotated[str, Meta(description="SHA-256 of that file, hexadecimal")]


class ObjectRecord(msgspec.Struct, frozen=True, omit_defaults=True):
    """An object of the world as it stands at the start."""

    id: Annotated[int, Meta(description="the number that FRAME and STATE call it by")]
    name: Annotated[str, Meta(description="its name in the world, such as room/cup")]
    kind: Annotated[str, Meta(description="its kind, the folder in objectdb")]
    place: Annotated[Vector, Meta(description="in the world, metres")]
    rotation: Annotated[Quaternion, Meta(description="world <- object, wxyz")]
    sites: Annotated[dict[str, SiteRecord], Meta(description="its named frames")] = {}
    properties: Annotated[dict[str, Any], Meta(description="size, mass and the like, from its files")] = {}
    states: Annotated[dict[str, Any], Meta(description="the values its states have now")] = {}
    footprint: Annotated[
        list[list[Point]],
        Meta(description="outlines of what it occupies for a walker, in its frame turned about z only, metres"),
    ] = []
    shape: Annotated[
        ShapeRecord | None,
        Meta(description="of the target, as algorithm.toml's `shape` asks; of the others, as `shapes` asks"),
    ] = None
    way: Annotated[
        list[Point] | None,
        Meta(description=f"of a human, as algorithm.toml's `ways` asks: where the hips will be in {_SOON} s, metres"),
    ] = None


class PoseRecord(msgspec.Struct, frozen=True):
    """A pose of the human."""

    root: Annotated[Vector, Meta(description="place of the hips' joint in the world, metres")]
    rotations: Annotated[list[Quaternion], Meta(description="43 unit quaternions wxyz, parent <- child")]

    @classmethod
    def of(cls, rotations: Array, root: Array) -> PoseRecord:
        """The record of arrays (43, 4) and (3,)."""
        return cls(root=tuple(root.tolist()), rotations=rotations.tolist())


class Goal(msgspec.Struct, frozen=True, omit_defaults=True):
    """What the motion is to reach; every field may be missing."""

    place: Annotated[Vector | None, Meta(description="in the world, metres")] = None
    rotation: Annotated[Quaternion | None, Meta(description="in the world, wxyz")] = None
    facing: Annotated[float | None, Meta(description="final heading about z, radians, 0 towards +x")] = None
    posture: Annotated[str | None, Meta(description="path of a clip whose last frame is the posture")] = None
    object: Annotated[ObjectRecord | None, Meta(description="the object named as the goal")] = None


class Start(msgspec.Struct, frozen=True, kw_only=True):
    """START: all that an algorithm is told before the first frame."""

    version: Annotated[int, Meta(description="of the protocol")] = VERSION
    kind: Annotated[Literal["human", "object"], Meta(description="which of the two this process is asked to be")]
    human: Annotated[dict[str, Any], Meta(description="the acting human's skeleton: offsets, tips, limits, grips ...")]
    pose: Annotated[PoseRecord, Meta(description="the human's present pose, frame 0")]
    frames: Annotated[
        int, Meta(ge=0, description="N, the frames asked for; frame N is the goal. 0: as many as the motion needs")
    ]
    rate: Annotated[float, Meta(gt=0.0, description="frames a second")] = 60.0
    wish: Annotated[
        bool | UnsetType,
        Meta(description="if true, the frames are a wish: the motion is over when the algorithm says DONE"),
    ] = UNSET
    carried: Annotated[
        bool | UnsetType,
        Meta(description="if true, another motion carries the body: this one's hips, legs and root do not count"),
    ] = UNSET
    ways: Annotated[
        bool | UnsetType,
        Meta(description="if true, FRAME tells the way of each human that moved, as algorithm.toml's `ways` asks"),
    ] = UNSET
    seed: Annotated[int, Meta(ge=0, description="for whatever is random")] = 0
    object: Annotated[ObjectRecord | None, Meta(description="the target object")] = None
    site: Annotated[str, Meta(description="which of the object's sites the action names")] = ""
    goal: Annotated[Goal, Meta(description="what to reach")] = Goal()
    motion: Annotated[str | None, Meta(description="path of the action's motion data (.npz)")] = None
    parameters: Annotated[dict[str, Any], Meta(description="the algorithm's parameters, defaults filled in")] = {}
    hand: Annotated[Literal["", "right", "left"], Meta(description="the hand to use, where one is meant")] = ""
    busy: Annotated[
        list[Literal["right", "left"]] | UnsetType, Meta(description="the hands that hold something; missing: none")
    ] = UNSET
    held: Annotated[
        dict[str, int] | UnsetType,
        Meta(description='what is in the `"right"` and the `"left"` hand, its number in `world`; missing: nothing'),
    ] = UNSET
    led: Annotated[
        list[Literal["right", "left"]] | UnsetType,
        Meta(description="of these hands those that a motion made with this one leads; missing: none"),
    ] = UNSET
    hold: Annotated[
        Literal["", "take", "keep", "release"], Meta(description="what the action does to the object in the hand")
    ] = ""
    world: Annotated[
        list[ObjectRecord], Meta(description="other objects, and humans, as algorithm.toml's `world` and `humans` ask")
    ] = []
    directory: Annotated[str, Meta(description="the algorithm's own folder")] = ""


class Ready(msgspec.Struct, frozen=True):
    """READY: the algorithm has read START and will answer."""

    version: Annotated[int, Meta(description="of the protocol, as the algorithm speaks it")] = VERSION


class State(msgspec.Struct, frozen=True):
    """STATE: states of an object that changed, sent before the POSE or OBJECT of the frame in which they do."""

    object: Annotated[int, Meta(description="id of the object")]
    states: Annotated[dict[str, Any], Meta(description="the new value of each state that changed")]


class Meant(msgspec.Struct, frozen=True):
    """MEANT: what the motion is to bring about, before its first pose; it has failed where it has not in the end."""

    states: Annotated[
        dict[str, tuple[float, float]],
        Meta(description="of the motion's object: the least and the most that each of these is to be in the end"),
    ]
    otherwise: Annotated[str, Meta(description="what the person is told where one is not, in one line")]


_start = msgspec.json.Decoder(Start)
_ready = msgspec.json.Decoder(Ready)
_state = msgspec.json.Decoder(State)
_meant = msgspec.json.Decoder(Meant)
_json = msgspec.json.Encoder()


# --- bytes ------------------------------------------------------------------------------------------------------------


def encode(kind: Kind, payload: bytes | memoryview = b"") -> bytes:
    """One message.

    Raises:
        ProtocolError: the payload is larger than 16 MB.
    """
    if len(payload) > MAX_PAYLOAD:
        raise ProtocolError(f"a {kind.name} message of {len(payload)} bytes is larger than the {MAX_PAYLOAD} allowed")
    return HEADER.pack(len(payload), kind) + payload


def encode_start(start: Start) -> bytes:
    """The START message."""
    return encode(Kind.START, _json.encode(start))


def encode_state(state: State) -> bytes:
    """The STATE message."""
    return encode(Kind.STATE, _json.encode(state))


def encode_meant(meant: Meant) -> bytes:
    """The MEANT message."""
    return encode(Kind.MEANT, _json.encode(meant))


def encode_frame(
    k: int,
    root: Array,
    rotations: Array,
    grips: Array,
    object_pose: Array | None = None,
    moved: Array | None = None,
) -> bytes:
    """The FRAME message, of arrays of float64.

    Args:
        k: the frame asked for, from 1.
        root: (3,) metres. rotations: (43, 4) wxyz.
        grips: (2, 7) right and left palm frames in the world.
        object_pose: (7,) place and rotation, for an object algorithm only.
        moved: (n, 8) id, place and rotation of each object that moved, for those who asked for the world; of humans
            (n, 20), with their ways, for those who asked for `ways`.
    """
    parts = [_K.pack(k), root.tobytes(), rotations.tobytes(), grips.tobytes()]
    if object_pose is not None:
        parts.append(object_pose.tobytes())
    if moved is not None:
        parts.append(moved.tobytes())
    block = b"".join(parts)
    return HEADER.pack(len(block), Kind.FRAME) + block


def decode_start(payload: bytes | memoryview) -> Start:
    """START's payload.

    Raises:
        ProtocolError: not JSON, a field of the wrong type, or another version.
    """
    try:
        start = _start.decode(payload)
    except msgspec.MsgspecError as error:
        raise ProtocolError(f"START: {error}") from None
    if start.version != VERSION:
        raise ProtocolError(f"START is of protocol version {start.version}; this speaks version {VERSION}")
    return start


def decode_ready(payload: bytes | memoryview) -> Ready:
    """READY's payload; an empty one means version 1.

    Raises:
        ProtocolError: not JSON, or a version that this main does not speak.
    """
    try:
        ready = _ready.decode(payload) if len(payload) else Ready()
    except msgspec.MsgspecError as error:
        raise ProtocolError(f"READY: {error}") from None
    if ready.version != VERSION:
        raise ProtocolError(f"READY is of protocol version {ready.version}; this main speaks version {VERSION}")
    return ready


def decode_state(payload: bytes | memoryview) -> State:
    """STATE's payload.

    Raises:
        ProtocolError: not JSON, or a field is missing or of the wrong type.
    """
    try:
        return _state.decode(payload)
    except msgspec.MsgspecError as error:
        raise ProtocolError(f"STATE: {error}") from None


def decode_meant(payload: bytes | memoryview) -> Meant:
    """MEANT's payload.

    Raises:
        ProtocolError: not JSON, or a field is missing or of the wrong type.
    """
    try:
        return _meant.decode(payload)
    except msgspec.MsgspecError as error:
        raise ProtocolError(f"MEANT: {error}") from None
