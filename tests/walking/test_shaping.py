"""A walk is the same in however many parts it is shaped, and its beginning needs nothing of what comes later."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import ahmss
from ahmss.body.skeleton import Skeleton
from ahmss.walking.course import Course, plan
from ahmss.walking.journey import Journey, Standing, at_seam, footing, journey, onward
from ahmss.walking.library import Library, load
from ahmss.walking.shaping import Shaped, Shaping
from ahmss.walking.treading import Ends

KEN = Skeleton.of()
UPRIGHT = KEN.upright()
BOX = np.array([[0.8, -0.5], [1.6, -0.5], [1.6, 0.7], [0.8, 0.7]])


@pytest.fixture(scope="module")
def library() -> Library:
    return load(Path(ahmss.__file__).parents[1] / "objectdb" / "floor" / "walk.npz")


def walk(library: Library, goal: tuple[float, float], facing: float, *, box: bool = False, frames: int = 0) -> Journey:
    standing = Standing.of(KEN, library)
    now = footing(KEN, *UPRIGHT, standing)
    course = plan(now.place, np.array(goal), [BOX] if box else [], radius=0.27, start_heading=now.heading)
    return journey(KEN, library, standing, now, course, facing, frames)


def in_parts(shaping: Shaping, sizes: tuple[int, ...]) -> Shaped:
    """All frames, asked for so many at a time."""
    parts: list[Shaped] = []
    first = 0
    while first < shaping.frames:
        end = min(first + sizes[len(parts) % len(sizes)], shaping.frames)
        parts.append(shaping.part(first, end))
        first = end
    rotations, root, ankles, feet = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("rotations", "root", "ankles", "feet")
    )
    bearing = np.concatenate([part.bearing for part in parts])
    return Shaped(rotations, root, ankles, feet, bearing, parts[-1].footprints)


def assert_same(parts: Shaped, whole: Shaped) -> None:
    for name in ("rotations", "root", "ankles", "feet"):
        assert np.abs(getattr(parts, name) - getattr(whole, name)).max() < 1e-9, name
    assert (parts.bearing == whole.bearing).all()
    for one, other in zip(parts.footprints, whole.footprints, strict=True):
        assert (one.since == other.since).all()
        assert np.abs(one.places - other.places).max() < 1e-9
        assert np.abs(one.headings - other.headings).max() < 1e-9


@pytest.mark.parametrize(
    ("goal", "facing", "box", "frames"),
    [
        ((7.0, 1.0), 0.4, False, 0),
        ((-2.0, -1.5), 2.5, False, 0),
        ((0.2, 0.1), 1.0, False, 0),
        ((2.8, 0.1), -1.2, True, 0),
        ((4.0, 0.0), 0.0, False, 300),
    ],
    ids=["far", "behind", "one step", "round a box", "in so many frames"],
)
def test_parts_are_the_whole(
    library: Library, goal: tuple[float, float], facing: float, box: bool, frames: int
) -> None:
    whole = walk(library, goal, facing, box=box, frames=frames).shaped
    for sizes in ((13,), (3, 90, 11)):
        assert_same(in_parts(walk(library, goal, facing, box=box, frames=frames).shaping, sizes), whole)


def test_a_walk_that_goes_on_otherwise_is_the_same_in_parts(library: Library) -> None:
    standing = Standing.of(KEN, library)
    going = walk(library, (6.0, 0.0), 0.0)
    going.shaping.part(0, going.seams[2] + 1)
    stride = at_seam(going, 2)
    whole = walk(library, (6.0, 0.0), 0.0).shaped
    stands = [one.at(going.seams[2])[0] for one in whole.footprints]
    assert np.abs(stride.ankles - stands).max() < 1e-9

    along = np.linspace(0.0, 2.0, 101)[:, None] * (np.cos(stride.heading), np.sin(stride.heading))
    course = Course(stride.place + along, np.full(101, stride.heading), 2.0)
    twice = [onward(KEN, library, standing, stride, course, stride.heading + 0.5) for _ in range(2)]
    assert_same(in_parts(twice[0].shaping, (29,)), twice[1].shaped)


def test_the_beginning_needs_nothing_of_the_end(library: Library) -> None:
    going = walk(library, (30.0, 0.0), 0.0)
    standing = Standing.of(KEN, library)
    now = footing(KEN, *UPRIGHT, standing)
    rotations = going.nominal.rotations.copy()
    rotations[400:] = np.nan
    ends = Ends(now.ankles, now.headings, now.ankles, now.headings)
    unknown = Shaping(KEN, replace(going.nominal, rotations=rotations), going.line, ends, standing.height)
    first, wanted = unknown.part(0, 100), going.shaping.part(0, 100)
    assert np.abs(first.rotations - wanted.rotations).max() < 1e-9
    assert np.abs(first.root - wanted.root).max() < 1e-9
    assert (going.shaping.level == going.shaped.root[:, :2]).all()
