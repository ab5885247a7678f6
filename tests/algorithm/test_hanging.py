"""An arm that hangs is moved out of a thing that one walks past, sooner than it would be there, and back."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import skin_of
from ahmss.skills.hanging import Hanging

SKELETON = Skeleton.of(1.72)
PIECE, PIECES = 30, 8
SIDES = ("right", "left")


def passed(side: str, into: float) -> tuple[Array, Array, Array, list[Prism]]:
    """Who goes 2 m past a block, lower than elbows, that a hand would be so deep in: poses before, after, roots, it."""
    rotations, root = SKELETON.relaxed()
    points, radii = skin_of(Reacher.of(SKELETON, side), rotations, root)
    low, sign = points[:, 2] < 0.95, 1.0 if side == "left" else -1.0  # it faces along x
    inner = float((sign * points[low, 1] + radii[low]).max()) - into
    corners = [(0.9, inner), (1.1, inner), (1.1, inner + 0.3), (0.9, inner + 0.3)]
    ring = np.array([[x, sign * y] for x, y in corners])
    n = PIECE * PIECES
    roots = root + np.linspace(0.0, 2.0, n)[:, None] * np.array([1.0, 0.0, 0.0])
    before = np.repeat(rotations[None], n, axis=0)
    after, post, arm = before.copy(), [Prism(ring, 0.0, 0.95)], Hanging(SKELETON, side, 60.0)
    for i in range(PIECES):
        piece = slice(PIECE * i, PIECE * (i + 1))
        arm.over(post, after[piece], roots[piece])
    return before, after, roots, post


def gap(side: str, rotations: Array, root: Array, post: list[Prism]) -> float:
    points, radii = skin_of(Reacher.of(SKELETON, side), rotations, root)
    return float((clearance(post, points) - radii).min())


@pytest.mark.parametrize("side", SIDES)
def test_it_is_not_in_the_thing_and_hangs_again_behind_it(side: str) -> None:
    before, after, roots, post = passed(side, 0.03)
    assert gap(side, before, roots, post) < -0.025
    assert gap(side, after, roots, post) > 0.001
    np.testing.assert_allclose(after[:40], before[:40], atol=1e-12)
    np.testing.assert_allclose(after[-1], before[-1], atol=0.02)


@pytest.mark.parametrize("side", SIDES)
def test_it_goes_softly_from_piece_to_piece(side: str) -> None:
    _, after, _, _ = passed(side, 0.03)
    turns = to_rotation_vector(multiply(conjugate(after[:-1]), after[1:]))
    assert 0.3 < np.degrees(np.linalg.norm(turns, axis=-1)).max() < 0.8
    assert np.degrees(np.linalg.norm(np.diff(turns, axis=0), axis=-1)).max() < 0.15


def test_the_rest_of_the_body_stays() -> None:
    before, after, _, _ = passed("right", 0.03)
    others = np.ones(43, bool)
    others[Reacher.of(SKELETON, "right").links] = False
    assert (after[:, others] == before[:, others]).all()


def test_where_there_is_room_it_hangs_as_it_was() -> None:
    before, after, _, _ = passed("left", -0.05)
    assert (after == before).all()
