"""A clip set on the stage: its poses put under the acting human, its targets brought to the world's places.

What several of the shipped algorithms share, and an author may use: a clip knows neither where the human stands, nor
how tall it is, nor where the object is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.settling import settle
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import multiply
from ahmss.body.skeleton import Skeleton
from ahmss.errors import AlgorithmError
from ahmss.motion.clip import Clip
from ahmss.motion.edit import floor_frame, mirrored, part
from ahmss.motion.planting import feet, plant

__all__ = ["Staged", "face", "lips", "mirrored", "part", "stage", "stands"]

_LIPS = np.array([-0.0422, 0.0, -0.0062])
_UNTURNED = np.array([1.0, 0.0, 0.0, 0.0])
_HEAD = INDEX["head"]


@dataclass(frozen=True)
class Staged:
    """A clip's F frames in the world.

    rotations (F, 43, 4), root (F, 3), importance (F, 44), contacts (F, 2). local (F, 5, 8): the targets as the clip
    has them; base: what they are relative to, one frame in the world or one a clip frame. feet (2, 7): where the
    human's feet are now. planted: whether both stay there throughout.
    """

    clip: Clip
    rotations: Array
    root: Array
    base: Transform | None
    feet: Array
    planted: bool

    @property
    def local(self) -> Array:
        """The clip's targets (F, 5, 8), all without weight where it has none."""
        targets = self.clip.targets
        return np.zeros((self.clip.frames, 5, 8)) if targets is None else targets


def stage(task: HumanTask, clip: Clip) -> Staged:
    """Set a clip on the stage for the task's human, object and hand.

    A clip whose feet stay on the floor is put where the human's feet stand, and where it is relative to an object, its
    hips go between there and the object; the others start at the human's floor frame (or lie in the object's frame,
    where the header says so).

    Raises:
        AlgorithmError: the clip's targets are relative to a site, but the action names none; or the human is too far
            from where a motion relative to an object starts.
    """
    if task.hand == "left":
        clip = mirrored(clip)
    present = feet(task.human, task.start.rotations, task.start.root)
    planted = _on_both_feet(clip)
    if stands(clip):
        rotations, root = plant(task.human, clip.rotations, present)
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
