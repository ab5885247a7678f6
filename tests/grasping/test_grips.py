"""Hands of both humans on cups, a lever, a tap, a plate, boxes, a knob: what the skin that viewers show does there."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS, fingers
from ahmss.body.quaternion import conjugate, from_axis_angle, from_matrix, multiply, rotate
from ahmss.grasping.hand import FINGERS, Hand
from ahmss.grasping.holding import Holding
from ahmss.grasping.power import power
from ahmss.grasping.precision import precision
from ahmss.motion.steps import finished
from tests.demo.skin import Skin

from .shapes import WORKSPACE, field, outside, thing

DEEPEST = 0.002  # metres that a finger may be within the shape
TOUCHES = 0.003  # metres within which the skin is on it
LOOSELY = 0.005  # metres within which a finger in a loop has its bar: where it is narrow the ends don't bend further
AROUND = -0.3  # cosine between the normals under two links of a finger that goes around a bar
OPPOSITE = -0.6  # cosine between the normals under the thumb and under the finger most opposite to it
NAMES = ("cup40", "cup55", "cup72", "cup90", "cup110", "lever", "tap", "plate", "box60", "box80", "knob")
BETWEEN = ("cup55", "cup90", "box80")  # smaller and larger ones are held
ALL = ("cup72", "lever", "plate", "box60")  # held by either hand of both, the others by ken's right and aiko's left
HANDS = [("ken", "right"), ("ken", "left"), ("aiko", "right"), ("aiko", "left")]
WITHIN = np.array([[2, 0, 0], [0, 2, 0], [0, 0, 2], [1, 1, 0], [0, 1, 1], [1, 0, 1], [2 / 3, 2 / 3, 2 / 3]]) / 2.0


@cache
def held(name: str, who: str, side: str) -> Holding | None:
    """The grip of a palm that comes from 10 cm before the site."""
    at = thing(name)
    hand = Hand.of(WORKSPACE.humans.get(who).skeleton, side)
    if at.grip == "precision":
        grip = np.concatenate([at.site[:3] - 0.1 * rotate(at.site[3:], np.array([1.0, 0.0, 0.0])), at.site[3:]])
        return finished(precision(hand, field(name), grip, at.site))
    up = rotate(at.site[3:], np.array([0.0, 0.0, 1.0]))
    turned = from_matrix(np.stack([at.palm, np.cross(up, at.palm), up], axis=1))
    return finished(power(hand, field(name), np.concatenate([at.site[:3] - 0.1 * at.palm, turned]), at.site))


@cache
def skin(who: str) -> Skin:
    shape = WORKSPACE.humans.shape(who)
    return Skin.read(shape.glb, WORKSPACE.humans.get(who).skeleton)


def on_object(holding: Holding, who: str, side: str) -> tuple[Array, Array]:
    """Points (n, 3) on the faces of the fingers' skin in the object's frame, and their links (n)."""
    skeleton = WORKSPACE.humans.get(who).skeleton
    rotations, root = skeleton.upright()
    rotations = rotations.copy()
    rotations[list(fingers(side))] = holding.shape
    of = skin(who)
    chosen = np.flatnonzero(np.isin(of.link, list(fingers(side))))
    faces = np.searchsorted(chosen, of.faces[np.isin(of.link, list(fingers(side)))[of.faces].all(axis=1)])
    places, turned = forward(rotations, root, skeleton.offsets)
    on_hand, hand = skeleton.grips[0 if side == "right" else 1], INDEX[f"{side}_hand"]
    palm, q_palm = places[hand] + rotate(turned[hand], on_hand[:3]), multiply(turned[hand], on_hand[3:])
    seen = rotate(conjugate(q_palm), of.posed(rotations, root, chosen) - palm)
    seen = holding.palm[:3] + rotate(holding.palm[3:], seen)
    return (WITHIN @ seen[faces]).reshape(-1, 3), np.repeat(of.link[chosen][faces[:, 0]], len(WITHIN))


@pytest.mark.parametrize("begins", [-50.0, -10.0, 10.0, 50.0])
@pytest.mark.parametrize(("serves", "most"), [(True, 15.0), (False, 30.0)])
def test_a_hand_lies_askew_as_it_has_come_but_no_more_than_it_holds_well_so(
    begins: float, serves: bool, most: float
) -> None:
    """Up to 15 degrees, up to 30 where the arm asks for it: what came at 20 was turned on to 25."""
    at, hand = thing("cup72"), Hand.of(WORKSPACE.humans.get("ken").skeleton, "right")
    turned = from_matrix(np.stack([at.palm, np.cross([0.0, 0.0, 1.0], at.palm), [0.0, 0.0, 1.0]], axis=1))
    turned = multiply(turned, from_axis_angle(np.array([1.0, 0.0, 0.0]), np.array(np.radians(begins))))
    grip = np.concatenate([at.site[:3] - 0.1 * at.palm, turned])

    def cost(palms: Array) -> tuple[Array, NDArray[np.bool_]]:
        return np.zeros(len(palms)), np.full(len(palms), serves)

    holding = finished(power(hand, field("cup72"), grip, at.site, cost))
    assert holding is not None
    assert holding.holds
    thumb = rotate(conjugate(turned), rotate(holding.palm[3:], np.array([0.0, 0.0, 1.0])))
    askew = np.radians(begins) + np.arctan2(-thumb[1], thumb[2])
    assert np.degrees(askew) == pytest.approx(np.clip(begins, -most, most), abs=0.1)


@pytest.mark.parametrize(
    ("name", "who", "side"),
    [
        pytest.param(name, *HANDS[3 * (i % 2)], marks=[pytest.mark.long] if name in BETWEEN else [])
        for i, name in enumerate(NAMES)
    ]
    + [pytest.param(name, *HANDS[3 - 3 * (i % 2)], marks=pytest.mark.long) for i, name in enumerate(NAMES)]
    + [pytest.param(name, *hand, marks=pytest.mark.long) for name in ALL for hand in HANDS[1:3]],
)
def test_it_holds_and_no_finger_is_deeper_than_2_mm(name: str, who: str, side: str) -> None:
    holding = held(name, who, side)
    assert holding is not None
    assert holding.holds
    points, link = on_object(holding, who, side)
    distance = outside(points, thing(name).near, TOUCHES)
    deepest = int(distance.argmin())
    assert distance[deepest] > -DEEPEST, LINKS[link[deepest]]
    on = {LINKS[k].split("_")[1] for k in set(link[distance < TOUCHES].tolist())}
    assert "thumb" in on
    assert len(on) >= (2 if name == "tap" else 3), on
    thumb = points[(link == INDEX[f"{side}_thumb_distal"]) | (link == INDEX[f"{side}_thumb_proximal"])]
    others = points[~np.isin(link, [INDEX[f"{side}_thumb_distal"], INDEX[f"{side}_thumb_proximal"]])]
    assert facing(thumb, others, name) < OPPOSITE


@pytest.mark.parametrize(
    ("name", "who", "side"),
    [("mug46", *HANDS[0])]
    + [
        pytest.param(name, *hand, marks=pytest.mark.long)
        for name, hand in (
            *(("mug46", hand) for hand in HANDS[1:]),
            *(("mug25", hand) for hand in HANDS),
            ("mug36", HANDS[0]),
            ("mug_aside", HANDS[0]),
        )
    ],
)
def test_fingers_go_through_the_loop_of_a_mug_and_around_its_handle(name: str, who: str, side: str) -> None:
    holding = held(name, who, side)
    assert holding is not None
    assert holding.holds
    points, link = on_object(holding, who, side)
    distance = outside(points, thing(name).near, LOOSELY)
    assert distance.min() > -DEEPEST, LINKS[link[distance.argmin()]]
    through = 0
    for finger in FINGERS:
        own = points[[LINKS[k].startswith(f"{side}_{finger}") for k in link.tolist()]]
        through += bool(facing(own, own, name, LOOSELY) < AROUND)
    assert through >= 2
    assert distance[[LINKS[k].startswith(f"{side}_thumb") for k in link.tolist()]].min() < LOOSELY


def facing(thumb: Array, others: Array, name: str, within: float = TOUCHES) -> float:
    """The least cosine between the surface's normals at the thumb's nearest points and those where fingers touch."""
    normals = [exact_normals(points, name, within) for points in (thumb, others)]
    return float((normals[0] @ normals[1].T).min(initial=1.0))


def exact_normals(points: Array, name: str, within: float) -> Array:
    """Normals (m, 3), by exact differences, at those of the points that are on the surface."""
    near = thing(name).near
    touching = points[outside(points, near, within) < within][::7]
    step = 2e-3 * np.eye(3)
    slope = np.stack([outside(touching + s, near, 0.01) - outside(touching - s, near, 0.01) for s in step], axis=1)
    return slope / np.linalg.norm(slope, axis=1, keepdims=True)


@pytest.mark.parametrize(
    ("name", "side"),
    [
        ("cup72", "right"),
        pytest.param("plate", "right", marks=pytest.mark.long),
        pytest.param("box60", "left", marks=pytest.mark.long),
    ],
)
def test_the_other_hand_holds_it_mirrored(name: str, side: str) -> None:
    one, other = held(name, "ken", "right"), held(name, "ken", "left")
    assert one is not None
    assert other is not None
    np.testing.assert_allclose(one.flexion, other.flexion, atol=0.15)
    assert one.thumb.out == pytest.approx(other.thumb.out, abs=0.15)


@pytest.mark.parametrize(
    ("who", "cups", "more"), [("ken", NAMES[:5:2], 0.2), pytest.param("aiko", NAMES[:5], 0.1, marks=pytest.mark.long)]
)
def test_a_wider_cup_opens_the_hand(who: str, cups: tuple[str, ...], more: float) -> None:
    grips = [held(name, who, "right") for name in cups]
    bent = [grip.flexion[1].sum() for grip in grips if grip is not None]
    assert len(bent) == len(cups)
    assert (np.diff(bent) < -more).all()


def test_what_is_wider_than_a_hand_is_not_held() -> None:
    wide = held("box150", "ken", "right")
    assert wide is None or not wide.holds
