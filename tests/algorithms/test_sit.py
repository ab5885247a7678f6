"""sit: down onto a chair wherever it stands, and up again, also with something in a hand."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import HumanPose, HumanTask, Transform, frames
from ahmss.algorithm.messages import ObjectRecord
from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.links import LINKS
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, rotate, to_rotation_vector
from ahmss.errors import AlgorithmError
from ahmss.motion.contact import foot_points
from ahmss.reaching.prism import clearance
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import skin_of
from ahmss.reaching.standing import centre_of_mass
from ahmss.skills import stepping
from ahmss.walking import trip
from ahmss.walking.walkers import Walker

from .reached import TABLE, outlined, prisms
from .scene import Body, frame_of, program, record
from .solids import LEGS, SEAT, deepest

CHAIR = "room/chair"
UP = np.array([0.0, 0.0, 1.0])
STAND = np.array([0.35, 0.0, 0.0])


def chair(seed: int) -> Transform:
    """A chair anywhere, turned by any angle."""
    random = np.random.default_rng(seed)
    return Transform(
        np.append(random.uniform(-3.0, 3.0, 2), 0.0), from_axis_angle(UP, float(random.uniform(-np.pi, np.pi)))
    )


def at(name: str, frame: Transform, place: Array = STAND, turned: float = 0.0) -> Body:
    """A human who stands at a place of the chair, looking where a sitter looks, or turned by degrees."""
    x, y, _ = frame.apply(place).tolist()
    heading = np.degrees(2.0 * np.arctan2(frame.rotation[3], frame.rotation[0]))
    return Body(name, x, y, float(heading + turned))


def does(
    body: Body, action: str, frame: Transform, told: Callable[[HumanTask], Iterator[Any]] | None = None, **given: Any
) -> list[HumanPose]:
    start = body.start(CHAIR, action, frame=frame, hand="", **given)
    return body.do(told or "sit", msgspec.structs.replace(start, object=outlined(start.object, 3)))  # type: ignore[arg-type]


def holding(body: Body, lower: float = 0.0) -> None:
    """Bend the right arm as one does who holds a cup, or let it hang."""
    left = np.array([0.0, 1.0, 0.0])
    body.rotations[4] = multiply(body.rotations[4], from_axis_angle(left, -1.4 + lower))


@pytest.mark.parametrize("frames_asked", [1, 8])
def test_who_is_to_sit_in_a_moment_takes_most_of_a_second_and_comes_to_the_seat(frames_asked: int) -> None:
    frame = chair(0)
    body = at("ken", frame)
    shown = does(body, "sit", frame, frames=frames_asked, wish=True)
    ahead, aside, height = frame.inverse().apply(body.root).tolist()
    assert abs(ahead + 0.055) < 0.005
    assert abs(aside) < 0.005
    assert 0.10 < height - 0.43 < 0.13
    assert 48 < len(shown) < 65
    up = does(body, "stand_up", frame, frames=frames_asked, wish=True)
    assert len(up) > 40
    assert body.root[2] > 0.9


def arrays(shown: list[HumanPose]) -> tuple[Array, Array]:
    return np.array([pose.rotations for pose in shown]), np.array([pose.root for pose in shown])


@pytest.mark.parametrize("seed", range(6))
def test_one_sits_on_the_seat_and_neither_in_nor_over_it(seed: int) -> None:
    name, frame = ("ken", "aiko")[seed % 2], chair(seed)
    body = at(name, frame)
    down = does(body, "sit", frame)
    ahead, aside, height = frame.inverse().apply(body.root).tolist()
    assert abs(ahead + 0.055) < 0.005
    assert abs(aside) < 0.005
    assert 0.10 < height - 0.43 < 0.13
    up = does(body, "stand_up", frame)
    depths = [deepest(name, pose, frame, (*SEAT, *LEGS))[0] for pose in [*down[::9], down[-1], *up[::9]]]
    assert -0.006 < max(depths) < 0.002


@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_the_feet_stay_and_the_weight_is_over_them_until_the_seat_is_near(name: str) -> None:
    frame = chair(7)
    body = at(name, frame)
    planted = foot_points(body.skeleton, body.rotations[None], body.root[None])[0]
    for action in ("sit", "stand_up"):
        rotations, root = arrays(does(body, action, frame))
        points = foot_points(body.skeleton, rotations, root)
        assert np.abs(points - planted).max() < 1e-3
        centre = frame.inverse().apply(centre_of_mass(body.skeleton, rotations, root))
        heel = frame.inverse().apply(planted.reshape(-1, 3))[:, 0].min()
        high = root[:, 2] > 0.43 + 0.30  # the hips are 18 cm over where they come to
        assert high.sum() > 40
        assert (centre[high, 0] - heel).min() > 0.03
        assert np.linalg.norm(np.diff(root, axis=0), axis=1).max() * 60.0 < 1.0


def test_the_trunk_leans_before_the_knees_bend_far() -> None:
    frame = chair(1)
    body = at("ken", frame)
    rotations, root = arrays(does(body, "sit", frame))
    trunk = rotate(multiply(rotations[:, 0], rotations[:, 1]), np.array([1.0, 0.0, 0.0]))
    lean = np.degrees(np.arccos(np.clip(trunk[:, 2], -1.0, 1.0)))
    quarter = int(np.argmax(root[:, 2] < root[0, 2] - 0.25 * (root[0, 2] - root[-1, 2])))
    assert lean[quarter] > 25.0
    assert 35.0 < lean.max() < 50.0
    assert lean[-1] < 8.0


@pytest.mark.parametrize("name", ["ken", "aiko"])
@pytest.mark.parametrize("lower", [0.0, 1.4])
def test_a_hand_that_holds_something_keeps_it_upright_and_clear_of_the_chair(name: str, lower: float) -> None:
    frame = chair(3)
    body = at(name, frame)
    holding(body, lower)
    before = body.grip().rotation
    for action in ("sit", "stand_up"):
        shown = does(body, action, frame, busy=["right"])
        rotations, root = arrays(shown)
        palms = grips(body.skeleton, rotations, root)[:, 0]
        tipped = to_rotation_vector(multiply(conjugate(before), palms[:, 3:]))
        assert np.degrees(np.linalg.norm(tipped, axis=-1)).max() < 2.0
        assert np.linalg.norm(np.diff(palms[:, :3], axis=0), axis=1).max() * 60.0 < 1.3
        assert all(pose.targets[0, 7] == 1.0 for pose in shown)
        assert max(deepest(name, pose, frame, (*SEAT, *LEGS))[0] for pose in shown[::10]) < 0.002
        if action == "sit":
            assert palms[-1, 2] > 0.43 + 0.2


def test_who_stands_a_step_aside_goes_there_first() -> None:
    frame = chair(4)
    body = at("aiko", frame, STAND + np.array([0.45, 0.35, 0.0]), turned=60.0)
    does(body, "sit", frame)
    assert np.linalg.norm(frame.inverse().apply(body.root)[:2] - [-0.055, 0.0]) < 0.01


def test_who_is_far_is_told_to_walk_there_first() -> None:
    frame = chair(5)
    body = at("ken", frame, STAND + np.array([12.6, 0.0, 0.0]))
    with pytest.raises(AlgorithmError, match=r"room/chair is 12\.6 m from here; `do floor walk to chair` first"):
        does(body, "sit", frame)


def test_who_is_some_metres_away_walks_there() -> None:
    frame = chair(5)
    body = at("ken", frame, STAND + np.array([1.6, 0.4, 0.0]), turned=90.0)
    does(body, "sit", frame)
    assert np.linalg.norm(frame.inverse().apply(body.root)[:2] - [-0.055, 0.0]) < 0.01


def test_hands_of_who_steps_to_it_past_a_table_are_drawn_in() -> None:
    body, table = Body("ken", 0.0, 0.3, 0.0), record(TABLE)
    rotations, root = arrays(does(body, "sit", frame_of(CHAIR), world=[outlined(table, 11)]))
    for side in ("right", "left"):
        points, radii = skin_of(Reacher.of(body.skeleton, side), rotations, root)
        assert float((clearance(prisms(table), points) - radii).min()) > 0.0
    arms = [i for i, link in enumerate(LINKS) if link.endswith(("arm", "hand"))]
    steps = np.abs((rotations[1:, arms] * rotations[:-1, arms]).sum(axis=-1))
    assert np.degrees(2.0 * np.arccos(np.clip(steps, 0.0, 1.0))).max() < 6.0


def somebody(frame: Transform, place: tuple[float, float]) -> ObjectRecord:
    """aiko at a place of the chair."""
    x, y, _ = frame.apply(np.array([*place, 0.0])).tolist()
    return ObjectRecord(-7, "aiko", "human", (x, y, 0.0), (1.0, 0.0, 0.0, 0.0))


@pytest.mark.parametrize("away", [0.0, 0.25])
def test_who_is_on_the_chair_is_named_when_patience_ends(away: float, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stepping, "_PATIENCE", 0.5)
    frame = chair(2)
    stands = at("ken", frame, STAND + np.array([away, 0.0, 0.0]))
    with pytest.raises(AlgorithmError, match="aiko is where one sits on room/chair; take another seat"):
        does(stands, "sit", frame, world=[somebody(frame, (-0.05, 0.1))])


def test_one_waits_for_who_is_on_the_chair_standing_still_and_then_sits_down(monkeypatch: pytest.MonkeyPatch) -> None:
    frame, asked = chair(2), list[HumanTask]()
    seat = frame.apply(np.array([-0.055, 0.0, 0.43]))

    def walkers(task: HumanTask) -> list[Walker]:
        asked.append(task)
        return [Walker.of(np.zeros(1), seat[None, :2], "aiko")] if len(asked) <= 40 else []

    monkeypatch.setattr(stepping, "walkers", walkers)
    body = at("ken", frame)
    rotations, root = body.rotations.copy(), body.root.copy()
    shown = does(body, "sit", frame)
    still = np.array([pose.rotations for pose in shown[:40]])
    assert np.abs(still - rotations).max() < 1e-3
    assert np.abs(np.array([pose.root for pose in shown[:40]]) - root).max() < 1e-6
    assert len(shown) == 40 + 126
    assert asked[0].notes == ["waits for aiko, who is where one sits on room/chair"]
    assert np.linalg.norm(shown[-1].root - seat) < 0.14


def test_who_stands_where_one_stands_to_sit_down_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trip, "_PATIENCE", 0.5)
    frame = chair(2)
    body = at("ken", frame, STAND + np.array([0.75, 0.0, 0.0]))
    with pytest.raises(AlgorithmError, match="aiko stands in the way, where one is to stand"):
        does(body, "sit", frame, world=[somebody(frame, (0.4, 0.05))])


def test_who_sits_beside_is_no_hindrance() -> None:
    frame = chair(2)
    body = at("ken", frame)
    assert len(does(body, "sit", frame, world=[somebody(frame, (-0.05, 0.6))])) == 126


def test_who_sits_does_not_sit_down_and_who_stands_does_not_stand_up() -> None:
    frame = chair(6)
    body = at("ken", frame)
    with pytest.raises(AlgorithmError, match="one must sit on room/chair to stand up from it"):
        does(body, "stand_up", frame)
    does(body, "sit", frame)
    with pytest.raises(AlgorithmError, match="one must stand to sit down"):
        does(body, "sit", frame)


@pytest.mark.parametrize("length", [90, 200])
def test_it_has_as_many_frames_as_asked_for(length: int) -> None:
    frame = chair(2)
    body = at("ken", frame)
    start = body.start(CHAIR, "sit", frame=frame, hand="", frames=length)
    assert len(list(frames(program("sit"), start))) == length
