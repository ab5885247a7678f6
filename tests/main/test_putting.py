"""Where a thing that is put down goes: on what was said, near who puts it, beside what stands there; and how high."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from msgspec import structs

from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.errors import CommandError
from ahmss.main.afforded import Actor
from ahmss.main.command import Act
from ahmss.main.database import Database
from ahmss.main.tops import height_of_what_is_under, place_on_top

from .test_afforded import KEN, SHIPPED, Room, ken

UP = np.array([0.0, 0.0, 1.0])
CUP, TABLE = "room/cup", "room/table"
HALF = np.array([0.5, 0.6])  # of the table's top, metres


def room() -> Room:
    """The room with its cup in ken's right hand."""
    made = Room()
    made.held(CUP, "ken")
    return made


def standing(x: float, y: float, facing: float) -> Actor:
    """Ken at a place, facing so many degrees, the cup in his right hand."""
    actor = ken(room__cup="right")
    turned = multiply(from_axis_angle(UP, np.radians(facing)), actor.rotations[0])
    return replace(
        actor, root=np.array([x, y, actor.root[2]]), rotations=np.vstack([turned[None], actor.rotations[1:]])
    )


def on_table(made: Room, place: Array) -> Array:
    """A place as the table's own frame has it."""
    pose = made.pose(TABLE)
    return rotate(pose[3:] * [1.0, -1.0, -1.0, -1.0], place - pose[:3])


@pytest.mark.parametrize(("side", "facing"), [((-0.77, 0.0), 0.0), ((0.77, 0.1), 180.0), ((0.0, 0.87), -90.0)])
@pytest.mark.parametrize("turned", [0.0, 40.0])
def test_a_cup_goes_onto_the_near_part_of_the_table_wherever_one_stands(
    side: tuple[float, float], facing: float, turned: float
) -> None:
    made = room()
    table = made.placed[TABLE]
    turn = from_axis_angle(UP, np.radians(turned))
    made.placed[TABLE] = structs.replace(table, rotation=tuple(turn.tolist()))
    x, y = (made.pose(TABLE)[:3] + rotate(turn, np.array([*side, 0.0])))[:2]
    place = place_on_top(SHIPPED, made, CUP, TABLE, standing(x, y, facing + turned), "right")
    inside = on_table(made, place)
    assert inside[2] == pytest.approx(0.88)
    assert (np.abs(inside[:2]) < HALF - 0.036 - 0.05).all()
    assert np.hypot(*(place[:2] - (x, y))) < 0.5
    assert np.hypot(*(inside[:2] - side)) < np.hypot(*side)  # on this side of the middle


def test_the_hand_that_holds_it_says_on_which_side_of_one_it_is_put() -> None:
    made, actor = room(), standing(0.0, 0.2, 0.0)
    right = place_on_top(SHIPPED, made, CUP, TABLE, actor, "right")
    left = place_on_top(SHIPPED, made, CUP, TABLE, actor, "left")
    assert left[1] - right[1] == pytest.approx(0.36, abs=0.05)


def test_it_is_put_beside_what_stands_there_already() -> None:
    made, actor = room(), standing(0.0, 0.2, 0.0)
    free = place_on_top(SHIPPED, made, CUP, TABLE, actor, "right")
    made.objects["other"] = structs.replace(made.objects[CUP], name="other", holder="", hand="")
    made.placed["other"] = structs.replace(made.placed[CUP], name="other", position=tuple(free.tolist()))
    beside = place_on_top(SHIPPED, made, CUP, TABLE, actor, "right")
    assert 0.12 < np.hypot(*(beside - free)[:2]) < 0.17
    made.placed["other"] = structs.replace(made.placed["other"], position=(*free[:2].tolist(), 0.0))  # under the table
    np.testing.assert_allclose(place_on_top(SHIPPED, made, CUP, TABLE, actor, "right"), free)


def test_what_is_full_or_has_no_top_says_so() -> None:
    made, actor = room(), standing(0.0, 0.2, 0.0)
    with pytest.raises(CommandError, match=r"room/chair has no top .*; say a place: to X Y Z"):
        place_on_top(SHIPPED, made, CUP, "room/chair", actor, "right")
    middle = made.pose(TABLE)[:3]
    for i in range(9):
        for j in range(11):
            name = f"cup{i}_{j}"
            made.objects[name] = structs.replace(made.objects[CUP], name=name, holder="", hand="")
            at = middle + np.array([0.11 * (i - 4), 0.11 * (j - 5), 0.88])
            made.placed[name] = structs.replace(made.placed[CUP], name=name, position=tuple(at.tolist()))
    with pytest.raises(CommandError, match="there is no room left on room/table"):
        place_on_top(SHIPPED, made, CUP, TABLE, actor, "right")


def test_a_height_that_is_left_out_is_that_of_what_is_under_the_place() -> None:
    made = room()
    assert height_of_what_is_under(SHIPPED, made, CUP, (0.6, 0.3)) == pytest.approx(0.88)
    assert height_of_what_is_under(SHIPPED, made, CUP, (-0.5, 0.3)) == 0.0


def test_the_line_that_was_typed_has_the_place_in_its_goal() -> None:
    made, actor, database = room(), standing(0.0, 0.2, 0.0), Database(SHIPPED)
    onto = database.order(Act("cup", "put", goal_object="table"), made, actor).goal.place
    np.testing.assert_allclose(onto, place_on_top(SHIPPED, made, CUP, TABLE, actor, "right"))
    assert database.order(Act("cup", "put", goal_place=(0.6, 0.3)), made, actor).goal.place == (0.6, 0.3, 0.88)
    assert database.order(Act("cup", "put", goal_place=(0.6, 0.3, 1.0)), made, actor).goal.place == (0.6, 0.3, 1.0)


def test_what_is_grasped_is_reached_for_first_by_whose_hand_is_not_there() -> None:
    made, database = Room(), Database(SHIPPED)
    far = replace(ken(), root=np.array([0.0, -0.15, ken().root[2]]))
    orders = database.orders([Act("cup", "grasp", hand="left", after=7, frames=40)], made, far)
    assert [(order.title, order.hand, order.after, order.act.follows) for order in orders] == [
        ("room/cup reach", "left", 7, False), ("room/cup grasp", "left", 0, True),
    ]  # fmt: skip
    assert orders[1].frames == 40
    said = database.orders([Act("cup", "reach"), Act("cup", "grasp", follows=True)], made, far)
    assert [order.affordance.name for order in said] == ["reach", "grasp"]


def test_a_hand_that_is_there_already_does_not_reach_again() -> None:
    made, database = Room(), Database(SHIPPED)
    rotations, root = KEN.upright()
    palm = grips(KEN, rotations, root)[0, :3]
    made.placed["room/cup"] = structs.replace(
        made.placed["room/cup"], position=tuple((palm + np.array([0.05, 0.0, -0.05])).tolist())
    )
    assert [order.affordance.name for order in database.orders([Act("cup", "grasp")], made, ken())] == ["grasp"]


def beside(made: Room, x: float, y: float, kind: str = CUP, height: float = 0.88) -> None:
    """Another thing of a kind at a place."""
    made.objects["two"] = structs.replace(made.objects[kind], name="two", holder="", hand="")
    made.placed["two"] = structs.replace(made.placed[kind], name="two", position=(x, y, height))


@pytest.mark.parametrize("off", [(0.0, 0.0), (0.05, 0.0), (0.03, -0.05)])
@pytest.mark.parametrize(("x", "y", "height"), [(0.42, 0.2, 0.88), (-0.8, 0.6, 0.0)])
def test_it_is_not_put_into_what_stands_there_but_told_where_there_is_room(
    off: tuple[float, float], x: float, y: float, height: float
) -> None:
    """A cup was put into another, which was lifted out."""
    made, actor, database = room(), standing(0.0, 0.2, 0.0), Database(SHIPPED)
    beside(made, x, y, height=height)
    order = database.order(Act("cup", "put", goal_place=(x + off[0], y + off[1])), made, actor)
    with pytest.raises(CommandError, match=r"room/cup put: two stands there; there is room at -?\d\.\d\d") as told:
        database.check(order, made, actor)
    said = str(told.value).partition("room at ")[2].partition(",")[0].split()
    free = float(said[0]), float(said[1])
    assert 0.072 + 0.025 < np.hypot(free[0] - x, free[1] - y) < 0.16
    database.check(database.order(Act("cup", "put", goal_place=free), made, actor), made, actor)


def test_who_puts_it_over_beside_or_under_what_stands_there_is_let() -> None:
    made, actor, database = room(), standing(0.0, 0.2, 0.0), Database(SHIPPED)
    beside(made, 0.42, 0.2)
    for place in ((0.42, 0.2, 0.98), (0.5, 0.2), (0.42, 0.2, 0.0)):
        database.check(database.order(Act("cup", "put", goal_place=place), made, actor), made, actor)


def test_what_stands_on_the_floor_is_not_put_into_either() -> None:
    made, actor, database = room(), standing(0.0, 0.2, 0.0), Database(SHIPPED)
    chair = made.pose("room/chair")
    order = database.order(Act("cup", "put", goal_place=(float(chair[0]), float(chair[1]))), made, actor)
    with pytest.raises(CommandError, match="room/chair stands there"):
        database.check(order, made, actor)


def carrying(x: float, y: float, facing: float) -> tuple[Room, Actor]:
    """Ken at a place in the control room, facing so many degrees, with a carton between both hands."""
    made, actor = Room(kind="control_room"), ken(frozenset({"carton"}), carton="right")
    turned = from_axis_angle(UP, np.radians(facing))
    hips = multiply(turned, actor.rotations[0])
    actor = replace(actor, root=np.array([x, y, actor.root[2]]), rotations=np.vstack([hips[None], actor.rotations[1:]]))
    place = np.array([x, y, 0.82]) + rotate(turned, np.array([0.3, 0.0, 0.0]))
    like = "control_room/panel"
    made.objects["carton"] = structs.replace(
        made.objects[like], name="carton", kind="carton", id=999, holder="ken", hand="right", parent="", states={}
    )
    made.placed["carton"] = structs.replace(
        made.placed[like], name="carton", kind="carton", position=tuple(place.tolist()),
        rotation=tuple(turned.tolist()), parent="",
    )  # fmt: skip
    return made, actor


@pytest.mark.parametrize(("x", "y", "facing"), [(1.1, 0.0, 0.0), (1.1, 0.6, 0.0), (1.25, 0.3, -20.0)])
def test_a_carton_is_not_put_down_into_a_panel_but_told_from_where_there_is_room(
    x: float, y: float, facing: float
) -> None:
    """It was laid into the panel's foot."""
    made, actor = carrying(x, y, facing)
    database = Database(SHIPPED)
    order = database.order(Act("carton", "put_down"), made, actor)
    with pytest.raises(CommandError, match=r"carton put_down: control_room/panel.* stands there; step back") as told:
        database.check(order, made, actor)
    words = str(told.value).partition("walk to ")[2].rstrip("`").split()
    made, actor = carrying(float(words[0]), float(words[1]), float(words[3]))
    database.check(order, made, actor)
    assert 0.04 < np.hypot(float(words[0]) - x, float(words[1]) - y) < 0.5


def test_a_carton_is_put_down_where_there_is_room_and_not_through_a_table() -> None:
    database = Database(SHIPPED)
    made, actor = carrying(0.0, 0.0, 90.0)
    order = database.order(Act("carton", "put_down"), made, actor)
    database.check(order, made, actor)
    beside = made.placed["control_room/panel"]
    made.objects["table"] = structs.replace(made.objects["control_room/panel"], name="table", kind="table", id=998)
    made.placed["table"] = structs.replace(beside, name="table", kind="table", position=(0.0, 0.9, 0.0))
    with pytest.raises(CommandError, match="carton put_down: table stands there"):
        database.check(order, made, actor)
