"""turned: a lever between thumb and fingers stays held where one finger rolls off it, and not where they open."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from ahmss.algorithm import ObjectPose, frames
from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import from_axis_angle, multiply, rotate

from .scene import frame_of, program
from .test_buttons_and_levers import TAP, Hand, told

AROUND = 0.075  # metres from its axis the lever is taken, 0.243 high
TURNS = 40.0  # degrees


class Pinch(Hand):
    """A right hand whose index and middle finger are bent by so many degrees at each knuckle and joint."""

    def bent(self, **degrees: float) -> None:
        self.rotations = self.body.rotations.copy()
        for name, of in degrees.items():
            bend = from_axis_angle(np.array([0.0, 1.0, 0.0]), np.array(np.radians(of)))
            for link in (i for i, link in enumerate(LINKS) if link.startswith(f"right_{name}")):
                self.rotations[link] = multiply(self.rotations[link], bend)

    def tips(self) -> Array:
        """Of thumb, index and middle finger (3, 3)."""
        places, world = forward(self.rotations, self.body.root, self.body.skeleton.offsets)
        links = [INDEX[f"right_{name}_distal"] for name in ("thumb", "index", "middle")]
        return places[links] + rotate(world[links], self.body.skeleton.tips[links])

    def openings(self) -> Array:
        """Metres between the thumb and each of the two (2,)."""
        tips = self.tips()
        return np.linalg.norm(tips[1:] - tips[0], axis=1)


def turns(bends: Array, degrees: Array) -> tuple[Array, Array]:
    """How far the lever is turned, degrees (n), as a pinch so bent (n, 2) goes so far (n), and its openings (n, 2)."""
    hand = Pinch()
    hand.bent(index=0.0, middle=30.0)
    tips, palm = hand.tips(), grips(hand.body.skeleton, hand.rotations, hand.body.root)[0, :3]
    held = 0.5 * (tips[0] + tips[1])
    rows, openings = [], []
    for (index, middle), angle in zip(bends, np.radians(degrees), strict=True):
        hand.bent(index=index, middle=middle)
        openings.append(hand.openings())
        at = frame_of(TAP).apply(np.array([AROUND * np.cos(angle), AROUND * np.sin(angle), 0.243]))
        rows += hand.rows(palm, [palm + at - held])
    for k, row in enumerate(rows, 1):
        row[0] = k
    first = {"turn": 0.0, "flow": "shut"}
    poses = frames(program("turned"), hand.start(TAP, "lever", states=first), rows)
    states = told((pose for pose in poses if isinstance(pose, ObjectPose)), first)
    return np.degrees([state["turn"] for state in states]), np.array(openings)


def through(*bends: tuple[float, float], each: int = 12) -> Array:
    """(n, 2) from one to the next, so many frames for each, and as many at the last."""
    parts = [np.linspace(a, b, each) for a, b in pairwise(bends)]
    return np.concatenate([*parts, np.repeat(np.array(bends[-1:]), each, axis=0)])


@pytest.mark.parametrize(("apart", "follows"), [(-20.0, True), (30.0, False)])
def test_it_is_held_by_the_finger_that_closed_with_the_thumb_and_stays_where_another_rolls_off(
    apart: float, follows: bool
) -> None:
    """A middle finger that was as bent all the time, as in a hand at ease, holds nothing."""
    takes = through((-60.0, apart), (0.0, 30.0))
    rolls = through((0.0, 30.0), (-40.0, 30.0))
    bends = np.concatenate([takes, rolls])
    angle, openings = turns(bends, np.concatenate([np.zeros(len(takes)), np.linspace(0.0, TURNS, len(rolls))]))
    assert openings[-1, 0] > openings[len(takes), 0] + 0.01  # the index finger is off it
    if follows:
        assert angle[-1] == pytest.approx(TURNS, abs=0.5)
    else:
        assert angle[-1] < 0.6 * TURNS


def test_it_is_let_go_when_the_last_finger_opens_by_6_mm() -> None:
    takes = through((-60.0, -20.0), (0.0, 30.0))
    rolls, opens = through((0.0, 30.0), (-40.0, 30.0)), through((-40.0, 30.0), (-40.0, 0.0))
    bends = np.concatenate([takes, rolls, opens])
    goes = np.linspace(0.0, TURNS, len(rolls) + len(opens))
    angle, openings = turns(bends, np.concatenate([np.zeros(len(takes)), goes]))
    least = openings.min(axis=1)
    last = int(np.flatnonzero(np.diff(angle) > 0.0)[-1]) + 1
    assert last > len(takes) + len(rolls)
    assert least[last] < least[len(takes)] + 0.01
    assert least[last + 1] > least[len(takes)] + 0.006
