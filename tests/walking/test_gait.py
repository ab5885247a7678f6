"""A straight walk's figures beside those of people: ../shared/NATURAL.md, "1 Walking", measured (A, B) and published.

Ranges span what was measured on two people walking at 1.07 to 1.28 m/s and what is published of free speed; where ours
lies outside of that, the range reaches as far as it does and the comment says what people do.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

from ahmss.walking.catalogue import STRAIGHT
from ahmss.walking.gait import GAIT
from ahmss.walking.journey import Journey
from ahmss.walking.library import BODY, RATE
from ahmss.walking.performer import Stand, perform
from ahmss.walking.plans import Planner

from . import measures as m
from .gaitfigures import Figures, figures
from .measures import HUMANS, Goal

RANGES: dict[str, tuple[float, float]] = {
    "cadence": (96.0, 111.0),  # A 96, B 110 to 111
    "speed": (1.0, 1.35),
    "step_per_leg": (0.70, 0.78),  # A 0.72, B 0.74 to 0.76
    "width": (0.04, 0.10),  # A 0.07, B 0.01 and 0.08, published 0.08 to 0.10
    "stance": (60.0, 67.0),
    "double": (10.0, 17.0),
    "strike": (18.0, 28.0),  # A 23, B 26, W 24
    "toe_off": (-70.0, -50.0),  # A -53, B -64, W -70
    "clearance": (0.008, 0.025),  # 11 to 20 mm, published 11 +- 6
    "rotation": (9.0, 18.0),
    "list": (7.5, 11.0),
    "tilt": (1.0, 5.0),
    "vertical_per_leg": (0.036, 0.059),
    "lateral_per_leg": (0.040, 0.062),
    "below_standing": (0.025, 0.036),  # A 35 mm, B 30 mm
    "thorax": (4.5, 13.0),
    "arm": (30.0, 52.0),  # published 30 to 40, A 42, B 40 to 55
    "knee_swing": (55.0, 64.0),  # measured 55 to 59; a foot without toes leaves with its ankle higher
    "knee_loading": (14.0, 22.0),  # published 15 to 20, A 16
    "knee_landing": (0.0, 13.5),  # people 0 to 5: for the same reason the hips are lower when both feet stand
}


@lru_cache
def straight(name: str, frames: int = 0) -> tuple[m.Walk, Journey]:
    return m.walked(Goal(name, 30.0, 12.0, 0.0, 0.0), frames)


def measured(name: str, frames: int = 0) -> Figures:
    body = m.subject(name)
    return figures(straight(name, frames)[0], float(np.radians(30.0)), body.rotations, body.standing.height)


@pytest.mark.parametrize("name", HUMANS)
@pytest.mark.parametrize("figure", RANGES)
def test_a_figure_is_a_persons(figure: str, name: str) -> None:
    low, high = RANGES[figure]
    assert low <= getattr(measured(name), figure) <= high


WHEN = {  # percent of the right leg's cycle, from its touchdown: NATURAL.md's table and its curves
    "rotation": (0, 15),  # the right side is most forward
    "list": (12, 30),  # the right side is highest
    "vertical": (23, 40),  # or half a cycle later
    "lateral": (18, 36),  # over the right foot
    "arm": (44, 60),  # the right arm is most forward, against the leg
    "thorax": (44, 62),
    "knee": (68, 80),
    "foot": (97, 104),  # across the landing
}


@pytest.mark.parametrize("name", HUMANS)
@pytest.mark.parametrize("curve", WHEN)
def test_it_is_greatest_when_it_is_a_persons(curve: str, name: str) -> None:
    first, last = WHEN[curve]
    values = measured(name).curves[curve]
    if curve == "vertical":
        values = values[:50] + values[50:]
    at = int(values.argmax())
    assert first <= at <= last or first <= at + 100 <= last


KNEE = np.array([2, 7, 14, 17, 15, 13, 11, 9, 8, 9, 12, 18, 28, 43, 55, 57, 49, 34, 16, 2], float)
FOOT = np.array([24, 11, 2, 0, 0, 0, 0, -1, -3, -6, -13, -25, -44, -61, -63, -49, -30, -10, 8, 22], float)
ARM = np.array([-19, -19, -18, -13, -7, -1, 6, 13, 19, 23, 26, 24, 20, 15, 10, 5, -2, -9, -15, -18], float)


@pytest.mark.parametrize("name", HUMANS)
@pytest.mark.parametrize(("curve", "wanted", "error"), [("knee", KNEE, 11.0), ("foot", FOOT, 9.0), ("arm", ARM, 8.0)])
def test_a_curve_follows_a_persons(curve: str, wanted: np.ndarray, error: float, name: str) -> None:
    """Root mean square against row T of the table (the arm's against AB), every 5 % of the cycle."""
    found = measured(name).curves[curve][::5]
    assert float(np.sqrt(np.mean((found - wanted) ** 2))) < error
    assert np.corrcoef(found, wanted)[0, 1] > 0.9


def _stands_out(curve: np.ndarray, at: int) -> float:
    """By how much a peak is above what is within 8 % of the cycle, on its lower side."""
    before, after = curve[np.arange(at - 8, at) % 100], curve[np.arange(at + 1, at + 9) % 100]
    return float(curve[at] - max(before.min(), after.min()))


@pytest.mark.parametrize("name", HUMANS)
def test_the_knee_bends_twice_a_cycle_and_no_more(name: str) -> None:
    knee = measured(name).curves["knee"]
    rising = np.diff(np.concatenate([knee, knee[:1]])) > 0.0
    peaks = [i for i in range(100) if rising[i - 1] and not rising[i] and _stands_out(knee, i) > 4.0]
    assert len(peaks) == 2, f"at {peaks} percent of the cycle"


@pytest.mark.parametrize("name", HUMANS)
def test_left_and_right_do_the_same(name: str) -> None:
    walk, made = straight(name)
    first, second = made.seams[4:6]
    step = second - first
    here, there = walk.root[first : first + step, 2], walk.root[first + step : first + 2 * step, 2]
    np.testing.assert_allclose(here, there, atol=1e-4)
    knees = m.knee_flexion(walk)
    np.testing.assert_allclose(knees[first:second, 0], knees[second : second + step, 1], atol=0.1)


@pytest.mark.parametrize("name", HUMANS)
def test_the_head_is_steadier_than_the_pelvis(name: str) -> None:
    """Yaw 2.5 to 11 degrees, pitch 2 to 4, peak to peak."""
    found = measured(name)
    assert 2.0 < np.ptp(found.curves["head"]) < 11.0
    assert 1.5 < np.ptp(found.curves["nod"]) < 4.5
    assert np.ptp(found.curves["head"]) < np.ptp(found.curves["rotation"])


@pytest.mark.parametrize("name", HUMANS)
def test_the_head_keeps_to_a_place_ahead(name: str) -> None:
    """The higher the body, the lower it looks; the further to the right, the more it turns to the left."""
    curves = measured(name).curves
    assert np.corrcoef(curves["nod"], curves["vertical"])[0, 1] > 0.9
    assert np.corrcoef(curves["head"], curves["lateral"])[0, 1] < -0.9  # both are positive to the right


@pytest.mark.parametrize("name", HUMANS)
def test_a_leg_that_pushes_off_comes_forward_without_a_halt(name: str) -> None:
    """The knee bends more and more from the heel's rise to the middle of the swing."""
    knee = measured(name).curves["knee"]
    assert np.diff(knee[50:72]).min() > 0.0


@pytest.mark.parametrize("share", [0.75, 1.3])
def test_frames_asked_for_change_the_cadence_and_not_the_steps(share: float) -> None:
    natural = straight("ken")[1].natural
    usual, other = measured("ken"), measured("ken", round(share * natural))
    assert other.cadence == pytest.approx(usual.cadence / share, rel=0.02)
    assert other.step_per_leg == pytest.approx(usual.step_per_leg, rel=0.01)
    assert len(straight("ken", round(share * natural))[0].root) == round(share * natural) + 1


def test_seams_of_straight_steps_are_as_smooth_as_walking_on() -> None:
    """Jerk and pops at touchdowns beside those of the same subject walking on, uncut."""
    body = m.subject(m.library().human)
    stand = Stand(body.rotations, body.root)
    plan = Planner(body.skeleton, stand, GAIT).take(STRAIGHT).plan
    performed = perform(body.skeleton, stand, plan, GAIT)
    rotations = np.repeat(body.rotations[None], len(performed.root), axis=0)
    rotations[:, :BODY] = performed.rotations
    landed = [round(step.land * RATE) for step in plan.steps]
    first, last = landed[2] - 10, landed[-3] + 10
    part = slice(first, last)
    nothing = np.zeros((last - first, 2, 4))
    uncut = m.Walk(
        body.skeleton, rotations[part], performed.root[part], performed.bearing[part], nothing[..., :3], nothing,
        (0, *(frame - first for frame in landed[2:-2]), last - first - 1),
    )  # fmt: skip
    walk, made = straight(m.library().human)
    begin, end = made.seams[2] - 10, made.seams[-3] + 10
    inner = tuple(frame - begin for frame in made.seams[2:-2])
    cut = m.Walk(
        body.skeleton, walk.rotations[begin:end], walk.root[begin:end], walk.bearing[begin:end],
        walk.ankles[begin:end], walk.feet[begin:end], (0, *inner, end - begin - 1),
    )  # fmt: skip
    assert m.worst_jerks(cut)[0] < 1.1 * m.worst_jerks(uncut)[0]
    assert m.worst_pops(cut)[0] < 1.1 * m.worst_pops(uncut)[0] + 0.2
