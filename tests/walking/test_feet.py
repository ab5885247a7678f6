"""Feet that follow footsteps: planted exactly, continuous where they leave and land."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.quaternion import norm, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.contact import runs
from ahmss.walking.catalogue import STRAIGHT, Key
from ahmss.walking.feet import FootTracks, tracks
from ahmss.walking.footsteps import LEFT, RIGHT, Footsteps, Frame, Step
from ahmss.walking.gait import GAIT
from ahmss.walking.performer import Stand
from ahmss.walking.plans import Planner

HUMAN = Skeleton.of(1.75, "male")
SOLES = np.stack([HUMAN.soles, HUMAN.soles * (1.0, -1.0, 1.0)])
FINE = 960.0
STRAIGHT_PLAN = Footsteps(
    (Frame(0.0, -0.05, -0.08), Frame(0.0, 0.05, 0.08)), 0.0,
    [
        Step(LEFT, Frame(0.5, 0.05, 0.08), 0.7, 1.1, 0.0, 0.4, 0.8),
        Step(RIGHT, Frame(1.1, -0.05, -0.08), 1.2, 1.65, 0.0, 1.0, 1.0),
        Step(LEFT, Frame(1.1, 0.05, 0.08), 1.77, 2.1, 0.0, 0.7, 0.0),
    ],
    3.0,
)  # fmt: skip


def planned(key: Key) -> Footsteps:
    return Planner(HUMAN, Stand(*HUMAN.relaxed()), GAIT).take(key).plan


PLANS = {
    "straight": STRAIGHT_PLAN,
    "walk": planned(STRAIGHT),
    "turn": planned(Key("one_step", 90, 150)),
    "back": planned(Key("two_step", 180, -60)),
    "start": planned(Key("start", 150)),
    "end": planned(Key("end", 0, 120, "small", "left")),
}


def made(name: str, rate: float = 60.0) -> tuple[FootTracks, Array, Array]:
    """The tracks, the soles' points (F, 2, 3, 3), the times."""
    plan = PLANS[name]
    times = np.arange(round(plan.seconds * rate) + 1) / rate
    found = tracks(HUMAN, GAIT, plan, times)
    return found, found.ankles[:, :, None] + rotate(found.rotations[:, :, None], SOLES), times


@pytest.mark.parametrize("name", PLANS)
def test_what_bears_stays_where_it_is(name: str) -> None:
    found, points, _ = made(name)
    for foot in range(2):
        for point in range(3):
            for first, end in runs(found.bearing[:, foot, point]):
                stays = points[first:end, foot, point] - points[first, foot, point]
                assert np.linalg.norm(stays, axis=-1).max() < 1e-3


@pytest.mark.parametrize("name", PLANS)
def test_nothing_sinks_and_somebody_stands(name: str) -> None:
    found, points, _ = made(name, 240.0)
    assert points[..., 2].min() > -1e-4
    assert found.bearing.any(axis=(1, 2)).all()
    np.testing.assert_allclose(norm(found.rotations), 1.0, atol=1e-12)


@pytest.mark.parametrize("name", PLANS)
def test_feet_land_where_the_plan_says(name: str) -> None:
    plan = PLANS[name]
    end = plan.steps[-1].land + 0.45
    found = tracks(HUMAN, GAIT, plan, np.array([0.0, end]))
    for foot in (RIGHT, LEFT):
        own = [step for step in plan.steps if step.foot == foot]
        first, last = plan.feet[foot], own[-1].landing
        np.testing.assert_allclose(found.ankles[0, foot, :2], [first.x, first.y], atol=1e-9)
        np.testing.assert_allclose(found.ankles[1, foot, :2], [last.x, last.y], atol=2e-3)
        ahead = rotate(found.rotations[1, foot], np.array([1.0, 0.0, 0.0]))
        assert np.cos(last.heading) * ahead[0] + np.sin(last.heading) * ahead[1] > 0.9999
        np.testing.assert_allclose(found.ankles[:, foot, 2], -HUMAN.soles[0, 2], atol=1e-4)


@pytest.mark.parametrize("name", PLANS)
def test_it_goes_on_in_place_and_speed_where_it_leaves_and_lands(name: str) -> None:
    _, points, _ = made(name, FINE)
    for step in PLANS[name].steps:
        for when in (step.lift, step.land):
            i = round(when * FINE)
            near = points[i - 6 : i + 7, step.foot]
            speed = np.diff(near, axis=0) * FINE
            assert np.linalg.norm(np.diff(near, axis=0), axis=-1).max() < 6.0 / FINE
            jumps = np.linalg.norm(np.diff(speed, axis=0), axis=-1)
            assert jumps.max() < 250.0 / FINE, f"{when}: {jumps.max() * FINE:.0f} m/s2"


@pytest.mark.parametrize("name", PLANS)
def test_a_swinging_foot_does_not_scrape(name: str) -> None:
    _, points, times = made(name, 240.0)
    for step in PLANS[name].steps:
        edge = 0.3 * (step.land - step.lift)
        inner = (times > step.lift + edge) & (times < step.land - edge)
        assert points[inner, step.foot, :, 2].min() > 0.005


def test_the_heel_strikes_first_and_the_toe_leaves_last() -> None:
    _, points, times = made("straight", 240.0)
    step = STRAIGHT_PLAN.steps[1]
    landed, left = np.searchsorted(times, step.land) + 1, np.searchsorted(times, step.lift) - 1
    heel, _, toe = points[landed, RIGHT, :, 2]
    assert toe > heel + 0.03
    heel, _, toe = points[left, RIGHT, :, 2]
    assert heel > toe + 0.08
