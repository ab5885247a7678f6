"""Reaches to the floor beside a table: nothing of the body that bends is in its top."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import HumanPose
from ahmss.algorithm.messages import Goal
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.reaching.trunk import trunk_points

from .reached import TABLE, outlined
from .scene import FLOOR, Body, frame_of, record
from .solids import deepest, skin

TOP = ((-0.5, 0.5, -0.6, 0.6, 0.85, 0.88),)
HUMANS = ("ken", "aiko")


@pytest.mark.parametrize("name", HUMANS)
def test_the_head_is_as_thick_as_its_skin(name: str) -> None:
    human = skin(name)
    rotations, root = human.skeleton.upright()
    points, radii = trunk_points(human.skeleton, rotations, root)
    vertices = np.flatnonzero(human.link == INDEX["head"])
    seen = human.posed(rotations, root, vertices)
    neck = forward(rotations, root, human.skeleton.offsets)[0][INDEX["head"], 2] + 0.1  # metres: chin and throat
    outside = (np.linalg.norm(seen[:, None] - points, axis=-1) - radii).min(axis=-1)[seen[:, 2] > neck]
    assert outside.max() < 0.01


@pytest.mark.parametrize(
    ("name", "place", "stands"),
    [
        ("aiko", (0.78, 0.88, 0.32), (0.95, 1.22, -66.0)),
        pytest.param("ken", (0.59, 0.85, 0.33), (0.72, 1.27, -134.0), marks=pytest.mark.long),
        pytest.param("ken", (1.14, 1.03, 0.28), (1.01, 1.13, 19.0), marks=pytest.mark.long),
        ("aiko", (0.92, 0.98, 0.06), (0.91, 1.14, -132.0)),  # leaning past it, else the arm is too short
        pytest.param("ken", (0.45, 1.01, 0.2), (0.59, 1.23, -130.0), marks=pytest.mark.long),
        pytest.param("ken", (1.17, 0.91, 0.14), (0.91, 1.15, -12.0), marks=pytest.mark.long),
    ],
)
def test_who_bends_beside_a_table_is_not_in_its_top(
    name: str, place: tuple[float, float, float], stands: tuple[float, float, float]
) -> None:
    shown, off = bent_to(name, place, stands)
    assert off < 0.03
    table = frame_of(TABLE)
    depths = [deepest(name, HumanPose(pose.rotations, pose.root), table, TOP) for pose in shown[::4]]
    assert max(depths)[0] < 1e-3, max(depths)


def test_where_the_easier_arm_ends_short_the_other_reaches_it() -> None:
    assert bent_to("ken", (1.14, 0.9, 0.19), (1.18, 1.3, -167.0))[1] < 1e-3, "28 mm of the left hand"


def bent_to(
    name: str, place: tuple[float, float, float], stands: tuple[float, float, float]
) -> tuple[list[HumanPose], float]:
    """The poses of a reach beside the room's table, and how far the palm is from the place in the end, metres."""
    body = Body(name, *stands)
    start = body.start(FLOOR, "stand", frames=0, wish=True, hand="", parameters={}, goal=Goal(place=place))
    shown = body.do("reach", msgspec.structs.replace(start, world=[outlined(record(TABLE), 11)]))
    palms = shown[-1].targets[:2]
    return shown, float(np.linalg.norm(palms[palms[:, 7] > 0.0][:, :3] - place, axis=-1).min())
