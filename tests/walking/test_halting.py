"""Walkers who are told to stop: they come to a stand, on both feet, wherever they are on their way."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.motion.contact import foot_points
from ahmss.motion.smoothness import pops
from ahmss.walking.journey import footing
from ahmss.walking.library import BODY, RATE
from ahmss.walking.trip import Ground, Trip, Walker

from . import measures as m


def halted(name: str, at: int, others: tuple[Walker, ...] = ()) -> tuple[Array, Array, m.Subject]:
    """Rotations (F, 43, 4) and root (F, 3) of who walks 4 m and is told to stop at a frame."""
    body = m.subject(name)
    rotations, root = body.at((0.0, 0.0), 0.0)
    made, turned = [root], [rotations[:BODY]]
    trip = Trip(
        body.skeleton, m.library(), Ground(), np.array([4.0, 1.0]), None, others=lambda: others,
        rests=lambda: len(made) > at,
    )  # fmt: skip
    for piece in trip.pieces(rotations, root):
        made.extend(piece.root)
        turned.extend(piece.rotations)
        assert len(made) < 1000, "it never stands"
    whole = np.repeat(rotations[None], len(made), axis=0)
    whole[:, :BODY] = turned
    return whole, np.array(made), body


@pytest.mark.parametrize("name", m.HUMANS)
@pytest.mark.parametrize("at", [70, 100, 125, 150])
def test_who_walks_stands_after_another_step(name: str, at: int) -> None:
    rotations, root, body = halted(name, at)
    assert len(root) - at < 2.5 * RATE
    assert 1.0 < np.linalg.norm(root[-1, :2]) < 3.5
    now = footing(body.skeleton, rotations[-1], root[-1], body.standing)
    assert abs(root[-1, 2] - root[0, 2]) < 1e-3
    away = now.ankles - now.place
    ahead = np.array([np.cos(now.heading), np.sin(now.heading)])
    assert np.abs(away @ ahead - body.standing.ankles[:, 0]).max() < 0.005  # the feet are beside each other
    assert pops(rotations[:, :BODY]).max() < m.POP
    soles = foot_points(body.skeleton, rotations[-1][None], root[-1][None])[0, ..., 2]
    assert np.abs(soles).max() < 1e-3  # flat on the floor, both


def test_before_a_foot_is_lifted_the_weight_goes_back() -> None:
    _, root, _ = halted("ken", 18)
    assert len(root) < 90
    assert np.linalg.norm(root[-1, :2]) < 1e-3


def test_who_waits_for_somebody_waits_no_more() -> None:
    place = np.array([0.75, 0.19])
    beside = Walker(place, np.zeros(2), name="aiko", way=np.repeat(place[None], 6, axis=0))
    _, root, _ = halted("ken", 60, (beside,))
    assert len(root) < 80 + 2.5 * RATE
