"""What can't be used from where one stands is used from elsewhere, before it is refused."""

from __future__ import annotations

import msgspec
import numpy as np

from ahmss.algorithm import Transform
from ahmss.algorithm.messages import ObjectRecord

from .layouts import Control, Layout, used
from .scene import WORKSPACE, Body

PLACED = [one for one in WORKSPACE.objects.place("panel", "panel") if one.kind != "panel"]
PANEL = Layout(
    tuple(
        Control(i, one.kind, Transform(np.array(one.position), np.array(one.rotation)))
        for i, one in enumerate(PLACED, 1)
    )
)
SWITCH = next(one for one, placed in zip(PANEL.controls, PLACED, strict=True) if placed.name == "panel/switch_3")
FROM, TO = {"position": "low", "turn": 0.7854}, {"along": 0.6, "position": "off"}
SOMEBODY = ObjectRecord(-9, "somebody", "human", (0.316, 0.094, 0.0), (1.0, 0.0, 0.0, 0.0))
"""They stand before the middle of the panel, so that nobody else stands straight before the switch."""


def test_a_switch_that_the_hand_can_not_turn_from_here_is_turned_from_elsewhere() -> None:
    """From here the arm is stretched out and brings the hand into its neighbours, whichever it is."""
    body = Body("ken", 0.4988, -0.4529, 177.325)
    start = PANEL.start(SWITCH, body, "turn", FROM, parameters=TO)
    begun = body.root.copy()
    done = used(body, msgspec.structs.replace(start, world=[*start.world, SOMEBODY]), "turn")
    went = done.shown[-1].root[:2]
    assert np.linalg.norm(went - begun[:2]) > 0.1
    assert np.linalg.norm(went - np.array(SOMEBODY.place[:2])) > 0.5
    assert done.nearest(PANEL.others(SWITCH)) > -0.002
    assert len(done.shown) < 1200  # of which who looked for ways that could not serve stood there for thousands
