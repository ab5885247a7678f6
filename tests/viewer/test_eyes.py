"""The camera between a human's eyes: it goes with the head, and the head is not in the picture."""

from __future__ import annotations

import numpy as np
import pytest
from ahmss_viewer.aim import Aim
from ahmss_viewer.camera import project
from ahmss_viewer.eyes import view_of
from ahmss_viewer.figure import plain_figure
from ahmss_viewer.glb import read_glb
from ahmss_viewer.options import ViewOptions
from ahmss_viewer.painter import Painter
from ahmss_viewer.stage import Stage

from ahmss.body.quaternion import from_axis_angle, multiply
from ahmss.errors import CommandError

from .conftest import Draw
from .scenes import RED, SKELETON, UNTURNED, box_glb

UP = np.array([0.0, 0.0, 1.0])
SIZE = (320, 240)


def stage(heading: float = 0.0) -> Stage:
    """A human at the origin with that heading, radians, and a red box 2 m ahead of heading 0, below its eyes."""
    made = Stage()
    rotations, root = SKELETON.upright()
    rotations[0] = multiply(from_axis_angle(UP, heading), rotations[0])
    made.add_human(9, "ken", SKELETON.offsets, plain_figure(SKELETON), SKELETON.eye)
    made.pose_human(9, rotations, root)
    made.add_object(1, "box", read_glb(box_glb((0.4, 0.4, 0.4), RED)), np.array([2.0, 0.0, 1.1]), UNTURNED)
    return made


def test_what_is_ahead_is_in_the_middle_and_no_part_of_the_head_before_it(draw: Draw) -> None:
    made = stage()
    view = view_of(made, "ken")
    assert project(np.array([2.0, 0.0, 1.1]), view, SIZE)[:2] == pytest.approx([160.0, 120.0], abs=12.0)
    picture = draw(made, view)
    red = (picture[..., 0] > 80) & (picture[..., 0] > 2.5 * picture[..., 1])
    assert red[110:130, 150:170].all()
    assert 0.01 < red.mean() < 0.1


def test_who_turns_left_has_what_was_ahead_on_the_right() -> None:
    x, _, depth = project(np.array([2.0, 0.0, 1.1]), view_of(stage(np.radians(30.0)), "ken"), SIZE)
    assert depth > 0.0
    assert 230.0 < x < 320.0
    assert project(np.array([2.0, 0.0, 1.1]), view_of(stage(np.pi), "ken"), SIZE)[2] < 0.0


def test_the_eyes_turn_to_a_place_whatever_the_head_does() -> None:
    view = view_of(stage(np.radians(50.0)), "ken", (2.0, 0.0, 1.1))
    assert project(np.array([2.0, 0.0, 1.1]), view, SIZE)[:2] == pytest.approx([160.0, 120.0], abs=0.5)


@pytest.mark.parametrize("heading", [135.0, 225.0])
def test_the_own_trunk_is_in_no_picture_wherever_the_eyes_turn(draw: Draw, heading: float) -> None:
    made = stage(np.radians(heading))
    made.move_object(1, np.array([1.2, 0.0, 0.2]), UNTURNED)
    picture = draw(made, view_of(made, "ken", (1.2, 0.0, 0.2)))
    red = (picture[..., 0] > 80) & (picture[..., 0] > 2.5 * picture[..., 1])
    assert red[105:135, 145:175].all()


def test_the_trunk_of_others_and_ones_own_shadow_are_as_they_are() -> None:
    made = stage()
    rotations, root = SKELETON.upright()
    made.add_human(10, "aiko", SKELETON.offsets, plain_figure(SKELETON), SKELETON.eye)
    made.pose_human(10, rotations, root + np.array([1.0, 0.0, 0.0]))
    view_of(made, "ken")
    own, other = (sum(len(batch.faces) for batch in made.actors[number].batches) for number in (9, 10))
    assert sum(len(batch.faces) for batch, _ in made.moving()) == own + other  # as the sun sees them
    limbs = sum(len(batch.faces) for batch, _ in made.moving(seen=True)) - other
    assert 0.5 * own < limbs < own


def test_the_aim_goes_with_the_eyes_and_says_whose_there_are(painter: Painter) -> None:
    made = stage()
    aim = Aim(ViewOptions(eyes="ken", headless=True))
    first = aim.begin(made, painter)
    rotations, root = SKELETON.upright()
    made.pose_human(9, rotations, root + np.array([0.5, 0.0, 0.0]))
    assert aim.step(made, 0.1).target - first.target == pytest.approx([0.5, 0.0, 0.0], abs=1e-9)
    with pytest.raises(CommandError, match='no human "aiko" to see by; there is: ken'):
        view_of(made, "aiko")
