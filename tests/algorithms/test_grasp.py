"""grasp: every finger at the wall, the thumb apart from the others; and the hand opened again."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.algorithm import Transform, frames
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS, fingers
from ahmss.body.quaternion import rotate
from ahmss.errors import AlgorithmError

from .scene import CUP, Body, frame_of, program

RADIUS = 0.036


def gaps(body: Body, side: str, axis: Transform) -> dict[str, float]:
    """The least distance of each finger link's skin from the cup's wall, metres."""
    places, turned = forward(body.rotations, body.root, body.skeleton.offsets)
    found = {}
    for link in fingers(side):
        along = np.linspace(0.0, 1.0, 33)[:, None] * body.skeleton.tips[link]
        seen = axis.inverse().apply(places[link] + rotate(turned[link], along))
        found[LINKS[link]] = float(np.hypot(seen[:, 0], seen[:, 1]).min()) - RADIUS - body.skeleton.radii[link]
    return found


@pytest.mark.parametrize(("name", "side"), [("ken", "right"), ("aiko", "right"), ("ken", "left")])
def test_every_finger_touches_the_wall(name: str, side: str) -> None:
    body = Body(name, y=-0.3, facing=20.0) if side == "left" else Body(name)
    body.do("reach", body.start(CUP, "reach", hand=side))
    body.do("grasp", body.start(CUP, "grasp", hand=side))
    for link, gap in gaps(body, side, frame_of(CUP)).items():
        assert abs(gap) < 0.004, link
    palm = body.grip(0 if side == "right" else 1).place - frame_of(CUP).place
    assert np.hypot(*palm[:2]) == pytest.approx(RADIUS, abs=1.5e-3)


def test_the_thumb_goes_to_the_other_side() -> None:
    body = Body()
    body.do("reach", body.start(CUP, "reach"))
    body.do("grasp", body.start(CUP, "grasp"))
    places, _ = forward(body.rotations, body.root, body.skeleton.offsets)
    thumb, *others = (
        places[INDEX[f"right_{finger}_distal"]] - frame_of(CUP).place
        for finger in ("thumb", "index", "middle", "ring", "little")
    )
    for other in others:
        assert thumb[:2] @ other[:2] < 0.0


def test_a_thicker_object_bends_the_fingers_less() -> None:
    bent = {}
    for diameter in (0.05, 0.09):
        body = Body()
        body.do("reach", body.start(CUP, "reach"))
        body.do("grasp", body.start(CUP, "grasp", parameters={"diameter": diameter}))
        links = [INDEX["right_middle_proximal"], INDEX["right_middle_intermediate"], INDEX["right_middle_distal"]]
        bent[diameter] = float(np.arccos(np.abs(body.rotations[links, 0])).sum())
    assert bent[0.05] > bent[0.09] + 0.2


def test_it_says_so_when_the_cup_is_out_of_reach() -> None:
    body = Body()
    with pytest.raises(AlgorithmError, match="reach for it first"):
        list(frames(program("grasp"), body.start(CUP, "grasp")))


def test_opened_fingers_leave_the_wall_before_the_hand_goes() -> None:
    body = Body()
    body.do("reach", body.start(CUP, "reach"))
    body.do("grasp", body.start(CUP, "grasp"))
    before = body.grip().place
    start = body.start(CUP, "release")
    shown = body.do("grasp", start)
    assert np.linalg.norm(body.grip().place - before) == pytest.approx(0.06, abs=2e-3)
    half = Body()
    for pose in shown:
        half.rotations, half.root = pose.rotations, pose.root
        assert min(gaps(half, "right", frame_of(CUP)).values()) > -0.004


def test_only_the_arm_and_its_fingers_are_cared_for() -> None:
    body = Body()
    body.do("reach", body.start(CUP, "reach"))
    pose = next(iter(frames(program("grasp"), body.start(CUP, "grasp"))))
    for name in ("hips", "left_hand", "right_upper_leg", "left_index_distal"):
        assert pose.importance[INDEX[name]] == 0.0
    assert pose.importance[43] == 0.0
