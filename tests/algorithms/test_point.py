"""point: the arm straight, the fingertip where the right eye sees the target; then down again."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.algorithm import HumanTask, frames
from ahmss.algorithm.messages import Goal
from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.errors import AlgorithmError
from ahmss.motion.smoothness import worst_pop

from .devices import acting, at, begun, device, posed, tips
from .scene import Body, program


def degrees(a: Array, b: Array) -> float:
    return float(np.degrees(np.arccos(np.clip(a @ b / np.linalg.norm(a) / np.linalg.norm(b), -1.0, 1.0))))


def aimed(name: str, target: Array, facing: float) -> tuple[float, float, float, float]:
    """Degrees: the fingertip off the right eye's line, the finger and the forearm off the arm's; the worst pop."""
    body = Body(name, 0.4, -0.7, facing)
    shown = body.do("point", begun(body, None, "", {}, goal=Goal(place=tuple(target.tolist()))))
    side, middle = acting(shown), len(shown) // 2
    places, turned = (of[middle] for of in posed(body, shown))
    head, tip = INDEX["head"], tips(body, shown, side)[middle]
    eye = places[head] + rotate(turned[head], body.skeleton.eye + np.array([0.0, -0.032, 0.0]))
    shoulder, wrist, knuckle = (places[INDEX[f"{side}_{link}"]] for link in ("upper_arm", "hand", "index_proximal"))
    arm = tip - shoulder
    pop = worst_pop(np.array([pose.rotations for pose in shown])).degrees
    return degrees(tip - eye, target - eye), degrees(tip - knuckle, arm), degrees(wrist - shoulder, arm), pop


def drawn(seed: int) -> tuple[str, Array, float]:
    random = np.random.default_rng(seed)
    angle, away = random.uniform(-np.pi, np.pi), random.uniform(1.0, 4.5)
    target = np.array([0.4 + away * np.cos(angle), -0.7 + away * np.sin(angle), random.uniform(0.2, 2.3)])
    return ("ken", "aiko")[seed % 2], target, float(np.degrees(angle)) + random.uniform(-75.0, 75.0)


BRISK = 43  # the arm is nearly straight at both ends of a way that takes 38 frames
LONG = [pytest.param(seed, marks=pytest.mark.long) for seed in range(4, 60) if seed != BRISK]


@pytest.mark.parametrize("seed", [*range(4), BRISK, *LONG])
def test_the_fingertip_is_where_the_eye_sees_the_target(seed: int) -> None:
    sight, finger, forearm, pop = aimed(*drawn(seed))
    assert sight < 1.0
    assert finger < 2.0
    assert forearm < 8.0  # the straight arm: upper arm, forearm and finger in a line
    assert pop < 1.5


def test_it_stays_for_a_second_and_comes_down_again() -> None:
    body = Body("ken")
    stood = body.rotations.copy()
    shown = body.do("point", begun(body, None, "", {}, goal=Goal(place=(3.0, -0.5, 1.4))))
    tip = tips(body, shown, "right")
    stays = int((np.linalg.norm(tip - tip[len(tip) // 2], axis=1) < 0.002).sum()) / 60.0
    assert 1.0 <= stays <= 1.6
    arm = slice(INDEX["right_upper_arm"], INDEX["right_hand"] + 1)
    assert np.abs((shown[-1].rotations[arm] * stood[arm]).sum(axis=1)).min() > 0.999


def test_what_is_called_is_told() -> None:
    body, panel = Body("aiko"), device("television", at(2.0, 0.3, 0.0, np.pi))
    start = begun(body, panel, "screen", {"call": "Pump one, good"})
    task = HumanTask(start)
    for _ in program("point")(task):
        pass
    assert task.notes == ['calls: "Pump one, good"']


def test_behind_the_back_and_walking_it_is_refused() -> None:
    body = Body("ken", facing=0.0)
    with pytest.raises(AlgorithmError, match="behind the back"):
        list(frames(program("point"), begun(body, None, "", {}, goal=Goal(place=(-3.0, 0.2, 1.2)))))
    with pytest.raises(AlgorithmError, match="standing"):
        list(frames(program("point"), begun(body, None, "", {}, goal=Goal(place=(3.0, 0.2, 1.2)), carried=True)))


def test_what_names_no_site_is_pointed_at_in_its_middle() -> None:
    frame = at(2.0, 0.3, 2.3, np.pi)
    body = Body("aiko")
    gauge = device("gauge", frame)
    shown = body.do("point", begun(body, gauge, "", {}))
    middle = len(shown) // 2
    tip = tips(body, shown, acting(shown))[middle]
    places, turned = (of[middle] for of in posed(body, shown))
    head = INDEX["head"]
    eye = places[head] + rotate(turned[head], body.skeleton.eye + np.array([0.0, -0.032, 0.0]))
    assert degrees(tip - eye, frame.apply(np.array([0.0145, 0.0, 0.0])) - eye) < 0.5
