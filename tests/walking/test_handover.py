"""One walk goes over into another without anything that changes suddenly."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.walking.course import Course
from ahmss.walking.journey import Journey, at_seam, onward
from ahmss.walking.makingway import turned_into

from . import measures as m

KEN = m.subject("ken")


def walk(frames: int = 0) -> Journey:
    rotations, root = KEN.at((0.0, 0.0), 0.0)
    now = m.footing(KEN.skeleton, rotations, root, KEN.standing)
    course = m.straight(now, np.array([6.0, 0.0]))
    return m.journey(KEN.skeleton, m.library(), KEN.standing, now, course, 0.0, frames)


def ahead(place: Array, heading: float, length: float, towards: float = 0.0) -> Course:
    s = np.linspace(0.0, length, int(length / 0.02) + 1)[:, None]
    way = np.array([np.cos(heading + towards), np.sin(heading + towards)])
    since = place + (0.3 if towards else 0.0) * np.array([np.cos(heading), np.sin(heading)])
    course = Course(since + s * way, np.full(len(s), heading + towards), length)
    made = turned_into(place, heading, course) if towards else course
    assert made is not None
    return made


def both(going: Journey, seam: int, course: Course, rate: float, slow: float = 1.0) -> tuple[m.Walk, Journey]:
    """The old walk up to a seam and the new one from there."""
    stride = at_seam(going, seam)
    new = onward(KEN.skeleton, m.library(), KEN.standing, stride, course, float(course.heading[-1]), rate, slow)
    first, then = going.shaping.part(0, going.seams[seam] + 1), new.shaping.part(1, new.shaping.frames)
    turned = np.concatenate([first.rotations, then.rotations])
    whole = np.repeat(KEN.rotations[None], len(turned), axis=0)
    whole[:, : m.BODY] = turned
    parts = [np.concatenate([getattr(first, of), getattr(then, of)]) for of in ("root", "bearing", "ankles", "feet")]
    return m.Walk(KEN.skeleton, whole, *parts), new


@pytest.mark.parametrize("frames", [0, 500])
@pytest.mark.parametrize("seam", [1, 2, 3])
@pytest.mark.parametrize(
    ("length", "towards", "slow"), [(4.0, 0.8, 1.0), (4.0, -0.8, 0.8), (0.5, 0.0, 1.0), (3.0, 0.0, 0.7)]
)
def test_nothing_changes_suddenly(length: float, towards: float, slow: float, seam: int, frames: int) -> None:
    going = walk(frames)
    stride = at_seam(going, seam)
    made, new = both(going, seam, ahead(stride.place, stride.heading, length, towards), stride.rate, slow)
    root = made.root
    assert m.hips_acceleration(made) < m.HIPS_ACCELERATION
    assert root[:, 2].min() > 0.87 * root[0, 2]
    at = going.seams[seam]
    turned = m.pops(made.rotations[:, : m.BODY])[at - 6 : at + 30].max()
    assert turned < m.POP
    np.testing.assert_allclose(root[-1, :2], new.line.course.points[-1], atol=0.01)


@pytest.mark.parametrize("frames", [0, 500])
@pytest.mark.parametrize("seam", [1, 2])
@pytest.mark.parametrize(("length", "towards", "slow"), [(4.0, 0.8, 1.0), (0.5, 0.0, 1.0), (3.0, 0.0, 0.7)])
def test_a_foot_that_touches_stands(length: float, towards: float, slow: float, seam: int, frames: int) -> None:
    going = walk(frames)
    stride = at_seam(going, seam)
    made, _ = both(going, seam, ahead(stride.place, stride.heading, length, towards), stride.rate, slow)
    assert m.slid(made).max() < 0.001
    assert m.drift(made) < 0.001
    assert m.sunk(made) < 1e-4
    assert m.missed(made) < 1e-6
    assert m.supported(made) == 1.0


@pytest.mark.parametrize("seam", [1, 2, 3])
@pytest.mark.parametrize("slow", [0.67, 0.71, 0.8, 0.93])
def test_whose_turn_it_is_is_known_at_any_pace(slow: float, seam: int) -> None:
    going = walk()
    stride = at_seam(going, 1)
    course = ahead(stride.place, stride.heading, 4.5)
    slower = onward(KEN.skeleton, m.library(), KEN.standing, stride, course, 0.0, 1.0, slow)
    other = "left" if stride.ahead == "right" else "right"
    assert at_seam(slower, seam).ahead == (other if seam % 2 else stride.ahead)


def test_who_goes_slower_goes_as_fast_again_after_a_while() -> None:
    going = walk()
    stride = at_seam(going, 1)
    course = ahead(stride.place, stride.heading, 20.0)
    rates = onward(KEN.skeleton, m.library(), KEN.standing, stride, course, 0.0, 1.0, 0.7).rates
    assert rates[0] == 1.0
    assert rates[60] == pytest.approx(0.7)
    assert rates[200] == pytest.approx(1.0)
    assert np.abs(np.diff(rates[:-2])).max() < 0.03


def test_it_is_the_same_in_parts() -> None:
    makes = []
    for sizes in ((400,), (7, 20, 5, 60, 400)):
        going = walk()
        stride = at_seam(going, 2)
        new = onward(
            KEN.skeleton, m.library(), KEN.standing, stride, ahead(stride.place, stride.heading, 2.0, 0.5), 0.5
        )
        first, parts = 0, []
        for size in sizes:
            end = min(first + size, new.shaping.frames)
            parts.append(new.shaping.part(first, end).rotations)
            first = end
        makes.append(np.concatenate(parts))
    np.testing.assert_allclose(makes[0], makes[1], atol=1e-9)
