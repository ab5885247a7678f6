"""A performance: what a person does before a tracker, frame by frame, and where in it they stand upright.

The simulated tracker mounts its sensors on one. It is composed (`ahmss.capture.subject`) or a clip, replayed as if a
person performed it: real capture goes through the whole chain this way.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.quaternion import conjugate, from_rotation_vector, multiply, slerp, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.motion.clip import Clip
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.planting import feet, plant
from ahmss.motion.resample import continuous

__all__ = ["SENSORS", "Performance", "begun_upright", "of_clip"]

SENSORS = 15  # the links that bear a sensor are the first 15; fingers have none


@dataclass(frozen=True)
class Performance:
    """A motion of F frames by one person, in the world (z up, the floor at z = 0).

    rotations (F, 43, 4) unit quaternions, parent <- child; root (F, 3) metres; rate in frames a second; upright: the
    first frame of the still upright pose and the one after its last.
    """

    rotations: Array
    root: Array
    rate: float
    skeleton: Skeleton
    name: str
    upright: tuple[int, int]

    @property
    def frames(self) -> int:
        """How many frames there are."""
        return len(self.rotations)

    @property
    def duration(self) -> float:
        """Seconds from the first frame to the last."""
        return (self.frames - 1) / self.rate

    def links(self) -> tuple[Array, Array]:
        """The links that bear sensors, in the world: joints (F, 15, 3) in metres, rotations (F, 15, 4)."""
        places, world = forward(self.rotations, self.root, self.skeleton.offsets)
        return places[:, :SENSORS], world[:, :SENSORS]


def of_clip(clip: Clip, skeleton: Skeleton, upright_seconds: float = 2.0, *, name: str = "clip") -> Performance:
    """A clip as a person performs it for a tracker: they stand upright first, then go into the clip within a second.

    Args:
        clip: frames at even times (no keyframes), the floor at z = 0.
        skeleton: whose lengths the person has.
        upright_seconds: how long they stand still.
        name: what the performance is called.

    Raises:
        ValueError: the clip is one of keyframes; resample it first.
    """
    if clip.header.times is not None:
        raise ValueError("a performance needs frames at even times, this clip has keyframes; resample it first")
    return begun_upright((clip.rotations, clip.root), clip.rate, skeleton, upright_seconds, name)


def begun_upright(
    motion: tuple[Array, Array], rate: float, skeleton: Skeleton, seconds: float, name: str, going: float = 1.0
) -> Performance:
    """A motion (rotations, root) with the upright pose held before it, and `going` seconds from there to its start."""
    rotations, root = continuous(motion[0]), motion[1]
    upright = _upright(skeleton, rotations[0], root[0])
    still, count = max(round(seconds * rate), 1), max(round(going * rate), 1)
    into = _into(upright, (rotations, root), np.arange(1, count) / count, count)
    return Performance(
        rotations=np.concatenate([np.repeat(upright[0][None], still, axis=0), into[0], rotations]),
        root=np.concatenate([np.repeat(upright[1][None], still, axis=0), into[1], root]),
        rate=rate, skeleton=skeleton, name=name, upright=(0, still),
    )  # fmt: skip


def _upright(skeleton: Skeleton, rotations: Array, root: Array) -> tuple[Array, Array]:
    """Upright where a pose stands, facing as its feet do."""
    upright, at = skeleton.upright()
    turned, place = plant(skeleton, upright, feet(skeleton, rotations, root))
    return turned, np.array([place[0], place[1], at[2]])


def _into(upright: tuple[Array, Array], motion: tuple[Array, Array], share: Array, count: int) -> tuple[Array, Array]:
    """Frames (n, 43, 4) and (n, 3) from upright to the motion's start, arriving with the motion's own velocity.

    What is gone towards is the start carried back along its first step, less and less.
    """
    rotations, root = motion
    back = -(1.0 - share) * share**2 * count  # of a step: none at both ends, one step a frame at the motion's start
    first = min(1, len(root) - 1)
    turn = to_rotation_vector(multiply(conjugate(rotations[0]), rotations[first]))
    goal = multiply(rotations[0], from_rotation_vector(back[:, None, None] * turn))
    place = root[0] + back[:, None] * (root[first] - root[0])
    done = minimum_jerk(share)
    return slerp(upright[0], goal, done[:, None]), upright[1] + done[:, None] * (place - upright[1])
