"""The door opened and closed by its lever, feet planted: the body turns to it, leans, and the hand goes along the arc.

Clips for `playback`. Each starts and ends at ease; what the hand does is told as targets relative to the knob's site,
so that it meets the lever on any body and wherever the human stands.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from ahmss.algorithm import Transform, importance_of
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE, RIGHT_HAND
from ahmss.body.inverse import grips as grip_frames
from ahmss.body.links import fingers
from ahmss.body.quaternion import from_axis_angle, from_matrix, rotate, slerp
from ahmss.body.skeleton import Skeleton
from ahmss.motion.clip import Clip, ClipHeader
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.fingers import Cylinder, closed, opened
from ahmss.motion.poser import STANDING, Arm, Posture, pose
from motions.scene import Scene

__all__ = ["ANGLE", "clips"]

RATE = 60.0
ANGLE = 30.0  # degrees that the door is opened: as far as the arm reaches without a step
SIDE = "right"
OVER = 62.0  # degrees by which the palm looks down rather than at the door
INTO_FINGERS = 0.016  # metres from the palm's middle to the lever, towards the fingers
SHY = 0.05  # metres by which the hand comes from above and before the lever
UP = np.array([0.0, 0.0, 1.0])
IDENTITY = np.array([1.0, 0.0, 0.0, 0.0])

ARM = Arm(forward=30.0, aside=20.0, turn_in=10.0, elbow=70.0, pronate=40.0)
AT_CLOSED = replace(
    STANDING, shift=(0.035, -0.03), hips_turn=-14.0, hips_lean=2.0, turn=-26.0, lean=3.0, right_arm=ARM,
)  # fmt: skip
AT_OPEN = replace(
    STANDING, shift=(0.065, -0.075), hips_turn=-18.0, hips_lean=9.0, hips_tilt=-7.0, turn=-18.0, lean=12.0, tilt=-9.0,
    drop=0.006, right_arm=ARM,
)  # fmt: skip


@dataclass(frozen=True)
class Phase:
    """A part of the motion: how long, the posture and the door's angle at its end, and what the hand does meanwhile.

    hold, at its end: how much of the way from the free hand to the lever (0..1). fist: how far it is closed.
    """

    seconds: float
    posture: Posture
    angle: float
    hold: float
    fist: float


def clips(skeleton: Skeleton, scene: Scene) -> dict[str, Clip]:
    """Clips by their path in objectdb/."""
    opening = (
        Phase(0.95, AT_CLOSED, 0.0, 1.0, 0.0),
        Phase(0.30, AT_CLOSED, 0.0, 1.0, 1.0),
        Phase(1.30, AT_OPEN, ANGLE, 1.0, 1.0),
        Phase(0.25, AT_OPEN, ANGLE, 1.0, 0.0),
        Phase(1.20, STANDING, ANGLE, 0.0, 0.0),
    )
    closing = (
        Phase(1.15, AT_OPEN, ANGLE, 1.0, 0.0),
        Phase(0.30, AT_OPEN, ANGLE, 1.0, 1.0),
        Phase(1.30, AT_CLOSED, 0.0, 1.0, 1.0),
        Phase(0.25, AT_CLOSED, 0.0, 1.0, 0.0),
        Phase(1.00, STANDING, 0.0, 0.0, 0.0),
    )
    return {
        "door/open.npz": _clip(skeleton, scene, 0.0, opening),
        "door/close.npz": _clip(skeleton, scene, ANGLE, closing),
    }


def on_lever(scene: Scene) -> Transform:
    """The palm's frame on the lever of the closed door: over it from the front, the thumb to the hinge."""
    over = np.radians(OVER)
    out = np.array([0.0, np.cos(over), -np.sin(over)])  # in the door's frame the room is on -y, the hinge at -x
    thumb = np.array([-1.0, 0.0, 0.0])
    ahead = np.cross(out, thumb)  # where the fingers point
    place = -scene.lever_radius * out - INTO_FINGERS * ahead
    return scene.knob.then(Transform(place, from_matrix(np.stack([out, np.cross(thumb, out), thumb], axis=-1))))


def turned(scene: Scene, frame: Transform, degrees: float) -> Transform:
    """A frame that is fixed to the leaf, with the door open by some degrees."""
    hinge = scene.hinge
    leaf = Transform(np.zeros(3), from_axis_angle(UP, np.radians(degrees)))
    return hinge.then(leaf).then(hinge.inverse()).then(frame)


def _clip(skeleton: Skeleton, scene: Scene, angle: float, phases: tuple[Phase, ...]) -> Clip:
    """The motion, frame by frame, from standing at ease."""
    standing = pose(skeleton, STANDING)
    free = Transform.of(grip_frames(skeleton, *standing)[RIGHT_HAND])
    site = turned(scene, scene.knob, angle)
    shapes = (opened(SIDE), _fist(skeleton, scene))
    before = Phase(0.0, STANDING, angle, 0.0, 0.0)
    rotations, root, rows = [standing[0]], [standing[1]], [np.zeros((5, 8))]
    for phase in phases:
        for done in minimum_jerk(np.arange(1, round(phase.seconds * RATE) + 1) / round(phase.seconds * RATE)):
            hold = before.hold + done * (phase.hold - before.hold)
            fist = before.fist + done * (phase.fist - before.fist)
            lever = turned(scene, on_lever(scene), before.angle + done * (phase.angle - before.angle))
            palm = _path(free, lever, hold)
            posture = replace(_between(before.posture, phase.posture, done), grips={SIDE: palm.row()})
            made = pose(skeleton, posture)
            _shape_hand(made[0], standing[0], shapes, hold, fist)
            rotations.append(made[0])
            root.append(made[1])
            rows.append(_targets(site, palm, lever, hold))
        before = phase
    return _made(skeleton, np.stack(rotations), np.stack(root), np.stack(rows))


def _made(skeleton: Skeleton, rotations: Array, root: Array, rows: Array) -> Clip:
    shares = {"": 1.0, "left_upper_arm": 0.5, "left_lower_arm": 0.5, "head": 0.05, "root": 1.0}
    return Clip(
        rotations=rotations, root=root - root[0] * np.array([1.0, 1.0, 0.0]),
        importance=np.tile(importance_of(shares), (len(rotations), 1)), contacts=np.ones((len(rotations), 2)),
        rate=RATE, targets=rows, header=ClipHeader(origin="made by scripts/make_motions.py", human=skeleton.name),
    )  # fmt: skip


def _path(free: Transform, lever: Transform, hold: float) -> Transform:
    """The palm between hanging free and the lever, off the straight line to where it does not scrape the lever."""
    place = free.place + hold * (lever.place - free.place)
    aside = rotate(lever.rotation, np.array([-1.0, 0.0, 0.0])) + 0.5 * UP
    rise = SHY * 16.0 * hold**2 * (1.0 - hold) ** 2
    turn = float(minimum_jerk(np.array(hold / 0.8)))
    return Transform(place + rise * aside, slerp(free.rotation, lever.rotation, turn))


def _targets(site: Transform, palm: Transform, lever: Transform, hold: float) -> Array:
    """Targets (5, 8) relative to the site at the start: the palm, the more the nearer it is; the gaze on the lever."""
    rows = np.zeros((5, 8))
    rows[RIGHT_HAND, :7] = site.inverse().then(palm).row()
    rows[RIGHT_HAND, 7] = minimum_jerk(np.array(hold / 0.9))
    rows[GAZE, :3] = site.inverse().apply(lever.place)
    rows[GAZE, 7] = float(hold > 0.02)
    return rows


def _fist(skeleton: Skeleton, scene: Scene) -> Array:
    """The fingers (14, 4) closed around the lever."""
    on_hand = Transform.of(skeleton.grips[RIGHT_HAND])
    hand = on_lever(scene).then(on_hand.inverse())
    lever = hand.inverse().then(scene.knob)
    axis = rotate(lever.rotation, np.array([1.0, 0.0, 0.0]))
    return closed(skeleton, SIDE, Cylinder(lever.place, axis, scene.lever_radius))


def _shape_hand(rotations: Array, standing: Array, shapes: tuple[Array, Array], hold: float, fist: float) -> None:
    """The right hand's fingers: at ease, open before the lever, closed around it."""
    links = list(fingers(SIDE))
    free = slerp(standing[links], shapes[0], float(minimum_jerk(np.array(hold / 0.8))))
    rotations[links] = slerp(free, shapes[1], fist)


def _between(a: Posture, b: Posture, share: float) -> Posture:
    """A posture on the way from one to another, number by number."""
    mixed = {}
    for field in fields(Posture):
        before, after = getattr(a, field.name), getattr(b, field.name)
        if isinstance(before, float):
            mixed[field.name] = before + share * (after - before)
        elif isinstance(before, tuple):
            mixed[field.name] = tuple(x + share * (y - x) for x, y in zip(before, after, strict=True))
    arm = {f.name: getattr(a.right_arm, f.name) for f in fields(Arm) if f.name != "swivel"}
    arm = {name: x + share * (getattr(b.right_arm, name) - x) for name, x in arm.items()}
    return replace(a, **mixed, right_arm=Arm(**arm))
