"""turn: thumb and fingers take the tap's lever, go with it about its axis, and let it go."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import HumanPose, frames
from ahmss.algorithm.messages import PoseRecord, Start
from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.errors import AlgorithmError
from ahmss.motion.smoothness import worst_pop

from .reached import outlined
from .scene import Body, frame_of, program, record

TAP = "room/sink/tap"
LARGEST = 0.87  # radians
AT = np.array([0.075, 0.0, 0.243])  # of the lever in the tap's frame while it is shut


def standing(name: str, aside: float = 0.0) -> Body:
    place = frame_of(TAP).apply(np.array([0.72, aside, 0.0]))
    out = rotate(frame_of(TAP).rotation, np.array([-1.0, 0.0, 0.0]))
    return Body(name, float(place[0]), float(place[1]), float(np.degrees(np.arctan2(out[1], out[0]))))


def turning(body: Body, angle: float = 0.0, **given: Any) -> Start:
    states = {"turn": angle, "flow": "running" if angle else "shut"}
    return Start(
        kind="human", human=body.skeleton.to_record(), pose=PoseRecord.of(body.rotations, body.root), site="lever",
        object=outlined(record(TAP, None, states, shaped=True), 3), world=[outlined(record("room/sink"), 11)],
        **({"frames": 0, "wish": True} | given),
    )  # fmt: skip


def pinch(body: Body, shown: list[HumanPose]) -> tuple[Array, Array]:
    """The middle between the tips of thumb and index (F, 3) in the tap's frame, and how far these are apart (F)."""
    side = ("right", "left")[int(shown[-1].targets[1, 7])]
    links = [INDEX[f"{side}_thumb_distal"], INDEX[f"{side}_index_distal"]]
    rotations, root = np.array([p.rotations for p in shown]), np.array([p.root for p in shown])
    places, turned = forward(rotations, root, body.skeleton.offsets)
    tips = places[:, links] + rotate(turned[:, links], body.skeleton.tips[links])
    return frame_of(TAP).inverse().apply(tips.mean(axis=1)), np.linalg.norm(tips[:, 0] - tips[:, 1], axis=-1)


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize(("begins", "ends"), [(0.0, LARGEST), (LARGEST, 0.0)])
def test_the_pinch_goes_with_the_lever(name: str, begins: float, ends: float) -> None:
    body = standing(name)
    shown = body.do("turn", turning(body, begins))
    middle, apart = pinch(body, shown)
    angle = np.arctan2(middle[:, 1], middle[:, 0])
    closed = apart < apart.min() + 0.004
    held = np.flatnonzero(closed)
    assert np.abs(np.linalg.norm(middle[held, :2], axis=1) - AT[0]).max() < 0.03
    assert np.abs(middle[held, 2] - AT[2]).max() < 0.02
    assert angle[held[0]] == pytest.approx(begins, abs=0.15)
    assert angle[held[-1]] - angle[held[0]] == pytest.approx(ends - begins, abs=0.15)
    assert apart[held[-1] :].max() > apart.min() + 0.01  # let go
    np.testing.assert_allclose(shown[-1].root, shown[0].root, atol=0.01)
    palms = [grips(body.skeleton, pose.rotations, pose.root)[:, :3] for pose in (shown[0], shown[-1])]
    assert np.linalg.norm(palms[1] - palms[0], axis=-1).max() < 0.03  # back where it came from
    assert worst_pop(np.array([pose.rotations for pose in shown])).degrees < 1.5


def test_it_is_refused_from_afar_while_carried_and_without_a_shape() -> None:
    body = standing("ken")
    shapeless = turning(body)
    assert shapeless.object is not None
    shapeless = msgspec.structs.replace(shapeless, object=msgspec.structs.replace(shapeless.object, shape=None))
    for start, sentence in ((shapeless, "has a shape"), (turning(body, carried=True), "standing")):
        with pytest.raises(AlgorithmError, match=sentence):
            list(frames(program("turn"), start))
    body.root = body.root + np.array([-1.5, 0.0, 0.0])
    with pytest.raises(AlgorithmError, match="too short"):
        list(frames(program("turn"), turning(body)))


def test_the_free_hand_is_used() -> None:
    body = standing("ken")
    poses = list(frames(program("turn"), turning(body, busy=["right"])))
    assert poses[-1].targets[1, 7] == 1.0
