"""A console as high as a shoulder, its plate flat: who leans over it dips no shoulder into it, and comes far in."""

from __future__ import annotations

from functools import cache

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import Transform, WorldObject
from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.quaternion import from_axis_angle
from ahmss.reaching.goal import Goal
from ahmss.reaching.leaning import Stretch
from ahmss.reaching.path import curves
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.prism import clearance
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.skin import bare_arm
from ahmss.skills.box import filled
from ahmss.skills.by_fingertip import Touching

from .devices import at, begun, device
from .layouts import Used, used
from .scene import WORKSPACE, Body

BLOCKS = [  # a plate that slopes by 10 degrees, 1.25 m high in front and 1.33 m at its back, on its foot
    {"outline": [[-0.52, 0.0], [-0.2, 0.0], [-0.02, 1.197], [-0.52, 1.197]], "y": [-0.4875, 0.4875]},
    {
        "outline": [[-0.52, 1.197], [-0.02, 1.197], [0.0, 1.247], [-0.491, 1.333], [-0.52, 1.333]],
        "y": [-0.4875, 0.4875],
    },
]
RING = [(-0.52, -0.4875), (0.0, -0.4875), (0.0, 0.4875), (-0.52, 0.4875)]
WALKS = str(WORKSPACE.objects.get("push_button").affordances["press"].motion)
CONSOLE = msgspec.structs.replace(
    device("panel", at(0.0, 0.0, 0.0)), id=20, name="console", footprint=[RING],
    properties={"size": [0.52, 0.975, 1.333], "blocks": BLOCKS},
)  # fmt: skip
OUT = from_axis_angle(np.array([0.0, 1.0, 0.0]), np.radians(-80.0))


@cache
def pressed(name: str, place: tuple[float, float, float], stands: tuple[float, float, float]) -> Used:
    button = device("push_button", Transform(np.array(place), OUT))
    body = Body(name, *stands)
    return used(body, begun(body, button, "face", {}, motion=WALKS, world=[CONSOLE]), "press")


@pytest.mark.parametrize(
    ("name", "place", "stands"),
    [("ken", (-0.418, -0.318, 1.328), (0.3, 0.1, 180.0)), ("aiko", (-0.38, 0.325, 1.318), (0.5, 0.0, 180.0))],
)
def test_who_leans_over_it_has_neither_arm_in_it(
    name: str, place: tuple[float, float, float], stands: tuple[float, float, float]
) -> None:
    """The shoulder of the arm that hangs was 23 mm in the plate's edge."""
    done = pressed(name, place, stands)
    rotations, root = (np.array([getattr(pose, field) for pose in done.shown]) for field in ("rotations", "root"))
    for side in ("right", "left"):
        points, radii = bare_arm(Reacher.of(done.body.skeleton, side), rotations, root)
        assert float((clearance(filled(WorldObject.of(CONSOLE)), points) - radii).min()) > -0.004, side


def test_a_finger_that_is_set_short_of_where_it_is_to_be_set_comes_straight_to_what_it_touches() -> None:
    """Over a high plate an arm may come to a button, and not to where the finger is set over it: it was refused."""
    body, up = Body("ken"), np.array([0.0, 0.0, 1.0])
    reaching, reacher = Reaching(body.skeleton, body.rotations, body.root), Reacher.of(body.skeleton, "right")
    shoulder = reacher.shoulder(seat(body.skeleton, body.rotations, body.root))
    face, off = shoulder + np.array([0.5, 0.0, 0.25]), 0.035 * up
    wrist = shoulder + 0.97 * reacher.length * np.array([0.8, 0.0, 0.6])
    palm = np.array([*wrist, 1.0, 0.0, 0.0, 0.0])
    palm[:3] += wrist - reacher.hand(palm)[0]
    depths = np.concatenate([np.linspace(0.0, 0.04, 21), np.linspace(0.04, -0.06, 51)])

    def way(palm: Array) -> Array:
        return np.concatenate([palm[:3] - depths[:, None] * up, np.tile(palm[3:], (len(depths), 1))], axis=1)

    touching = Touching(Goal(face, palms={"right": palm[None]}), off, up, face, way, ())
    over = np.concatenate([palm[:3] + off, palm[3:]])
    set_at = reaching.in_reach(reacher, reaching.start, over, face)
    short = float(np.linalg.norm((set_at - over)[:3]))
    assert short > 0.003
    hands = grips(body.skeleton, body.rotations, body.root)
    plan = Plan(
        reacher, None, reaching.start, reaching.start, hands, set_at, curves(hands[0], set_at, reaching.heading)[0],
        Stretch(0.0, True, 0.0, 0.9), 0.0, (), short=short,
    )  # fmt: skip
    goes, straight = touching.course(reaching, plan), way(over)
    np.testing.assert_allclose(goes[0], set_at, atol=1e-9)
    near = depths > 0.025  # the last centimetre before the face, and in it
    np.testing.assert_allclose(goes[near], straight[near], atol=1e-9)
    back = goes[depths < 0.0]  # and no farther than the arm comes
    np.testing.assert_allclose(reaching.in_reach(reacher, reaching.start, back, face), back, atol=1e-9)
    assert touching.meant(plan).short == 0.0
    assert touching.lacks(reaching, plan) == pytest.approx(0.0, abs=1e-9)
