"""What the world is made of: its objects and humans, and how it is at one moment."""

from __future__ import annotations

import hashlib

import msgspec

__all__ = [
    "CHUNK",
    "POSE_WIDTH",
    "VERSION",
    "WAY_SHAPE",
    "WAY_WIDTH",
    "HumanRecord",
    "ObjectChange",
    "ObjectRecord",
    "Place",
    "Rotation",
    "Scene",
    "Snapshot",
    "StateValue",
    "content_hash",
]

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
    """One human of the world; `skeleton` is the hash of its skeleton record, JSON, kept like a shape.

    leaves_s: 0 while its main is there; else the seconds after that was gone in which it leaves, infinite: it stays.
    """

    id: int
    name: str
    body: str
    skeleton: str = ""
    shape: str = ""
    texture: str = ""
    leaves_s: float = 0.0


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
