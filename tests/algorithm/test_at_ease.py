"""A motion that was made whole is slower where a joint or a palm turns too fast, and the same otherwise."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.algorithm import HumanTask
from ahmss.algorithm.messages import PoseRecord, Start
from ahmss.body.array import Array
from ahmss.body.inverse import solve
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle
from ahmss.body.skeleton import Skeleton
from ahmss.skills.at_ease import at_ease, resampled

FRAMES, ARM = 40, INDEX["right_lower_arm"]
Y, AHEAD = np.array([0.0, 1.0, 0.0]), np.array([0.3, -0.2, 0.2])


def task(frames: int = 0) -> HumanTask:
    body = Skeleton.of(1.7)
    rotations, root = body.upright()
    return HumanTask(Start(kind="human", human=body.to_record(), pose=PoseRecord.of(rotations, root), frames=frames))


def rows(one: HumanTask, degrees: float, *, palm: bool = False) -> Array:
    """A forearm, or a palm whose target it is, that turns evenly, so many degrees a frame from the tenth on."""
    turn = from_axis_angle(Y, np.radians(degrees * np.clip(np.arange(FRAMES) - 10.0, 0.0, 15.0)))
    rotations = np.repeat(one.start.rotations[None], FRAMES, axis=0)
    targets = np.zeros((FRAMES, 5, 8))
    if palm:
        targets[:, 0, :3], targets[:, 0, 3:7], targets[:, 0, 7] = one.start.root + AHEAD, turn, 1.0
    else:
        rotations[:, ARM] = turn * np.where(np.arange(FRAMES) % 2, 1.0, -1.0)[:, None]  # either sign is the same
    return one.block(rotations, np.repeat(one.start.root[None], FRAMES, axis=0), np.ones(44), targets)


def turned(rotations: Array) -> Array:
    """Degrees (n - 1,) from frame to frame."""
    cos = np.abs((rotations[1:] * rotations[:-1]).sum(axis=-1))
    return np.degrees(2.0 * np.arccos(np.clip(cos, 0.0, 1.0)))


def test_what_is_slow_stays_as_it_is() -> None:
    one = task()
    made = rows(one, 4.0)
    np.testing.assert_allclose(np.abs(at_ease(one, made)), np.abs(made), atol=1e-12)


@pytest.mark.parametrize("degrees", [8.0, 14.0])
def test_a_joint_that_turns_too_fast_takes_longer_for_the_same_way(degrees: float) -> None:
    one = task()
    made = at_ease(one, rows(one, degrees))
    arm = made[:, 4:176].reshape(-1, 43, 4)[:, ARM]
    assert turned(arm).max() < 6.0
    assert turned(arm).sum() == pytest.approx(15.0 * degrees, abs=1e-3)
    np.testing.assert_allclose(np.linalg.norm(arm, axis=1), 1.0, atol=1e-12)
    before = rows(one, degrees)[[0, -1], 4:176].reshape(2, 43, 4)[:, ARM]
    np.testing.assert_allclose(np.abs((arm[[0, -1]] * before).sum(axis=1)), 1.0, atol=1e-9)
    assert np.abs(np.diff(turned(arm)[12:])).max() < 6.0  # the pace changes softly
    assert len(made) < FRAMES * degrees / 5.0


def test_a_palm_that_turns_too_fast_in_the_world_takes_longer() -> None:
    one = task()
    made = at_ease(one, rows(one, 12.0, palm=True))
    targets = made[:, 220:260].reshape(-1, 5, 8)
    assert turned(targets[:, 0, 3:7]).max() < 7.6
    assert (targets[:, 0, 7] == 1.0).all()
    assert not targets[:, 1:].any()  # what nobody asked for stays so


def test_so_many_frames_as_were_asked_for_are_kept() -> None:
    one = task(FRAMES)
    assert len(at_ease(one, rows(one, 14.0))) == FRAMES


def test_between_frames_the_shorter_way_is_taken() -> None:
    one = task()
    made = resampled(rows(one, 8.0), np.array([12.5]))
    arm = made[0, 4:176].reshape(43, 4)[ARM]
    assert abs(arm @ from_axis_angle(Y, np.array(np.radians(20.0)))) == pytest.approx(1.0, abs=1e-6)
    assert made[0, 176:220] == pytest.approx(1.0)


@pytest.mark.parametrize("step", [0.005, 0.009])
def test_an_elbow_that_leaves_straight_takes_as_long_as_it_needs(step: float) -> None:
    """It bends by the root of how far the hand goes: half as fast a hand is no elbow half as fast."""
    one = task()
    made = rows(one, 0.0, palm=True)
    far = np.array([0.0, -0.2, -0.9])  # below the shoulder, farther than the arm is long
    palm = one.start.grip("right")
    in_by = np.clip(np.arange(FRAMES) - 10.0, 0.0, None)[:, None] * step
    targets = made[:, 220:260].reshape(-1, 5, 8)
    down = (far / np.linalg.norm(far))[None]
    targets[:, 0, :3] = palm.place + (0.003 - in_by) * down
    targets[:, 0, 3:7] = palm.rotation
    shown = at_ease(one, made)

    def fastest(some: Array) -> float:
        ends, rotations = some[:, 220:260].reshape(-1, 5, 8), some[:, 4:176].reshape(-1, 43, 4)
        return float(turned(solve(one.human, rotations, some[:, 1:4], ends)[:, ARM]).max())

    assert fastest(made) > 8.0
    assert fastest(shown) < 6.0
