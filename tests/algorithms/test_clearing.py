"""What keeps hands clear of neighbours: where they are set, how near they come, what is said where there is no way."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.algorithm import HumanTask, Transform
from ahmss.errors import AlgorithmError
from ahmss.skills.clearing import gap_of, offs, refuse_touching
from ahmss.skills.controls import beside

from .layouts import Control, Layout, about_z
from .scene import Body


def test_a_hand_is_set_straight_before_a_part_first_then_farther_then_aslant_along_its_sides() -> None:
    site = Transform(np.array([1.0, 2.0, 1.2]), about_z(0.5))
    own = [Transform(np.zeros(3), site.rotation).inverse().apply(off) for off in offs(site)]
    np.testing.assert_allclose(own[:2], [[-0.07, 0.0, 0.0], [-0.12, 0.0, 0.0]], atol=1e-12)
    assert len(own) == 6
    assert all(off[0] < -0.05 for off in own)
    assert max(abs(off[2]) for off in own) < 1e-12  # thumb and fingers close along z
    assert {float(np.sign(off[1])) for off in own[2:]} == {-1.0, 1.0}


def touching(away: float) -> tuple[HumanTask, Body]:
    """Who has the right palm before a gauge's face, or farther before it, a switch a hand's width beside it."""
    body = Body("ken")
    palm = body.grip()
    gauge = Control(2, "gauge", Transform(palm.place - np.array([0.02 + away, 0.0, 0.0]), about_z(0.0)))
    switch = Control(1, "rotary_switch", Transform(palm.place + np.array([0.0, 0.3, 0.0]), about_z(0.0)))
    return HumanTask(Layout((switch, gauge)).start(switch, body, "turn", parameters={})), body


def test_the_neighbour_that_a_hand_would_be_in_is_named_with_how_deep() -> None:
    task, body = touching(0.0)
    shown = body.rotations[None], body.root[None]
    assert gap_of(task, "right", *shown, beside(task)) < -0.002
    assert gap_of(task, "left", *shown, beside(task)) > 0.05
    with pytest.raises(AlgorithmError, match=r"panel/gauge_2 is in the way of a hand at panel/rotary_switch_1, .* mm"):
        refuse_touching(task, "right", *shown, beside(task))
    refuse_touching(task, "left", *shown, beside(task))


def test_who_is_clear_of_it_is_not_refused() -> None:
    task, body = touching(0.5)
    shown = body.rotations[None], body.root[None]
    assert gap_of(task, "right", *shown, beside(task)) > 0.05
    refuse_touching(task, "right", *shown, beside(task))
