"""A console like a low table: who steps along it to another button has hands that hang before its edge."""

from __future__ import annotations

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import Transform
from ahmss.body.quaternion import from_axis_angle

from .devices import at, begun, device
from .layouts import used
from .scene import WORKSPACE, Body
from .solids import deepest

CONSOLE = at(-0.81, -0.13, 0.0)
BLOCKS = [  # lowest and highest corners: a plate that slopes by 8 degrees, 0.81 m high in front
    [[-0.5245, -0.26, 0.0], [0.0, 0.26, 0.8086]], [[-0.0989, -0.26, 0.8086], [0.0, 0.26, 0.8586]],
    [[-0.1978, -0.26, 0.8086], [-0.0989, 0.26, 0.872]], [[-0.2967, -0.26, 0.8086], [-0.1978, 0.26, 0.8854]],
    [[-0.5245, -0.26, 0.8086], [-0.2967, 0.26, 0.8988]],
]  # fmt: skip
WALKS = str(WORKSPACE.objects.get("latching_button").affordances["press"].motion)


@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_hands_that_hang_before_its_edge_do_not_come_up_through_it(name: str) -> None:
    flat = from_axis_angle(np.array([0.0, 1.0, 0.0]), np.radians(-82.3))
    button = device("latching_button", CONSOLE.then(Transform(np.array([-0.4241, -0.091, 0.916]), flat)))
    console = msgspec.structs.replace(
        device("panel", CONSOLE), id=20, name="console", properties={"size": [0.52, 0.52, 0.9], "blocks": BLOCKS},
        footprint=[[(-0.5245, -0.26), (0.0, -0.26), (0.0, 0.26), (-0.5245, 0.26)]],
    )  # fmt: skip
    body = Body(name, -0.544, -0.172, 180.0)
    done = used(body, begun(body, button, "face", {}, motion=WALKS, world=[console]), "press")
    walls = [(a[0], b[0], a[1], b[1], a[2], b[2]) for a, b in BLOCKS]
    assert max(deepest(name, pose, CONSOLE, walls)[0] for pose in done.shown[::2]) < 0.002
