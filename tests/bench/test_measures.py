"""What is wrong with a made-up motion shows in its own measure, and in no other's."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ahmss.bench.capture import IN_PLACE, STANDING, WALKING
from ahmss.bench.depth import in_things
from ahmss.bench.hands import off_target, slips
from ahmss.bench.measures import BOUNDS, UNITS
from ahmss.bench.solids import Solids
from ahmss.bench.survey import Span
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_rotation_vector, multiply, rotate
from ahmss.database.workspace import Workspace

from .made import (
    FRAMES,
    RATE,
    ROOT,
    WALK,
    along_x,
    holding,
    measured,
    moved,
    palms,
    placed,
    standing,
    stepping,
    wanting,
)


def test_who_stands_is_as_good_as_real() -> None:
    found = measured(standing())
    assert found.worse == []
    assert found.bar is IN_PLACE
    assert list(found.figures) == list(UNITS)
    assert max(found.figures.values()) < 1e-3


def test_every_measure_has_a_bound() -> None:
    found = measured(standing())
    for bar in (WALKING, IN_PLACE, STANDING):
        for name in UNITS:
            assert replace(found, bar=bar).bound(name) > 0.0
    assert found.bound("hand") == BOUNDS["hand"]


def test_whom_steps_carry_on_is_compared_with_walking_whatever_they_do() -> None:
    onward = stepping(standing(), 0.3)
    assert measured(onward).bar is WALKING
    assert measured(onward, Span(0, 45)).bar is IN_PLACE  # before the step
    assert measured(onward, Span(45, FRAMES)).bar is WALKING


def test_who_makes_no_step_is_not_compared_with_walking() -> None:
    still = standing(doing=WALK)  # as a switch is pressed: by an action that would have walked there
    assert measured(still).bar is IN_PLACE
    assert measured(moved(still, along_x(still, 0.2))).bar is IN_PLACE  # hips that go back onto a seat
    assert measured(stepping(still, 0.0)).bar is IN_PLACE  # a foot lifted, and put down where it stood


def test_a_sliding_foot_is_seen() -> None:
    still = standing()
    found = measured(moved(still, along_x(still, 0.1)))
    assert found.figures["slide"] == pytest.approx(100.0 * 0.1 * FRAMES / RATE, rel=0.02)
    assert found.figures["drift"] == pytest.approx(1000.0 * 0.1 * (FRAMES - 1) / RATE, rel=0.02)
    assert found.figures["speed_p95"] == pytest.approx(0.1, rel=0.01)
    assert found.worse == ["slide", "drift", "speed_p95"]


def test_only_what_slides_in_the_frames_counts() -> None:
    still = standing()
    way = along_x(still, 0.1)
    way[60:] = way[60]
    glided = moved(still, way)
    assert measured(glided, Span(0, 60)).worse == ["slide", "drift", "speed_p95"]
    assert measured(glided, Span(70, FRAMES)).worse == []


def test_a_foot_that_is_lifted_does_not_slide_on_the_floor() -> None:
    still = standing()
    lifted = moved(still, along_x(still, 0.1) + np.array([0.0, 0.0, 0.1]))
    assert measured(lifted).figures["drift"] == 0.0
    assert measured(moved(still, np.array([0.0, 0.0, -0.02]))).figures["floor"] == pytest.approx(20.0, abs=0.1)


def test_a_jump_is_seen_where_it_is() -> None:
    still = standing()
    rotations = still.rotations.copy()
    elbow = INDEX["left_lower_arm"]
    rotations[60:, elbow] = multiply(rotations[60:, elbow], from_rotation_vector(np.radians([0.0, 40.0, 0.0])))
    jumped = replace(still, rotations=rotations)
    found = measured(jumped)
    assert found.figures["pop"] == pytest.approx(40.0, abs=0.1)
    assert found.where["pop"] == found.where["acceleration"] == "left_lower_arm"
    assert found.worse == ["acceleration", "jerk", "pop"]
    around = [measured(jumped, Span(k, k + 1)).figures["pop"] for k in (59, 60, 61)]
    assert around == pytest.approx([20.0, 40.0, 20.0], abs=0.1)  # the step leads to frame 60
    assert measured(jumped, Span(0, 30)).worse == []
    assert measured(jumped, Span(90, FRAMES)).worse == []
    # an item that ends at the jump sees it too: nothing is left out at the ends of a part
    assert "acceleration" in measured(jumped, Span(30, 61)).worse


def test_hips_that_jump_are_seen() -> None:
    still = standing()
    way = np.zeros((FRAMES, 3))
    way[60:, 2] = 0.02
    assert measured(moved(still, way)).figures["hips"] == pytest.approx(0.02 * RATE**2)


def test_a_hand_that_misses_is_seen() -> None:
    still = standing()
    assert off_target(wanting(still, np.array([0.0, 0.0, 0.0]))).max() == 0.0
    missed = off_target(wanting(still, np.array([0.0, 0.003, 0.004])))
    assert missed[-1] == pytest.approx(0.005)
    assert missed[:60].max() == 0.0  # while another motion has just taken the hand it is on its way
    assert measured(wanting(still, np.array([0.0, 0.003, 0.004]))).worse == ["hand"]


def test_a_hand_on_its_way_need_only_arrive() -> None:
    still = standing()
    left = np.linspace(0.3, 0.0, FRAMES)[:, None] * np.array([1.0, 0.0, 0.0])
    assert off_target(wanting(still, left)).max() == 0.0
    assert off_target(wanting(still, left + np.array([0.002, 0.0, 0.0])))[-1] == pytest.approx(0.002)


def test_what_slips_in_the_hand_is_seen() -> None:
    gliding = moved(standing(), along_x(standing(), 0.2))
    slip = np.zeros((FRAMES, 3))
    slip[60:, 2] = -0.008
    assert slips(holding(gliding, np.zeros((FRAMES, 3)))).max() < 1e-9
    found = slips(holding(gliding, slip))
    assert found[50] < 1e-9
    assert found[-1] == pytest.approx(0.008)


def test_what_goes_along_with_a_hand_that_turns_does_not_slip() -> None:
    still = standing()
    rotations = still.rotations.copy()
    turns = np.linspace(0.0, 1.0, FRAMES)[:, None] * np.array([0.3, 0.0, 1.2])
    rotations[:, 0] = multiply(from_rotation_vector(turns), rotations[:, 0])
    turning = replace(still, rotations=rotations)
    palm = palms(turning)[:, 0]
    beside = rotate(palm[:, 3:], np.array([0.05, 0.02, 0.1]))
    assert np.ptp(beside, axis=0).max() > 0.05
    assert slips(holding(turning, beside)).max() < 1e-9
    assert slips(holding(turning, np.tile(beside[:1], (FRAMES, 1)))).max() > 0.05


def test_what_is_in_no_hand_may_go_where_it_likes() -> None:
    still = standing()
    way = along_x(still, 0.2)
    assert slips(holding(still, way, hand="")).max() == 0.0
    assert slips(holding(still, way))[-1] == pytest.approx(0.2 * (FRAMES - 2) / RATE, rel=0.01)


def test_what_stands_still_in_an_open_hand_is_not_in_it_yet() -> None:
    gliding = moved(standing(), along_x(standing(), 0.2))
    held = holding(gliding, np.zeros((FRAMES, 3)))
    poses = held.things["cup"].poses.copy()
    poses[:60] = poses[60]
    taken = replace(held, things={"cup": replace(held.things["cup"], poses=poses)})
    assert slips(taken).max() < 1e-9


def test_a_thing_of_others_is_nobodys_slip() -> None:
    held = holding(standing(), along_x(standing(), 0.2))
    cup = held.things["cup"]
    others = replace(cup, holders=("aiko",) * FRAMES)
    assert slips(replace(held, things={"cup": others})).max() == 0.0


def test_a_hand_in_a_table_is_seen() -> None:
    still = standing(6)
    workspace = Workspace.find(ROOT)
    palm = palms(still)[0, 0, :3]
    beside = in_things(placed(still, "table", (5.0, 0.0, 0.0)), workspace)
    assert beside.deepest.max() == 0.0
    inside = in_things(placed(still, "table", (float(palm[0]), float(palm[1]), float(palm[2]) - 0.87)), workspace)
    assert 0.005 < inside.deepest.max() < 0.03
    assert inside.thing[0] == "table"
    assert "right_" in inside.link[0]
    assert inside.deepest[0] == inside.deepest[5]


def test_a_hand_between_the_walls_of_a_cup_is_in_it_while_nobody_has_it() -> None:
    still = standing(6)
    workspace = Workspace.find(ROOT)
    palm = palms(still)[0, 0, :3]
    around = placed(still, "cup", (float(palm[0]), float(palm[1]), float(palm[2]) - 0.05))
    taken = replace(around.things["cup"], holders=("ken",) * 6)
    free, held = in_things(around, workspace), in_things(replace(around, things={"cup": taken}), workspace)
    assert free.thing[0] == "cup"
    assert 0.01 < free.deepest.max() < 0.04
    assert held.deepest.max() < 0.005  # no deeper than its bottom is thick


def test_a_thing_that_hands_may_be_in_is_not_filled() -> None:
    solids, still = Solids(Workspace.find(ROOT)), np.array([1.0, 2.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    middle = np.array([[1.0, 2.0, 0.05], [1.0, 2.03, 0.05], [1.0, 2.04, 0.05]])
    assert solids.filled("cup", still, middle) == pytest.approx([0.036, 0.006, 0.0], abs=1e-3)
    assert solids.filled("chair", still, middle + np.array([0.0, 0.0, 0.3])).max() == 0.0


def test_a_part_is_met_where_its_states_have_it() -> None:
    solids, still = Solids(Workspace.find(ROOT)), np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    lever = np.array([0.07, 0.0, 0.243])  # in the tap's lever while it is shut
    about = from_rotation_vector(np.array([0.0, 0.0, 0.87]))
    points = np.stack([lever, rotate(about, lever)])
    shut = solids.depth("tap", still, {"turn": 0.0, "flow": "shut"}, points)
    running = solids.depth("tap", still, {"turn": 0.87, "flow": "running"}, points)
    assert shut[0] > 0.003
    assert shut[1] == 0.0
    assert running == pytest.approx(shut[::-1], abs=2e-4)


def test_a_wall_has_no_inside() -> None:
    solids = Solids(Workspace.find(ROOT))
    assert solids.parts("wall_1") == solids.parts("floor") == []
    assert {solid.part for solid in solids.parts("tap")} == {"", "lever"}


def test_what_is_thin_is_met_as_exactly_as_what_is_large() -> None:
    """A door's lever is 19 mm thick, its leaf 2 m high: on a grid over both a hand 3 mm in the lever was 1 mm in it."""
    solids, still = Solids(Workspace.find(ROOT)), np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0])
    over = np.array([0.0095, 0.0085, 0.0065, 0.0035, 0.0])  # metres over the lever's axis
    points = np.array([0.66, -0.075, 1.02]) + over[:, None] * np.array([0.0, 0.0, 1.0])
    assert solids.depth("door", still, {}, points) == pytest.approx(0.0095 - over, abs=1e-4)
