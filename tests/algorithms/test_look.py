"""look: the gaze on a thing wherever it is; who has it behind their back turns around on the spot first."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.algorithm import HumanTask
from ahmss.algorithm.messages import Start
from ahmss.body.inverse import GAZE
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.database import Workspace
from ahmss.errors import AlgorithmError

from .scene import ROOT, TELEVISION, Body, frame_of, program

SCREEN = frame_of(TELEVISION).apply(np.array([0.1, 0.0, 0.82]))
BEARING = float(np.degrees(np.arctan2(SCREEN[1], SCREEN[0])))
HELPED = 30.0  # degrees that the eyes may have to turn in the head


def off(body: Body) -> float:
    """Degrees, level, between where the face is turned and the screen."""
    places, turned = forward(body.rotations, body.root, body.skeleton.offsets)
    head = INDEX["head"]
    ahead, way = rotate(turned[head], np.array([0.0, 0.0, -1.0]))[:2], SCREEN[:2] - places[head, :2]
    return float(np.degrees(np.arccos(ahead @ way / np.linalg.norm(ahead) / np.linalg.norm(way))))


def test_the_gaze_is_on_the_screen_from_the_first_frame() -> None:
    body = Body()
    shown = body.do("look", body.start(TELEVISION, "look"))
    assert len(shown) == 60
    np.testing.assert_allclose([pose.targets[GAZE, :3] for pose in shown], np.tile(SCREEN, (60, 1)), atol=1e-6)
    assert {pose.targets[GAZE, 7] for pose in shown} == {1.0}
    assert shown[0].importance[INDEX["head"]] == 1.0
    assert shown[0].importance[INDEX["right_hand"]] == 0.0


@pytest.mark.parametrize("aside", [40.0, 110.0, -155.0, 180.0])
def test_it_is_seen_in_the_end_wherever_it_was(aside: float) -> None:
    body = Body(facing=BEARING - aside)
    body.do("look", body.start(TELEVISION, "look", wish=True))
    assert off(body) < HELPED
    assert np.linalg.norm(body.root[:2]) < 0.1  # on the spot


def told(start: Start) -> tuple[int, list[str]]:
    """How many frames a look has, and what it says."""
    task = HumanTask(start)
    return sum(len(rows) for rows in program("look")(task)), task.notes


def test_who_is_carried_or_reaches_does_not_turn_around_and_is_told_that_it_is_not_seen() -> None:
    body = Body(facing=BEARING - 155.0)
    for given in ({"carried": True}, {"led": ["right"]}):
        count, notes = told(body.start(TELEVISION, "look", **given))
        assert count == 60
        assert [note.split(":")[0] for note in notes] == ["room/television is 155 degrees aside, behind the back"]


def test_nobody_begins_to_turn_around_in_fewer_frames_than_that_takes() -> None:
    body = Body(facing=BEARING - 155.0)
    with pytest.raises(AlgorithmError, match=r"behind the back, and 60 frames are too few .*; leave `frames` out"):
        told(body.start(TELEVISION, "look"))
    assert told(body.start(TELEVISION, "look", frames=240))[0] >= 240


def test_whatever_is_looked_at_is_turned_to_where_it_is_behind() -> None:
    objects = Workspace(ROOT).objects
    looks = {name: objects.get(name).affordances.get("look") for name in objects.names() if name != "human"}
    by = {name: look.human_algorithm for name, look in looks.items() if look is not None}
    assert len(by) > 8
    assert set(by.values()) == {"look"}
    assert all(look.motion is not None for look in looks.values() if look is not None)  # a walk library to turn by
