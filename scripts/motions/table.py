"""What is done at the table: reaching for the cup, lifting it, drinking. Keyframes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ahmss.algorithm import Transform, importance_of
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE, RIGHT_HAND
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, from_matrix, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.clip import Clip, ClipHeader
from ahmss.motion.poser import STANDING, Arm, Fingers, Posture, pose
from ahmss.skills.staging import lips
from motions.scene import Scene

__all__ = ["clips"]

OPEN_HAND = Fingers(knuckle=8.0, middle=16.0, end=8.0, thumb=95.0, thumb_bend=0.0, thumb_away=18.0, spread=0.0)
AROUND = Fingers(knuckle=45.0, middle=45.0, end=25.0, thumb=72.0, thumb_bend=0.0, thumb_away=18.0, spread=0.0)
GAP = 0.034  # metres between palm and cup where the reach ends and the grasp begins
INTO_FINGERS = 0.01  # as in algorithms/grasp
HEAD = INDEX["head"]
ORIGIN = "made by scripts/make_motions.py"
UP = np.array([0.0, 0.0, 1.0])
UNTURNED = np.array([1.0, 0.0, 0.0, 0.0])
LEFT = np.array([0.0, 1.0, 0.0])


@dataclass(frozen=True)
class Key:
    """A keyframe: its time, its posture, where the right hand's target is and what the gaze is on."""

    time: float
    posture: Posture
    hand: Array | None = None  # (7,) in the frame that the clip's targets are relative to
    gaze: Array | None = None  # (3,)


def clips(skeleton: Skeleton, scene: Scene) -> dict[str, Clip]:
    """Clips by their path in objectdb/."""
    return {
        "cup/reach.npz": reach(skeleton, scene),
        "cup/lift.npz": lift(skeleton, scene),
        "cup/drink.npz": drink(skeleton, scene),
    }


def reach(skeleton: Skeleton, scene: Scene) -> Clip:
    """The palm beside the cup, hand open; the trunk leans as far as the arm needs it."""
    grip = on_cup(scene.cup, scene.cup_radius, GAP)
    posture = replace(AT_TABLE, right_arm=REACHING, right_fingers=OPEN_HAND, grips={"right": grip.row()})
    hand = scene.cup.inverse().then(grip).row()
    return keyframes(skeleton, "site", WHOLE, Key(1.0, posture, hand, np.zeros(3)))


def lift(skeleton: Skeleton, scene: Scene) -> Clip:
    """The cup raised and brought nearer, the body upright again; the targets say where the cup goes."""
    raised = Transform(np.array([-0.13, -0.02, 0.17]), UNTURNED)
    posture = holding(scene, scene.cup.then(raised), HOLDING, EASY)
    return keyframes(skeleton, "site", CARRYING, Key(1.0, posture, raised.row(), np.zeros(3)))


def drink(skeleton: Skeleton, scene: Scene) -> Clip:
    """To the mouth, the cup tilted while the head goes back a little, and down again in front of the chest."""
    keys: list[Key] = []
    for time, tilt, lean, nod, arm in DRINKING:
        posture = replace(EASY, lean=lean, nod=nod, head_turn=HEAD_TURN, head_tilt=HEAD_TILT, right_arm=arm)
        at_mouth = mouth_cup(scene, tilt)
        keys.append(Key(time, _drinking(skeleton, scene, posture, at_mouth), at_mouth.row()))
    down = Transform(np.array([-0.32, -0.03, -0.25]), _upright_in_face(0.0))  # the upper arm hangs
    keys.append(Key(1.0, _drinking(skeleton, scene, replace(EASY, right_arm=HOLDING), down), down.row()))
    return keyframes(skeleton, "face", CARRYING | {"head": 1.0}, *keys)


# --- postures ---------------------------------------------------------------------------------------------------------

REACHING = Arm(forward=35.0, aside=14.0, turn_in=18.0, elbow=45.0, pronate=0.0, swivel=-4.0)
HOLDING = Arm(forward=12.0, aside=14.0, turn_in=30.0, elbow=85.0, pronate=0.0, swivel=-22.0)
AT_MOUTH = Arm(forward=45.0, aside=35.0, turn_in=35.0, elbow=125.0, pronate=0.0, swivel=-44.0)
TILTED = replace(AT_MOUTH, swivel=-46.0)
EASY = replace(STANDING, right_fingers=AROUND)
AT_TABLE = replace(
    STANDING, hips_lean=9.0, lean=9.0, turn=7.0, hips_turn=3.0, nod=4.0, shift=(0.05, -0.005),
    left_arm=Arm(forward=-2.0, aside=9.0, turn_in=5.0, elbow=18.0, pronate=15.0),
)  # fmt: skip
# Time, tilt of the cup, lean of the trunk, nod of the head (degrees), and the arm that says where the elbow is.
DRINKING = (
    (0.25, 28.0, 5.0, 10.0, AT_MOUTH), (0.45, 38.0, 2.0, 2.0, TILTED), (0.58, 41.0, 1.0, 0.0, TILTED),
    (0.69, 28.0, 4.0, 8.0, AT_MOUTH),
)  # fmt: skip
YAW_ON_CUP = 112.0  # degrees from the cup's x (away from the human) to the palm's
HAND_DOWN = 0.0  # degrees that the fingers point below the level
HEAD_TURN, HEAD_TILT = 6.0, -6.0  # degrees, to the left
POURS_ASIDE = 30.0  # degrees from the face's middle to the side of the hand
YAW_AT_MOUTH = 45.0  # degrees that the hand turns about the cup's axis on the way to the mouth
WHOLE = {"": 1.0, "head": 0.05, "left_": 0.3, "root": 1.0}
WHOLE |= {f"left_{link}": 1.0 for link in ("upper_leg", "lower_leg", "foot")}
# With the cup in the hand the fingers stay as they closed around it.
CARRYING = WHOLE | {f"right_{finger}": 0.0 for finger in ("thumb", "index", "middle", "ring", "little")}


def on_cup(cup: Transform, radius: float, gap: float) -> Transform:
    """The palm's frame on the wall of a cup, or a gap before it; `cup` on its axis, x away from the human."""
    yaw = np.radians(YAW_ON_CUP)
    out = np.array([np.cos(yaw), np.sin(yaw), 0.0])
    fingers = np.cross(out, UP)
    turn = np.arcsin(INTO_FINGERS / radius)
    place = -radius * (np.cos(turn) * out + np.sin(turn) * fingers) - gap * out
    level = from_matrix(np.stack([out, np.cross(UP, out), UP], axis=-1))
    return cup.then(Transform(place, multiply(from_axis_angle(out, np.radians(HAND_DOWN)), level)))


def holding(scene: Scene, cup: Transform, arm: Arm, posture: Posture) -> Posture:
    """A posture with the cup in the right hand at a frame (of its wall site)."""
    grip = on_cup(cup, scene.cup_radius, 0.0)
    return replace(posture, right_arm=arm, grips={"right": grip.row()})


def mouth_cup(scene: Scene, tilt: float) -> Transform:
    """The rim in the face's frame (x up, z back), its near edge at the lips, tilted to them by some degrees."""
    aside = np.radians(POURS_ASIDE)
    tilted = from_axis_angle(np.array([0.0, -np.cos(aside), -np.sin(aside)]), np.radians(tilt))
    up = rotate(tilted, np.array([1.0, 0.0, 0.0]))
    ahead = np.array([0.0, 0.0, -1.0]) + up[2] * up
    away = scene.cup_radius / np.linalg.norm(ahead) * ahead
    return Transform(away, multiply(tilted, _upright_in_face(YAW_AT_MOUTH)))


def _upright_in_face(yaw: float) -> Array:
    """An upright cup as the face sees it, turned about its axis by some degrees from its x pointing away."""
    level = from_matrix(np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]))
    return multiply(level, from_axis_angle(UP, np.radians(yaw)))


def _drinking(skeleton: Skeleton, scene: Scene, posture: Posture, rim_in_face: Transform) -> Posture:
    """The posture with the right hand on a cup whose rim is somewhere before the face."""
    wall_in_rim = scene.rim.inverse().then(scene.cup)
    grip_in_rim = wall_in_rim.then(on_cup(Transform(np.zeros(3), UNTURNED), scene.cup_radius, 0.0))
    for _ in range(3):
        rotations, root = pose(skeleton, posture)
        places, world = forward(rotations, root, skeleton.offsets)
        face = Transform(places[HEAD], world[HEAD]).then(Transform(lips(skeleton), UNTURNED))
        posture = replace(posture, grips={"right": face.then(rim_in_face).then(grip_in_rim).row()})
    return posture


def keyframes(skeleton: Skeleton, targets: str, shares: dict[str, float], *keys: Key) -> Clip:
    """A clip of keyframes for `slerp`; the targets are the hand's and the gaze's."""
    poses = [pose(skeleton, key.posture) for key in keys]
    rows = np.zeros((len(keys), 5, 8))
    for row, key in zip(rows, keys, strict=True):
        if key.hand is not None:
            row[RIGHT_HAND, :7], row[RIGHT_HAND, 7] = key.hand, 1.0
        if key.gaze is not None:
            row[GAZE, :3], row[GAZE, 7] = key.gaze, 1.0
    return Clip(
        rotations=np.stack([rotations for rotations, _ in poses]),
        root=np.stack([root for _, root in poses]),
        importance=np.tile(importance_of(shares), (len(keys), 1)),
        contacts=np.ones((len(keys), 2)),
        rate=60.0,
        targets=rows,
        header=ClipHeader(
            origin=ORIGIN,
            human=skeleton.name,
            targets=targets,
            times=tuple(key.time for key in keys),  # type: ignore[arg-type]
        ),
    )
