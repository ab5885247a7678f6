"""slide, turn and check on a panel's controls: levers, rotary switches, keys under covers, gauges."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import HumanTask, Transform, frames
from ahmss.algorithm.messages import ObjectRecord, PoseRecord
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.errors import AlgorithmError
from ahmss.motion.steps import finished
from ahmss.skills import brought_there, controls, pinching
from ahmss.skills.box import Box
from ahmss.skills.controls import front_of
from ahmss.skills.part_ways import Part
from ahmss.walking import trip

from .layouts import Control, Layout, Used, about_z, used
from .scene import Body, program

Y = np.array([0.0, 1.0, 0.0])


def control(kind: str, slope: float = 90.0, height: float = 1.15, number: int = 1, aside: float = 0.0) -> Control:
    """A control half a metre before who stands at the origin, on a plate of a slope in degrees."""
    turn = multiply(about_z(np.pi), from_axis_angle(Y, np.array(np.radians(slope - 90.0))))
    return Control(number, kind, Transform(np.array([0.55, aside, height]), turn))


def moved(
    kind: str, action: str, states: dict[str, Any], slope: float, name: str, **parameters: Any
) -> tuple[Used, list]:
    """What the human does, and the states that follow of it."""
    it = control(kind, slope)
    body = Body(name, 0.0, 0.1, 0.0)
    start = Layout((it,)).start(it, body, action, states)
    start = msgspec.structs.replace(start, parameters=dict(start.parameters) | parameters)
    first = PoseRecord.of(body.rotations, body.root)
    done = used(body, start, "slide" if action == "slide" else "turn")
    own = {"state", "part", "along"}
    of = msgspec.structs.replace(
        start, kind="object", pose=first, hand=done.side, frames=0,
        parameters={key: value for key, value in AFFORDED[action].items() if key in own},
    )  # fmt: skip
    algorithm = program("slid" if action == "slide" else "turned")
    told: list[dict[str, Any]] = []
    for pose in frames(algorithm, of, body.rows(done.shown)):
        told.append((told[-1] if told else dict(it.record(states).states)) | pose.states)
    return done, told


def worst_turn(done: Used) -> float:
    """Degrees that a link of an arm turns in a frame at the most."""
    turns = np.array([pose.rotations for pose in done.shown])[:, INDEX["right_upper_arm"] : INDEX["left_hand"] + 1]
    return float(np.degrees(2.0 * np.arccos(np.clip(np.abs((turns[1:] * turns[:-1]).sum(axis=-1)), 0.0, 1.0))).max())


COVER = {"part": "cover", "state": "cover_turn"}
AFFORDED: dict[str, dict[str, Any]] = {
    "slide": {},
    "turn": {"along": 0.6},
    "open": COVER,
    "close": COVER | {"share": 0.65},
}


@pytest.mark.parametrize(("name", "slope", "begins", "ends"), [("ken", 90.0, 0.0, 0.7), ("aiko", 60.0, 0.8, 0.1)])
def test_the_knob_goes_with_the_hand_to_where_it_was_said(name: str, slope: float, begins: float, ends: float) -> None:
    done, told = moved("lever", "slide", {"level": begins}, slope, name, level=ends)
    levels = np.array([states["level"] for states in told])
    assert levels[0] == begins
    assert levels[-1] == pytest.approx(ends, abs=0.02)
    assert (np.diff(levels) * np.sign(ends - begins) > -0.01).all()
    it = control("lever", slope)
    pinch = it.frame.inverse().apply(0.5 * (done.tip("thumb") + done.tip("index")))
    going = np.flatnonzero(np.abs(np.diff(levels)) > 0.005)
    knob = np.array([0.046, 0.0, -0.05]) + levels[going, None] * np.array([0.0, 0.0, 0.1])
    assert np.linalg.norm(pinch[going] - knob, axis=1).max() < 0.03
    assert len(going) > 10


def test_a_knob_that_the_arm_is_too_short_for_is_stepped_to_or_refused() -> None:
    """From before it the arm is long enough: thumb and fingers went along 7 cm off the knob."""
    it, middle = control("lever", 60.0), np.array([0.046, 0.0, -0.05])
    far, alone = Body("aiko", -0.44, 0.1, 0.0), Layout((it,))
    with pytest.raises(AlgorithmError, match=r"hand stops \d\d mm short of it, .* first$"):
        used(far, alone.start(it, far, "slide", motion=None, parameters={"level": 1.0}), "slide")
    done = used(far, alone.start(it, far, "slide", parameters={"level": 1.0}), "slide")
    pinch = it.frame.inverse().apply(0.5 * (done.tip("thumb") + done.tip("index")))
    for level in (0.0, 1.0):
        assert np.linalg.norm(pinch - middle - level * np.array([0.0, 0.0, 0.1]), axis=1).min() < 0.03


class _Turns(SimpleNamespace):
    """Performs a part that comes only so far of its way, and no farther than it can."""

    def performed(self, part: Part):
        yield from ()
        return SimpleNamespace(goes=min(float(part.way(np.ones(1))[0][0, 2]), self.most) * self.share)


@pytest.mark.parametrize(("share", "most", "comes"), [(0.8, 1.0, 0.1), (1.1, 1.0, 0.1), (1.0, 0.07, 0.07)])
def test_a_hand_goes_on_until_the_part_is_where_it_is_to_be(
    monkeypatch: pytest.MonkeyPatch, share: float, most: float, comes: float
) -> None:
    monkeypatch.setattr(brought_there, "held_ends", lambda _task, _part, _plan, made: (made.goes, made.goes))
    up = np.array([0.0, 0.0, 0.1])
    site = Transform(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
    part = Part(site, lambda share: (share[:, None] * up, np.tile(site.rotation, (len(share), 1))), 1.0)
    part = replace(part, came=lambda _, last: float(last) / 0.1)
    turns = _Turns(share=share, most=most)
    made = finished(brought_there.brought_there(None, part, None, turns.performed))  # type: ignore[arg-type]
    assert made.goes == pytest.approx(comes, abs=0.0005)


def test_a_knob_that_the_hand_does_not_bring_there_is_refused_with_where_it_would(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It was left there, and said to be done."""

    def half_way(*given: Any) -> tuple[np.ndarray, np.ndarray]:
        first, last = brought_there.held_ends(*given)
        return first, np.append(0.5 * (first + last)[:3], first[3:])

    monkeypatch.setattr(pinching, "held_ends", half_way)
    it, body = control("lever"), Body("ken", 0.0, 0.1, 0.0)
    start = Layout((it,)).start(it, body, "slide", {"level": 0.1}, motion=None, parameters={"level": 0.9})
    with pytest.raises(AlgorithmError, match=r"would bring panel/lever_1 to 0\.50 instead of 0\.90 from here"):
        used(body, start, "slide")


@pytest.mark.parametrize(
    ("kind", "action", "state", "begins", "ends", "position"),
    [
        ("rotary_switch", "turn", "turn", 0.0, 1.5708, "high"),
        ("rotary_switch", "turn", "turn", 1.5708, 0.7854, "low"),
        ("rotary_switch", "turn", "turn", 0.0, 0.7854, ""),
        ("key_switch", "turn", "turn", 0.0, 1.5708, "on"),
        ("key_switch", "open", "cover_turn", 1.7453, 0.0, "open"),
        ("key_switch", "close", "cover_turn", 0.0, 1.7453, "closed"),
    ],
)
def test_what_turns_comes_to_its_position(
    kind: str, action: str, state: str, begins: float, ends: float, position: str
) -> None:
    done, told = moved(kind, action, {state: begins}, 75.0, "ken", position=position)
    assert worst_turn(done) < 8.0  # also where a wrist at its limit turns back
    angles = [states[state] for states in told]
    assert angles[0] == begins
    assert angles[-1] == pytest.approx(ends, abs=1e-3)
    assert (np.diff(angles) * np.sign(ends - begins) >= 0.0).all()  # and not back behind a hand that has let it go
    assert max(np.abs(np.diff(angles))) < 0.2  # with the hand, not at once; a cover falls shut


def test_a_cover_that_is_let_go_falls_shut_when_no_finger_is_under_it_any_more() -> None:
    done, told = moved("key_switch", "close", {"cover_turn": 0.0}, 75.0, "ken", position="closed")
    angles = np.array([states["cover_turn"] for states in told])
    falls = int(np.flatnonzero(np.diff(angles) > 0.0)[-1]) + 1
    left = next(k for k in range(falls, 0, -1) if angles[k - 1] == angles[k - 2])
    assert 0.5 * 1.7453 < angles[left - 1] < 0.7 * 1.7453  # the hand has brought it most of the way
    assert 4 <= falls - left <= 12
    tab = control("key_switch", 75.0).frame.apply(np.array([0.1, 0.0, 0.0]))  # above the plate, where it falls
    places, world = forward(
        np.array(done.shown[left].rotations), np.array(done.shown[left].root), done.body.skeleton.offsets
    )
    tips = [INDEX[f"{done.side}_{finger}_distal"] for finger in ("thumb", "index")]
    at = places[tips] + rotate(world[tips], done.body.skeleton.tips[tips])
    assert np.linalg.norm(at - tab, axis=-1).min() > 0.05


def test_no_such_position_is_refused_with_those_that_there_are() -> None:
    with pytest.raises(AlgorithmError, match='no position "hot"; it has: off, low, high'):
        moved("rotary_switch", "turn", {}, 90.0, "ken", position="hot")


@pytest.mark.parametrize(("begins", "said"), [(0.7854, ["it is at low already"]), (0.0, [])])
def test_what_is_in_its_position_already_is_told(begins: float, said: list[str]) -> None:
    it, body = control("rotary_switch"), Body("ken", 0.0, 0.1, 0.0)
    task = HumanTask(Layout((it,)).start(it, body, "turn", {"turn": begins}, parameters={"position": "low"}))
    next(program("turn")(task))
    assert task.notes == said


def test_what_the_wrist_does_not_turn_far_enough_is_told_and_not_left_half_way() -> None:
    """The hand would have to turn by 171 degrees with it."""
    it, body = control("rotary_switch", 90.0, 0.8), Body("aiko", 0.0, 0.1, 0.0)
    start = Layout((it,)).start(it, body, "turn", {"turn": 0.0}, parameters={"along": 1.9, "position": "high"})
    with pytest.raises(AlgorithmError, match=r"the wrist turns \d+ of 171 degrees on .*; turn it to low first, or"):
        used(body, msgspec.structs.replace(start, hand="left"), "turn")


def test_neighbours_of_a_lever_are_left_alone() -> None:
    levers = [control("lever", 60.0, number=i + 1, aside=0.09 * (i - 2)) for i in range(5)]
    body = Body("aiko", 0.0, 0.1, 0.0)
    layout = Layout(tuple(levers))
    done = used(body, layout.start(levers[2], body, "slide", parameters={"level": 1.0}), "slide")
    assert done.nearest(layout.others(levers[2])) > 0.0


def test_a_thumb_opens_no_wider_than_a_neighbour_leaves_room() -> None:
    """Open as wide as it comes it was 5.6 mm in the lever beside, that as if its knob were anywhere on its way."""
    lever = Control(1, "lever", Transform(np.array([-0.643, 0.121, 0.952]), np.array([0.856, 0.013, -0.511, 0.082])))
    other = Control(2, "lever", Transform(np.array([-0.61, 0.057, 0.954]), np.array([0.82, 0.151, -0.512, 0.209])))
    body = Body("ken", -0.131, 0.343, -171.0)
    done = used(body, Layout((lever, other)).start(lever, body, "slide", parameters={"level": 0.8}), "slide")
    assert done.clear(other.boxes()) > -0.002


@pytest.mark.parametrize(("name", "which"), [("ken", 1), ("aiko", 2)])
def test_neighbours_of_a_switch_are_left_alone(name: str, which: int) -> None:
    """They are 91 mm apart, as on a panel: fingers that do not turn it are closed into the palm."""
    row = [control("rotary_switch", 60.0, number=i + 1, aside=0.091 * (i - 2)) for i in range(5)]
    body = Body(name, 0.0, 0.1, 0.0)
    layout = Layout(tuple(row))
    done = used(body, layout.start(row[which], body, "turn", parameters={"along": 0.6, "position": "high"}), "turn")
    assert done.nearest(layout.others(row[which])) > -0.002
    plate = Box(row[which].frame, np.array([-0.1, -0.1, -0.1]), np.array([0.0, 0.1, 0.1]))
    assert done.nearest([plate]) > -0.002


def checked(body: Body, gauge: Control, **states: Any) -> tuple[Used, list[str]]:
    start = Layout((gauge,)).start(gauge, body, "check", states)
    notes: list[str] = []

    def noted(task: HumanTask):
        yield from program("check")(task)
        notes.extend(task.notes)

    return used(body, start, noted), notes


def gaze_off(done: Used, gauge: Control, frame: int) -> float:
    """Metres between where the gaze is asked to be and the gauge's face; far if it is free."""
    target = done.shown[frame].targets[4]
    return float(np.linalg.norm(target[:3] - gauge.site("face").place)) if target[7] > 0.99 else np.inf


def test_a_gauge_is_looked_at_for_a_while_and_told() -> None:
    gauge, body = control("gauge", 90.0, 1.5), Body("ken", -0.3, 0.2, 10.0)
    root = body.root.copy()
    done, notes = checked(body, gauge, value=0.625)
    assert notes == ["value is {value}"]  # main puts it in
    assert 60 < sum(gaze_off(done, gauge, frame) < 1e-6 for frame in range(len(done.shown))) < 150
    np.testing.assert_allclose(done.shown[-1].root, root, atol=1e-9)


def test_one_goes_to_a_gauge_that_is_too_far_or_seen_from_the_side() -> None:
    gauge = control("gauge", 90.0, 1.5)
    for x, y, facing in ((-1.6, 0.4, 0.0), (0.5, 1.0, -90.0), (0.0, 0.0, 180.0)):
        done, notes = checked(Body("aiko", x, y, facing), gauge)
        assert notes == ["value is {value}"]
        off = done.shown[-1].root[:2] - gauge.frame.place[:2]
        assert 0.3 < np.linalg.norm(off) < 1.2
        assert off @ front_of(gauge.frame) / np.linalg.norm(off) > np.cos(np.radians(60.0))
        assert gaze_off(done, gauge, -1) < 1e-6


def test_the_front_of_a_control_is_level_whatever_its_slope() -> None:
    for slope in (0.0, 20.0, 60.0, 90.0):
        np.testing.assert_allclose(front_of(control("gauge", slope).frame), [-1.0, 0.0], atol=1e-9)
    lying = Transform(np.zeros(3), from_axis_angle(np.array([1.0, 0.0, 0.0]), np.array(np.pi / 2)))
    np.testing.assert_allclose(front_of(lying), [1.0, 0.0], atol=1e-9)


def standing(name: str, x: float, y: float) -> ObjectRecord:
    """Somebody who stands there, as main tells of them."""
    return ObjectRecord(-7, name, "human", (x, y, 0.0), (1.0, 0.0, 0.0, 0.0))


@pytest.mark.parametrize("place", [(-1.0, 0.0), (-1.1, 0.1), (0.05, 0.55), (0.05, -0.55), (0.0, -0.2), (0.1, 0.1)])
def test_who_stands_on_the_way_or_beside_the_control_is_not_walked_through(place: tuple[float, float]) -> None:
    lever, body = control("lever", 75.0), Body("ken", -2.2, 0.0, 0.0)
    start = Layout((lever,)).start(lever, body, "slide", {"level": 0.0}, world=[standing("aiko", *place)])
    done = used(body, start, "slide")
    hips = np.array([pose.root[:2] for pose in done.shown])
    assert np.linalg.norm(hips - place, axis=1).min() > 0.6
    assert np.linalg.norm(hips[-1] - lever.frame.place[:2]) < 0.8  # it came there


def test_who_stands_where_one_would_stand_is_named_when_patience_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trip, "_PATIENCE", 0.5)
    lever, body = control("lever", 75.0), Body("ken", -2.2, 0.0, 0.0)
    start = Layout((lever,)).start(lever, body, "slide", {"level": 0.0}, world=[standing("aiko", 0.05, 0.0)])
    with pytest.raises(AlgorithmError, match="aiko stands in the way, where one is to stand"):
        used(body, start, "slide")


@pytest.mark.parametrize(("kind", "action"), [("lever", "slide"), ("push_button", "press")])
def test_who_stands_almost_before_the_control_is_reached_past_leaning(kind: str, action: str) -> None:
    it, body = control(kind, 75.0), Body("ken", -2.2, 0.0, 0.0)
    states = {"level": 0.0} if kind == "lever" else {}
    done = used(body, Layout((it,)).start(it, body, action, states, world=[standing("aiko", 0.05, 0.08)]), action)
    hips = np.array([pose.root[:2] for pose in done.shown])
    assert np.linalg.norm(hips - (0.05, 0.08), axis=1).min() > 0.6
    assert hips[-1, 1] < -0.55


def test_where_somebody_comes_to_stand_meanwhile_one_goes_beside_them(monkeypatch: pytest.MonkeyPatch) -> None:
    goes, asked = controls.gone_to, []

    def gone_to(task: HumanTask, stand: Any, gaze: Any) -> Any:
        asked.append(stand.place)
        if len(asked) == 1:
            task.world[-7].place[:2] = (0.05, 0.14)
            yield gaze.alone()
            raise AlgorithmError("aiko stands in the way")
        return (yield from goes(task, stand, gaze))

    monkeypatch.setattr(controls, "gone_to", gone_to)
    lever, body = control("lever", 75.0), Body("ken", -2.2, 0.0, 0.0)
    start = Layout((lever,)).start(lever, body, "slide", {"level": 0.0}, world=[standing("aiko", -2.2, 3.0)])
    done = used(body, start, "slide")
    assert len(asked) == 2
    assert abs(asked[0][1]) < 0.2
    assert np.linalg.norm(done.shown[-1].root[:2] - (0.05, 0.14)) > 0.6
    assert np.linalg.norm(done.shown[-1].root[:2] - asked[1]) < 0.1


def test_a_gauge_is_read_from_beside_who_reads_it() -> None:
    gauge, body = control("gauge", 90.0, 1.5), Body("ken", -2.2, 0.0, 0.0)
    start = Layout((gauge,)).start(gauge, body, "check", {"value": 0.5}, world=[standing("aiko", -0.25, 0.05)])
    hips = np.array([pose.root[:2] for pose in used(body, start, "check").shown])
    assert np.linalg.norm(hips - (-0.25, 0.05), axis=1).min() > 0.6
    assert np.linalg.norm(hips[-1] - gauge.frame.place[:2]) < 1.2


def test_out_of_a_panel_that_was_moved_onto_one_is_stepped_first() -> None:
    """It stands where they stand, and what is on it reaches over its edge; from within the button would be in reach."""
    button, body = Control(1, "push_button", Transform(np.array([0.2, 0.1, 1.15]), about_z(np.pi))), Body("ken")
    row = [Control(i, "lever", Transform(np.array([-0.04, 0.1 * (i - 6), 0.9]), about_z(np.pi))) for i in range(2, 11)]
    ring = [(-0.06, -0.5), (0.9, -0.5), (0.9, 0.5), (-0.06, 0.5)]
    panel = ObjectRecord(99, "panel", "panel", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), footprint=[ring])
    parts = [lever.record() for lever in row]
    start = Layout((button,)).start(button, body, "press", world=[panel, *parts, standing("aiko", -1.0, -1.2)])
    notes: list[str] = []

    def noted(task: HumanTask):
        yield from program("press")(task)
        notes.extend(task.notes)

    done = used(body, start, noted)
    assert notes == ["steps out of panel, which was moved onto where one stands"]
    assert done.shown[-1].root[0] < -0.25
    tip = done.pad(button.site("face"))
    assert tip[:, 0].min() < -0.003  # and pressed
