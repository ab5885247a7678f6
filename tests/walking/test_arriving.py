"""Who comes to the chair of the shipped room to sit down on it turns before it, and the feet swing past its legs."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from ahmss.body.quaternion import rotate
from ahmss.database import Workspace
from ahmss.motion.contact import foot_points
from ahmss.walking.library import BODY
from ahmss.walking.trip import Ground, Trip

from . import measures as m


@pytest.mark.parametrize("name", m.HUMANS)
@pytest.mark.parametrize("start", [(-1.2, 1.4, -20.0), (2.4, -1.2, 90.0), (-1.8, -1.5, 0.0)])
def test_feet_keep_clear_of_the_chair(start: tuple[float, float, float], name: str) -> None:
    objects, ground = Workspace(m.ROOT).objects, {}
    for placed in objects.place("room", "room"):
        for ring in objects.footprint(placed.kind, placed.position[2], np.array(placed.rotation)):
            corners = np.pad(np.array(ring), ((0, 0), (0, 1)))
            ground[placed.name] = (np.array(placed.position) + rotate(np.array(placed.rotation), corners))[:, :2]
    body = m.subject(name)
    trip = Trip(body.skeleton, m.library(), Ground([*ground.values()], [*ground]), np.array([1.78, 0.2]), np.pi)
    pieces = list(trip.pieces(*body.at(start[:2], start[2])))
    rotations = np.repeat(body.rotations[None], sum(len(piece.root) for piece in pieces), axis=0)
    rotations[:, :BODY] = np.concatenate([piece.rotations for piece in pieces])
    root = np.concatenate([piece.root for piece in pieces])
    np.testing.assert_allclose(root[-1, :2], [1.78, 0.2], atol=1e-3)
    points = foot_points(body.skeleton, rotations, root)[..., :2].reshape(-1, 2)
    chair = shapely.Polygon(ground["room/chair"])
    assert shapely.distance(chair, shapely.points(points)).min() > 0.02
