"""near_shapes: how deep balls are in the faces of what stands near, under a table's top as over it."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import HumanTask, Transform
from ahmss.algorithm.messages import ShapeRecord
from ahmss.body.quaternion import from_axis_angle
from ahmss.skills.near_shapes import Faces

from .reached import outlined
from .scene import WORKSPACE, Body, record

TURNED = Transform(np.array([1.0, 2.0, 0.0]), from_axis_angle(np.array([0.0, 0.0, 1.0]), 0.7))


def around(place: tuple[float, float, float], *, shaped: bool = True) -> Faces:
    """The faces of a table that stands turned, near a place of it."""
    table, kept = outlined(record("room/table", TURNED), 11), WORKSPACE.objects.kept_shape("table")
    assert kept is not None
    if shaped:
        table = msgspec.structs.replace(table, shape=ShapeRecord(str(kept[0]), kept[1]))
    task = HumanTask(Body().start("room/chair", "sit", world=[table]))
    assert task.object is not None
    return Faces.about(task, TURNED.apply(np.array(place))[:2], 0.3, but=task.object)


def test_a_ball_is_as_deep_as_it_reaches_past_a_face() -> None:
    faces = around((0.7, 0.0, 0.0))
    assert faces.names == ("room/table",)
    radii = np.array([0.05])
    for place, deep in (((0.53, 0.0, 0.865), 0.02), ((0.0, 0.0, 0.90), 0.03), ((0.47, 0.0, 0.82), 0.02)):
        found = faces.deepest(TURNED.apply(np.array([[place]])), radii)
        assert found == (pytest.approx(deep, abs=1e-6), "room/table")
    assert faces.deepest(TURNED.apply(np.array([[[0.47, 0.0, 0.5]]])), radii)[0] < -0.02  # under its top
    assert faces.deepest(TURNED.apply(np.array([[[0.8, 0.0, 0.5]]])), radii) == (-0.05, "")


def test_what_is_farther_and_what_tells_no_shape_is_not_looked_at() -> None:
    assert not len(around((0.9, 0.0, 0.0)).triangles)
    assert not len(around((0.7, 0.0, 0.0), shaped=False).triangles)
