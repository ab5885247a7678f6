"""A library built: a few clips of it."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from ahmss.body.quaternion import rotate
from ahmss.body.skeleton import Skeleton
from ahmss.walking.build import build
from ahmss.walking.catalogue import STRAIGHT, Key
from ahmss.walking.gait import GAIT
from ahmss.walking.library import BODY, Library, save
from ahmss.walking.nominal import length_of
from ahmss.walking.performer import Stand

HUMAN = Skeleton.of(1.72, "male", "somebody")
STAND = Stand(*HUMAN.relaxed())
FEW = (Key("start", 90), Key("end", 0, 60, "small", "left"), Key("one_step", 60, 90), Key("two_step", 90, -30, "small"))


@cache
def made() -> Library:
    return build(HUMAN, STAND, GAIT, FEW)


def heading(q: np.ndarray) -> float:
    ahead = rotate(q, np.array([0.0, 0.0, -1.0]))
    return float(np.degrees(np.arctan2(ahead[1], ahead[0])))


def test_what_was_asked_for_is_there_and_the_straight_step() -> None:
    assert set(made().clips) == {*FEW, STRAIGHT}
    assert made().human == "somebody"
    assert made().hip_height == pytest.approx(STAND.root[2])
    assert all(key == clip.key for key, clip in made().clips.items())


def test_the_same_again_is_the_same_bytes(tmp_path: Path) -> None:
    save(made(), tmp_path / "one.npz")
    save(build(HUMAN, STAND, GAIT, reversed(FEW)), tmp_path / "two.npz")
    assert (tmp_path / "one.npz").read_bytes() == (tmp_path / "two.npz").read_bytes()


@pytest.mark.parametrize("key", FEW, ids=lambda key: key.name)
def test_a_clip_turns_as_its_key_says(key: Key) -> None:
    clip = made().clips[key]
    if key.kind in ("one_step", "two_step", "start"):
        assert heading(clip.rotations[0, 0]) == pytest.approx(heading(STAND.rotations[0]), abs=0.01)
    if key.kind in ("one_step", "two_step", "end"):
        assert heading(clip.rotations[-1, 0]) == pytest.approx(key.direction + key.facing, abs=0.01)
        alike = np.abs((clip.rotations[-1, 1:] * STAND.rotations[1:BODY]).sum(axis=-1))
        np.testing.assert_allclose(alike, 1.0, atol=1e-9)


@pytest.mark.parametrize("key", FEW, ids=lambda key: key.name)
def test_a_clip_goes_along_its_way(key: Key) -> None:
    clip = made().clips[key]
    way = clip.root[-1, :2] - clip.root[0, :2]
    direction = np.radians(key.direction)
    across = -np.sin(direction) * way[0] + np.cos(direction) * way[1]
    assert length_of(clip) > 0.1
    assert abs(across) < 0.06


def test_progress_is_told() -> None:
    told: list[tuple[int, int]] = []
    build(HUMAN, STAND, GAIT, FEW[2:], lambda done, of: told.append((done, of)))
    assert told == [(1, 2), (2, 2)]


def test_a_taller_human_walks_further_with_the_same_cadence() -> None:
    tall = Skeleton.of(1.90, "male", "tall")
    other = build(tall, Stand(*tall.relaxed()), GAIT, ()).clips[STRAIGHT]
    own = made().clips[STRAIGHT]
    assert other.frames == own.frames
    ratio = tall.relaxed()[1][2] / STAND.root[2]
    assert length_of(other) / length_of(own) == pytest.approx(ratio, rel=0.02)
