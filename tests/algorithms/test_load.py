"""Who carries a carton between both hands comes to stand where it is in nothing, and has room where it is put down."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from ahmss.algorithm import HumanTask
from ahmss.algorithm.messages import Goal
from ahmss.algorithm.place import Transform, WorldObject
from ahmss.body.array import Array
from ahmss.skills.box import filled
from ahmss.skills.load import load_of

from .devices import at, begun, device
from .scene import Body, program
from .test_keeping import PANEL, WALKS, bearing, numbered

CORNERS = np.array(list(itertools.product((-0.14, 0.14), (-0.18, 0.0, 0.18), (0.0, 0.28))))
BUSY = {"busy": ["left", "right"], "held": {"right": 21, "left": 21}}


def in_panel(body: Body, in_hand: Transform, ahead: float = 0.0) -> float:
    """Metres by which the carton is in the panel, or would be so far ahead."""
    corners: Array = body.grip().then(in_hand).apply(CORNERS + np.array([ahead, 0.0, 0.0]))
    return float(max(-block.signed(corners).min() for block in filled(WorldObject.of(device("panel", PANEL)))))


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize("what", ["gauge", "stand"])
def test_a_carton_is_not_in_the_panel_before_which_one_comes_to_stand(name: str, what: str) -> None:
    """It was, with a hand, as one who carries it looked at a gauge beside the panel, and went to the panel."""
    body, carton = bearing(name, (0.2, 0.9, 0.0))
    in_hand = body.grip().inverse().then(WorldObject.of(carton).frame)
    gauge, panel = device("gauge", at(2.19, 0.6, 1.55, np.pi)), numbered(device("panel", PANEL), 20)
    if what == "gauge":
        start = begun(body, gauge, "face", {}, motion=WALKS, world=[panel, carton], **BUSY)
        body.do(program("check"), start)
    else:
        goal = Goal(place=panel.place, object=panel)
        body.do("walk", begun(body, None, "", {}, motion=WALKS, world=[panel, carton], goal=goal, **BUSY))
    assert np.linalg.norm(body.root[:2] - [1.25, 0.35]) < 0.6
    assert in_panel(body, in_hand) < -0.02
    assert in_panel(body, in_hand, 0.1) < 0.0


def test_what_one_hand_holds_is_no_load() -> None:
    body, carton = bearing("ken", (0.0, 0.0, 0.0))
    start = begun(body, None, "", {}, world=[carton], busy=["right"], held={"right": 21})
    assert load_of(HumanTask(start)) is None
