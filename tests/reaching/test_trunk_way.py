"""The trunk's way beside things: straight where that is well, else round them."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.motion.steps import finished
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.standing import Posture, Standing
from ahmss.reaching.trunk import trunk_points
from ahmss.reaching.trunk_way import between, drawn_towards

HUMAN = Skeleton.of(1.76)
SHARES = np.linspace(0.0, 1.0, 41)


def bent() -> tuple[Standing, Posture, Posture]:
    """Standing and facing +x, upright, and crouched and leant to the left of that, as to the floor."""
    rotations, root = HUMAN.relaxed()
    standing = Standing.of(HUMAN, rotations, root)
    assert standing is not None
    low = standing.postures(np.zeros(1), np.radians([90.0]), np.array([0.6]), np.array([0.35]), np.zeros(3))
    return standing, standing.base, Posture(low.rotations[0], low.root[0])


def edge(at: float) -> Prism:
    """The top of a table whose edge is so far ahead."""
    return Prism(np.array([[at, -1.0], [at + 1.0, -1.0], [at + 1.0, 1.0], [at, 1.0]]), 0.84, 0.88)


def deepest(standing: Standing, made: Posture, prism: Prism) -> float:
    """Metres that trunk, head and knees are in it on the way, deeper than at either end."""
    points, radii = trunk_points(HUMAN, standing.on_feet(made.rotations, made.root), made.root)
    gap = clearance([prism], points) - radii
    return float((np.minimum(np.minimum(gap[0], gap[-1]), 0.0) - gap).max())


def at(start: Posture, end: Posture, towards: Posture | None, shares: Array = SHARES) -> Posture:
    return between(start, end, towards, shares)


@pytest.mark.parametrize("rises", [False, True])
def test_who_bends_past_an_edge_goes_round_it_and_back_up(rises: bool) -> None:
    standing, up, low = bent()
    start, end = (low, up) if rises else (up, low)
    prism = edge(0.5)
    assert deepest(standing, at(start, end, None), prism) > 0.03
    towards = finished(drawn_towards(standing, start, end, None, [prism]))
    assert towards is not None
    made = at(start, end, towards)
    assert deepest(standing, made, prism) < 0.0
    np.testing.assert_allclose(made.root[[0, -1]], [start.root, end.root], atol=1e-12)
    assert np.abs(np.diff(made.root, axis=0)).max() < 0.04


def test_where_nothing_is_in_the_way_it_goes_straight() -> None:
    standing, up, low = bent()
    assert finished(drawn_towards(standing, up, low, None, [edge(1.2)])) is None
    made = at(up, low, None)
    np.testing.assert_allclose(made.root, up.root + SHARES[:, None] * (low.root - up.root), atol=1e-12)
