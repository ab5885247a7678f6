"""What the virtual-space server answers, and what it says unasked."""

from __future__ import annotations

import msgspec

from ahmss.world.records import VERSION, HumanRecord, ObjectRecord, Scene, Snapshot

__all__ = [
    "Added",
    "AssetPart",
    "Done",
    "JoinFirst",
    "Joined",
    "Refused",
    "Reply",
    "Stats",
    "Ticked",
    "Welcome",
]


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
