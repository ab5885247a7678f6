"""Two at one panel: an arm keeps out of who stands beside, and waits for an arm that works in its way."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from ahmss.algorithm import HumanTask, Transform
from ahmss.algorithm.messages import ObjectRecord, SiteRecord
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate
from ahmss.errors import AlgorithmError
from ahmss.main.body_parts import Body as Shown
from ahmss.main.body_parts import Parts
from ahmss.main.company import site_number
from ahmss.main.play import PlaySetup, play_script
from ahmss.motion.edit import floor_frame
from ahmss.skills.elbow_room import awaited, crowding, refuse_head_in
from ahmss.skills.reaching import Looking
from ahmss.world.recording import Reader
from ahmss.world.view import World
from tests.algorithms.devices import acting, at, before, begun, device, tips
from tests.algorithms.scene import WORKSPACE, Body, program
from tests.demo.recorded import Recorded

ROOT = Path(__file__).resolve().parents[2]
SITES = WORKSPACE.objects.get("human").sites
ARM, LEFT = INDEX["right_upper_arm"], INDEX["left_upper_arm"]
SPINE = INDEX["spine"]
NAMES = list(SITES)
HAND = NAMES.index("right_hand")
SCRIPT = """
add control_room
human ken body ken at 1.18 -0.09 facing 0
human aiko body aiko at 1.25 0.57 facing 0
aiko: do panel/button_14 press
"""


def beside(body: Body, name: str = "ken") -> ObjectRecord:
    """Somebody as main tells of them to who asks for arms."""
    place, rotation = floor_frame(body.rotations, body.root)
    moving = [site for site in SITES if SITES[site].part]
    rows = Parts(SITES[site] for site in moving).of(body.skeleton, Shown(body.skeleton, body.rotations, body.root).pose)
    sites = {
        site: SiteRecord(
            tuple(rotate(conjugate(rotation), row[:3] - place)), id=site_number(7, list(SITES).index(site))
        )
        for site, row in zip(moving, rows, strict=True)
    }
    return ObjectRecord(-7, name, "human", tuple(place.tolist()), tuple(rotation.tolist()), sites)


def raised(body: Body) -> SimpleNamespace:
    """A way on which the right arm comes up to the side, as what was performed."""
    n = 40
    rotations, root = np.repeat(body.rotations[None], n, axis=0), np.repeat(body.root[None], n, axis=0)
    turned = np.linspace(0.0, 1.3, n)
    ahead = np.stack([np.cos(0.5 * turned), 0.0 * turned, 0.0 * turned, np.sin(0.5 * turned)], axis=-1)
    rotations[:, ARM] = multiply(rotations[:, ARM], ahead)
    return SimpleNamespace(rotations=rotations, root=root)


def test_an_arm_that_would_come_into_who_stands_beside_is_told_by_how_much() -> None:
    body = Body("aiko", 0.0, 0.0, 0.0)
    made = raised(body)
    places, _ = forward(made.rotations[-1], made.root[-1], body.skeleton.offsets)
    assert np.linalg.norm((places[ARM + 1] - places[ARM])[:2]) > 0.2  # it is out
    by = {y: crowding(HumanTask(begun(body, None, "", {}, world=[beside(Body("ken", *at, 0.0))])), made, "right")
          for y, at in (("near", out(places, 0.3)), ("far", out(places, 1.6)))}  # fmt: skip
    assert by["near"] > 0.03
    assert by["far"] == 0.0
    assert crowding(HumanTask(begun(body, None, "", {}, world=[])), made, "right") == 0.0


def out(places: Array, far: float) -> tuple[float, float]:
    """A place on the floor so far from the shoulder, where the arm goes."""
    way = (places[ARM + 1] - places[ARM])[:2]
    x, y = (places[ARM][:2] + far * way / np.linalg.norm(way)).tolist()
    return x, y


@pytest.mark.parametrize(("works", "least", "most"), [(45, 45, 45 + 62), (0, 1, 62), (10_000, 355, 361)])
def test_one_waits_while_an_arm_works_in_the_way_but_not_for_ever(works: int, least: int, most: int) -> None:
    """It works for so many frames; who holds it still may do so for good, and nobody waits for ever."""
    body = Body("aiko", 0.0, 0.0, 0.0)
    made = raised(body)
    places, _ = forward(made.rotations[-1], made.root[-1], body.skeleton.offsets)
    record = beside(Body("ken", *out(places, 0.3), 0.0))
    task = HumanTask(begun(body, None, "", {}, world=[record]))
    waits = awaited(task, made, "right", Looking(task, np.array([1.0, 0.0, 1.2])))  # type: ignore[arg-type]
    place = rotate(np.array(record.rotation), np.array(record.sites["right_hand"].position)) + record.place
    frames = 0
    for frames, _ in enumerate(waits, 1):
        moved = place + np.array([0.0, 0.0, 0.05 * np.sin(0.2 * frames) if frames < works else 0.0])
        task.see(np.concatenate([body.row(frames), [site_number(7, HAND), *moved, 1.0, 0.0, 0.0, 0.0]]))
    assert least <= frames <= most
    assert task.notes == ["waits for ken, whose arm is in the way"]


def test_nobody_waits_for_an_arm_that_is_not_in_the_way() -> None:
    body = Body("aiko", 0.0, 0.0, 0.0)
    task = HumanTask(begun(body, None, "", {}, world=[beside(Body("ken", -1.2, 0.0, 0.0))]))
    assert not list(awaited(task, raised(body), "right", Looking(task, np.array([1.0, 0.0, 1.2]))))  # type: ignore[arg-type]
    assert task.notes == []


def bowed(body: Body) -> SimpleNamespace:
    """A way on which one bends aside, the right arm coming up."""
    made = raised(body)
    turned = np.linspace(0.0, 0.7, len(made.root))
    made.rotations[:, SPINE] = multiply(
        np.stack([np.cos(0.5 * turned), 0.0 * turned, 0.0 * turned, -np.sin(0.5 * turned)], axis=-1),
        made.rotations[:, SPINE],
    )
    return made


def test_nobody_leans_the_head_into_who_stands_beside() -> None:
    """It was 50 mm in an upper arm for two seconds, and nothing was said."""
    body = Body("aiko", 0.0, 0.0, 0.0)
    made = bowed(body)
    heads = forward(made.rotations[[0, -1]], made.root[[0, -1]], body.skeleton.offsets)[0][:, INDEX["head"]]
    way = (heads[1] - heads[0])[:2]
    assert np.linalg.norm(way) > 0.15
    for far, raises in ((0.0, True), (0.7, False)):
        x, y = (heads[1][:2] + (far + 0.05) * way / np.linalg.norm(way)).tolist()
        task = HumanTask(begun(body, None, "", {}, world=[beside(Body("ken", x, y, 0.0))]))
        if raises:
            with pytest.raises(AlgorithmError, match=r"the head would be \d+ mm in ken, who stands where one leans to"):
                refuse_head_in(task, made)  # type: ignore[arg-type]
        else:
            refuse_head_in(task, made)  # type: ignore[arg-type]


def test_nobody_leans_the_head_to_where_an_arm_will_hang_again_that_works_now() -> None:
    """He let it down, and the head was 50 mm in it."""
    body = Body("aiko", 0.0, 0.0, 0.0)
    made = bowed(body)
    head = forward(made.rotations[-1], made.root[-1], body.skeleton.offsets)[0][INDEX["head"]]
    ken = Body("ken", 0.0, 0.0, 0.0)
    shoulder = forward(ken.rotations, ken.root, ken.skeleton.offsets)[0][ARM]
    ken = Body("ken", *(head - shoulder)[:2].tolist(), 0.0)  # over the head is his shoulder, from which the arm hangs
    with pytest.raises(AlgorithmError, match="the head would be"):
        refuse_head_in(HumanTask(begun(body, None, "", {}, world=[beside(ken)])), made)  # type: ignore[arg-type]
    ken.rotations = raised(ken).rotations[-1]
    record = beside(ken)
    with pytest.raises(AlgorithmError, match="the head would be"):
        refuse_head_in(HumanTask(begun(body, None, "", {}, world=[record])), made)  # type: ignore[arg-type]


@pytest.mark.long
def test_where_somebody_stands_in_the_place_that_is_why_a_lever_can_not_be_slid(tmp_path: Path) -> None:
    """It was said that somebody taller could."""
    (tmp_path / "script.txt").write_text(
        "add control_room\nhuman aiko body aiko at 1.10 0.19 facing 0\nhuman ken body ken at 1.22 -0.47 facing 0\n"
        "ken: do panel/lever_4 slide level=0.5\naiko: wait 60\n"
    )
    report = play_script(tmp_path / "script.txt", PlaySetup(workspace=str(ROOT), fast=True))
    (message,) = (message for main in report.mains for message in main["messages"])
    assert message.endswith("from where there is room beside aiko; do it when they have gone")


def test_a_lever_comes_to_where_it_is_slid_though_the_hand_is_turned_as_it_goes_past_somebody(tmp_path: Path) -> None:
    """A wrist at its limit turned about the knob: it was left at 0.446."""
    (tmp_path / "script.txt").write_text(
        "add control_room\nhuman ken body ken at 1.17 0.2 facing 0\nhuman aiko body aiko at 0.5 0.9 facing 0\n"
        "aiko: do panel/lever_5 slide level=0.5\n"
    )
    recording = tmp_path / "run.rec"
    report = play_script(tmp_path / "script.txt", PlaySetup(workspace=str(ROOT), fast=True, record=recording))
    assert report.failures == 0
    world = World()
    with Reader(recording) as reader:
        reader.show(len(reader) - 1, world)
    assert world.objects["control_room/panel/lever_5"].states["level"] == pytest.approx(0.5, abs=0.01)


@pytest.mark.long
def test_who_reaches_across_keeps_the_elbow_out_of_who_stands_beside(tmp_path: Path) -> None:
    (tmp_path / "script.txt").write_text(SCRIPT)
    recording = tmp_path / "run.rec"
    report = play_script(tmp_path / "script.txt", PlaySetup(workspace=str(ROOT), fast=True, record=recording))
    assert report.failures == 0
    ken, aiko = (Recorded.read(recording, name, ("control_room/panel/button_14",)) for name in ("ken", "aiko"))
    assert "aiko" in aiko.holders["control_room/panel/button_14"]
    n = min(len(ken.root), len(aiko.root))
    (other, _), (own, _) = ken.links, aiko.links
    upper = np.linspace(0.0, 1.0, 9)[:, None]
    theirs = other[:n, LEFT, None] + upper * (other[:n, LEFT + 1] - other[:n, LEFT])[:, None]
    for side in (ARM, LEFT):
        arm = own[:n, side, None] + upper * (own[:n, side + 1] - own[:n, side])[:, None]
        gap = np.linalg.norm(arm[:, :, None] - theirs[:, None], axis=-1).min()
        assert gap > 0.11  # as thick as two upper arms; 0.034 where nobody looks


def test_a_display_is_touched_when_the_other_s_hand_has_left_the_field() -> None:
    frame = at(1.0, 2.0, 1.2)
    ken, aiko = before("ken", frame, 0.5, 0.28), before("aiko", frame, 0.5, -0.28)
    assert touching(aiko, ken, frame).notes == []  # his arms hang beside him
    panel = device("touch_panel", frame, {"page": "pump"})
    shown = ken.do("touch", begun(ken, panel, "screen", {"field": "start"}))
    on_it = shown[int(frame.inverse().apply(tips(ken, shown, acting(shown)))[:, 0].argmin())]
    ken.rotations, ken.root = on_it.rotations, on_it.root
    assert touching(aiko, ken, frame).notes == ["waits for ken, whose arm is in the way"]


def touching(body: Body, other: Body, frame: Transform) -> HumanTask:
    """The task of one who has touched a field while the other was as they are, who does not move."""
    panel = device("touch_panel", frame, {"page": "pump"})
    task = HumanTask(begun(body, panel, "screen", {"field": "start"}, world=[beside(other)]))
    assert sum(len(rows) for rows in program("touch")(task)) > 60
    return task


def test_a_keyboard_is_typed_on_when_the_other_s_hand_has_left_the_keys() -> None:
    frame = at(1.0, 2.0, 0.9)
    ken, aiko = before("ken", frame, 0.42, 0.62), before("aiko", frame, 0.36)
    assert typing(aiko, ken, frame).notes == []  # his arms hang beside him
    reach = begun(ken, device("keyboard", frame), "keys", {"before": 0.08, "turn": "free"}, hand="left")
    shown = ken.do("reach", reach)
    ken.rotations, ken.root = shown[-1].rotations, shown[-1].root
    assert typing(aiko, ken, frame).notes == ["waits for ken, whose arm is in the way"]


def typing(body: Body, other: Body, frame: Transform) -> HumanTask:
    """The task of one who has typed a letter while the other was as they are, who does not move."""
    task = HumanTask(begun(body, device("keyboard", frame), "keys", {"text": "JF"}, world=[beside(other)]))
    assert sum(len(rows) for rows in program("touch_type")(task)) > 60
    return task
