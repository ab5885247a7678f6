"""The palm's way: of a family of curves the shortest that stays clear."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.skeleton import Skeleton
from ahmss.motion.steps import finished
from ahmss.reaching.path import Curve, clear_curves, curves
from ahmss.reaching.prism import Prism
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.skin import MARGIN, gaps

SKELETON = Skeleton.of()
ROTATIONS, ROOT = SKELETON.upright()
REACHER = Reacher.of(SKELETON, "right")
PRESENT = REACHER.arm.from_pose(ROTATIONS[REACHER.links])
FROM = grips(SKELETON, ROTATIONS, ROOT)[0]
TIME = np.linspace(0.0, 1.0, 20)
SEATS = tuple(np.repeat(a[None], 20, axis=0) for a in seat(SKELETON, ROTATIONS, ROOT))


def family() -> list[Curve]:
    to = np.concatenate([FROM[:3] + np.array([0.3, 0.05, 0.25]), FROM[3:]])
    return curves(FROM, to, 0.0)


def block(x: float, high: float) -> Prism:
    ring = np.array([[x, -2.0], [x + 1.0, -2.0], [x + 1.0, 2.0], [x, 2.0]]) + FROM[:2]
    return Prism(ring, 0.0, high)


def chosen(prisms: list[Prism]) -> Curve:
    seats: tuple[Array, Array] = SEATS[0], SEATS[1]
    return finished(clear_curves(REACHER, family(), seats, PRESENT, prisms))[0]


def near(curve: Curve, prism: Prism) -> float:
    """How near hand and forearm come to a thing at the least, metres, but for the ends."""
    between = gaps(REACHER, curve.at(TIME)[None], (SEATS[0], SEATS[1]), PRESENT, [prism])
    return float(between[0, 6:14].min())


def test_where_nothing_is_the_shortest_is_taken() -> None:
    lengths = [curve.length for curve in family()]
    assert chosen([]).length == pytest.approx(min(lengths))
    assert chosen([block(3.0, 2.0)]).length == pytest.approx(min(lengths))


def test_over_an_edge_it_is_as_long_as_it_must_be() -> None:
    """The same as if all were looked at, though the long ones are not."""
    table = block(0.12, float(FROM[2]) + 0.08)
    curve = chosen([table])
    shortest = min(family(), key=lambda one: one.length)
    assert near(shortest, table) < 0.0
    assert near(curve, table) > 0.5 * MARGIN
    clear = [one.length for one in family() if near(one, table) > MARGIN]
    assert curve.length <= min(clear) + 1e-9


def test_the_others_leave_each_in_its_own_way() -> None:
    """For where the solved arm does not keep clear: none of them leaves as another does, and the best comes first."""
    found = finished(
        clear_curves(REACHER, family(), (SEATS[0], SEATS[1]), PRESENT, [block(0.12, float(FROM[2]) + 0.08)])
    )
    leaving = np.array([curve.points[1] for curve in found])
    apart = np.linalg.norm(leaving[:, None] - leaving, axis=-1) + np.eye(len(found))
    assert len(found) > 3
    assert apart.min() > 0.02
    assert found[0].length == pytest.approx(chosen([block(0.12, float(FROM[2]) + 0.08)]).length)
