"""The view that is chosen: everything in it, nothing in the way, and it follows."""

from __future__ import annotations

import numpy as np
import pytest
from ahmss_viewer.aim import Aim, Arrivals
from ahmss_viewer.camera import View, look_at, project
from ahmss_viewer.choosing import best_view, clear_preset, preset, without_hidden
from ahmss_viewer.figure import plain_figure
from ahmss_viewer.framing import Follower, fit, interest
from ahmss_viewer.glb import read_glb
from ahmss_viewer.options import ViewOptions
from ahmss_viewer.painter import Painter
from ahmss_viewer.stage import Stage

from .scenes import SKELETON, UNTURNED, WHITE, box_glb, raised

ASPECT = 16 / 9
SIZE = (1600, 900)


@pytest.fixture
def stage() -> Stage:
    made = Stage()
    made.add_human(1, "ken", SKELETON.offsets, plain_figure(SKELETON))
    made.pose_human(1, *raised(0.5))
    return made


def test_all_points_fit_into_the_picture_and_fill_it() -> None:
    points = np.random.default_rng(1).uniform(-1.0, 2.0, (60, 3))
    for azimuth in (0.0, 1.1, 3.0):
        view = fit(View(azimuth=azimuth, elevation=0.4), points, ASPECT)
        seen = project(points, view, SIZE)
        share = seen[:, :2] / SIZE
        assert (seen[:, 2] > 0).all()
        assert share.min() > 0.05
        assert share.max() < 0.95
        assert np.ptp(share, axis=0).max() > 0.7


def test_a_projected_place_lies_right_when_it_is_right_and_up_when_it_is_up() -> None:
    view = look_at(np.array([-3.0, 0.0, 1.0]), np.array([0.0, 0.0, 1.0]))  # looks along +x: right is -y
    right, up = project(np.array([[0.0, -0.5, 1.0], [0.0, 0.0, 1.5]]), view, SIZE)
    assert right[0] > 810
    assert right[1] == pytest.approx(450)
    assert up[1] < 440
    assert up[0] == pytest.approx(800)
    assert right[2] == pytest.approx(3.0)


def test_the_front_of_the_human_is_seen_and_a_wall_before_it_avoided(stage: Stage, painter: Painter) -> None:
    wanted = interest(stage)
    assert wanted is not None
    free = best_view(stage, painter, wanted, ASPECT)
    place = free.pose()[:3, 3]
    assert place[0] > 0, "the human faces +x"
    side = np.sign(place[1])
    wall = read_glb(box_glb((3.0, 0.1, 4.0), WHITE))
    stage.add_object(5, "wall", wall, np.array([1.2, side * 0.8, 1.0]), UNTURNED)
    again = best_view(stage, painter, wanted, ASPECT).pose()[:3, 3]
    assert np.sign(again[1]) == -side


def test_who_stands_in_a_recess_is_seen_from_behind(stage: Stage, painter: Painter) -> None:
    wanted = interest(stage)
    assert wanted is not None
    for number, size, place in (
        (5, (0.1, 2.6, 4.0), (1.2, 0.0)),
        (6, (3.0, 0.1, 4.0), (-0.2, 1.2)),
        (7, (3.0, 0.1, 4.0), (-0.2, -1.2)),
    ):
        stage.add_object(number, "wall", read_glb(box_glb(size, WHITE)), np.array([*place, 1.0]), UNTURNED)
    place = best_view(stage, painter, wanted, ASPECT).pose()[:3, 3]
    assert place[0] < -1.5
    assert abs(place[1]) < -0.6 * place[0]


@pytest.mark.parametrize(("name", "way"), [("front", (1, 0)), ("back", (-1, 0)), ("left", (0, 1)), ("right", (0, -1))])
def test_presets_stand_where_they_say(stage: Stage, name: str, way: tuple[int, int]) -> None:
    wanted = interest(stage)
    assert wanted is not None
    place = preset(name, wanted, ASPECT).pose()[:3, 3]
    assert place[:2] @ np.array(way) > 1.5


@pytest.mark.parametrize(("name", "place"), [("right", (0.0, -0.8)), ("close", (0.6, -0.5))])
def test_a_preset_looks_past_what_hides_the_human(
    stage: Stage, painter: Painter, name: str, place: tuple[float, float]
) -> None:
    wanted = interest(stage)
    assert wanted is not None
    plain = preset(name, wanted, ASPECT)
    free = clear_preset(name, stage, painter, wanted, ASPECT, None)
    assert abs(free.azimuth - plain.azimuth) < np.radians(13.0), "with nothing in the way it hardly turns"
    post = read_glb(box_glb((0.5, 0.5, 4.0), WHITE))
    stage.add_object(5, "post", post, np.array([*place, 1.0]), UNTURNED)
    again = clear_preset(name, stage, painter, wanted, ASPECT, None)
    seen, seen_plain = (len(without_hidden(stage, painter, wanted, view, ASPECT, [wanted])) for view in (again, plain))
    assert seen > seen_plain


def test_following_keeps_the_human_in_the_middle(stage: Stage) -> None:
    view, follower = View(target=np.array([0.0, 0.0, 0.9]), distance=4.0), Follower("ken")
    rotations, root = raised(0.0)
    for step in range(240):
        stage.pose_human(1, rotations, root + np.array([0.0, min(step, 180) / 60.0, 0.0]))
        view = follower.step(view, stage, ASPECT, 1 / 60)
    assert view.target[1] == pytest.approx(3.0, abs=0.4)
    assert view.azimuth == View().azimuth


def test_without_a_name_the_view_rests_until_somebody_leaves_it(stage: Stage) -> None:
    wanted = interest(stage)
    assert wanted is not None
    view, follower = fit(View(), wanted.points, ASPECT), Follower()
    assert follower.step(view, stage, ASPECT, 0.1) is view
    rotations, root = raised(0.0)
    stage.pose_human(1, rotations, root + np.array([0.0, 4.0, 0.0]))
    for _ in range(200):
        view = follower.step(view, stage, ASPECT, 1 / 30)
    now = interest(stage)
    assert now is not None
    share = project(now.points, view, SIZE)[:, :2] / SIZE
    assert share.min() > 0.0
    assert share.max() < 1.0


def test_what_a_table_hides_need_not_fit_into_a_tile_but_heads_and_hands_must(stage: Stage, painter: Painter) -> None:
    wanted = interest(stage)
    assert wanted is not None
    view = fit(View(azimuth=0.0, elevation=0.1), wanted.points, ASPECT)
    assert without_hidden(stage, painter, wanted, view, ASPECT, [wanted])[:, 2].min() < 0.2
    counter = read_glb(box_glb((0.1, 4.0, 0.8), WHITE))
    stage.add_object(5, "counter", counter, np.array([0.9, 0.0, 0.4]), UNTURNED)
    points = without_hidden(stage, painter, wanted, view, ASPECT, [wanted])
    assert points[:, 2].min() > 0.5
    assert points[:, 2].max() == wanted.points[:, 2].max()


def test_the_view_is_chosen_again_while_the_scene_comes_but_not_during_a_motion(stage: Stage) -> None:
    arrivals = Arrivals()
    box = read_glb(box_glb((0.5, 0.5, 0.5), WHITE))

    def comes(number: int) -> None:
        stage.add_object(number, f"box {number}", box, np.array([1.2, 0.0, 1.0]), UNTURNED)

    assert arrivals.due(stage), "the first picture"
    assert not arrivals.due(stage), "nothing has come"
    comes(5)
    assert arrivals.due(stage)
    comes(6)
    stage.pose_human(1, *raised(0.6))
    assert arrivals.due(stage), "with the room the first motion has begun already"
    comes(7)
    stage.pose_human(1, *raised(0.7))
    assert not arrivals.due(stage), "no jump during a motion"
    assert arrivals.due(stage), "but when it rests"
    stage.remove_object(7)
    assert not arrivals.due(stage)
    comes(7)
    assert not arrivals.due(stage), "a recording that begins again"
    stage.add_human(2, "aiko", SKELETON.offsets, plain_figure(SKELETON))
    stage.pose_human(1, *raised(0.8))
    assert arrivals.due(stage), "somebody new is always looked for"


def test_a_window_that_was_open_before_the_scene_does_not_stay_behind_a_wall(stage: Stage, painter: Painter) -> None:
    aim, arrivals = Aim(ViewOptions()), Arrivals()
    assert arrivals.due(stage)
    alone = aim.begin(stage, painter)
    place = alone.pose()[:3, 3]
    wall = read_glb(box_glb((0.1, 1.6, 4.0), WHITE))
    turn = np.arctan2(place[1], place[0]) / 2
    stage.add_object(5, "wall", wall, 0.5 * place, np.array([np.cos(turn), 0.0, 0.0, np.sin(turn)]))
    wanted = interest(stage)
    assert wanted is not None
    assert arrivals.due(stage)
    again = aim.begin(stage, painter)
    seen, before = (len(without_hidden(stage, painter, wanted, view, ASPECT, [wanted])) for view in (again, alone))
    assert seen > before + 10
