"""Opening and closing a door by its lever, the feet planted: the gaze goes there first, the body turns and leans, and
the hand goes along the lever's arc, so far as the arm reaches without a step.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.body.array import Array
from ahmss.body.inverse import RIGHT_HAND
from ahmss.body.inverse import grips as grip_frames
from ahmss.body.quaternion import from_axis_angle, from_matrix, rotate, slerp
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.poser import STRAIGHT, Arm, Posture, between, pose

__all__ = ["ANGLE", "Door", "close_door", "on_lever", "open_door"]

ANGLE = 30.0  # degrees that the door is opened
_OVER = 62.0  # degrees by which the palm looks down rather than at the door
_INTO_FINGERS = 0.016  # metres from the palm's middle to the lever, towards the fingers
_SHY = 0.05  # metres by which the hand comes from above and before the lever
_AHEAD = 0.30  # seconds by which the gaze leads the hand
_EYES_LEAVE = 0.65  # of the way that the head goes to what is looked at; the eyes do the rest
_UP = np.array([0.0, 0.0, 1.0])

_ARM = Arm(
    forward=30.0, aside=25.0, turn_in=-42.0, elbow=70.0, pronate=40.0
)  # the elbow out, or the wrist would not do
_STANDING = Posture(stance=STRAIGHT)
_AT_CLOSED = replace(
    _STANDING, shift=(0.05, -0.03), hips_turn=-14.0, hips_lean=2.0, turn=-26.0, lean=3.0, right_arm=_ARM,
)  # fmt: skip
_AT_OPEN = replace(
    _STANDING, shift=(0.095, -0.078), hips_turn=-18.0, hips_lean=10.0, hips_tilt=-7.0, turn=-18.0, lean=14.0, tilt=-9.0,
    drop=0.012, right_arm=_ARM,
)  # fmt: skip


def _frame(x: float, y: float, z: float) -> Transform:
    """A frame of the usual door, which leads away to the right of one who stands a little turned to it."""
    return Transform(np.array([x, y, z]), from_axis_angle(_UP, np.radians(200.0)))


@dataclass(frozen=True)
class Door:
    """Where the door is, in the stance frame (origin between the ankles, x ahead, y left), metres.

    hinge: z the axis, x along the closed leaf; it opens towards y. knob: the axis of the lever on the subject's side,
    axes as the hinge's. lever_radius.
    """

    hinge: Transform = field(default_factory=lambda: _frame(0.879, -0.224, 0.005))
    knob: Transform = field(default_factory=lambda: _frame(0.214, -0.386, 1.025))
    lever_radius: float = 0.011


@dataclass(frozen=True)
class _Phase:
    """A part of the motion: how long, the posture and the door's angle at its end, and how far the hand is then on its
    way from hanging free to the lever (0..1)."""

    seconds: float
    posture: Posture
    angle: float
    hold: float


_OPENING = (
    _Phase(_AHEAD, _STANDING, 0.0, 0.0),
    _Phase(0.95, _AT_CLOSED, 0.0, 1.0),
    _Phase(0.30, _AT_CLOSED, 0.0, 1.0),
    _Phase(1.30, _AT_OPEN, ANGLE, 1.0),
    _Phase(0.25, _AT_OPEN, ANGLE, 1.0),
    _Phase(1.20, _STANDING, ANGLE, 0.0),
)
_CLOSING = (
    _Phase(_AHEAD, _STANDING, ANGLE, 0.0),
    _Phase(1.15, _AT_OPEN, ANGLE, 1.0),
    _Phase(0.30, _AT_OPEN, ANGLE, 1.0),
    _Phase(1.30, _AT_CLOSED, 0.0, 1.0),
    _Phase(0.25, _AT_CLOSED, 0.0, 1.0),
    _Phase(1.00, _STANDING, 0.0, 0.0),
)


def open_door(skeleton: Skeleton, door: Door, time: Array) -> tuple[Array, Array]:
    """Rotations (F, 43, 4) and root (F, 3) of taking the lever, pushing the door open and letting go, at times (F,)."""
    return _play(skeleton, door, _OPENING, 0.0, time)


def close_door(skeleton: Skeleton, door: Door, time: Array) -> tuple[Array, Array]:
    """Rotations (F, 43, 4) and root (F, 3) of taking the open door's lever, pulling it shut and letting go."""
    return _play(skeleton, door, _CLOSING, ANGLE, time)


def on_lever(door: Door) -> Transform:
    """The palm's frame on the lever of the closed door: over it from the front, the thumb to the hinge."""
    over = np.radians(_OVER)
    out = np.array([0.0, np.cos(over), -np.sin(over)])  # in the door's frame the subject is on -y, the hinge at -x
    thumb = np.array([-1.0, 0.0, 0.0])
    ahead = np.cross(out, thumb)  # where the fingers point
    place = -door.lever_radius * out - _INTO_FINGERS * ahead
    return door.knob.then(Transform(place, from_matrix(np.stack([out, np.cross(thumb, out), thumb], axis=-1))))


def _turned(door: Door, frame: Transform, degrees: float) -> Transform:
    """A frame that is fixed to the leaf, with the door open by some degrees."""
    leaf = Transform(np.zeros(3), from_axis_angle(_UP, np.radians(degrees)))
    return door.hinge.then(leaf).then(door.hinge.inverse()).then(frame)


def _play(skeleton: Skeleton, door: Door, phases: tuple[_Phase, ...], angle: float, time: Array) -> tuple[Array, Array]:
    """The poses at the given times."""
    free = Transform.of(grip_frames(skeleton, *pose(skeleton, _STANDING))[RIGHT_HAND])
    rotations, roots = [], []
    for t in time.tolist():
        posture, turned, hold = _at(phases, angle, t)
        lever = _turned(door, on_lever(door), turned)
        gaze = np.array([*lever.place, _looking(phases, t)])
        made = pose(skeleton, replace(posture, grips={"right": _path(free, lever, hold).row()}, gaze=gaze))
        rotations.append(made[0])
        roots.append(made[1])
    return np.stack(rotations), np.stack(roots)


def _at(phases: tuple[_Phase, ...], angle: float, t: float) -> tuple[Posture, float, float]:
    """Posture, the door's angle and how far the hand is, at time t."""
    before, begin = _Phase(0.0, _STANDING, angle, 0.0), 0.0
    for phase in phases:
        done = float(minimum_jerk(np.array((t - begin) / phase.seconds)))
        if t < begin + phase.seconds:
            return (
                between(before.posture, phase.posture, done),
                before.angle + done * (phase.angle - before.angle),
                before.hold + done * (phase.hold - before.hold),
            )
        before, begin = phase, begin + phase.seconds
    return before.posture, before.angle, before.hold


def _looking(phases: tuple[_Phase, ...], t: float) -> float:
    """How much the gaze is on the lever: from the beginning, ahead of the hand, until it lets go."""
    letting_go = sum(phase.seconds for phase in phases[:-2])
    return _EYES_LEAVE * float(
        minimum_jerk(np.array(t / 0.55)) * (1.0 - minimum_jerk(np.array((t - letting_go - 0.1) / 0.8)))
    )


def _path(free: Transform, lever: Transform, hold: float) -> Transform:
    """The palm between hanging free and the lever, off the straight line to where it does not scrape the lever."""
    place = free.place + hold * (lever.place - free.place)
    aside = rotate(lever.rotation, np.array([-1.0, 0.0, 0.0])) + 0.5 * _UP
    rise = _SHY * 16.0 * hold**2 * (1.0 - hold) ** 2
    turn = float(minimum_jerk(np.array(hold / 0.8)))
    return Transform(place + rise * aside, slerp(free.rotation, lever.rotation, turn))
