"""Clips of the shipped library joined along a straight way."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from ahmss.motion.smoothness import pops
from ahmss.walking.catalogue import STRAIGHT, Key
from ahmss.walking.nominal import clip_of, join, length_of, stretched, woven
from ahmss.walking.selection import Selection, candidates, measured, select

from . import measures as m


def walk(direction: int = 60, facing: int = 90, distance: float = 4.0, mirror: bool = False):
    lengths = measured(candidates(direction, facing), lambda key: length_of(clip_of(m.library(), key)))
    return join(woven(m.library(), direction, facing, select(lengths, distance), mirror=mirror), 1.0)


def test_clips_follow_each_other_along_the_way() -> None:
    clips = [
        clip_of(m.library(), Key("start", 60)), clip_of(m.library(), STRAIGHT),
        clip_of(m.library(), STRAIGHT, mirror=True), clip_of(m.library(), Key("end", 0, 90, "normal", "right")),
    ]  # fmt: skip
    made = join(clips, 1.0)
    assert made.seams == tuple(np.cumsum([0, *(clip.frames for clip in clips)]))
    assert len(made.root) == made.seams[-1] + 1
    np.testing.assert_allclose(made.root[0], [0.0, 0.0, clips[0].root[0, 2]], atol=1e-4)
    for clip, (first, last) in zip(clips, pairwise(made.seams), strict=True):
        assert made.root[last, 0] - made.root[first, 0] == pytest.approx(length_of(clip), abs=1e-9)
    assert abs(made.root[-1, 1]) < 0.02


@pytest.mark.parametrize("mirror", [False, True])
@pytest.mark.parametrize(("direction", "facing"), [(0, 0), (60, 90), (150, -120), (180, 30), (90, 180)])
def test_what_is_joined_goes_on_in_place_and_speed(direction: int, facing: int, mirror: bool) -> None:
    made = walk(direction, facing, mirror=mirror)
    size = pops(made.rotations).max(axis=-1)
    hips = np.linalg.norm(np.diff(made.root, 2, axis=0), axis=-1) * 3600.0
    for seam in made.seams[1:-1]:
        steps = np.linalg.norm(np.diff(made.root[seam - 3 : seam + 4], axis=0), axis=-1)
        assert steps.max() < 1.5 * steps.min() + 0.002
        assert size[seam - 4 : seam + 1].max() < m.POP
        assert hips[seam - 2 : seam + 1].max() < m.HIPS_ACCELERATION


def test_rotations_do_not_change_sign() -> None:
    made = walk(120, 150, 6.0)
    assert (made.rotations[1:] * made.rotations[:-1]).sum(axis=-1).min() > 0.9


def test_lengths_are_scaled() -> None:
    clips = [clip_of(m.library(), Key("start", 30)), clip_of(m.library(), Key("end", 0, 0, "small", "right"))]
    one, half = join(clips, 1.0), join(clips, 0.5)
    np.testing.assert_allclose(half.root, 0.5 * one.root, atol=1e-12)
    np.testing.assert_array_equal(half.rotations, one.rotations)


def test_stretched_to_its_own_length_it_is_itself() -> None:
    made = walk()
    same = stretched(made, np.arange(len(made.root), dtype=float))
    np.testing.assert_allclose(same.root, made.root, atol=1e-12)
    np.testing.assert_allclose(same.rotations, made.rotations, atol=1e-12)
    np.testing.assert_array_equal(same.bearing, made.bearing)
    assert same.seams == made.seams


def test_stretched_it_passes_the_same_places_at_other_times() -> None:
    made = walk()
    last = len(made.root) - 1
    slow = stretched(made, np.linspace(0.0, last, 2 * last + 1))
    np.testing.assert_allclose(slow.root[::2], made.root, atol=1e-9)
    np.testing.assert_allclose(slow.seams, 2 * np.array(made.seams), atol=1)
    assert np.abs(slow.root[1::2] - 0.5 * (made.root[1:] + made.root[:-1])).max() < 2e-3


def test_a_walk_seen_in_a_mirror() -> None:
    made, seen = walk(60, 90), walk(60, 90, mirror=True)
    np.testing.assert_allclose(seen.root, made.root * [1.0, -1.0, 1.0], atol=1e-12)
    np.testing.assert_array_equal(seen.bearing, made.bearing[:, ::-1])


def test_every_other_straight_is_the_mirror_image() -> None:
    chosen = Selection("3Parts", "normal", 4, "right", 1.0, 1.0)
    made = join(woven(m.library(), 0, 0, chosen, mirror=False), 1.0)
    assert len(made.seams) == 7
    for seam in made.seams[1:-1]:
        landing = made.bearing[seam].any(axis=-1) & ~made.bearing[seam - 1].any(axis=-1)
        assert landing.sum() <= 1
    sways = made.root[list(made.seams[1:6]), 1]
    assert (np.diff(np.sign(sways)) != 0.0).all() or np.abs(sways).max() < 5e-3


def test_an_end_to_the_right_is_the_other_one_in_a_mirror() -> None:
    end = clip_of(m.library(), Key("end", 0, -60, "normal", "left"))
    other = clip_of(m.library(), Key("end", 0, 60, "normal", "right"), mirror=True)
    np.testing.assert_array_equal(end.rotations, other.rotations)
    assert end.key == Key("end", 0, -60, "normal", "left")


def test_what_no_table_has_is_refused() -> None:
    with pytest.raises(ValueError, match="no clip of a walk is called"):
        clip_of(m.library(), Key("start", 45))
