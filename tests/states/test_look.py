"""How parts look in states, and the record in which that travels."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.errors import ProtocolError
from ahmss.states.behaviour import Appearance, Behaviour, decode_behaviour
from ahmss.states.condition import parse_condition
from ahmss.states.look import looks
from ahmss.states.state import State

TELEVISION = Behaviour(
    {"power": State("off", ("off", "on"))},
    (
        Appearance(("screen",), lit=1.0),
        Appearance(("screen", "diode"), parse_condition("power == off"), color=(10, 20, 30), lit=0.0),
        Appearance(("steam",), parse_condition("power == off"), shown=False),
    ),
)
GAUGE = Behaviour(
    {"value": State(0.0, (), 10.0, 30.0)},
    (
        Appearance(("needle",), by="value", turn=np.pi, axis=(0.0, 0.0, 2.0), pivot=(1.0, 0.0, 0.0)),
        Appearance(("needle",), move=(0.0, 0.0, 0.5)),
    ),
)


def test_the_last_word_on_colour_light_and_being_there_is_right() -> None:
    off, on = looks(TELEVISION, {"power": "off"}), looks(TELEVISION, {"power": "on"})
    assert (off["screen"].paint.color, off["screen"].paint.lit) == ((10, 20, 30), 0.0)
    assert (on["screen"].paint.color, on["screen"].paint.lit) == (None, 1.0)
    assert not off["steam"].shown
    assert on["steam"].shown
    assert on["diode"] == looks(TELEVISION, {})["diode"]


def test_a_part_turns_about_its_pivot_by_the_share_of_a_number_and_moves_add_up() -> None:
    matrix = looks(GAUGE, {"value": 20.0})["needle"].matrix
    assert matrix is not None
    np.testing.assert_allclose(matrix @ [3.0, 0.0, 0.0, 1.0], [1.0, 2.0, 0.5, 1.0], atol=1e-12)  # a quarter turn
    still = looks(GAUGE, {"value": 10.0})["needle"].matrix
    assert still is not None
    np.testing.assert_allclose(still @ [3.0, 0.0, 0.0, 1.0], [3.0, 0.0, 0.5, 1.0], atol=1e-12)


def test_a_behaviour_travels_and_what_says_nothing_is_no_asset() -> None:
    for behaviour in (TELEVISION, GAUGE):
        assert decode_behaviour(behaviour.encode()) == behaviour
    assert Behaviour().encode() == b""
    assert TELEVISION.parts == ("screen", "diode", "steam")
    assert TELEVISION.unsteady == {"steam"}
    with pytest.raises(ProtocolError, match="can't be read"):
        decode_behaviour(b'{"states": 3}')
