"""A clip set on the stage: its poses put under the acting human, its targets brought to the world's places.

What several of the shipped algorithms share, and an author may use: a clip knows neither where the human stands, nor
how tall it is, nor where the object is.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import align, conjugate, from_axis_angle, multiply
from ahmss.body.skeleton import Skeleton
from ahmss.errors import AlgorithmError
from ahmss.motion.clip import Clip
from ahmss.motion.edit import floor_frame, mirrored, part
from ahmss.motion.planting import feet, plant, stance
from ahmss.reaching.standing import Posture
from ahmss.skills.settling import settle
from ahmss.skills.sitting import LOWEST, heading_of, must_stand, seat_of

__all__ = ["Staged", "face", "lips", "mirrored", "part", "stage", "stands"]

_LIPS = np.array([-0.0422, 0.0, -0.0062])
_UNTURNED = np.array([1.0, 0.0, 0.0, 0.0])
_HEAD = INDEX["head"]
_UP = np.array([0.0, 0.0, 1.0])
_LEG = ("upper_leg", "lower_leg", "foot")
_SWAYS = 0.1  # metres: hips that go less far stay where they are, as far as who sits is concerned
_CARES = 0.5  # an arm's importance below which a clip leaves it to others


@dataclass(frozen=True)
class Staged:
    """A clip's F frames in the world.

    rotations (F, 43, 4), root (F, 3), importance (F, 44), contacts (F, 2). local (F, 5, 8): the targets as the clip
    has them; base: what they are relative to, one frame in the world or one a clip frame. feet (2, 7): where the
    human's feet are now. planted: whether both stay there throughout. towards: what the trunk is drawn towards on its
    way to each of the frames, of who rises or crouches; empty: one does neither.
    """

    clip: Clip
    rotations: Array
    root: Array
    base: Transform | None
    feet: Array
    planted: bool
    towards: Sequence[Posture | None] = ()

    @property
    def local(self) -> Array:
        """The clip's targets (F, 5, 8), all without weight where it has none."""
        targets = self.clip.targets
        return np.zeros((self.clip.frames, 5, 8)) if targets is None else targets


def stage(task: HumanTask, clip: Clip) -> Staged:
    """Set a clip on the stage for the task's human, object and hand.

    A clip whose feet stay on the floor is put where the human's feet stand, or, of who sits, on the hips as they sit;
    where it is relative to an object, its hips go between there and the object; the others start at the human's floor
    frame (or lie in the object's frame, where the header says so). Of who is carried, an arm for which the clip hardly
    cares is left to what carries them: it knows what is beside.

    Raises:
        AlgorithmError: the clip's targets are relative to a site, but the action names none; or the human is too far
            from where a motion relative to an object starts, or sits and the clip takes the body elsewhere.
    """
    if task.hand == "left":
        clip = mirrored(clip)
    if task.carried:
        clip = _without_idle_arms(clip)
    present = feet(task.human, task.start.rotations, task.start.root)
    planted = _on_both_feet(clip)
    sits = None if task.carried else seat_of(task)
    if sits and not (_on_the_spot(clip) or _from_seat(clip)):
        raise AlgorithmError(must_stand(task, "do that"))
    if stands(clip):
        rotations, root = _seated(task, clip) if sits else plant(task.human, clip.rotations, present)
    elif planted:
        rotations, root = settle(task, clip, _object(task), present)
    else:
        origin = _object(task) if clip.header.frame == "object" else _floor(task)
        rotations, root = clip.rotations.copy(), origin.apply(clip.root)
        rotations[:, 0] = multiply(origin.rotation, clip.rotations[:, 0])
    return Staged(clip, rotations, root, _base(task, clip), present, planted)


def stands(clip: Clip) -> bool:
    """Whether both feet stay on the floor throughout; then each frame is staged by itself, and `part`s may be."""
    return _on_both_feet(clip) and clip.header.frame == "human"


def _on_the_spot(clip: Clip) -> bool:
    """Whether one stands throughout and the hips hardly go anywhere, so that it can be done on a seat as well."""
    return stands(clip) and float(np.ptp(clip.root, axis=0).max()) < _SWAYS


def _from_seat(clip: Clip) -> bool:
    """Whether a motion relative to an object begins with the hips low: it stands up, or goes on sitting."""
    seated = clip.header.frame == "object" and _on_both_feet(clip)
    return seated and float(clip.root[0, 2]) < LOWEST * float(clip.root[:, 2].max())


def _seated(task: HumanTask, clip: Clip) -> tuple[Array, Array]:
    """Rotations (F, 43, 4) and root (F, 3) of a clip in which one stands, for who sits.

    Hips, legs, and arms for which the clip hardly cares, stay as they are; over the hips the trunk is as it is over the
    clip's feet.
    """
    start, hips, spine = task.start, INDEX["hips"], INDEX["spine"]
    _, heading = stance(feet(task.human, clip.rotations, clip.root))
    turn = from_axis_angle(_UP, heading_of(start.rotations) - heading)
    trunk = multiply(turn, multiply(clip.rotations[:, hips], clip.rotations[:, spine]))
    kept = [i for i, link in enumerate(LINKS) if link == "hips" or link.endswith(_LEG)] + _idle(clip)
    rotations = clip.rotations.copy()
    rotations[:, spine] = multiply(conjugate(start.rotations[hips]), trunk)
    rotations[:, kept] = start.rotations[kept]
    return align(rotations, start.rotations), np.repeat(start.root[None], clip.frames, axis=0)


def _without_idle_arms(clip: Clip) -> Clip:
    importance = clip.importance.copy()
    importance[:, _idle(clip)] = 0.0
    return replace(clip, importance=importance)


def _idle(clip: Clip) -> list[int]:
    """The links, fingers and all, of arms for which a clip hardly cares."""
    sides = tuple(side for side in ("right", "left") if clip.importance[:, INDEX[f"{side}_upper_arm"]].max() < _CARES)
    arms = [i for i, link in enumerate(LINKS) if link.startswith(sides) and not link.endswith(_LEG)]
    return arms if sides else []


def face(task: HumanTask, rotations: Array, root: Array) -> Transform:
    """The face (...) of poses in the world: origin between the lips, axes of the head link (x up, y left, z back)."""
    places, world = forward(rotations, root, task.human.offsets)
    head = Transform(places[..., _HEAD, :], world[..., _HEAD, :])
    return Transform(head.apply(lips(task.human)), head.rotation)


def lips(skeleton: Skeleton) -> Array:
    """The middle of the mouth (3,) in the head's frame, metres: under the eyes by a share of stature."""
    return skeleton.eye + skeleton.stature * _LIPS


def _on_both_feet(clip: Clip) -> bool:
    return bool((clip.contacts > 0.5).all())


def _base(task: HumanTask, clip: Clip) -> Transform | None:
    """What the targets are relative to; None for the face, which moves with the motion."""
    kind = clip.header.targets
    if clip.targets is None or not clip.targets[..., 7].any() or kind == "face":
        return None
    if kind == "human":
        return _floor(task)
    if kind == "object":
        return _object(task)
    if task.site is None:
        raise AlgorithmError("the motion's targets are relative to a site, but the action names no site")
    return task.site


def _object(task: HumanTask) -> Transform:
    if task.object is None:
        raise AlgorithmError("the motion is relative to an object, but the action has none")
    return task.object.frame


def _floor(task: HumanTask) -> Transform:
    """The human's floor frame at the start: under the hips, x where they face."""
    return Transform(*floor_frame(task.start.rotations, task.start.root))
