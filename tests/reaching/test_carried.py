"""A hand of who is carried to a place: there with the last frame, whatever becomes of the pose that was given."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.inverse import grips, solve
from ahmss.body.links import INDEX
from ahmss.body.skeleton import Skeleton
from ahmss.motion.smoothness import angular_steps, pops
from ahmss.reaching.carried import Carried
from ahmss.reaching.goal import Goal
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import hand_skin

HUMAN = Skeleton.of(1.7)
ROTATIONS, ROOT = HUMAN.relaxed()
SPINE = INDEX["spine"]
FRAMES = 90
ON = np.array([0.006, 0.0, 0.0])  # metres a frame
ROW = {"right": 0, "left": 1}
# Hands are mirror images: the other one is seen to in the long tests.
SIDES = ["right", pytest.param("left", marks=pytest.mark.long)]
MIRRORED = ["left", pytest.param("right", marks=pytest.mark.long)]


@cache
def carried(side: str, *, in_place: bool = False, sways: float = 0.0, aside: float = 0.2) -> tuple[Array, Array, Array]:
    """Poses (F, 43, 4) of who is carried straight on and reaches, the palms (F, 7) gone for, and how far off it is.

    in_place: every pose given is the same array, changed. sways: metres that the way goes to and fro. aside: metres
    from the middle to the place.
    """
    place = ROOT + np.array([ON[0] * FRAMES + 0.4, aside if side == "left" else -aside, 0.05])
    given, root = ROTATIONS.copy(), ROOT.copy()
    hand = Carried(HUMAN, Goal(place, around=np.array([0, 0, 0, 1.0, 0, 0, 0])), given, root, [side])
    made: list[Array] = []
    palms: list[Array] = []
    for k in range(FRAMES):
        root = ROOT + (k + 1) * ON + np.array([0.0, sways * np.sin(0.35 * k), 0.0])
        pose, target, _ = hand.step(given, root, (k + 1) / FRAMES, (FRAMES - k - 1) * ON, settles=False)
        made.append(pose)
        palms.append(hand.palm)
        assert target[7] == 1.0
        if in_place:
            given[:] = pose
        else:
            given = pose.copy()
    return np.array(made), np.array(palms), grips(HUMAN, made[-1], root)[ROW[side], :3] - hand.palm[:3]


@pytest.mark.parametrize("side", SIDES)
def test_it_is_there_with_the_last_frame_and_no_joint_jerks(side: str) -> None:
    made, _, off = carried(side)
    assert np.linalg.norm(off) < 0.002
    assert 0.1 < pops(made).max() < 1.3


@pytest.mark.parametrize("side", SIDES)
def test_a_pose_that_changes_in_place_changes_nothing(side: str) -> None:
    made, _, _ = carried(side, in_place=True)
    assert np.array_equal(made, carried(side)[0])
    assert np.linalg.norm(made[-1, SPINE] - ROTATIONS[SPINE]) > 0.02  # the waist has bent: what it began at matters


@pytest.mark.parametrize("side", MIRRORED)
def test_of_two_palms_as_easy_the_body_that_sways_does_not_take_now_this_now_that(side: str) -> None:
    _, palms, off = carried(side, sways=0.03, aside=0.1)
    heading = np.unwrap(2.0 * np.arctan2(palms[:, 6], palms[:, 3]))
    turns = np.sign(np.diff(heading)[np.abs(np.diff(heading)) > 1e-6])
    assert len(np.flatnonzero(np.diff(turns))) == 0
    assert np.linalg.norm(off) < 0.005


@pytest.mark.parametrize("side", MIRRORED)
def test_a_hand_rises_over_what_it_would_be_in_and_is_there_in_the_end(side: str) -> None:
    """A table under the place, whose top is higher than the way of the hand was half-way."""
    place = ROOT + np.array([ON[0] * FRAMES + 0.4, 0.2 if side == "left" else -0.2, 0.05])
    goal, y = Goal(place, around=np.array([0, 0, 0, 1.0, 0, 0, 0])), float(place[1])
    ring = np.array([[0.55, y - 0.5], [2.0, y - 0.5], [2.0, y + 0.5], [0.55, y + 0.5]])
    table = Prism(ring, 0.0, float(place[2]) - 0.08)
    ways: list[Array] = []
    for near in ([], [table]):
        hand, given, way = Carried(HUMAN, goal, ROTATIONS, ROOT, [side]), ROTATIONS.copy(), list[Array]()
        for k in range(FRAMES):
            root = ROOT + (k + 1) * ON
            given, target, _ = hand.step(given, root, (k + 1) / FRAMES, (FRAMES - k - 1) * ON, near)
            way.append(target[:3])
        ways.append(np.array(way))
        assert np.linalg.norm(way[-1] - hand.palm[:3]) < 2e-3
    risen = (ways[1] - ways[0])[:, 2]
    assert risen.min() > -1e-3
    assert risen.max() > 0.01
    assert risen[0] < 1e-3
    assert np.abs(np.diff(risen, n=2)).max() < 0.0101  # softly


@pytest.mark.parametrize("side", SIDES)
@pytest.mark.parametrize("on", [0.004, 0.006])
def test_a_hand_that_hangs_far_before_a_table_is_over_its_top_before_it_comes_to_its_edge(side: str, on: float) -> None:
    """The place is half a metre behind the edge: raised as usual the hand would pass through the top."""
    step, reacher = np.array([on, 0.0, 0.0]), Reacher.of(HUMAN, side)
    place = ROOT + np.array([on * FRAMES + 0.5, 0.2 if side == "left" else -0.2, 0.05])
    near, far, y = float(place[0]) - 0.5, 3.0, float(place[1])
    ring = np.array([[near, y - 0.5], [far, y - 0.5], [far, y + 0.5], [near, y + 0.5]])
    table = Prism(ring, 0.0, float(place[2]) - 0.05)
    hand = Carried(HUMAN, Goal(place, around=np.array([0, 0, 0, 1.0, 0, 0, 0])), ROTATIONS, ROOT, [side])
    given, targets = ROTATIONS.copy(), np.zeros((5, 8))
    gaps: list[float] = []
    for k in range(FRAMES):
        root = ROOT + (k + 1) * step
        given, targets[ROW[side]], _ = hand.step(given, root, (k + 1) / FRAMES, (FRAMES - k - 1) * step, [table])
        points, radii = hand_skin(reacher, solve(HUMAN, given, root, targets), root)
        gaps.append(float((clearance([table], points) - radii).min()))
    assert min(gaps) > 0.003, int(np.argmin(gaps))
    assert gaps[-1] < 0.02


@pytest.mark.parametrize("side", SIDES)
def test_the_arm_of_who_comes_on_fast_is_bent_before_it_has_to_bend_at_once(side: str) -> None:
    """A body that comes on by 18 mm a frame: stretched out to the last, the arm is bent late and the hand 71 mm off."""
    step, frames, reacher = np.array([0.018, 0.0, 0.0]), 60, Reacher.of(HUMAN, side)
    place = ROOT + frames * step + np.array([0.4, 0.2 if side == "left" else -0.2, 0.15])
    hand = Carried(HUMAN, Goal(place, around=np.array([0, 0, 0, 1.0, 0, 0, 0])), ROTATIONS, ROOT, [side])
    given, targets, made = ROTATIONS.copy(), np.zeros((5, 8)), list[Array]()
    for k in range(frames):
        root = ROOT + (k + 1) * step
        given, targets[ROW[side]], _ = hand.step(given, root, (k + 1) / frames, (frames - k - 1) * step)
        made.append(solve(HUMAN, given, root, targets)[reacher.links])
    turned = np.degrees(np.linalg.norm(angular_steps(np.array(made)), axis=-1))
    assert 2.0 < turned[frames // 2 :].max() < 5.2
    assert hand.short < 0.015
