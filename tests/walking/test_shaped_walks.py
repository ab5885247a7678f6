"""Walks as they are shaped onto a straight line and a curve, beside the clips that they are made of."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.walking.catalogue import STRAIGHT, Key
from ahmss.walking.course import Course, plan
from ahmss.walking.journey import Standing
from ahmss.walking.legs import foot_frames
from ahmss.walking.library import BODY
from ahmss.walking.line import Line
from ahmss.walking.nominal import Nominal, clip_of, join
from ahmss.walking.shaping import Shaped, shape
from ahmss.walking.treading import Ends

from . import measures as m

UP, FORWARD = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])


def straight_course(length: float, heading: float = 0.0) -> Course:
    return plan(np.zeros(2), length * np.array([np.cos(heading), np.sin(heading)]), [], radius=0.27)


def walk_of(straights: int = 4, facing: int = 0) -> Nominal:
    library = m.library()
    clips = [clip_of(library, Key("start"))]
    clips += [clip_of(library, STRAIGHT, mirror=i % 2 == 1) for i in range(straights)]
    clips.append(clip_of(library, Key("end", 0, facing, "normal", "right" if straights % 2 == 0 else "left")))
    return join(clips, 1.0)


def shaped(nominal: Nominal, course: Course, *, heading: float = 0.0, facing: float = 0.0) -> Shaped:
    """Without any shrinking, from standing to standing as the clips do."""
    body = m.subject(m.library().human)
    x = nominal.root[list(nominal.seams), 0]
    way = Line(course, float(x[-1]), float(x[1]), float(x[-2]), 1.0, 1.0)
    first, last = _stood(body.standing, np.zeros(2), heading), _stood(body.standing, course.points[-1], facing)
    return shape(body.skeleton, nominal, way, Ends(*first, *last), body.standing.height)


def _stood(standing: Standing, place: Array, heading: float) -> tuple[Array, Array]:
    cos, sin = np.cos(heading), np.sin(heading)
    return place + standing.ankles @ np.array([[cos, sin], [-sin, cos]]), standing.headings + heading


def test_on_a_straight_line_the_hips_go_as_in_the_clips() -> None:
    nominal = walk_of()
    made = shaped(nominal, straight_course(float(nominal.root[-1, 0])))
    np.testing.assert_allclose(made.root[:, :2], nominal.root[:, :2], atol=1e-9)
    np.testing.assert_allclose(made.root[:, 2], nominal.root[:, 2], atol=6e-3)
    np.testing.assert_allclose(np.abs((made.rotations[:, :6] * nominal.rotations[:, :6]).sum(axis=-1)), 1.0, atol=1e-9)


def test_on_a_straight_line_the_feet_go_as_in_the_clips() -> None:
    """But for what fitting shifted: a centimetre or two."""
    nominal = walk_of()
    body = m.subject(m.library().human)
    ankles, _ = foot_frames(body.skeleton, nominal.rotations, nominal.root)
    made = shaped(nominal, straight_course(float(nominal.root[-1, 0])))
    assert np.linalg.norm(made.ankles - ankles, axis=-1).max() < 0.03


@pytest.mark.parametrize("heading", [0.7, -2.5])
def test_turned_as_a_whole_the_walk_is_the_same(heading: float) -> None:
    nominal = walk_of(3, 60)
    length, facing = float(nominal.root[-1, 0]), np.radians(60.0)
    one = shaped(nominal, straight_course(length), facing=facing)
    other = shaped(nominal, straight_course(length, heading), heading=heading, facing=heading + facing)
    turn = from_axis_angle(UP, heading)
    np.testing.assert_allclose(other.root, rotate(turn, one.root), atol=1e-9)
    np.testing.assert_allclose(other.ankles, rotate(turn, one.ankles), atol=1e-9)
    wanted = one.rotations.copy()
    wanted[:, 0] = multiply(turn, wanted[:, 0])
    np.testing.assert_allclose(np.abs((other.rotations * wanted).sum(axis=-1)), 1.0, atol=1e-9)
    np.testing.assert_array_equal(other.bearing, one.bearing)


def arc(radius: float, angle: float) -> Course:
    a = np.linspace(0.0, angle, int(radius * abs(angle) / 0.02) + 2)
    points = radius * np.stack([np.sin(np.abs(a)), np.sign(angle) * (1.0 - np.cos(a))], axis=-1)
    return Course(points, a, radius * abs(angle))


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_on_a_curve_the_body_turns_with_it_and_feet_stay(side: float) -> None:
    nominal = walk_of(4)
    length = float(nominal.root[-1, 0])
    course = arc(1.5, side * length / 1.5)
    facing = float(course.heading[-1])
    made = shaped(nominal, course, facing=facing)
    assert np.linalg.norm(made.root[-1, :2] - course.points[-1]) < 0.005
    away = np.abs(np.linalg.norm(made.root[:, :2] - [0.0, side * 1.5], axis=-1) - 1.5)
    np.testing.assert_allclose(away, np.abs(nominal.root[:, 1]), atol=1e-4)
    body = m.subject(m.library().human)
    rotations = np.repeat(body.rotations[None], len(made.root), axis=0)
    rotations[:, :BODY] = made.rotations
    walk = m.Walk(body.skeleton, rotations, made.root, made.bearing, made.ankles, made.feet, nominal.seams)
    assert m.drift(walk) < 1e-3
    assert m.sunk(walk) < 3e-3
    assert m.missed(walk) < 1e-6
    assert m.knee_flexion(walk).min() > 0.0


def test_footprints_are_where_feet_stand() -> None:
    nominal = walk_of(4)
    made = shaped(nominal, straight_course(float(nominal.root[-1, 0])))
    for foot, prints in enumerate(made.footprints):
        for i, frame in enumerate(prints.since):
            flat = np.abs(rotate(made.feet[:, foot], FORWARD)[:, 2]) < 1e-4
            there = np.flatnonzero(flat & (np.arange(len(flat)) >= frame))
            place, heading = prints.at(int(frame))
            np.testing.assert_allclose(made.ankles[there[0], foot, :2], place, atol=2e-3)
            assert i == 0 or not made.bearing[frame - 1, foot].any()
            assert np.isfinite(heading)
