"""draw_out and drawn: a chair that is drawn up to a desk is drawn back by its back, until one can sit down on it."""

from __future__ import annotations

from pathlib import Path

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import HumanTask, WorldObject, frames
from ahmss.algorithm.messages import ObjectRecord
from ahmss.body.array import Array
from ahmss.errors import AlgorithmError
from ahmss.main.play import PlaySetup, play_script
from ahmss.skills.seat_room import drawn_back, in_its_room
from tests.demo.recorded import Recorded

from .devices import at, begun, device, mover
from .scene import ROOT, WORKSPACE, Body, program

DESK = msgspec.structs.replace(device("desk", at(0.0, 0.0, 0.0, np.pi)), id=8)
WALKS = str(WORKSPACE.objects.get("castor_chair").affordances["draw_out"].motion)


def chair(x: float) -> ObjectRecord:
    """A chair at so much before the desk's middle, whose sitter looks at it."""
    return device("castor_chair", at(x, 0.1, 0.0), shaped=True)


def drawn(body: Body, it: ObjectRecord, far: float, **given: object) -> Array:
    """Where the chair is (n, 3) as somebody draws it out by so much."""
    start = begun(body, it, "back", {"far": far}, motion=WALKS, world=[DESK], **given)
    shown = body.do("draw_out", start)
    moved = mover(body, start, {"closed_hand": 40.0, "threshold": 0.06})
    return np.array([pose.place for pose in frames(program("drawn"), moved, body.rows(shown))])


@pytest.mark.parametrize(("name", "busy"), [("ken", []), ("aiko", ["right"])])
def test_it_comes_along_with_the_hand_as_far_as_was_said_and_stays(name: str, busy: list[str]) -> None:
    places = drawn(Body(name, -1.7, 0.5, 0.0), chair(-0.6), 0.2, busy=busy)
    assert places[-1] == pytest.approx([-0.8, 0.1, 0.0], abs=0.004)
    assert np.abs(places[:, 1:] - [0.1, 0.0]).max() < 1e-9
    steps = np.diff(places[:, 0])
    assert steps.max() < 5e-4
    assert 0.003 < -steps.min() < 0.01  # metres a frame
    assert np.abs(np.diff(steps)).max() < 0.002
    assert np.ptp(places[-30:, 0]) < 1e-4


def test_it_is_drawn_back_until_there_is_room_to_stand_before_it() -> None:
    far = {x: drawn_back(*asked(x)) for x in (-0.6, -1.3)}
    assert -0.6 - far[-0.6] + 0.4 == pytest.approx(-0.35 - 0.4, abs=0.021)  # the stand, 0.4 m from the desk's edge
    assert far[-1.3] == 0.0


def asked(x: float) -> tuple[HumanTask, WorldObject]:
    """The task of who asks about a chair, and the chair."""
    task = HumanTask(begun(Body(), chair(x), "seat", {}, world=[DESK]))
    assert task.object is not None
    return task, task.object


def test_who_wants_to_sit_there_is_told_what_leaves_no_room_and_what_to_do() -> None:
    body = Body("ken", -1.2, 1.0, 0.0)
    start = begun(body, chair(-0.6), "seat", {}, motion=WALKS, world=[DESK])
    assert in_its_room(*asked(-0.6)) == "desk"
    told = "castor_chair is drawn up to desk, there is no room to sit down on it; `do castor_chair draw_out` first"
    with pytest.raises(AlgorithmError, match=told):
        body.do("sit", start)
    properties = {**start.object.properties, "castors": False}  # type: ignore[union-attr]
    stays = msgspec.structs.replace(start.object, properties=properties)  # type: ignore[type-var]
    with pytest.raises(AlgorithmError, match="move one of them first"):
        body.do("sit", msgspec.structs.replace(start, object=stays))


SCRIPT = """
add floor
add desk as d at 0 0 0 facing 180
add castor_chair as c at -0.62 0.1 0 facing 0
human aiko body aiko at -1.6 0.5 facing 0
aiko: do c draw_out
aiko: do c sit
aiko: do floor stand
"""


@pytest.mark.long
def test_drawn_out_in_two_pulls_it_is_sat_on_and_nobody_is_raised_from_it_in_place(tmp_path: Path) -> None:
    (tmp_path / "script.txt").write_text(SCRIPT)
    recording = tmp_path / "run.rec"
    report = play_script(tmp_path / "script.txt", PlaySetup(workspace=str(ROOT), fast=True, record=recording))
    messages = [said for main in report.mains for said in main["messages"]]  # type: ignore[attr-defined]
    assert messages == ["floor stand: one must stand for that; `do c stand_up` first"]
    aiko = Recorded.read(recording, "aiko", ("c",))
    place = aiko.object("c").place
    assert place[-1] == pytest.approx([-1.15, 0.1, 0.0], abs=0.03)
    assert np.abs(place[:, 1] - 0.1).max() < 0.01
    assert np.linalg.norm((aiko.root[-1] - place[-1])[:2]) < 0.05
    assert aiko.root[-1, 2] < 0.65
