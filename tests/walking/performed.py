"""Recordings of a known walk: performed to a plan, then turned, moved and perhaps seen in a mirror."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, from_rotation_vector, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion import clip as clips
from ahmss.motion.clip import Clip, ClipHeader
from ahmss.motion.contact import foot_points
from ahmss.walking.catalogue import Key
from ahmss.walking.fitting import Pose
from ahmss.walking.gait import GAIT
from ahmss.walking.library import BODY, RATE
from ahmss.walking.mirroring import mirror
from ahmss.walking.performer import Performed, Stand, perform
from ahmss.walking.plans import Planner, Take
from ahmss.walking.replanting import whole

HUMAN = Skeleton.of(1.62, "female", "aiko")


def _leaning() -> Stand:
    """Standing with the hips 3 cm ahead of the ankles, as people do."""
    rotations, root = HUMAN.relaxed()
    back = np.radians(2.2)
    for side in ("right", "left"):
        for link, sign in (("upper_leg", 1.0), ("foot", -1.0)):
            joint = INDEX[f"{side}_{link}"]
            rotations[joint] = multiply(rotations[joint], from_rotation_vector(np.array([0.0, sign * back, 0.0])))
    lowest = foot_points(HUMAN, rotations, root)[..., 2].min()
    return Stand(rotations, root - np.array([0.0, 0.0, lowest]))


STAND = _leaning()
STANDING = Pose(STAND.rotations[:BODY], STAND.root)
UP = np.array([0.0, 0.0, 1.0])


@cache
def performance(key: Key) -> tuple[Performed, Take]:
    """All that is performed for a clip, before and after it too."""
    take = Planner(HUMAN, STAND, GAIT).take(key)
    return perform(HUMAN, STAND, take.plan, GAIT), take


def recorded(key: Key, degrees: float = 130.0, seen: bool = False) -> Clip:
    """The performance as a recording in a room, heading anywhere; seen: in a mirror."""
    performed, _ = performance(key)
    rotations, root = performed.rotations.copy(), performed.root
    if seen:
        rotations, root = mirror(rotations, root)
    turn = from_axis_angle(UP, np.radians(degrees))
    rotations[:, 0] = multiply(turn, rotations[:, 0])
    root = rotate(turn, root) + np.array([1.5, -2.0, 0.0])
    frames = len(root)
    return Clip(
        whole(HUMAN, rotations), root, np.ones((frames, 44)), np.ones((frames, 2)), RATE,
        header=ClipHeader(origin="performed", human=HUMAN.name),
    )  # fmt: skip


def save(clip: Clip, path: Path) -> Path:
    clips.save(clip, path)
    return path
