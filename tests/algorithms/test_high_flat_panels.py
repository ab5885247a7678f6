"""A console as high as a shoulder, its plate nearly flat: an arm reaches over it, and through no edge of it."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import HumanTask, Transform, WorldObject
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, multiply
from ahmss.reaching.prism import clearance
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import bare_arm
from ahmss.skills.arm_clear import sunk_in
from ahmss.skills.box import filled

from .devices import at, begun, device
from .layouts import used
from .scene import WORKSPACE, Body

BLOCKS = [  # a plate that slopes by 13 degrees, 1.13 m high in front and 1.25 m at its back, on its foot
    {"outline": [[-0.52, 0.0], [-0.2, 0.0], [-0.02, 1.08], [-0.52, 1.08]], "y": [-0.44, 0.44]},
    {"outline": [[-0.52, 1.08], [-0.02, 1.08], [0.0, 1.13], [-0.49, 1.246], [-0.52, 1.246]], "y": [-0.44, 0.44]},
]
RING = [(-0.52, -0.44), (0.0, -0.44), (0.0, 0.44), (-0.52, 0.44)]
WALKS = str(WORKSPACE.objects.get("push_button").affordances["press"].motion)
X, Y = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])


@pytest.mark.parametrize(
    ("name", "place", "rolled"),
    [
        ("aiko", (-0.425, -0.284, 1.234), 5.1), ("aiko", (-0.45, 0.27, 1.240), 0.0),
        ("ken", (-0.42, 0.357, 1.233), -8.0),
    ],
)  # fmt: skip
def test_the_arm_of_who_presses_far_in_it_is_in_nothing(
    name: str, place: tuple[float, float, float], rolled: float
) -> None:
    """It was up to 78 mm in the plate, which is used from its side."""
    turn = multiply(from_axis_angle(Y, np.radians(-77.0)), from_axis_angle(X, np.radians(rolled)))
    console = msgspec.structs.replace(
        device("panel", at(0.0, 0.0, 0.0)), id=20, name="console", footprint=[RING],
        properties={"size": [0.52, 0.88, 1.25], "blocks": BLOCKS},
    )  # fmt: skip
    button = device("push_button", Transform(np.array(place), turn))
    body, task = Body(name, 1.145, 0.215, 183.5), {"motion": WALKS, "world": [console]}
    done = used(body, begun(body, button, "face", {}, **task), "press")
    rotations, root = (np.array([getattr(pose, field) for pose in done.shown]) for field in ("rotations", "root"))
    for side in ("right", "left"):
        points, radii = bare_arm(Reacher.of(body.skeleton, side), rotations, root)
        assert float((clearance(filled(WorldObject.of(console)), points) - radii).min()) > -0.004, side
    pad = done.tip("index")[:, :2] - np.array(place)[:2]
    assert float(np.linalg.norm(pad, axis=-1).min()) < 0.02


def test_a_finger_in_a_plate_counts_as_the_arm_does() -> None:
    """A hand that hangs into a low box with its fingers only; it was an index finger, 25 mm in a plate."""
    body = Body("ken")
    rotations, root = body.skeleton.upright()
    fingertip = forward(rotations, root, body.skeleton.offsets)[0][INDEX["right_middle_distal"]]
    low = {"outline": [[-0.2, 0.0], [0.2, 0.0], [0.2, 1.0], [-0.2, 1.0]], "y": [-0.2, 0.2]}
    box = msgspec.structs.replace(
        device("panel", at(float(fingertip[0]), float(fingertip[1]), float(fingertip[2]) - 1.0 + 0.01)),
        id=20, name="console", properties={"size": [0.4, 0.4, 1.0], "blocks": [low]},
    )  # fmt: skip
    button = device("push_button", at(3.0, 0.0, 1.0))
    task = HumanTask(begun(body, button, "face", {}, world=[box]))
    away = np.array([[2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    deep, name = sunk_in(task, "right", np.tile(rotations, (3, 1, 1)), root + away)
    assert 0.01 < deep < 0.06
    assert name == "console"
    assert sunk_in(task, "left", np.tile(rotations, (3, 1, 1)), root + away)[0] <= 0.0


def test_a_forearm_in_a_neighbour_of_what_the_hand_is_at_counts_too() -> None:
    """A hand that came at a switch with its clearest palms had the forearm 7 mm in the lever beside it."""
    body = Body("ken")
    rotations, root = body.skeleton.upright()
    places = forward(rotations, root, body.skeleton.offsets)[0]
    elbow, wrist = (places[INDEX[f"right_{link}"]] for link in ("lower_arm", "hand"))
    x, y, z = (0.5 * (elbow + wrist)).tolist()
    small = {"box": [[-0.02, -0.02, -0.02], [0.02, 0.02, 0.02]]}
    lever = msgspec.structs.replace(device("lever", at(x, y, z)), id=20, name="lever_8", properties=small)
    switch = device("rotary_switch", at(x, y, z - 0.3))
    task = HumanTask(begun(body, switch, "knob", {}, world=[lever]))
    away = np.array([[-2.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    poses = np.tile(rotations, (3, 1, 1))
    deep, name = sunk_in(task, "right", poses, root + away)
    assert deep > 0.02
    assert name == "lever_8"
    assert sunk_in(task, "left", poses, root + away)[0] <= 0.0
    elsewhere = HumanTask(begun(body, device("rotary_switch", at(x - 2.0, y, z)), "knob", {}, world=[lever]))
    assert sunk_in(elsewhere, "right", poses, root + away)[0] <= 0.0  # what is far from the control is not beside it
