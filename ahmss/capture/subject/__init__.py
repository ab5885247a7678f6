"""The subject: a performer of our own, for where no person with sensors is at hand.

It does what the thesis captured (5.3.1): opening and closing a door, sitting down and standing up; and bending to lift.
Each performance begins with the still upright pose that the calibration wants (5.1), the feet where they stay.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.capture.performance import Performance, begun_upright
from ahmss.capture.subject.chair import Seat, sit, stand_up
from ahmss.capture.subject.door import Door, close_door, open_door
from ahmss.capture.subject.lifting import Box, lift

__all__ = ["PERFORMANCES", "Box", "Door", "Props", "Seat", "Sight", "perform"]

RATE = 60.0
_READYING = 0.9  # seconds from upright to standing at ease
_UP_AGAIN = 3.0  # seconds after which one who has sat down stands up
_AFTER = 0.5  # seconds that the last pose is held


@dataclass(frozen=True)
class Props:
    """What the subject acts on, in its stance frame."""

    door: Door = field(default_factory=Door)
    seat: Seat = field(default_factory=Seat)
    box: Box = field(default_factory=Box)


@dataclass(frozen=True)
class Sight:
    """A performance to choose: what is seen of it, how long it takes in seconds, and how it is done.

    play: skeleton, props and times (F,) to rotations (F, 43, 4) and root (F, 3).
    """

    sentence: str
    seconds: float
    play: Callable[[Skeleton, Props, Array], tuple[Array, Array]]


PERFORMANCES: dict[str, Sight] = {
    "door_open": Sight(
        "Takes the lever of a door, pushes it open, lets go.", 4.3, lambda s, p, t: open_door(s, p.door, t)
    ),
    "door_close": Sight(
        "Takes the lever of an open door, pulls it shut, lets go.", 4.3, lambda s, p, t: close_door(s, p.door, t)
    ),
    "sit": Sight("Sits down on a chair, hands on the thighs.", 2.2, lambda s, p, t: sit(s, p.seat, t)),
    "stand_up": Sight(
        "Sits down, waits a little, and stands up again.", 4.9, lambda s, p, t: _sit_and_stand_up(s, p.seat, t)
    ),
    "lift": Sight("Bends and lifts a box with both hands.", 2.95, lambda s, p, t: lift(s, p.box, t)),
    "put_down": Sight(
        "Lifts a box, and puts it down again.", 6.5, lambda s, p, t: lift(s, p.box, np.minimum(t, 6.5 - t))
    ),
}


def perform(
    name: str, skeleton: Skeleton, props: Props | None = None, *, upright_seconds: float = 2.0, rate: float = RATE
) -> Performance:
    """The subject's performance of that name: upright first, ready, then the motion, its last pose held half a second.

    Args:
        name: one of `PERFORMANCES`.
        skeleton: whose lengths the subject has.
        props: what it acts on; the room's door, chair and a box if left out.
        upright_seconds: how long it stands still.
        rate: frames a second.

    Raises:
        KeyError: no such performance; the message lists them.
    """
    if name not in PERFORMANCES:
        raise KeyError(f"no performance {name!r}; the subject performs: {', '.join(PERFORMANCES)}")
    sight = PERFORMANCES[name]
    time = np.arange(round((sight.seconds + _AFTER) * rate) + 1) / rate
    motion = sight.play(skeleton, props or Props(), time)
    return begun_upright(motion, rate, skeleton, upright_seconds, name, going=_READYING)


def _sit_and_stand_up(skeleton: Skeleton, seat: Seat, time: Array) -> tuple[Array, Array]:
    """Sitting down, a moment on the chair, standing up."""
    before = time < _UP_AGAIN
    down, up = sit(skeleton, seat, time[before]), stand_up(skeleton, seat, time[~before] - _UP_AGAIN)
    return np.concatenate([down[0], up[0]]), np.concatenate([down[1], up[1]])
