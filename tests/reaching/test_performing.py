"""A planned reach as frames: which way the hand goes where the straight one would turn the arm fast."""

from __future__ import annotations

from collections.abc import Generator
from typing import Any

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.arm_on_way import FASTEST, Sought, fastest_of
from ahmss.reaching.goal import Goal
from ahmss.reaching.performing import Performed, perform
from ahmss.reaching.plan import Reaching
from ahmss.reaching.reacher import SIDES, Reacher, seat

HUMAN = Skeleton.of(1.7)
THEN = 40  # frames


def made(steps: Generator[Any, None, Any]) -> Any:
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value


def reached(
    rotations: Array, root: Array, place: Array, side: str, then: float = 0.0, sought: Sought | None = None
) -> Performed:
    """A reach from a pose as long as at ease; after it the palm goes down and up again by so many metres, if any."""
    reaching, reacher = Reaching(HUMAN, rotations, root), Reacher.of(HUMAN, side)
    found = made(reaching.posture(reacher, Goal(place), ()))
    plan = made(reaching.way(reacher, found, place, ()))
    length = round(60.0 * plan.seconds)
    time = np.arange(1.0, length + 1.0) / length
    follow = np.repeat(plan.palm[None], THEN, axis=0) if then else None
    if follow is not None:
        follow[:, 2] -= then * np.sin(np.linspace(0.0, np.pi, THEN)) ** 2
    looked = minimum_jerk(np.arange(1.0, length + (THEN if then else 0) + 1.0) / 18.0)
    return made(perform(plan, time, place, looked, then=follow, sought=sought))


def nearest(one: Performed, side: str) -> float:
    """Metres between the wrist and its own shoulder at the least, the gaze aside."""
    reacher = Reacher.of(HUMAN, side)
    palms = grips(HUMAN, one.rotations, one.root)[:, SIDES.index(side)]
    shoulder = reacher.shoulder(seat(HUMAN, one.rotations, one.root))
    return float(np.linalg.norm(reacher.hand(palms)[0] - shoulder, axis=-1).min())


@pytest.mark.parametrize("side", SIDES)
def test_a_hand_goes_around_its_own_shoulder(side: str) -> None:
    """From high to low past it: the straight way would turn the arm by twelve degrees in a frame."""
    sign = Reacher.of(HUMAN, side).sign
    rotations, root = HUMAN.upright()
    up = reached(rotations, root, np.array([0.1, 0.3 * sign, 1.85]), side)
    low = reached(up.rotations[-1], up.root[-1], np.array([0.1, 0.3 * sign, 0.7]), side)
    assert fastest_of(low.rotations[:, Reacher.of(HUMAN, side).links]) < FASTEST
    assert low.flaw == pytest.approx(0.0, abs=1e-9)
    assert nearest(low, side) > 0.155


def test_what_follows_has_its_own_pace() -> None:
    rotations, root = HUMAN.upright()
    place = np.array([0.4, -0.2, 1.1])
    alone, then = (reached(rotations, root, place, "right", by) for by in (0.0, 0.4))
    assert fastest_of(then.rotations[:, Reacher.of(HUMAN, "right").links]) > 1.3 * alone.fastest
    assert then.fastest == pytest.approx(alone.fastest, rel=0.02)


def test_a_hand_goes_round_what_it_comes_to() -> None:
    """What is sought is in nobody's way as a thing; asked itself, it says how deep the hand would be in it."""
    rotations, root = HUMAN.upright()
    place = np.array([0.4, -0.2, 1.1])
    ball, radius = nearly_there(reached(rotations, root, place, "right")), 0.03

    def deep(rotations: Array, root: Array) -> float:
        palms = grips(HUMAN, rotations, root)[:, 0, :3]
        return radius - float(np.linalg.norm(palms - ball, axis=-1).min())

    straight, round_it = (reached(rotations, root, place, "right", sought=sought) for sought in (None, deep))
    assert deep(straight.rotations, straight.root) > 0.02
    assert deep(round_it.rotations, round_it.root) <= 0.0
    assert round_it.flaw == pytest.approx(0.0, abs=1e-9)


def nearly_there(one: Performed) -> Array:
    """Where the right palm (3,) is when it has gone half its way."""
    return grips(HUMAN, one.rotations, one.root)[len(one.root) // 2, 0, :3]
