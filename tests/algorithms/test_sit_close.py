"""sit, where something stands close before the chair: no skin of who goes down or up is in it, or it is refused."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import HumanPose, Transform
from ahmss.algorithm.messages import ObjectRecord, ShapeRecord
from ahmss.bench.solids import Solids
from ahmss.body.quaternion import from_axis_angle
from ahmss.errors import AlgorithmError

from .reached import outlined
from .scene import TELEVISION, WORKSPACE, Body, record
from .solids import skin

CHAIR, TABLE = "room/chair", "room/table"
UP = np.array([0.0, 0.0, 1.0])
FRONT, SCREEN, EDGE = 0.22, 0.186, 0.5  # metres from the middles of chair, television, table to where they end
SOLIDS = Solids(WORKSPACE)


def before(name: str, facing: float, far: float, ends: float) -> tuple[Transform, ObjectRecord]:
    """A chair that faces a thing, turned by degrees, and the thing, metres before the middle of the chair's front."""
    turn = float(np.radians(facing))
    front = FRONT * np.array([np.cos(turn), np.sin(turn)])
    place = np.array([front[0] + far + ends, front[1], 0.0])
    thing = outlined(record(name, Transform(place, from_axis_angle(UP, np.pi))), 11)
    kept = WORKSPACE.objects.kept_shape(thing.kind)
    assert kept is not None
    chair = Transform(np.zeros(3), from_axis_angle(UP, turn))
    return chair, msgspec.structs.replace(thing, shape=ShapeRecord(str(kept[0]), kept[1]))


def down_and_up(name: str, chair: Transform, facing: float, thing: ObjectRecord, *actions: str) -> list[HumanPose]:
    """The poses of who stands before a chair and sits down on it, and what else they do then."""
    x, y, _ = chair.apply(np.array([0.35, 0.0, 0.0])).tolist()
    body, shown = Body(name, x, y, facing), list[HumanPose]()
    for action in actions or ("sit",):
        start = body.start(CHAIR, action, frame=chair, hand="", world=[thing])
        shown += body.do("sit", msgspec.structs.replace(start, object=outlined(start.object, 3)))  # type: ignore[arg-type]
    return shown


def deepest(name: str, shown: list[HumanPose], thing: ObjectRecord) -> float:
    """How deep, metres, skin is in a thing in any third frame."""
    seen, pose = skin(name), np.array([*thing.place, *thing.rotation])
    vertices = np.arange(len(seen.vertices))
    posed = (seen.posed(one.rotations, one.root, vertices) for one in shown[::3])
    return max(float(SOLIDS.depth(thing.kind, pose, {}, points).max()) for points in posed)


@pytest.mark.parametrize(("name", "facing"), [("ken", 0.0), ("aiko", -20.0), ("aiko", 20.0)])
def test_shins_are_not_in_what_stands_close_before_the_chair(name: str, facing: float) -> None:
    """They were 28, 18 and 14 mm in it."""
    chair, thing = before(TELEVISION, facing, 0.3, SCREEN)
    shown = down_and_up(name, chair, facing, thing, "sit", "stand_up")
    assert deepest(name, shown, thing) < 0.002
    rotations = np.array([pose.rotations[:15] for pose in shown[:130]])
    turns = np.abs((rotations[1:] * rotations[:-1]).sum(axis=-1))
    assert np.degrees(2.0 * np.arccos(np.clip(turns, 0.0, 1.0))).max() < 5.0  # in a frame, at ease 3.2
    assert np.linalg.norm(shown[130].root[:2] - chair.apply(np.array([-0.055, 0.0, 0.0]))[:2]) < 0.05


def test_who_has_no_room_however_they_go_down_is_told_how_much_is_lacking() -> None:
    chair, thing = before(TELEVISION, 20.0, 0.26, SCREEN)
    with pytest.raises(AlgorithmError) as refused:
        down_and_up("ken", chair, 20.0, thing)
    told = str(refused.value)
    assert told.startswith("room/chair stands too close to room/television, sitting down on it takes ")
    lacks = float(told.split(" takes ")[1].split(" cm")[0])
    assert 1.0 <= lacks <= 8.0
    assert told.endswith("move one of them first")
    chair, thing = before(TELEVISION, 20.0, 0.26 + 0.01 * lacks, SCREEN)
    assert deepest("ken", down_and_up("ken", chair, 20.0, thing), thing) < 0.002


def test_knees_go_under_a_table_and_the_trunk_leans_over_it_as_ever() -> None:
    chair, thing = before(TABLE, 0.0, 0.35, EDGE)
    free = down_and_up("aiko", chair, 0.0, before(TABLE, 0.0, 3.0, EDGE)[1])
    close = down_and_up("aiko", chair, 0.0, thing)
    assert len(free) < len(close) <= len(free) + 2  # a moment's thought
    spine = np.array([[pose.rotations[:2] for pose in shown[-len(free) :]] for shown in (free, close)])
    assert np.abs(spine[1] - spine[0]).max() < 1e-9


def test_a_head_is_not_in_a_wall() -> None:
    """It was 19 cm in it."""
    chair = Transform(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
    kept = WORKSPACE.objects.kept_shape("wall_1")
    assert kept is not None
    plane = FRONT + 0.4
    wall = outlined(record("room/wall_1", Transform(np.array([plane, 0.0, 0.0]), chair.rotation)), 11)
    shown = down_and_up("ken", chair, 0.0, msgspec.structs.replace(wall, shape=ShapeRecord(str(kept[0]), kept[1])))
    vertices = np.arange(len(skin("ken").vertices))
    assert max(skin("ken").posed(one.rotations, one.root, vertices)[:, 0].max() for one in shown[::3]) < plane + 0.002
