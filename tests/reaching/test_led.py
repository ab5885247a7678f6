"""A hand of who is carried to a thing comes round it to where it takes it, its fingers open, not through it."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.inverse import solve
from ahmss.body.links import fingers
from ahmss.body.quaternion import from_axis_angle, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.fingers import opened
from ahmss.reaching.carried import Carried
from ahmss.reaching.comfort import palms_at
from ahmss.reaching.goal import Goal
from ahmss.reaching.led import Led
from ahmss.reaching.path import lifted
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import hand_skin

HUMAN = Skeleton.of(1.7)
ROTATIONS, ROOT = HUMAN.relaxed()
FRAMES, ON = 90, np.array([0.006, 0.0, 0.0])  # metres a frame
STAYS = np.zeros(3)
ROW = {"right": 0, "left": 1}
SIGN = {"right": -1.0, "left": 1.0}  # to the left
RADIUS, HEIGHT, BEFORE = 0.036, 0.095, 0.066  # of a cup, and how far from its axis the palm stops


def cup_at(place: Array) -> Prism:
    around = np.linspace(0.0, 2.0 * np.pi, 24, endpoint=False)
    ring = place[:2] + RADIUS * np.stack([np.cos(around), np.sin(around)], axis=-1)
    return Prism(ring, float(place[2]) - 0.5 * HEIGHT, float(place[2]) + 0.5 * HEIGHT, sought=True)


def inward(side: str) -> Array:
    """A palm (4,) whose fingers point ahead and which looks inward: it takes a cup from its own side."""
    axes = palms_at(np.zeros(3), np.array([1.0, 0.0, 0.0]), SIGN[side])
    ahead = np.array([1.0, 0.0, 0.0])
    looks = rotate(axes, ahead) @ np.array([0.0, -SIGN[side], 0.0])
    return axes[int(looks.argmax())]


def open_handed(side: str) -> Array:
    """The pose (43, 4) that one stands in, the thumb out of the palm, fingers straight."""
    out = from_axis_angle(np.array([[0.0, 0.0, SIGN[side]]] * 2), np.array([np.radians(92.0), 0.0]))
    made = ROTATIONS.copy()
    made[list(fingers(side))] = opened(side, out)
    return made


def gaps(side: str, near: list[Prism], place: Array) -> tuple[Array, float]:
    """How near the skin of the hand is to a cup in each frame (F,), and how far the palm is from its place at last."""
    reacher, targets = Reacher.of(HUMAN, side), np.zeros((5, 8))
    goal = Goal(place, inward(side), before=BEFORE)
    given, found = open_handed(side), list[float]()
    hand = Carried(HUMAN, goal, given, ROOT, [side])
    for k in range(FRAMES):
        root = ROOT + (k + 1) * ON
        given, targets[ROW[side]], _ = hand.step(given, root, (k + 1) / FRAMES, (FRAMES - k - 1) * ON, near)
        points, radii = hand_skin(reacher, solve(HUMAN, given, root, targets), root)
        found.append(float((clearance([cup_at(place)], points) - radii).min()))
    return np.array(found), float(np.linalg.norm(targets[ROW[side], :3] - hand.palm[:3]))


@pytest.mark.parametrize("side", ["left", pytest.param("right", marks=pytest.mark.long)])  # mirror images
def test_it_comes_round_the_thing_to_its_place(side: str) -> None:
    place = ROOT + np.array([ON[0] * FRAMES + 0.4, SIGN[side] * 0.4, 0.05])
    through, _ = gaps(side, [], place)
    round_it, off = gaps(side, [cup_at(place)], place)
    assert through.min() < -0.015  # else there is nothing to come round
    assert round_it.min() > 0.01, int(round_it.argmin())
    assert off < 0.002


def test_nothing_changes_where_the_way_is_clear() -> None:
    led, turn = Led(), inward("left")
    start, palm = np.array([0.0, 0.3, 0.1, *turn]), np.array([0.2, 0.1, 0.2, *turn])
    for _ in range(30):
        led.step([cup_at(np.array([3.0, 0.0, 0.2]))], (np.zeros((1, 3)), np.array([0.01])), (start, palm), 0.3, STAYS)
    assert led.at(start, palm, 0.7) == pytest.approx(lifted(start, palm, 0.14, 0.1).at(np.array([0.7]))[0])


def table(edge: float) -> Prism:
    """Half a metre high, from an edge across the way on."""
    return Prism(np.array([[edge, -1.0], [edge + 2.0, -1.0], [edge + 2.0, 1.0], [edge, 1.0]]), 0.0, 0.5)


def first_way(near: Prism, ahead: Array) -> Array:
    """Palms (50, 3) on the way that a hand takes which hangs half a metre beside a table and goes 0.8 m over it."""
    led, turn = Led(), inward("left")
    palms = np.array([0.0, 0.0, 0.3, *turn]), np.array([0.8, 0.0, 0.65, *turn])
    led.step([near], (np.zeros((1, 3)), np.array([0.04])), palms, 0.01, ahead)
    return np.stack([led.at(*palms, time)[:3] for time in np.linspace(0.01, 1.0, 50)])


def test_it_sets_out_as_high_as_it_must() -> None:
    far, near = first_way(table(5.0), STAYS), first_way(table(0.25), STAYS)
    over = near[:, 0] > 0.25
    assert (far[far[:, 0] > 0.25, 2]).min() < 0.54  # else it would be over the table without
    assert near[over, 2].min() > 0.54


def test_it_is_higher_where_the_body_comes_on() -> None:
    stays, comes = (first_way(table(0.3), on) for on in (STAYS, np.array([0.6, 0.0, 0.0])))
    assert (comes - stays)[:, 2].max() > 0.05


def test_it_rises_before_it_goes_far() -> None:
    way = first_way(table(5.0), STAYS)
    risen = way[:, 2] > 0.4
    assert way[risen, 0][0] < 0.2


def test_it_is_led_out_along_the_palm_softly_and_comes_back() -> None:
    turn = from_axis_angle(np.array([0.0, 0.0, 1.0]), np.array(0.3))
    palm = np.array([0.0, 0.0, 0.0, *turn])
    ahead = rotate(turn, np.array([1.0, 0.0, 0.0]))
    across = rotate(turn, np.array([0.0, 1.0, 0.0]))
    start = np.concatenate([0.7 * across + 0.4 * ahead - np.array([0.0, 0.0, 0.15]), turn])
    hand = np.linspace(0.0, -0.15, 12)[:, None] * np.array([0.0, 1.0, 0.0]), np.full(12, 0.01)
    led, ways = Led(), list[float]()
    for near in [[cup_at(BEFORE * ahead)]] * 40 + [[cup_at(3.0 * ahead)]] * 300:
        led.step(near, hand, (start, palm), 0.3, STAYS)
        ways.append(float((led.at(start, palm, 0.7)[:3]) @ ahead))
    out = np.array(ways) - ways[-1]
    assert out.min() < -0.02  # away from the cup
    assert np.abs(np.diff(out, n=2)).max() < 0.003
    assert abs(out[-20]) < 1e-3
