"""The sites on a body's parts are where the whole body's forward kinematics has them."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.inverse import grips
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import multiply, normalize, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.database.records import Site
from ahmss.main.body_parts import Body, Parts


def test_a_site_goes_with_its_link_and_a_palm_with_its_grip() -> None:
    skeleton, draw = Skeleton.of(1.62), np.random.default_rng(3)
    rotations, root = normalize(draw.normal(size=(43, 4))), draw.normal(size=3)
    position, rotation = (0.02, -0.01, 0.03), tuple(normalize(draw.normal(size=4)).tolist())
    links = ("hips", "left_middle_distal", "right_lower_leg")
    names = (*links, "right_palm", "left_palm")
    found = Parts(Site(position, rotation, part=name) for name in names).of(
        skeleton, Body(skeleton, rotations, root).pose
    )
    places, turned = forward(rotations, root, skeleton.offsets)
    palms = grips(skeleton, rotations, root)
    frames = [(places[INDEX[name]], turned[INDEX[name]]) for name in links]
    frames += [(palm[:3], palm[3:]) for palm in palms]
    for row, (place, q) in zip(found, frames, strict=True):
        assert row[:3] == pytest.approx(place + rotate(q, np.array(position)), abs=1e-12)
        assert row[3:] == pytest.approx(multiply(q, np.array(rotation)), abs=1e-12)


def test_the_eyes_look_ahead_with_z_up() -> None:
    skeleton = Skeleton.of(1.62)
    rotations, root = skeleton.upright()
    (row,) = Parts([Site((0.5, 0.0, 0.1), part="eyes")]).of(skeleton, Body(skeleton, rotations, root).pose)
    places, turned = forward(rotations, root, skeleton.offsets)
    eye = places[INDEX["head"]] + rotate(turned[INDEX["head"]], skeleton.eye)
    assert row[:3] == pytest.approx(eye + np.array([0.5, 0.0, 0.1]), abs=1e-6)
    assert row[3:] == pytest.approx([1.0, 0.0, 0.0, 0.0], abs=1e-6)
