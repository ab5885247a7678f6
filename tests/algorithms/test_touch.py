"""touch and touched: the fingertip comes onto the glass where it is to, and the display answers."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ahmss.algorithm import HumanPose, Transform, frames
from ahmss.algorithm.messages import Start
from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.errors import AlgorithmError
from ahmss.motion.smoothness import worst_pop
from ahmss.reaching.leaning import looking

from .devices import UP, acting, before, begun, device, mover
from .scene import WORKSPACE, Body, program
from .touching import pads, skins

GLASS = np.array([0.0154, -0.18, -0.12])  # the lower left corner of the screen, in the panel's frame


class Panel:
    """A touch panel somewhere, tilted, and somebody before it."""

    def __init__(self, seed: int) -> None:
        random = np.random.default_rng(seed)
        turn = from_axis_angle(UP, random.uniform(-np.pi, np.pi))
        tilt = from_axis_angle(np.array([0.0, 1.0, 0.0]), -np.radians(random.uniform(0.0, 35.0)))
        self.frame = Transform(np.array([1.0, 2.0, random.uniform(1.0, 1.35)]), multiply(turn, tilt))
        name = ("ken", "aiko")[seed % 2]
        level = Transform(self.frame.place, turn)
        self.body = before(name, level, random.uniform(0.42, 0.55), random.uniform(-0.1, 0.1), random.uniform(-15, 15))

    def touched(
        self, states: dict[str, Any], motion: str | None = None, **parameters: Any
    ) -> tuple[Body, Start, list[HumanPose]]:
        """The human's frames."""
        start = begun(self.body, device("touch_panel", self.frame, states), "screen", parameters, motion=motion)
        return self.body, start, self.body.do("touch", start)

    def told(self, body: Body, start: Start, shown: list[HumanPose]) -> list[dict[str, Any]]:
        """What the display says at each frame."""
        made = frames(program("touched"), mover(body, start), body.rows(shown))
        return [dict(pose.states) for pose in made]

    def on_glass(self, body: Body, shown: list[HumanPose]) -> Array:
        """The finger's pad (F, 3): how far off the glass, to the right and up from the lower left corner."""
        into = -rotate(self.frame.rotation, np.array([1.0, 0.0, 0.0]))
        return self.frame.inverse().apply(pads(body, shown, acting(shown), into)) - GLASS

    def in_glass(self, body: Body, shown: list[HumanPose]) -> float:
        """Metres by which the finger's skin is in the glass at the most."""
        out = rotate(self.frame.rotation, np.array([1.0, 0.0, 0.0]))
        return float(-((skins(body, shown, acting(shown), -out) - self.frame.apply(GLASS)) @ out).min())


def on_screen(tip: Array) -> Array:
    """The frames in which a fingertip (F, 3) is on the glass: behind its plane, and not beside the panel."""
    return np.flatnonzero((tip[:, 0] <= 0.0) & (tip[:, 1:] > 0.0).all(axis=1) & (tip[:, 1:] < (0.36, 0.24)).all(axis=1))


SEEDS = [*range(4), *(pytest.param(seed, marks=pytest.mark.long) for seed in range(4, 50))]


@pytest.mark.parametrize("seed", SEEDS)
def test_a_tap_comes_onto_the_field_and_off_again(seed: int) -> None:
    panel = Panel(seed)
    body, start, shown = panel.touched({"page": "pump"}, field="start")
    tip = panel.on_glass(body, shown)
    on = on_screen(tip)
    assert np.hypot(*(tip[on, 1:] - (0.09, 0.155)).T).max() < 0.002
    assert tip[on, 0].min() > -0.002
    assert panel.in_glass(body, [shown[k] for k in on]) < 0.001
    assert 0.05 < len(on) / 60.0 < 0.22
    assert tip[-1, 0] > 0.08
    assert worst_pop(np.array([pose.rotations for pose in shown])).degrees < 1.5
    told = panel.told(body, start, shown)
    assert {"touched": "start", "power": "on"} in told
    assert told[-1] == {}
    assert {"touched": ""} in told


@pytest.mark.parametrize("seed", range(4))
def test_who_has_tapped_and_looks_aside_has_the_hand_clear(seed: int) -> None:
    """The trunk turns with the eyes, and takes the hand along: a fingertip was 20 mm in the panel's edge."""
    panel = Panel(seed)
    body, _, shown = panel.touched({"page": "pump"}, field="start")
    eyes = shown[-1].root + 0.6 * UP
    for aside in np.radians([-90.0, 90.0]):
        turned = rotate(from_axis_angle(UP, aside), panel.frame.place - eyes)
        rotations = looking(body.skeleton, shown[-1].rotations, shown[-1].root, eyes + turned)
        seen = HumanPose(rotations, shown[-1].root, shown[-1].importance, shown[-1].targets)
        out = rotate(panel.frame.rotation, np.array([1.0, 0.0, 0.0]))
        tip = skins(body, [seen], acting(shown), -out)[0]
        assert float((tip - panel.frame.apply(GLASS)) @ out) > 0.03


@pytest.mark.parametrize("seed", SEEDS[:2] + SEEDS[4:])
def test_a_slider_follows_the_finger(seed: int) -> None:
    panel = Panel(seed)
    body, start, shown = panel.touched({"page": "pump", "speed": 0.2}, field="speed", value=0.8, drag=True)
    tip = panel.on_glass(body, shown)
    on = on_screen(tip)
    assert np.hypot(*(tip[on[0], 1:] - (0.18 - 0.3 * 0.24, 0.04))) < 0.002
    assert np.hypot(*(tip[on[-1], 1:] - (0.18 + 0.3 * 0.24, 0.04))) < 0.002
    assert (np.diff(tip[on, 1]) > -1e-4).all()
    assert panel.in_glass(body, [shown[k] for k in on]) < 0.001
    values = [states["speed"] for states in panel.told(body, start, shown) if "speed" in states]
    assert values[-1] == pytest.approx(0.8, abs=0.005)
    assert values == sorted(values)
    assert len(values) > 12


def test_a_page_changes_when_its_field_is_touched() -> None:
    panel = Panel(0)
    body, start, shown = panel.touched({}, field="pump")
    assert {"touched": "pump", "page": "pump"} in panel.told(body, start, shown)


def test_a_place_is_touched_as_well() -> None:
    panel = Panel(1)
    body, start, shown = panel.touched({}, x=0.27, y=0.07)
    assert {"touched": "tank"} in panel.told(body, start, shown)


@pytest.mark.parametrize(
    ("parameters", "told"),
    [
        ({"field": "start"}, '"start" is on the page pump; it shows now: pump, tank'),
        ({"field": "valve"}, '"valve" is none of its fields; it shows now: pump, tank'),
        ({"field": "pump", "drag": True}, '"pump" is no slider; sliders that it shows: none'),
        ({}, "add field=, or x= y= in metres; fields that it shows: pump, tank"),
        ({"x": 0.5, "y": 0.1}, "0.5 0.1 is not on the screen, which is 0.36 m wide and 0.24 m high"),
    ],
)
def test_what_is_not_there_is_refused(parameters: dict[str, Any], told: str) -> None:
    with pytest.raises(AlgorithmError, match=told):
        Panel(0).touched({}, **parameters)


@pytest.mark.parametrize(
    ("said", "told"),
    [
        ({}, "draw speed to what\\? add value=, from 0, the low end of its track, to 1"),
        ({"value": 1.5}, "speed can't be drawn to 1.5; allowed: 0, the low end of its track, to 1"),
        ({"value": -0.2}, "speed can't be drawn to -0.2; allowed: 0,"),
    ],
)
def test_a_slider_is_drawn_to_where_its_track_goes(said: dict[str, Any], told: str) -> None:
    with pytest.raises(AlgorithmError, match=told):
        Panel(0).touched({"page": "pump"}, field="speed", drag=True, **said)


@pytest.mark.parametrize("seed", [0, 1])
def test_who_stands_too_far_away_steps_before_it_first(seed: int) -> None:
    panel = Panel(seed)
    far = panel.frame.apply(np.array([1.5, 0.6, 0.0]))
    panel.body = Body(("ken", "aiko")[seed], float(far[0]), float(far[1]), 40.0)
    motion = WORKSPACE.objects.get("touch_panel").affordances["tap"].motion
    assert motion is not None
    shown = panel.touched({}, field="pump", motion=str(motion))
    told = panel.told(*shown)
    assert [states["touched"] for states in told if states.get("touched")] == ["pump"]
    assert np.linalg.norm((panel.body.root - panel.frame.place)[:2]) < 0.75
