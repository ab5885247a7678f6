"""Buttons placed and tilted at random are pressed along their axes, and nothing beside them is touched."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.algorithm import HumanPose, Transform, frames
from ahmss.errors import AlgorithmError
from ahmss.motion.smoothness import worst_pop
from ahmss.skills.box import Box

from .layouts import Control, Layout, Used, about_z, somebody, used
from .scene import Body, program

PUSHED = 39  # frames in which a finger comes, pushes, and is drawn back
MORE, RESTS = 15, 24  # frames that follow; in which, the last, the fingers come to rest
FAST, ALL = range(3), range(3, 50)
EACH = 4  # buttons of a layout that are pressed


def check(layout: Layout, control: Control, name: str, seed: int) -> bool:
    """Press a button; whether it was in reach."""
    body = somebody(name, control, seed)
    try:
        done = used(body, layout.start(control, body, "press", parameters={}), "press")
    except AlgorithmError as error:
        if "too short" not in str(error):
            raise
        return False
    travel = 0.004
    tip, skin = (of(control.site("face"))[-PUSHED - MORE : -RESTS] for of in (done.pad, done.skin))
    contact = int(np.argmax(tip[:, 0] < 1e-4))
    assert np.linalg.norm(tip[contact, 1:]) < 0.002  # at its middle
    assert tip[:, 0].min() == pytest.approx(-travel, abs=0.001)
    assert np.abs(tip[:, 1:]).max() < 0.002  # along its axis, in and out
    assert tip[0, 0] > 0.02
    assert tip[-1, 0] > 0.02
    on = skin[tip[:, 0] < 1e-4]
    assert on[:, 0].min() > -travel - 0.001
    assert np.linalg.norm(on[:, 1:], axis=1).max() < 0.002
    assert done.nearest(layout.others(control)) > 0.0
    rotations = np.array([pose.rotations for pose in done.shown])
    assert worst_pop(rotations).degrees < 20.0  # no elbow flips; where a walk begins and ends, main eases what changes
    assert worst_pop(rotations[-2 * PUSHED :]).degrees < 2.0
    return True


def press_some(seed: int) -> None:
    layout = Layout.drawn(seed)
    chosen = np.random.default_rng(seed).permutation(len(layout.controls))[:EACH]
    reached = [
        check(layout, layout.controls[i], ("ken", "aiko")[(k + seed) % 2], 100 * seed + int(i))
        for k, i in enumerate(chosen)
    ]
    assert sum(reached) >= EACH - 1


@pytest.mark.parametrize("seed", FAST)
def test_a_button_anywhere_is_pressed_along_its_axis(seed: int) -> None:
    press_some(seed)


@pytest.mark.long
@pytest.mark.parametrize("seed", ALL)
def test_a_button_of_any_of_many_layouts_is(seed: int) -> None:
    press_some(seed)


def upright(height: float, away: float = 0.0) -> Control:
    return Control(1, "push_button", Transform(np.array([2.0 - away, 0.0, height]), about_z(np.pi)))


def test_out_of_reach_is_refused_with_by_how_much_and_where_from() -> None:
    """2.6 m high nobody comes to it, and the taller one is nearer to it."""
    short: list[float] = []
    for name in ("ken", "aiko"):
        body, control = Body(name, 0.0, 0.0, 0.0), upright(2.6)
        with pytest.raises(
            AlgorithmError, match=r"arm is 0\.\d+ m too short for it, even from .* at 1\.\d+ "
        ) as refused:
            list(frames(program("press"), Layout((control,)).start(control, body, "press")))
        short.append(float(str(refused.value).split(" m too short")[0].rpartition(" ")[2]))
    assert 0.1 < short[0] < short[1] < 1.0


def test_who_stands_far_away_or_looks_elsewhere_goes_there_first() -> None:
    control = upright(1.2)
    for x, facing in ((-1.0, 0.0), (1.5, 180.0)):
        body = Body("ken", x, 0.3, facing)
        done = used(body, Layout((control,)).start(control, body, "press", parameters={}), "press")
        hips = done.shown[-1].root
        assert 0.25 < 2.0 - hips[0] < 0.75
        assert abs(hips[1]) < 0.3
        tip = done.pad(control.site("face"))
        assert tip[-PUSHED:, 0].min() == pytest.approx(-0.004, abs=0.001)


def test_who_can_reach_it_takes_no_step() -> None:
    control = upright(1.2)
    body = Body("ken", 1.5, 0.0, 0.0)
    root = body.root.copy()
    done = used(body, Layout((control,)).start(control, body, "press", parameters={}), "press")
    assert max(np.linalg.norm(pose.root[:2] - root[:2]) for pose in done.shown) < 0.05


def test_a_box_tells_how_near_points_are() -> None:
    box = Box(
        Transform(np.array([1.0, 0.0, 0.0]), about_z(np.pi / 2)), np.array([0.0, -0.1, -0.2]), np.array([0.3, 0.1, 0.2])
    )
    gap = box.gap(np.array([[1.0, 0.5, 0.0], [1.0, 0.25, 0.0], [1.4, 0.1, 0.0], [1.0, -0.3, 0.6]]))
    np.testing.assert_allclose(gap, [0.2, -0.05, 0.3, 0.5], atol=1e-9)
    prism = box.prism()
    assert (prism.low, prism.high) == pytest.approx((-0.2, 0.2))
    np.testing.assert_allclose([prism.ring.min(axis=0), prism.ring.max(axis=0)], [[0.9, 0.0], [1.1, 0.3]], atol=1e-9)


def test_a_hand_in_a_box_is_seen() -> None:
    body = Body("ken")
    here = Used(body, [HumanPose(body.rotations, body.root)])
    palm = body.grip()
    corner = np.array([0.03, 0.03, 0.03])
    assert here.nearest([Box(palm, -corner, corner)]) < 0.0
    assert here.nearest([Box(Transform(palm.place + np.array([0.0, 0.0, 0.6]), palm.rotation), -corner, corner)]) > 0.2
