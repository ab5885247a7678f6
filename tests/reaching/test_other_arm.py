"""The arm that does not reach: what a trunk that bends would bring into a table is moved aside, the elbow too."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.steps import finished
from ahmss.reaching.other_arm import out_of_things
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import skin_of
from ahmss.reaching.standing import Posture

HUMAN = Skeleton.of(1.72, "male")
TABLE = Prism(np.array([[0.25, -0.6], [1.25, -0.6], [1.25, 0.6], [0.25, 0.6]]), 0.0, 0.88)
Y = np.array([0.0, 1.0, 0.0])


def bending(side: str, raised: float, elbow: float, bent: float) -> tuple[Posture, Posture]:
    """Who has an arm before them, raised and bent by so many radians, and the same as the trunk bends over a table."""
    reacher, (rotations, root) = Reacher.of(HUMAN, side), HUMAN.upright()
    upper = reacher.links.start
    rotations[upper] = multiply(from_axis_angle(Y, np.array(-raised)), rotations[upper])
    rotations[upper + 1] = multiply(rotations[upper + 1], from_axis_angle(Y, np.array(elbow)))
    poses = np.repeat(rotations[None], 120, axis=0)
    poses[:, 1] = multiply(rotations[1], from_axis_angle(Y, bent * minimum_jerk(np.arange(1, 121) / 120)))
    return Posture(rotations, root), Posture(poses, np.repeat(root[None], 120, axis=0))


def gap(reacher: Reacher, poses: Posture, rows: Array) -> float:
    rotations = poses.rotations.copy()
    rotations[:, reacher.links] = rows
    points, radii = skin_of(reacher, rotations, poses.root)
    return float((clearance([TABLE], points) - radii).min())


@pytest.mark.parametrize("side", ["right", "left"])
@pytest.mark.parametrize(
    ("raised", "elbow", "bent"), [(0.2, 1.5, 0.9), (0.6, 1.5, 0.9), (1.0, 1.0, 0.9), (1.4, 1.9, 1.3)]
)
def test_an_arm_that_a_trunk_would_take_into_a_table_is_moved_aside_softly(
    side: str, raised: float, elbow: float, bent: float
) -> None:
    reacher = Reacher.of(HUMAN, side)
    start, poses = bending(side, raised, elbow, bent)
    assert gap(reacher, poses, poses.rotations[:, reacher.links]) < -0.05
    rows = finished(out_of_things(reacher, [TABLE], start, poses))
    assert gap(reacher, poses, rows) > 0.0
    shown = np.concatenate([start.rotations[None, reacher.links], rows])
    turned = np.linalg.norm(to_rotation_vector(multiply(conjugate(shown[:-1]), shown[1:])), axis=-1)
    assert np.degrees(turned.max()) < 4.0
    assert np.degrees(turned[0].max()) < 0.1


def test_an_arm_that_stays_clear_is_left_as_it_is() -> None:
    reacher = Reacher.of(HUMAN, "left")
    start, poses = bending("left", 1.0, 1.5, 0.3)
    rows = finished(out_of_things(reacher, [TABLE], start, poses))
    np.testing.assert_array_equal(rows, poses.rotations[:, reacher.links])
