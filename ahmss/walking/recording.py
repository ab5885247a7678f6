"""A user's captures read: motion files of any maker and clips, as bodies of one human whose feet are known to stand."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.errors import DataError
from ahmss.motion import clip as clips
from ahmss.motion.clip import Clip
from ahmss.motion.contact import foot_points
from ahmss.motion.edit import at_rate
from ahmss.motion.grounding import ground
from ahmss.motion.importing import import_clip
from ahmss.walking.library import BODY, RATE
from ahmss.walking.phases import Walk, steady_contacts, walks
from ahmss.walking.replanting import touching

__all__ = ["MOTION_FILES", "Recording", "read"]

MOTION_FILES = (".bvh", ".amc", ".c3d", ".npz")


@dataclass(frozen=True, eq=False)
class Recording:
    """A motion of F frames at 60 a second, the floor at z = 0.

    rotations (F, 15, 4), root (F, 3); bearing (F, 2, 3) of heel, ball and toe; walks: what goes on in it.
    """

    file: str
    rotations: Array
    root: Array
    bearing: NDArray[np.bool_]
    contacts: NDArray[np.bool_]
    walks: tuple[Walk, ...]


def read(path: Path, skeleton: Skeleton) -> Recording:
    """A file's motion on a human.

    A clip of another human keeps its rotations; where its hips go is found from the feet that stand.

    Raises:
        DataError: the file is damaged, of a kind that holds no motion, or holds keyframes or a motion at an object.
    """
    clip = _clip(path, skeleton) if path.suffix.lower() == ".npz" else import_clip(path, skeleton, rate=RATE)[0]
    bears = steady_contacts(foot_points(skeleton, clip.rotations, clip.root), RATE)
    body = clip.rotations[:, :BODY]
    return Recording(
        path.name, body, clip.root, touching(skeleton, body, clip.root, bears), bears, walks(bears, clip.root, RATE)
    )


def _clip(path: Path, skeleton: Skeleton) -> Clip:
    clip = clips.load(path)
    if clip.header.times is not None:
        raise DataError(path, "header.times", "keyframes; a walk is cut from a motion")
    if clip.header.frame != "human":
        raise DataError(
            path, "header.frame", "its poses are relative to an object; a walk is cut from a human's motion"
        )
    clip = at_rate(clip, RATE)
    if clip.header.human not in ("", skeleton.name):
        rotations, root, _ = ground(skeleton, clip.rotations, None, RATE)
        return Clip(rotations, root, clip.importance, clip.contacts, RATE)
    return clip
