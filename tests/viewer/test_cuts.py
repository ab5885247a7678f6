"""Shots: from each part of a recording the side is taken on which it is to be seen, and the camera cuts between."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from ahmss_viewer.camera import project
from ahmss_viewer.cuts import Shot, shots
from ahmss_viewer.figure import plain_figure
from ahmss_viewer.framing import Interest, interest, work
from ahmss_viewer.glb import read_glb
from ahmss_viewer.looking import Looking
from ahmss_viewer.options import ViewOptions
from ahmss_viewer.painter import Painter
from ahmss_viewer.stage import Stage

from ahmss.body.links import INDEX
from ahmss.errors import CommandError

from .scenes import RED, SKELETON, UNTURNED, WHITE, box_glb, raised

ASPECT = 16 / 9
SIZE = (1600, 900)
TICKS, RATE = 360, 60.0
HIDDEN, FREE = np.array([0.9, 0.0, 1.0]), np.array([-0.9, 0.0, 1.0])  # a wall before the human, who faces +x; behind
LEFT, UP = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])
PALM = INDEX["right_hand"]


@pytest.fixture
def stage() -> Stage:
    """A human with the right arm held out, and a wall."""
    made = Stage()
    made.add_human(1, "ken", SKELETON.offsets, plain_figure(SKELETON))
    made.pose_human(1, *raised(1.0))
    made.add_object(2, "wall", read_glb(box_glb((0.1, 5.0, 2.6), WHITE)), HIDDEN, UNTURNED)
    return made


def filmed(stage: Stage, painter: Painter, step: float = 0.0) -> list[Shot]:
    """The shots of three seconds with the wall before the human, and three with it behind; who goes on to the left."""

    def show(tick: int) -> Interest | None:
        stage.move_object(2, HIDDEN if tick < TICKS // 2 else FREE, UNTURNED)
        rotations, root = raised(1.0)
        stage.pose_human(1, rotations, root + step * tick * LEFT)
        return interest(stage)

    look = Looking(stage, painter, ASPECT)
    try:
        found = shots(look, show, TICKS, RATE, ASPECT)
        for tick in range(0, TICKS, 10):
            wanted = show(tick)
            assert wanted is not None
            (shot,) = (shot for shot in found if shot.first <= tick < shot.end)
            hidden, _ = look.look(shot.view(tick), wanted)
            assert not hidden[PALM], tick
    finally:
        look.close()
    return found


def test_a_wall_is_looked_past_and_the_camera_cuts_where_it_goes(stage: Stage, painter: Painter) -> None:
    found = filmed(stage, painter)
    assert (found[0].first, found[-1].end) == (0, TICKS)
    assert all(a.end == b.first for a, b in pairwise(found))
    assert len(found) <= 3
    first, last = (shot.view(shot.first).pose()[:3, 3] for shot in (found[0], found[-1]))
    assert first[0] < HIDDEN[0]
    assert last[0] > FREE[0]


def test_the_camera_goes_along_without_a_jerk_and_keeps_all_in_the_picture(stage: Stage, painter: Painter) -> None:
    for shot in filmed(stage, painter, step=0.02):
        places = np.array([shot.view(tick).pose()[:3, 3] for tick in range(shot.first, shot.end)])
        assert np.linalg.norm(np.diff(places, axis=0), axis=1).max() < 0.06
        for tick in range(shot.first, shot.end, 20):
            rotations, root = raised(1.0)
            stage.pose_human(1, rotations, root + 0.02 * tick * LEFT)
            wanted = interest(stage)
            assert wanted is not None
            seen = project(wanted.points, shot.view(tick), SIZE)[:, :2] / SIZE
            assert ((seen > 0.0) & (seen < 1.0)).all(), tick


def test_the_hand_at_a_thing_counts_most(stage: Stage) -> None:
    palm = stage.actors[1].places[PALM]
    stage.add_object(3, "button", read_glb(box_glb((0.05, 0.05, 0.05), RED)), palm, UNTURNED)
    weights = []
    for place in (palm, palm + 3.0 * UP):
        stage.move_object(3, place, UNTURNED)
        stage.move_object(2, np.array([9.0, 9.0, 1.0]), UNTURNED)
        wanted = work(stage, touched=(3,))
        assert wanted is not None
        weights.append(wanted.weights)
        far = np.linalg.norm(wanted.points - place, axis=1).min() > 1.0
        assert far == (place is not palm), "what is far from hands is not in the picture"
    assert weights[0][PALM] == 6.0 * weights[1][PALM]
    assert weights[0][INDEX["left_hand"]] == weights[1][INDEX["left_hand"]]


@pytest.mark.parametrize(
    ("options", "error"),
    [
        ({"record": Path("a.mp4")}, "of recordings only"),
        ({"replay": Path("a.rec")}, "of recordings only"),
        (
            {"replay": Path("a.rec"), "sheet": Path("a.png"), "eyes": "ken"},
            "leave out --position, --look-at and --eyes",
        ),
    ],
)
def test_where_the_camera_cannot_cut_is_said(options: dict[str, Path], error: str) -> None:
    with pytest.raises(CommandError, match=error):
        ViewOptions(camera="cuts", **options)  # type: ignore[arg-type]
