"""What was brought to its place and is not let go of is told, with how to let go."""

from __future__ import annotations

import msgspec
import pytest

from ahmss.main.command import Act, Do, Wait, parse
from ahmss.main.database import Database
from ahmss.main.kept import is_about, still_in_hand
from tests.main.test_afforded import SHIPPED, Room, ken

PUT = Act("room/cup", "put", goal_place=(0.42, -0.15, 0.88))


@pytest.mark.parametrize(("holder", "said"), [("ken", True), ("aiko", False), ("", False)])
def test_a_cup_that_is_put_stays_in_the_hand_until_it_is_released(holder: str, said: bool) -> None:
    workspace = SHIPPED
    room = Room()
    held = ken(room__cup="right")
    order = Database(workspace).order(PUT, room, held)
    cup = msgspec.structs.replace(room.objects["room/cup"], holder=holder, hand="right" if holder else "")
    told = still_in_hand([order, order], {"room/cup": cup}, "ken", workspace)
    sentence = "room/cup put: room/cup is in the right hand still; `do room/cup release` lets go of it"
    assert told == ([sentence] if said else [])


@pytest.mark.parametrize(
    ("line", "so"),
    [("do cup release", True), ("do room/cup release", True), ("do up release", False), ("do tap turn", False),
     ("do tap turn with cup release", True), ("wait 1", False)],
)  # fmt: skip
def test_nothing_is_said_of_what_is_let_go_next(line: str, so: bool) -> None:
    read = parse(line)
    assert isinstance(read, (Do, Wait))
    assert is_about(read, "room/cup") is so
    assert not is_about(None, "room/cup")
