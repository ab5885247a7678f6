"""What travels between a human model and the main that moves its human: requests, and one answer to each.

Every message is msgpack of one of these structs, told apart by the tag `type`. Fields are only ever added, with
defaults, and never change their type. Metres, degrees, seconds and frames (`rate` to the second), in the world's frame;
a direction is as the human sees it: degrees to the left of where it faces.
"""

from __future__ import annotations

import msgspec

from ahmss.messagepack import Reading
from ahmss.world.schema import StateValue

__all__ = [
    "LARGEST",
    "PAGE",
    "PORT",
    "VERSION",
    "Accepted",
    "Act",
    "Action",
    "Affordances",
    "Await",
    "Cancel",
    "Compared",
    "Do",
    "Done",
    "Event",
    "Events",
    "GetAffordances",
    "GetEvents",
    "GetObjects",
    "GetSelf",
    "Objects",
    "Part",
    "Person",
    "Place",
    "Refused",
    "Reply",
    "Request",
    "Result",
    "Self",
    "Stop",
    "Thing",
    "Unavailable",
    "WaitState",
    "decode_reply",
    "decode_request",
    "encode",
]  # fmt: skip

VERSION = 1
PORT = 7427
"""Where a main's port is as a rule."""

PAGE = 64
"""Objects in one answer, at most."""

LARGEST = 1 << 16
"""A request may have this many bytes; a longer one ends its sender's connection."""

Place = tuple[float, float, float]


# What a human model asks. `request` numbers its requests; the answer repeats the number.


class GetSelf(msgspec.Struct, frozen=True, tag="get_self"):
    """Who and where is the human, and what does it do? Answered by Self."""

    request: int = 0
    version: int = VERSION


class GetObjects(msgspec.Struct, frozen=True, tag="get_objects"):
    """The objects of the world, from the `skip`-th on. Answered by Objects, at most PAGE of them.

    name: this one alone. seen: only what the human sees now (see docs/human-model-port.md).
    """

    name: str = ""
    seen: bool = False
    skip: int = 0
    request: int = 0


class GetAffordances(msgspec.Struct, frozen=True, tag="get_affordances"):
    """What an object affords this human now. Answered by Affordances."""

    object: str
    request: int = 0


class Act(msgspec.Struct, frozen=True):
    """One motion: an action of an object, which is named or found at a place. What is left out is found or usual.

    at: x, y[, z] of the object, metres, where it is not named. to: x, y[, z] of the goal, or `to_object` its name.
    facing_deg: where to face at the goal. hand: "left" or "right". pose: a clip whose last frame is the goal's posture.
    frames: how long, from 1. after: frames after which it begins, from the line's begin or from the end of the act that
    it `follows`; one that follows nothing is fused with those before it.
    """

    object: str = ""
    action: str = ""
    at: tuple[float, ...] = ()
    to: tuple[float, ...] = ()
    to_object: str = ""
    facing_deg: float | None = None
    hand: str = ""
    pose: str = ""
    parameters: dict[str, str | float] = {}
    frames: int | None = None
    after: int = 0
    follows: bool = False


class Do(msgspec.Struct, frozen=True, tag="do"):
    """Make these motions once the lines before are done: `acts`, or a `line` of the grammar that begins with `do`.

    Answered by Accepted or Refused.
    """

    acts: list[Act] = []
    line: str = ""
    request: int = 0


class Cancel(msgspec.Struct, frozen=True, tag="cancel"):
    """Give up one line: its motions stop with the next frame, or it never begins. Answered by Result."""

    number: int
    request: int = 0


class Stop(msgspec.Struct, frozen=True, tag="stop"):
    """Give up all lines, also those of others. What is held stays in the hand. Answered by Done."""

    request: int = 0


class Await(msgspec.Struct, frozen=True, tag="await"):
    """What became of a line? Answered by Result: once it is over, or after `seconds` at the latest (0: at once)."""

    number: int
    seconds: float = 0.0
    request: int = 0


class WaitState(msgspec.Struct, frozen=True, tag="wait_state"):
    """Wait until an object's state compares so; operator: == != < <= > >=. Answered by Compared, as Await is."""

    object: str
    state: str
    operator: str
    value: StateValue
    seconds: float = 0.0
    request: int = 0


class GetEvents(msgspec.Struct, frozen=True, tag="get_events"):
    """What happened from event number `since` on? Answered by Events: when there is one, as Await is."""

    since: int = 0
    seconds: float = 0.0
    request: int = 0


Request = GetSelf | GetObjects | GetAffordances | Do | Cancel | Stop | Await | WaitState | GetEvents


# What it is answered


class Refused(msgspec.Struct, frozen=True, tag="refused"):
    """Nothing was done; `reason` is one sentence that says what to do."""

    request: int
    reason: str


class Done(msgspec.Struct, frozen=True, tag="done"):
    """It was carried out."""

    request: int


class Self(msgspec.Struct, frozen=True, tag="self"):
    """The human now.

    place: on the floor between its feet. facing_deg: its heading, 0 towards +x. eye, gaze: the point between its eyes,
    and the unit vector of its line of sight, 15 degrees below where the head faces. holds: objects and the hand of each
    ("": none, it is sat on). doing: the numbers of the lines, the present one first. server: the world's address.
    frame, rate: frames made, and frames a second. late, held: frames that began late, and that a motion missed.
    """

    request: int
    human: str
    body: str
    stature: float
    place: Place
    facing_deg: float
    eye: Place
    gaze: Place
    holds: dict[str, str]
    doing: list[int]
    server: str
    frame: int
    rate: float
    late: int = 0
    held: int = 0
    version: int = VERSION


class Thing(msgspec.Struct, frozen=True):
    """An object. distance: from the human's place to the object's, level, metres; direction_deg: see above.

    seen: whether the human sees it now. holder, hand: who holds it, in which hand. within: the object it is a part of.
    """

    name: str
    kind: str
    sentence: str
    place: Place
    distance: float
    direction_deg: float
    seen: bool
    states: dict[str, StateValue] = {}
    holder: str = ""
    hand: str = ""
    within: str = ""


class Person(msgspec.Struct, frozen=True):
    """Another human; as Thing."""

    name: str
    place: Place
    facing_deg: float
    distance: float
    direction_deg: float


class Objects(msgspec.Struct, frozen=True, tag="objects"):
    """Objects, and with the first of them the other humans. next: `skip` for the rest; 0: that was all."""

    request: int
    objects: list[Thing]
    humans: list[Person] = []
    next: int = 0


class Action(msgspec.Struct, frozen=True):
    """An action that the human can do now.

    asks: what it needs or takes besides. frames: its usual number, 0: as many as it needs.
    parameters: what else may be set, each with its type, range and default in words; besides them every action takes
        patience, seconds to wait for what another has.
    """

    name: str
    sentence: str
    asks: list[str] = []
    frames: int = 0
    parameters: dict[str, str] = {}


class Unavailable(msgspec.Struct, frozen=True):
    """An action that the human can't do now, and why."""

    name: str
    reason: str


class Affordances(msgspec.Struct, frozen=True, tag="affordances"):
    """What an object affords this human now, and what it would afford under other circumstances."""

    request: int
    object: str
    now: list[Action]
    later: list[Unavailable] = []


class Accepted(msgspec.Struct, frozen=True, tag="accepted"):
    """It will be done, as line `number`. line: how it was understood. waits: how many lines are before it."""

    request: int
    number: int
    line: str
    waits: int = 0


class Part(msgspec.Struct, frozen=True):
    """A motion that is being made: its present frame, and its last one (0: it says itself when it is over)."""

    title: str
    frame: int
    of: int = 0


class Result(msgspec.Struct, frozen=True, tag="result"):
    """What became of a line: "waiting", "running", "done", "failed" (with `reason`) or "cancelled".

    frames: since it began. parts: its motions that are being made. notes: what their algorithms had to say.
    """

    request: int
    number: int
    line: str
    status: str
    reason: str = ""
    frames: int = 0
    parts: list[Part] = []
    notes: list[str] = []


class Compared(msgspec.Struct, frozen=True, tag="compared"):
    """Whether the state compares so now, and what it is."""

    request: int
    object: str
    holds: bool
    value: StateValue


class Event(msgspec.Struct, frozen=True):
    """Something that happened: "accepted", "began", "done", "failed", "cancelled", each of line `number`.

    frame: in which it did. text: the line, or the reason.
    """

    event: int
    kind: str
    number: int
    frame: int
    text: str


class Events(msgspec.Struct, frozen=True, tag="events"):
    """What happened. next: `since` for the next question. missed: how many were forgotten before they were asked."""

    request: int
    events: list[Event]
    next: int
    missed: int = 0


Reply = Refused | Done | Self | Objects | Affordances | Accepted | Result | Compared | Events

_encoder = msgspec.msgpack.Encoder()
_requests: Reading[Request] = Reading(Request, "human-model port: this is no request", "; see docs/human-model-port.md")
_replies: Reading[Reply] = Reading(Reply, "human-model port: this is no answer of a main")


def encode(message: Request | Reply) -> bytes:
    """The bytes of a message."""
    return _encoder.encode(message)


def decode_request(data: bytes) -> Request:
    """A human model's request; ProtocolError where the bytes are none."""
    return _requests(data)


def decode_reply(data: bytes) -> Reply:
    """A main's answer; ProtocolError where the bytes are none."""
    return _replies(data)
