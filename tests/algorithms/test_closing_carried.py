"""A hand that closes while its body is carried on: the elbow stays out of what the thing stands on."""

from __future__ import annotations

from collections.abc import Callable, Iterable

import msgspec
import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.blending import blend
from ahmss.body.inverse import LEFT_HAND, solve
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle
from ahmss.reaching.comfort import palms_at
from ahmss.reaching.prism import clearance
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.skin import skin_of
from ahmss.reaching.tracking import Tracking
from ahmss.skills.closing_carried import closing_carried
from ahmss.skills.stepping import IMPORTANCE

from .reached import TABLE, outlined, prisms
from .scene import CUP, Body, record

FRAMES, ON = 30, np.array([0.0025, -0.0035, 0.0])  # metres a frame
ARM = slice(INDEX["left_upper_arm"], INDEX["left_hand"] + 1)
LOWER = 0.2  # metres from the shoulder down to the palm
LINKS = 16  # of forearm, hand and fingers
TURN = 60  # of the natural turns of a palm
OVER = 0.06  # metres from the table's top up to it


def closed(close: Callable[[HumanTask, str, Array], Iterable[Array]]) -> tuple[Array, Array]:
    """Arms (F, 3, 4) as they are shown, and how near the left forearm is to a table in each frame (F,).

    The body goes by along a table's edge, the palm stays where it is over the top; a walk goes on meanwhile.
    """
    body = Body("aiko", facing=-110.0)
    reacher = Reacher.of(body.skeleton, "left")
    shoulder = reacher.shoulder(seat(body.skeleton, body.rotations, body.root))
    place = shoulder + np.array([0.1, -0.39, -LOWER])
    arm = Tracking(reacher, reacher.arm.from_pose(body.rotations[ARM]))
    asked = np.append(place, palms_at(shoulder, place, reacher.sign)[TURN])
    for _ in range(90):
        palm = arm.step(asked, seat(body.skeleton, body.rotations, body.root), 1.0)
    top = float(palm[2]) - OVER
    turn = from_axis_angle(np.array([0.0, 0.0, 1.0]), np.radians(-20.0))
    middle = shoulder + np.array([0.48, -0.15, 0.0])
    table = outlined(record(TABLE, Transform(np.array([middle[0], middle[1], top - 0.88]), turn)), 7)
    walk, targets = body.rotations.copy(), np.zeros((5, 8))
    targets[LEFT_HAND, :7], targets[LEFT_HAND, 7] = palm, 1.0
    body.rotations[ARM] = reacher.arm.into_pose(arm.links)
    start = body.start(CUP, "grasp", hand="left")
    task = HumanTask(msgspec.structs.replace(start, object=None, world=[table], carried=True))
    task.see(body.row(0))
    importance = np.zeros(44)
    importance[ARM] = 1.0
    rows = task.block(
        np.repeat(body.rotations[None], FRAMES, axis=0), np.repeat(body.root[None], FRAMES, axis=0), importance,
        np.repeat(targets[None], FRAMES, axis=0),
    )  # fmt: skip
    arms, gaps = [body.rotations[ARM]], list[float]()
    for k, row in enumerate(close(task, "left", rows), 1):
        made, own = row.reshape(-1)[4:176].reshape(43, 4), row.reshape(-1)[176:219]
        both = blend(np.stack([made, walk]), np.stack([own, IMPORTANCE[:43]]), body.rotations)
        body.root = body.root + ON
        body.rotations = solve(body.skeleton, both, body.root, targets)
        task.see(body.row(k))
        points, radii = (part[::LINKS] for part in skin_of(reacher, body.rotations, body.root))
        gaps.append(float((clearance(prisms(table), points) - radii).min()))
        arms.append(body.rotations[ARM])
    return np.array(arms), np.array(gaps)


def test_the_elbow_is_swung_out_of_the_table_that_the_thing_stands_on() -> None:
    _, left = closed(lambda _task, _side, rows: rows)
    arms, kept = closed(lambda task, side, rows: closing_carried(task, side, [rows]))
    assert left.min() < -0.004
    assert kept.min() > 0.0
    turned = 2.0 * np.degrees(np.arccos(np.clip(np.abs((arms[1:] * arms[:-1]).sum(axis=-1)), 0.0, 1.0)))
    assert 0.5 < turned.max() < 6.0
