"""A cup over one's head is reached for with the hand askew of it, as far as a hand still holds it so, and held."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ahmss.algorithm import HumanPose, Transform
from ahmss.body.links import INDEX, LINKS, fingers
from ahmss.body.quaternion import IDENTITY, rotate
from ahmss.errors import AlgorithmError
from ahmss.motion.smoothness import worst_pop
from tests.grasping.shapes import kind, outside

from .scene import CUP, FLOOR, Body, record
from .test_before_grip import DEEPEST, LOOSELY, UP, seen, skin


def taken(name: str, ahead: float, aside: float, height: float) -> tuple[Body, str, Transform, list[list[HumanPose]]]:
    """A cup in the air, reached for and grasped by who faces it straight; the hand that has it, and both motions."""
    body, cup = Body(name, facing=0.0), Transform(np.array([ahead, aside, height]), IDENTITY)
    told: dict[str, Any] = {"frame": cup, "world": [record(FLOOR)]}
    reached = body.do("reach", body.start(CUP, "reach", hand="", **told))
    side = ("right", "left")[int(reached[-1].targets[1, 7] > 0.0)]
    return body, side, cup, [reached, body.do("grasp", body.start(CUP, "grasp", hand=side, **told))]


@pytest.mark.parametrize(
    ("name", "ahead", "aside", "height", "most"),
    [
        ("ken", 0.45, 0.0, 1.6, 16.0), ("ken", 0.35, 0.15, 1.85, 31.0), ("aiko", 0.45, -0.1, 1.65, 31.0),
        *(pytest.param("ken", ahead, aside, 1.85, 31.0, marks=pytest.mark.long)
          for ahead in (0.35, 0.45, 0.55) for aside in (-0.15, 0.0, 0.15)),
    ],
)  # fmt: skip
def test_a_cup_over_ones_head_is_held_from_where_one_stands(
    name: str, ahead: float, aside: float, height: float, most: float
) -> None:
    body, side, cup, motions = taken(name, ahead, aside, height)
    thumb = rotate(body.grip(("right", "left").index(side)).rotation, UP)  # level to the cup, or up along it
    assert np.degrees(np.arccos(abs(thumb[2]))) < most
    of = skin(name)
    chosen: Any = np.flatnonzero(np.isin(of.link, [INDEX[f"{side}_hand"], *fingers(side)]))
    gaps = np.array(
        [outside(seen(of, pose, cup, chosen), kind("cup"), LOOSELY) for pose in motions[0][-10:] + motions[1]]
    )
    assert gaps.min() > -DEEPEST
    touching = {LINKS[link].split("_")[1] for link in of.link[chosen[gaps[-1] < LOOSELY]].tolist()} - {"hand"}
    assert touching >= {"thumb", "index", "middle", "ring"}
    for shown in motions:
        assert worst_pop(np.array([pose.rotations for pose in shown])).degrees < 2.0


@pytest.mark.parametrize(
    ("ahead", "told"),
    [
        (0.25, "wrist does not turn so far: the palm would be .* at room/cup; `do floor walk to cup` first"),
        (0.75, r"arm is 0\.\d\d m too short for that from here; `do floor walk to cup` first"),
    ],
)
def test_where_no_hand_comes_to_it_from_here_one_is_told_to_walk_to_it(ahead: float, told: str) -> None:
    with pytest.raises(AlgorithmError, match=told):
        taken("ken", ahead, 0.0, 1.85)
