"""Levers, switches and gauges, placed and tilted at random, are used, and nothing beside them is touched."""

from __future__ import annotations

import re

import msgspec
import numpy as np
import pytest
from msgspec import UNSET

from ahmss.algorithm import frames
from ahmss.algorithm.messages import PoseRecord
from ahmss.errors import AlgorithmError

from .layouts import Control, Layout, Used, somebody, used
from .scene import program

KINDS = ("lever", "rotary_switch", "gauge")
DOES = {
    "lever": ("slide", {"level": 1.0}), "gauge": ("check", {}), "rotary_switch": ("turn", {"along": 0.6}),
}  # fmt: skip
MOVES = {"lever": ("slid", "level"), "rotary_switch": ("turned", "turn")}
COMES_TO = {"lever": 1.0, "rotary_switch": np.pi / 4}
REFUSED = re.compile(
    r"too short for it|panel/\w+ is in the way of an? (hand|arm) at panel/\w+, which would be \d+ mm in it"
)
FAST, ALL = (2, 3), (0, 1, *range(4, 50))  # in 1 a lever is tried with many a stance


def came(layout: Layout, control: Control, done: Used, begins: PoseRecord) -> float:
    """What a lever's level or a switch's turn is in the end, as the object's own algorithm has it."""
    moves, state = MOVES[control.kind]
    action, parameters = DOES[control.kind]
    own = {key: value for key, value in parameters.items() if key == "along"}
    start = layout.start(control, done.body, action, parameters=own)
    start = msgspec.structs.replace(start, kind="object", pose=begins, hand=done.side, wish=UNSET)
    value = 0.0
    for pose in frames(program(moves), start, done.body.rows(done.shown)):
        value = float((pose.states or {}).get(state, value))
    return value


def use_one_of_each(seed: int) -> None:
    layout, reached = Layout.drawn(seed, KINDS), 0
    for k, kind in enumerate(DOES):
        control = next(one for one in layout.controls if one.kind == kind)
        action, parameters = DOES[kind]
        body, before = (somebody(("ken", "aiko")[(k + seed) % 2], control, 100 * seed + k) for _ in range(2))
        try:
            done = used(body, layout.start(control, body, action, parameters=parameters), action)
        except AlgorithmError as error:
            if not REFUSED.search(str(error)):
                raise
            continue
        reached += 1
        assert done.nearest(layout.others(control)) > -0.002, kind
        if kind in COMES_TO:
            begins = PoseRecord.of(before.rotations, before.root)
            assert came(layout, control, done, begins) == pytest.approx(COMES_TO[kind], abs=0.015), kind
    assert reached >= len(DOES) - 1


@pytest.mark.parametrize("seed", FAST)
def test_a_control_anywhere_is_used_and_its_neighbours_are_left_alone(seed: int) -> None:
    use_one_of_each(seed)


@pytest.mark.long
@pytest.mark.parametrize("seed", ALL)
def test_a_control_of_any_of_many_layouts_is(seed: int) -> None:
    use_one_of_each(seed)


def test_the_layouts_have_all_kinds() -> None:
    kinds = {control.kind for seed in FAST for control in Layout.drawn(seed, KINDS).controls}
    assert kinds == set(KINDS)
    assert np.unique([control.frame.place for control in Layout.drawn(0, KINDS).controls], axis=0).shape[0] == 40
