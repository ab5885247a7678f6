"""pressed and turned: what a fingertip and a hand do to a button and to a lever."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import pytest

from ahmss.algorithm import ObjectPose, Transform, frames
from ahmss.algorithm.messages import PoseRecord, Start
from ahmss.body.array import Array
from ahmss.body.fingertip import pad
from ahmss.body.inverse import grips
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import from_axis_angle, multiply, rotate

from .scene import Body, frame_of, program, record

SWITCH, TAP = "room/television/switch", "room/sink/tap"
TRAVEL = 0.004


class Hand:
    """A human that is carried about, so that a point of its right hand is where it is wanted."""

    def __init__(self, *, closed: float = 0.0) -> None:
        self.body = Body()
        self.rotations = self.body.rotations.copy()
        for link in list(fingers("right"))[2:]:
            bend = from_axis_angle(np.array([0.0, 1.0, 0.0]), np.array(np.radians(closed)))
            self.rotations[link] = multiply(self.rotations[link], bend)

    def pad(self, into: Array) -> Array:
        """What of the index finger touches that pushes along (3,)."""
        places, world = forward(self.rotations, self.body.root, self.body.skeleton.offsets)
        link = INDEX["right_index_distal"]
        tip = Transform(places[link], world[link]).apply(self.body.skeleton.tips[link])
        return pad(tip, rotate(world[link], np.array([1.0, 0.0, 0.0])), float(self.body.skeleton.radii[link]), into)

    def rows(self, point: Array, places: Iterable[Array]) -> list[Array]:
        """FRAMEs in which that point of the hand is at these places of the world."""
        made = []
        for k, place in enumerate(places, 1):
            root = self.body.root + place - point
            palms = grips(self.body.skeleton, self.rotations, root).reshape(14)
            made.append(np.concatenate([[k], root, self.rotations.reshape(172), palms]))
        return made

    def start(self, name: str, site: str, **given: Any) -> Start:
        states = given.pop("states", None)
        return Start(
            kind="object", human=self.body.skeleton.to_record(), pose=PoseRecord.of(self.rotations, self.body.root),
            frames=600, object=record(name, None, states), site=site, hand="right", **given,
        )  # fmt: skip


def told(poses: Iterable[ObjectPose], first: dict[str, Any]) -> list[dict[str, Any]]:
    """The states after each frame."""
    now, out = dict(first), []
    for pose in poses:
        now = now | pose.states
        out.append(now)
    return out


def pressing(outs: Iterable[float], *, beside: float = 0.0, position: str = "out", **parameters: Any) -> list[dict]:
    """The switch while the fingertip is so many metres before its face (negative: it has pushed it in)."""
    hand = Hand()
    face = frame_of(SWITCH).then(Transform(np.array([0.012, 0.0, 0.0]), np.array([1.0, 0.0, 0.0, 0.0])))
    first = {"position": position, "depth": 0.5 if position == "in" else 0.0}
    into = -rotate(face.rotation, np.array([1.0, 0.0, 0.0]))
    rows = hand.rows(hand.pad(into), [face.apply(np.array([out, beside, 0.0])) for out in outs])
    start = hand.start(SWITCH, "face", states=first, parameters=parameters)
    poses = list(frames(program("pressed"), start, rows))
    for pose in poses:
        np.testing.assert_array_equal(pose.place, frame_of(SWITCH).place)
    return told(poses, first)


IN = [0.02, 0.0, -0.25 * TRAVEL, -0.5 * TRAVEL, -TRAVEL, -1.5 * TRAVEL]
OUT = [-0.8 * TRAVEL, -0.4 * TRAVEL, 0.0, 0.02]


def test_a_switch_goes_in_with_the_fingertip_latches_and_comes_out_at_the_next_press() -> None:
    states = pressing(IN + OUT)
    assert [state["depth"] for state in states] == pytest.approx([0, 0, 0.25, 0.5, 1, 1, 0.8, 0.5, 0.5, 0.5])
    assert [state["position"] for state in states] == ["out"] * 4 + ["in"] * 6
    again = pressing(IN + OUT, position="in")
    assert [state["depth"] for state in again] == pytest.approx([0.5, 0.5, 0.5, 0.5, 1, 1, 0.8, 0.4, 0, 0])
    assert [state["position"] for state in again] == ["in"] * 4 + ["out"] * 6


def test_it_clicks_once_for_each_push() -> None:
    trembling = [0.02, *[-TRAVEL, -0.7 * TRAVEL] * 5, 0.01]
    assert [state["position"] for state in pressing(trembling)][1:] == ["in"] * 11
    twice = [0.02, -TRAVEL, 0.0, -TRAVEL, 0.0]
    assert [state["position"] for state in pressing(twice)] == ["out", "in", "in", "out", "out"]


def test_a_button_that_does_not_latch_is_in_while_it_is_pushed() -> None:
    states = pressing([*IN, *OUT], latching=False)
    assert [state["position"] for state in states] == ["out"] * 4 + ["in"] * 3 + ["out"] * 3
    assert states[-1]["depth"] == 0.0


@pytest.mark.parametrize("outs", [[-TRAVEL] * 5, [0.01, -0.05, -0.05]])
def test_a_finger_that_comes_from_behind_or_is_far_behind_pushes_nothing(outs: list[float]) -> None:
    assert {state["position"] for state in pressing(outs)} == {"out"}


def test_a_finger_beside_the_button_pushes_nothing() -> None:
    assert pressing(IN, beside=0.017)[-1]["position"] == "in"
    assert pressing(IN, beside=0.02)[-1] == {"position": "out", "depth": 0.0}


def turning(
    degrees: Iterable[float], *, closed: float = 45.0, away: float = 0.0, states: dict | None = None
) -> list[dict]:
    """The tap while the palm is so many degrees around its axis from where the lever is when it is shut."""
    hand = Hand(closed=closed)
    palm = grips(hand.body.skeleton, hand.rotations, hand.body.root)[0, :3]
    tap = frame_of(TAP)
    places = []
    for angle in np.radians(list(degrees)):
        place = np.array([0.075 * np.cos(angle), 0.075 * np.sin(angle), 0.243 + away])
        places.append(tap.apply(place))
    first = states or {"turn": 0.0, "flow": "shut"}
    start = hand.start(TAP, "lever", states=first)
    return told(frames(program("turned"), start, hand.rows(palm, places)), first)


def test_the_lever_turns_with_the_hand_that_holds_it_and_stays_where_it_is_left() -> None:
    way = [*np.linspace(0.0, 40.0, 20), *[40.0] * 3]
    turns = np.degrees([state["turn"] for state in turning(way)])
    np.testing.assert_allclose(turns, way, atol=0.06)
    left = turning([*way, -20.0, 0.0])  # away by more than the threshold at once
    assert np.degrees(left[-1]["turn"]) == pytest.approx(40.0, abs=0.1)


def test_it_turns_no_farther_than_it_can_and_comes_back_where_it_was_passed() -> None:
    way = [*np.linspace(0.0, 70.0, 30), *np.linspace(70.0, 20.0, 20)]
    turns = np.degrees([state["turn"] for state in turning(way)])
    np.testing.assert_allclose(turns, np.minimum(way, np.degrees(0.87)), atol=0.1)


def test_it_turns_back_from_where_it_stands() -> None:
    turns = [state["turn"] for state in turning(np.linspace(49.8, 0.0, 30), states={"turn": 0.87, "flow": "running"})]
    assert turns[0] == pytest.approx(0.87, abs=1e-3)
    assert turns[-1] == pytest.approx(0.0, abs=1e-3)


def test_an_open_hand_and_one_beside_it_turn_nothing() -> None:
    assert turning(np.linspace(0.0, 40.0, 20), closed=0.0)[-1]["turn"] == 0.0
    assert turning(np.linspace(0.0, 40.0, 20), away=0.3)[-1]["turn"] == 0.0


def test_closing_and_opening_fingers_turn_nothing() -> None:
    hand = Hand(closed=45.0)
    palm = grips(hand.body.skeleton, hand.rotations, hand.body.root)[0, :3]
    rows = hand.rows(palm, [frame_of(TAP).apply(np.array([0.075, 0.002 * k, 0.243])) for k in range(12)])
    for row, more in zip(rows, (*range(0, 36, 6), *range(30, -6, -6)), strict=True):
        rotations = row[4:176].reshape(43, 4)
        for link in list(fingers("right"))[2:]:
            bend = from_axis_angle(np.array([0.0, 1.0, 0.0]), np.array(np.radians(more)))
            rotations[link] = multiply(rotations[link], bend)
    first = {"turn": 0.3, "flow": "running"}
    states = told(frames(program("turned"), hand.start(TAP, "lever", states=first), rows), first)
    assert np.degrees([state["turn"] for state in states]) == pytest.approx(np.degrees(0.3), abs=0.1)
