"""between_hands: what the palms press from both sides goes with them, and stands again where it is put down."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
import pytest

from ahmss.algorithm import ObjectPose, frames
from ahmss.algorithm.messages import ObjectRecord, PoseRecord, SiteRecord, Start
from ahmss.body.array import Array
from ahmss.body.quaternion import from_matrix
from ahmss.body.skeleton import Skeleton

from .scene import program

SKELETON = Skeleton.of(1.76)
FLOOR = 0.1  # metres: what it stands on
OUT = {-1.0: np.array([0.0, 1.0, 0.0]), 1.0: np.array([0.0, -1.0, 0.0])}  # the right palm, at -y, looks to +y


def start() -> Start:
    sites = {"right": SiteRecord((0.0, -0.18, 0.2)), "left": SiteRecord((0.0, 0.18, 0.2))}
    box = ObjectRecord(3, "box", "carton", (0.0, 0.0, FLOOR), (1.0, 0.0, 0.0, 0.0), sites, {}, {})
    rotations, root = SKELETON.upright()
    return Start(
        kind="object",
        human=SKELETON.to_record(),
        pose=PoseRecord.of(rotations, root),
        object=box,
        frames=200,
        rate=60.0,
    )


def palm(side: float, place: Array) -> Array:
    out, thumb = OUT[side], np.array([1.0, 0.0, 0.0])
    return np.concatenate([place, from_matrix(np.stack([out, np.cross(thumb, out), thumb], axis=-1))])


def carried(middles: Iterable[tuple[float, ...]], apart: float = 0.36) -> Array:
    """Where the box is (F, 3) when the middle of the palms goes through these places, or they are so far apart, too."""
    rotations, root = SKELETON.upright()
    rows = []
    for k, middle in enumerate(middles, 1):
        x, y, z, wide = (*middle, apart)[:4]
        right, left = (palm(side, np.array([x, y + 0.5 * side * wide, z])) for side in (-1.0, 1.0))
        rows.append(np.concatenate([[k], root, rotations.reshape(172), right, left]))
    poses = list(frames(program("between_hands"), start(), rows))
    assert all(isinstance(pose, ObjectPose) for pose in poses)
    return np.array([pose.place for pose in poses])  # type: ignore[union-attr]


def test_it_goes_with_the_palms_and_stands_where_they_put_it_down() -> None:
    rise = [(0.0, 0.0, FLOOR + 0.2 + 0.01 * k) for k in range(31)]
    across = [(0.01 * k, 0.0, FLOOR + 0.5) for k in range(21)]
    down = [(0.2, 0.0, FLOOR + 0.5 - 0.01 * k) for k in range(36)]  # lower than it stood
    places = carried([*rise, *across, *down])
    np.testing.assert_allclose(places[30], [0.0, 0.0, FLOOR + 0.3], atol=1e-12)
    np.testing.assert_allclose(places[51], [0.2, 0.0, FLOOR + 0.3], atol=1e-12)
    np.testing.assert_allclose(places[-1], [0.2, 0.0, FLOOR], atol=1e-12)
    assert places[:, 2].min() == pytest.approx(FLOOR)


def test_palms_that_go_down_along_it_take_it_where_they_begin_to_rise() -> None:
    middles = [(0.0, 0.0, FLOOR + 0.24 - 0.01 * k) for k in range(5)] + [
        (0.0, 0.0, FLOOR + 0.2 + 0.01 * k) for k in range(9)
    ]
    places = carried(middles)
    np.testing.assert_allclose(places[:5, 2], FLOOR)
    assert places[-1, 2] == pytest.approx(FLOOR + 0.08)


@pytest.mark.parametrize(("apart", "middle"), [(0.38, 0.0), (0.36, 0.08)])
def test_palms_that_do_not_touch_it_leave_it(apart: float, middle: float) -> None:
    places = carried([(middle, 0.0, FLOOR + 0.2 + 0.01 * k) for k in range(20)], apart)
    np.testing.assert_allclose(places, np.broadcast_to([0.0, 0.0, FLOOR], places.shape))


def test_what_is_in_the_air_goes_with_palms_that_go_apart_and_is_left_where_it_stands_again() -> None:
    """It hung in the air where a hand had gone aside by itself, while its holder walked off."""
    rise = [(0.0, 0.0, FLOOR + 0.2 + 0.01 * k) for k in range(31)]
    apart = [(0.01 * k, 0.0, FLOOR + 0.5, 0.36 + 0.004 * k) for k in range(21)]
    down = [(0.2, 0.0, FLOOR + 0.5 - 0.01 * k, 0.44) for k in range(31)]
    off = [(0.2, 0.0, FLOOR + 0.2 + 0.01 * k, 0.44) for k in range(11)]
    places = carried([*rise, *apart, *down, *off])
    np.testing.assert_allclose(places[51], [0.2, 0.0, FLOOR + 0.3], atol=1e-12)
    np.testing.assert_allclose(places[-1], [0.2, 0.0, FLOOR], atol=1e-12)
