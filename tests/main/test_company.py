"""Humans are objects: named, listed with what they afford to whom, with sites that go where their bodies go."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec import UNSET

from ahmss.algorithm.messages import Start as StartMessage
from ahmss.algorithm.task import HumanTask
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.errors import CommandError
from ahmss.main.answering import Answering
from ahmss.main.catalogue import WorldCatalogue
from ahmss.main.command import Act
from ahmss.main.company import MovingSites, numbers
from ahmss.main.naming import find_object
from ahmss.main.order import Order
from ahmss.main.process import MainProcess, Setup
from ahmss.port import schema
from ahmss.world.process import ServerProcess
from tests.main.ground import steps

ROOT = Path(__file__).resolve().parents[2]
Serve = Callable[..., ServerProcess]
MINE = {"nod", "shake_head", "bow", "wave", "shrug", "thumbs_up", "think"}


@pytest.fixture
def pair(server: Serve, pool: None) -> Iterator[tuple[MainProcess, MainProcess]]:
    """Ken and aiko in the shipped workspace, face to face; each knows of the other."""
    address = server().address
    mains = [
        MainProcess(Setup(name, body=name, place=(x, 0.0), facing_deg=facing, server=address, workspace=ROOT), print)
        for name, x, facing in (("ken", 0.0, 0.0), ("aiko", 1.1, 180.0))
    ]
    ken, aiko = mains
    go_on(mains, lambda: "aiko" in ken.communication.objects and "ken" in aiko.communication.objects)
    yield ken, aiko
    for main in mains:
        main.close()


def go_on(mains: list[MainProcess], done: Callable[[], bool], seconds: float = 30.0) -> None:
    end = time.monotonic() + seconds
    while not done():
        assert time.monotonic() < end, [main.report.messages for main in mains]
        for main in mains:
            main.frame()
        time.sleep(0.004)


def listed(main: MainProcess, name: str) -> set[str]:
    return set(WorldCatalogue(main.workspace, main.communication, lambda: main.actor).actions(name).names)


def start_of(main: MainProcess, action: str, name: str = "aiko") -> StartMessage:
    database, scene = main.database, main.communication
    return database.start(database.order(Act(name, action), scene, main.actor), "human", scene, main.actor, 1, 60.0)


def test_an_algorithm_is_told_whether_it_is_about_oneself(pair: tuple[MainProcess, MainProcess]) -> None:
    ken, _ = pair
    told = {name: start_of(ken, "bow", name).object for name in ("ken", "aiko")}
    assert {name: thing.states.get("oneself") for name, thing in told.items() if thing is not None} == {
        "ken": "yes", "aiko": None,
    }  # fmt: skip


def test_an_algorithm_is_told_what_each_hand_holds(pair: tuple[MainProcess, MainProcess]) -> None:
    ken, _ = pair
    ken.play(steps("add cup as mug at 0.3 0.5 0.8", "add chair at -2 0 0"))
    number, scene = ken.communication.objects["mug"].id, ken.communication
    actor = replace(ken.actor, holds={"mug": "left", "chair": ""})
    start = ken.database.start(ken.database.order(Act("ken", "bow"), scene, actor), "human", scene, actor, 1, 60.0)
    assert start.held == {"left": number}
    assert start.busy == ["left"]


def test_an_algorithm_is_told_which_full_hands_a_motion_made_with_it_leads(
    pair: tuple[MainProcess, MainProcess], monkeypatch: pytest.MonkeyPatch
) -> None:
    ken, _ = pair
    start, told = ken.database.start, dict[str, StartMessage]()

    def started(order: Order, *given: Any, **named: Any) -> StartMessage:
        told[order.title] = start(order, *given, **named)
        return told[order.title]

    ken.play(steps("add cup as mug at 0.4 -0.2 0.9", "do mug grasp hand right"))
    assert ken.actor.holds == {"mug": "right"}
    monkeypatch.setattr(ken.database, "start", started)
    ken.play(steps("do ken nod with mug carry"))
    assert told["ken nod"].led == told["ken nod"].busy == ["right"]
    assert told["mug carry"].led is UNSET
    ken.play(steps("do ken nod"))
    assert told["ken nod"].led is UNSET


def test_nobody_goes_to_themselves(pair: tuple[MainProcess, MainProcess]) -> None:
    ken, _ = pair
    ken.play(steps("add floor"))
    database, scene = ken.database, ken.communication
    with pytest.raises(CommandError, match="floor walk: ken is oneself; name a place, or somebody else"):
        database.order(Act("floor", "walk", goal_object="ken"), scene, ken.actor)
    goal = database.order(Act("floor", "walk", goal_object="aiko"), scene, ken.actor).goal.object
    assert goal is not None
    assert goal.name == "aiko"


def test_humans_are_listed_among_the_objects_with_what_they_afford(pair: tuple[MainProcess, MainProcess]) -> None:
    ken, aiko = pair
    catalogue = WorldCatalogue(ken.workspace, ken.communication, lambda: ken.actor)
    assert dict(catalogue.objects().entries) == {
        "ken": "A person. (holds nothing)", "aiko": "A person. (holds nothing)",
    }  # fmt: skip
    assert listed(ken, "ken") == listed(aiko, "aiko") == MINE
    assert listed(ken, "aiko") == MINE | {"look", "talk", "point_out"}
    assert "human" not in catalogue.kinds().names
    assert find_object(ken.communication, "aiko") == "aiko"
    with pytest.raises(CommandError, match="did you mean aiko"):
        find_object(ken.communication, "aika")
    with pytest.raises(CommandError, match="is no place; a place is X Y or X Y Z"):
        find_object(ken.communication, "1 2 -3 0.4")
    with pytest.raises(CommandError, match=r"is a place, and was given as a name; give it as numbers, .*: to 0.2 -0.9"):
        find_object(ken.communication, "0.2 -0.9")


def test_what_is_held_changes_what_is_afforded_and_to_whom(pair: tuple[MainProcess, MainProcess]) -> None:
    ken, aiko = pair
    ken.agenda.add(steps("add cup at 0.4 -0.2 1")[0])
    go_on([ken, aiko], lambda: "cup" in ken.communication.objects and "cup" in aiko.communication.objects)
    ken.communication.client.claim("ken", ["cup"], "right")
    go_on([ken, aiko], lambda: aiko.communication.objects["ken"].states["holds"] == "something")
    assert "receive" in listed(aiko, "ken")
    assert "hand_over" not in listed(aiko, "ken")  # her hands are empty
    assert "grasp" not in listed(aiko, "cup")
    assert "receive" not in listed(ken, "aiko")
    with pytest.raises(StopIteration) as accepted:  # and a mind may ask for it, though the cup itself affords none
        next(Answering(aiko).answer(schema.Do(line="do ken receive", request=1)))
    assert isinstance(accepted.value.value, schema.Accepted)


@pytest.mark.parametrize(("height", "who"), [(0.88, {"ken", "aiko"}), (1.8, {"ken"}), (2.1, set())])
def test_the_top_shelf_affords_nothing_to_a_short_operator(
    pair: tuple[MainProcess, MainProcess], height: float, who: set[str]
) -> None:
    ken, aiko = pair
    ken.agenda.add(steps(f"add cup at 0.5 0.4 {height}")[0])
    go_on([ken, aiko], lambda: all("cup" in main.communication.objects for main in pair))
    for main in pair:
        assert ({"reach", "grasp"} <= listed(main, "cup")) == (main.setup.human in who)
    if "aiko" not in who:
        aiko.agenda.add(steps("do cup reach")[0])
        go_on([ken, aiko], lambda: aiko.agenda.done)
        assert f"cup reach: it is {height + 0.052:.2f} m high there; aiko reaches 1.78 m" in aiko.report.messages[-1]


def test_sites_go_where_the_body_goes(pair: tuple[MainProcess, MainProcess]) -> None:
    ken, aiko = pair
    start = start_of(ken, "wave")
    task = HumanTask(start)
    assert task.object is not None
    skeleton = aiko.blending.skeleton
    for turn in (0, 1):
        if turn:
            aiko.agenda.add(steps("do aiko think frames 600")[0])
            go_on([ken, aiko], lambda: aiko.report.frames > 200 and aiko.blending.grips[0, 2] > 1.2)
        body = ken.communication.body("aiko")
        places, world = forward(body.rotations, body.root, skeleton.offsets)
        head = INDEX["head"]
        eyes = places[head] + rotate(world[head], skeleton.eye)
        rows = MovingSites(ken.workspace).rows(ken.communication.poses(["aiko"]))
        assert {int(row[0]) for row in rows} <= set(numbers(start))
        row = np.concatenate([task.start.row, rows.ravel()])
        row[0] = turn + 1
        task.see(row)
        seen = task.object.site("eyes", task.start.root)
        np.testing.assert_allclose(seen.place, eyes, atol=1e-6)
        np.testing.assert_allclose(rotate(seen.rotation, np.eye(3)[0]), rotate(world[head], -np.eye(3)[2]), atol=1e-6)
        palm = task.object.site("right_hand", task.start.root)
        assert np.linalg.norm(palm.place - aiko.blending.grips[0, :3]) < 0.02
    stand = task.object.site("stand", task.start.root)
    np.testing.assert_allclose(stand.place[:2], [0.05, 0.0], atol=0.02)  # before her, facing her
    np.testing.assert_allclose(rotate(stand.rotation, np.eye(3)[0]), [1.0, 0.0, 0.0], atol=1e-3)


def test_an_algorithm_looks_at_who_walks(pair: tuple[MainProcess, MainProcess]) -> None:
    ken, aiko = pair
    ken.agenda.add(steps("do aiko look frames 400")[0])
    aiko.agenda.add(steps("add floor")[0])
    go_on([ken, aiko], lambda: aiko.agenda.done)
    aiko.agenda.add(steps("do floor walk to 1.2 1.3")[0])
    go_on([ken, aiko], lambda: aiko.agenda.done)
    go_on([ken, aiko], lambda: ken.report.frames > 200)
    places, world = forward(ken.blending.rotations, ken.blending.root, ken.blending.skeleton.offsets)
    ahead = rotate(world[INDEX["head"]], np.array([0.0, 0.0, -1.0]))
    bearing = np.arctan2(*(aiko.blending.root - places[INDEX["head"]])[1::-1])
    assert np.degrees(abs(np.arctan2(ahead[1], ahead[0]) - bearing)) < 8.0
    assert ken.report.messages == []


def test_who_leaves_is_not_waved_to_any_more(pair: tuple[MainProcess, MainProcess]) -> None:
    ken, aiko = pair
    ken.agenda.add(steps("do aiko look frames 6000")[0])
    go_on([ken, aiko], lambda: ken.control.busy)
    aiko.communication.client.leave("aiko")
    go_on([ken], lambda: ken.agenda.done)
    assert ken.report.messages == ["aiko look: aiko is gone"]


def test_a_human_is_not_added_like_a_thing(pair: tuple[MainProcess, MainProcess]) -> None:
    ken, aiko = pair
    ken.agenda.add(steps("add human as mari")[0])
    go_on([ken, aiko], lambda: ken.agenda.done)
    assert ken.report.messages == ["line 1: another human needs a main of its own; type: ahmss main --human mari"]
