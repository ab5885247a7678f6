"""Where hands come to be against the body, measured from joints alone and without what retargeting is made of.

Both measures are in arm lengths, scaled to the arm of the human, as ACCAD's performer has arms of 42 cm.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.body.skeleton import Skeleton
from ahmss.database.workspace import Workspace
from ahmss.motion.importing import import_clip, read_source

from .mocap import capture_path

CLIPS = ["A01", "A05", "B01", "B02", "B03", "B09", "B10", "B12", "B13"]
MOST = 0.02  # metres
SIDES = ("Right", "Left")
AXES = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])  # ahead, left, up; files have z, x, y


@dataclass
class Arms:
    """Shoulders and hands (F, 2, 3), right and left, from the neck along ahead, left and up of the trunk; metres.

    The trunk points from waist to neck, and to the left as the chest does; upright is as the zero pose is.
    """

    shoulders: Array
    hands: Array

    @classmethod
    def of(cls, limbs: Array, waist: Array, neck: Array, left: Array, upright: Array, scale: float) -> Arms:
        """Args: limbs (F, 2, 2, 3) shoulders, then hands; upright (3, 3): the trunk's axes by `frame` when upright."""
        turned = upright @ np.swapaxes(frame(neck - waist, left), -1, -2)
        local = scale * np.einsum("fij,fklj->fkli", turned, limbs - neck[:, None, None])
        return cls(local[:, 0], local[:, 1])


def frame(up: Array, left: Array) -> Array:
    """Columns ahead, left, up (..., 3, 3)."""
    up = up / np.linalg.norm(up, axis=-1, keepdims=True)
    left = left - up * (left * up).sum(axis=-1, keepdims=True)
    left = left / np.linalg.norm(left, axis=-1, keepdims=True)
    return np.stack([np.cross(left, up), left, up], axis=-1)


def length(shoulders: Array, elbows: Array, hands: Array) -> float:
    return float(np.median(np.linalg.norm(elbows - shoulders, axis=-1) + np.linalg.norm(hands - elbows, axis=-1)))


def performed(path: Path, arm: float) -> Arms:
    """The arms of a file of ACCAD, scaled to an arm of that length."""
    source = read_source(path)
    places, world = source.world()
    at = {name: i for i, name in enumerate(source.names)}
    arms = [places[:, [at[f"{side}{part}"] for side in SIDES]] for part in ("Arm", "ForeArm", "Hand")]
    x = np.array([1.0, 0.0, 0.0])
    zero = source.zero_pose()
    upright = AXES @ frame(zero[at["Neck"]] - zero[at["ToSpine"]], x)
    left = rotate(world[:, at["Spine1"]], x)
    limbs = np.stack([arms[0], arms[2]], axis=1)
    return Arms.of(limbs, places[:, at["ToSpine"]], places[:, at["Neck"]], left, upright, arm / length(*arms))


def imported(path: Path, skeleton: Skeleton) -> tuple[Arms, float]:
    """The human's, and how long they are."""
    clip, _ = import_clip(path, skeleton, rate=None)
    places, world = forward(clip.rotations, clip.root, skeleton.offsets)
    arms = [
        places[:, [INDEX[f"{side.lower()}_{part}"] for side in SIDES]] for part in ("upper_arm", "lower_arm", "hand")
    ]
    spine, y = INDEX["spine"], np.array([0.0, 1.0, 0.0])
    straight, root = skeleton.upright()
    zero, _ = forward(straight, root, skeleton.offsets)
    upright = frame(zero[INDEX["head"]] - zero[spine], y)
    limbs = np.stack([arms[0], arms[2]], axis=1)
    own = Arms.of(limbs, places[:, spine], places[:, INDEX["head"]], rotate(world[:, spine], y), upright, 1.0)
    return own, length(*arms)


@pytest.mark.parametrize("human", ["ken", "aiko"])
@pytest.mark.parametrize("clip", CLIPS)
def test_hands_stay_within_2_cm_of_the_source_relative_to_the_body(clip, human):
    path = capture_path(clip)
    own, arm = imported(path, Workspace(Path(__file__).parents[2]).humans.get(human).skeleton)
    source = performed(path, arm)
    far, meant = (np.linalg.norm(each.hands - each.shoulders, axis=-1) for each in (own, source))
    assert np.abs(far - meant).max() < MOST  # as far from the shoulder, which moves on the performer's trunk
    # In place on the trunk, up to a constant: which place on it the performer's shoulder has is nobody's to say.
    off = (source.hands - np.median(source.shoulders, axis=0)) - (own.hands - own.shoulders)
    middle = (off.max(axis=0) + off.min(axis=0)) / 2.0
    assert np.linalg.norm(off - middle, axis=-1).max() < MOST
    assert np.linalg.norm(np.median(off, axis=0), axis=-1).max() < 0.03
    assert np.ptp(source.hands, axis=0).max() > MOST or clip == "A01"  # they do move
