"""roll and rolled: who sits on castors draws up to a desk with the feet, types there, and rolls back to stand up."""

from __future__ import annotations

from typing import Any

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import HumanPose, HumanTask, Transform, frames
from ahmss.algorithm.messages import Goal, ObjectRecord
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, to_rotation_vector
from ahmss.errors import AlgorithmError
from ahmss.motion.contact import foot_points
from ahmss.skills.sitting import heading_of, must_stand, seat_of

from .devices import at, begun, device, mover
from .scene import WORKSPACE, Body, program

DESK = at(0.0, 0.0, 0.0, np.pi)  # a sitter is at -x, and looks along x
KEYS = at(-0.2, 0.1, 0.72, np.pi)
WALKS = str(WORKSPACE.objects.get("castor_chair").affordances["sit"].motion)


def numbered(thing: ObjectRecord, number: int) -> ObjectRecord:
    return msgspec.structs.replace(thing, id=number)


class Office:
    """A chair on castors somewhere before a desk with a keyboard, and somebody who sits down on it."""

    def __init__(self, name: str = "ken", x: float = -1.2, y: float = 0.0, turn: float = 0.0) -> None:
        self.desk, self.keys = numbered(device("desk", DESK), 8), numbered(device("keyboard", KEYS), 9)
        self.chair = device("castor_chair", at(x, y, 0.0, turn))
        stand = at(x, y, 0.0, turn).apply(np.array([0.4, 0.0, 0.0]))
        self.body = Body(name, float(stand[0]), float(stand[1]), float(np.degrees(turn)))
        self.does("sit", {}, motion=WALKS)

    def world(self, *but: str) -> list[ObjectRecord]:
        return [thing for thing in (self.desk, self.keys, self.chair) if thing.name not in but]

    def does(self, algorithm: str, parameters: dict[str, Any], **given: Any) -> list[HumanPose]:
        """Something with the chair, which then is where it has come to."""
        given = {"world": self.world("castor_chair")} | given
        start = begun(self.body, self.chair, "seat", parameters, hold="keep", **given)
        shown = self.body.do(algorithm, start)
        self.follow(start, shown)
        return shown

    def follow(self, start: Any, shown: list[HumanPose]) -> list[Any]:
        moved = mover(self.body, msgspec.structs.replace(start, object=self.chair, site="seat"))
        poses: list[Any] = list(frames(program("rolled"), moved, self.body.rows(shown)))
        place, rotation = poses[-1].place.tolist(), poses[-1].rotation.tolist()
        self.chair = msgspec.structs.replace(self.chair, place=tuple(place), rotation=tuple(rotation))
        return poses

    def types(self, text: str) -> tuple[str, list[HumanPose]]:
        start = begun(self.body, self.keys, "keys", {"text": text}, motion=WALKS, world=self.world("keyboard"))
        shown = self.body.do("touch_type", start)
        told = [dict(p.states) for p in frames(program("typed"), mover(self.body, start), self.body.rows(shown))]
        self.follow(start, shown)
        return [states["text"] for states in told if "text" in states][-1], shown

    @property
    def off(self) -> Array:
        """Where the hips are (3,) in the frame of the keys."""
        return KEYS.inverse().apply(self.body.root)


def soles(body: Body, shown: list[HumanPose]) -> Array:
    """(F, 2, 3) where the feet are."""
    rotations, root = np.array([p.rotations for p in shown]), np.array([p.root for p in shown])
    return foot_points(body.skeleton, rotations, root).reshape(len(shown), 2, -1, 3).mean(axis=2)


@pytest.mark.parametrize(("name", "x", "y", "turn"), [("ken", -1.2, 0.3, 0.4), ("aiko", -1.4, -0.3, -2.6)])
def test_who_sits_rolls_up_to_the_keys_and_the_chair_comes_along(name: str, x: float, y: float, turn: float) -> None:
    office = Office(name, x, y, turn)
    under = office.body.root[:2] - np.array(office.chair.place)[:2]
    shown = office.does("roll", {}, goal=Goal(object=office.keys))
    assert 0.4 < office.off[0] < 0.5
    assert abs(office.off[1]) < 1e-6
    assert abs(heading_of(office.body.rotations)) < 1e-6
    over = office.body.root[:2] - np.array(office.chair.place)[:2]
    assert np.linalg.norm(over) == pytest.approx(np.linalg.norm(under), abs=1e-6)
    assert over @ [1.0, 0.0] < -0.02  # before its back, not beside it
    root = np.array([pose.root for pose in shown])
    assert np.ptp(root[:, 2]) < 1e-9
    assert np.linalg.norm(np.diff(root[:, :2], axis=0), axis=1).max() * 60.0 < 0.8
    moving = np.linalg.norm(np.diff(soles(office.body, shown), axis=0), axis=-1) > 5e-4
    assert moving.any(axis=0).all()
    assert not moving.all(axis=1).any()  # a foot stands while the other one steps
    rotations = np.array([pose.rotations for pose in shown])
    turned = to_rotation_vector(multiply(conjugate(rotations[:-1]), rotations[1:]))
    assert np.degrees(np.linalg.norm(turned, axis=-1)).max() < 6.0


@pytest.mark.parametrize(("name", "x", "y", "turn"), [("aiko", -1.2, 0.2, 0.3), ("ken", -1.3, -0.3, -0.5)])
def test_who_sits_on_castors_types_from_wherever_they_sit(name: str, x: float, y: float, turn: float) -> None:
    office = Office(name, x, y, turn)
    assert office.off[0] > 0.9
    assert office.types("PUMP 3 ON")[0] == "PUMP 3 ON"
    assert 0.38 < office.off[0] < 0.5
    before = np.array(office.chair.place)
    assert office.types("OK")[0] == "OK"  # and stays there for the next word
    assert np.abs(np.array(office.chair.place) - before).max() < 1e-9


def test_on_a_seat_that_does_not_roll_one_is_too_far() -> None:
    office = Office()
    office.chair = msgspec.structs.replace(office.chair, properties={**office.chair.properties, "castors": False})
    with pytest.raises(
        AlgorithmError, match=r"too short for that from castor_chair; `do castor_chair stand_up` and type"
    ):
        office.types("OK")


@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_one_rolls_back_from_the_desk_to_stand_up(name: str) -> None:
    office = Office(name)
    office.types("OK")
    near, sits = np.array(office.chair.place), office.body.root[2]
    shown = office.does("sit", {"up": True}, motion=WALKS)
    assert office.body.root[2] > sits + 0.2
    assert office.body.root[0] < -0.35 - 0.3  # before the desk's edge
    back = float(near[0] - office.chair.place[0])
    assert back > 0.2
    rose = next(k for k, pose in enumerate(shown) if pose.root[2] > sits + 0.02)
    assert abs(shown[rose].root[0] - (office.chair.place[0] - 0.03)) < 0.06  # the chair stays as they stand up


def test_where_there_is_room_one_stands_up_where_one_sits() -> None:
    office = Office()
    before = np.array(office.chair.place)
    office.does("sit", {"up": True}, motion=WALKS)
    assert np.abs(np.array(office.chair.place) - before).max() < 0.01


def test_one_rolls_to_a_place_and_turns_there() -> None:
    office = Office()
    office.does("roll", {}, goal=Goal(place=(-1.5, 0.4, 0.0), facing=2.0))
    assert np.abs(np.array(office.chair.place)[:2] - [-1.5, 0.4]).max() < 1e-6
    assert heading_of(office.body.rotations) == pytest.approx(2.0)
    place = np.array(office.chair.place)
    office.does("roll", {}, goal=Goal(facing=-1.0))
    assert heading_of(office.body.rotations) == pytest.approx(-1.0)
    assert np.linalg.norm(office.chair.place - place) < 0.07


def test_what_leaves_no_room_is_named_with_what_to_do() -> None:
    office = Office()
    with pytest.raises(AlgorithmError, match=r"castor_chair can't be rolled there, desk is in the way; .*stand_up`"):
        office.does("roll", {}, goal=Goal(place=(0.0, 0.0, 0.0)))


def test_who_stands_does_not_roll_and_who_sits_is_told_how_to_stand_up() -> None:
    office = Office()
    task = HumanTask(begun(office.body, None, "", {}, world=office.world()))
    assert must_stand(task, "walk") == "one must stand to walk; `do castor_chair stand_up` first"
    office.does("sit", {"up": True}, motion=WALKS)
    task = HumanTask(begun(office.body, None, "", {}, world=office.world()))
    assert seat_of(task) is None
    with pytest.raises(AlgorithmError, match="one must sit on castor_chair to roll on it; `do castor_chair sit` first"):
        office.does("roll", {}, goal=Goal(facing=0.0))


def test_the_seat_stays_while_its_sitter_sits_down() -> None:
    office, frame = Office("aiko"), at(-1.2, 0.0, 0.0)
    assert (
        np.abs(Transform(np.array(office.chair.place), np.array(office.chair.rotation)).row() - frame.row()).max()
        < 1e-3
    )
