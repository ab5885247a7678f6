"""swing, with the door that it moves: opened wide and shut, pushed and pulled, with either hand, wherever it hangs."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import HumanPose, HumanTask, Transform, frames
from ahmss.algorithm.messages import ObjectRecord, Start
from ahmss.bench.solids import Solids
from ahmss.body.arm import Arm, excess
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE, RIGHT_HAND, grips, solve
from ahmss.body.links import INDEX, LINKS, fingers
from ahmss.body.quaternion import from_axis_angle, from_matrix, multiply, rotate
from ahmss.errors import AlgorithmError
from ahmss.grasping import rolling
from ahmss.motion.quality import worst_pop
from ahmss.reaching.prism import clearance
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import skin_of
from ahmss.skills import stepping
from tests.demo.skin import Skin
from tests.grasping.shapes import kind, outside

from .reached import TABLE, outlined, prisms
from .scene import DOOR, WORKSPACE, Body, frame_of, module, program, record
from .solids import JAMBS, LEAF, deepest
from .test_keeping import holding

SOLIDS = Solids(WORKSPACE)
UP = np.array([0.0, 0.0, 1.0])
WIDE = 1.3
PASSES = 0.55  # metres that a human needs
OPPOSITE = -0.6  # cosine between the sides of the lever on which fingers are
BEFORE, BEHIND = np.array([0.5, -0.6, 0.0]), np.array([0.7, 0.9, 0.0])  # in the closed door's frame, either side
HANGS = Transform(np.array([0.4, 0.0, 0.005]), from_axis_angle(UP, np.pi))  # in the doorway's


@dataclass
class Swung:
    """A human at a door: the frames shown, and the door's frame when closed, its angle at each of them."""

    name: str
    body: Body
    closed: Transform
    shown: list[HumanPose]
    angle: Array

    def leaf(self, frame: int) -> Transform:
        return self.closed.then(Transform(np.zeros(3), from_axis_angle(UP, float(self.angle[frame]))))


def closed_door(seed: int) -> Transform:
    random = np.random.default_rng(seed)
    place = np.append(random.uniform(-3.0, 3.0, 2), 0.005)
    return Transform(place, from_axis_angle(UP, float(random.uniform(-np.pi, np.pi))))


def swung(
    name: str, action: str, at: Array, facing: float, seed: int = 0, *, busy: tuple[str, ...] = (), angle: float = -1.0
) -> Swung:
    """Who stands at a place of the closed door's frame and faces so many degrees of it opens or closes it."""
    return _swung(name, action, tuple(at.tolist()), facing, seed, busy, angle)


@cache  # several tests measure one motion
def _swung(
    name: str, action: str, at: tuple[float, ...], facing: float, seed: int, busy: tuple[str, ...], angle: float
) -> Swung:
    closed, angle = closed_door(seed), angle if angle >= 0.0 else (0.0 if action == "open" else WIDE)
    body, given = _before(name, closed, at, facing, angle, busy)
    start = body.start(DOOR, action, **given)
    before = start.pose
    shown = body.do("swing", msgspec.structs.replace(start, object=outlined(start.object, 3)))  # type: ignore[arg-type]
    moves = body.start(DOOR, action, kind="object", **given, parameters={"closed_hand": 90.0})
    moves = msgspec.structs.replace(moves, pose=before)
    poses = list(frames(program("door"), moves, body.rows(shown)))
    ahead = np.array([rotate(pose.rotation, np.array([1.0, 0.0, 0.0])) for pose in poses])
    own = closed.inverse().apply(closed.place + ahead)
    return Swung(name, body, closed, shown, np.arctan2(own[:, 1], own[:, 0]))


def _before(
    name: str, closed: Transform, at: tuple[float, ...], facing: float, angle: float, busy: tuple[str, ...]
) -> tuple[Body, dict[str, Any]]:
    """Who stands at a place of the closed door's frame and faces so many degrees of it; what START is to say."""
    x, y, _ = closed.apply(np.array(at)).tolist()
    heading = 2.0 * np.arctan2(closed.rotation[3], closed.rotation[0])
    body = Body(name, x, y, float(np.degrees(heading) + facing))
    leaf = Transform(closed.place, multiply(closed.rotation, from_axis_angle(UP, angle)))
    return body, {"frame": leaf, "states": {"angle": angle}, "hand": "", "busy": list(busy)}


def at_the_door(name: str, action: str, at: Array, facing: float) -> tuple[Body, Start]:
    """Who stands at a place of the closed door's frame, and the START of what they do there."""
    body, given = _before(name, closed_door(0), tuple(at.tolist()), facing, 0.0, ())
    start = body.start(DOOR, action, **given)
    return body, msgspec.structs.replace(start, object=outlined(start.object, 3))  # type: ignore[arg-type]


CASES = [("open", BEFORE, 90.0), ("open", BEHIND, -90.0), ("close", BEFORE, 90.0), ("close", BEHIND, -120.0)]
BY_OTHERS = [("aiko", "open"), ("ken", "close")]
BY_EITHER = [  # one of the two, the other in the long tests
    pytest.param(name, *case, marks=[pytest.mark.long] if (i + j) % 2 else [])
    for i, name in enumerate(("ken", "aiko"))
    for j, case in enumerate(CASES)
]


@pytest.mark.parametrize(("name", "action", "at", "facing"), BY_EITHER)
def test_it_swings_wide_enough_to_pass_or_shut_and_nothing_goes_through_leaf_or_frame(
    name: str, action: str, at: Array, facing: float
) -> None:
    made = swung(name, action, at, facing, seed=len(action))
    end = float(made.angle[-1])
    if action == "open":
        assert 0.8 * np.sin(end) - 0.11 > PASSES  # less a lever and half the leaf
    else:
        assert abs(end) < np.radians(2.0)
    doorway = made.closed.then(HANGS.inverse())
    depths = [
        max(deepest(name, pose, made.leaf(k), LEAF), deepest(name, pose, doorway, JAMBS))
        for k, pose in [*enumerate(made.shown)][::12]
    ]
    assert max(depths)[0] < 0.006, max(depths)


@pytest.mark.parametrize(("name", "action", "at", "facing"), BY_EITHER)
def test_the_hand_is_on_the_lever_while_the_leaf_turns_softly(name: str, action: str, at: Array, facing: float) -> None:
    made = swung(name, action, at, facing, seed=3)
    turns = np.flatnonzero(np.abs(np.diff(made.angle)) > 1e-4)
    lever = np.array([0.68, -0.075 if at is BEFORE else 0.075, 1.02])
    rotations, root = np.array([pose.rotations for pose in made.shown]), np.array([pose.root for pose in made.shown])
    palms = grips(made.body.skeleton, rotations, root)
    apart = [
        np.linalg.norm(made.leaf(int(k)).apply(lever) - palms[k, :, :3], axis=-1).min() for k in (turns + 1).tolist()
    ]
    assert len(turns) > 60
    assert max(apart) < 0.03  # where the fingers begin: 16 mm from the middle of the palm, and the half of the lever
    assert np.degrees(np.abs(np.diff(made.angle, n=2)).max()) < 0.12
    bent = np.degrees(2.0 * np.arccos(np.clip(np.abs(rotations[:, INDEX["spine"], 0]), 0.0, 1.0)))
    assert bent.max() < 20.0
    assert worst_pop(rotations[1:]).degrees < 5.0


@pytest.mark.parametrize(
    ("name", "action", "at", "facing"),
    [
        ("ken", "close", BEFORE, 90.0), ("ken", "open", BEHIND, -90.0), ("ken", "close", BEHIND, -120.0),
        ("aiko", "close", BEFORE, 70.0),
    ],
)  # fmt: skip
def test_fingers_come_to_the_lever_and_leave_it_beside_lever_and_leaf(
    name: str, action: str, at: Array, facing: float
) -> None:
    made = swung(name, action, at, facing)
    turns = np.flatnonzero(np.abs(np.diff(made.angle)) > 1e-4)
    skin = Skin.read(WORKSPACE.humans.shape(name).glb, made.body.skeleton)
    chosen = np.flatnonzero(np.isin(skin.link, [INDEX["right_hand"], *fingers("right")]))
    frames = [*range(turns[0] - 60, turns[0]), *range(turns[-1], len(made.shown))]
    depths: list[float] = []
    for k in frames:
        points = skin.posed(made.shown[k].rotations, made.shown[k].root, chosen)
        depths.append(float(SOLIDS.depth("door", made.leaf(k).row(), {}, points).max()))
    assert max(depths) < 0.003, frames[int(np.argmax(depths))] - len(made.shown)


@pytest.mark.parametrize(
    ("name", "action"),
    [("ken", "open"), ("aiko", "close"), *(pytest.param(*one, marks=pytest.mark.long) for one in BY_OTHERS)],
)
def test_fingers_and_thumb_are_on_the_lever_all_the_way_and_not_in_it(name: str, action: str) -> None:
    made = swung(name, action, BEFORE, 90.0, seed=3)
    turns = np.flatnonzero(np.abs(np.diff(made.angle)) > 1e-4) + 1
    for k in turns[:: len(turns) // 5].tolist():
        around = on_lever(made, k)
        deepest = min(gap for gap, _ in around.values())
        assert deepest > -0.002, (k, around)
        assert around["thumb"][0] < 0.0035, (k, around)
        on = [finger for finger, (gap, _) in around.items() if finger != "thumb" and gap < 0.003]
        assert len(on) >= 3, (k, around)
        sides = np.concatenate([touching for _, touching in around.values()])
        assert (sides @ sides.T).min() < OPPOSITE, k


@pytest.mark.parametrize(("name", "action", "at", "facing"), BY_EITHER)
def test_neither_palm_nor_finger_is_in_the_door_that_it_turns_and_no_joint_is_fast(
    name: str, action: str, at: Array, facing: float
) -> None:
    made = swung(name, action, at, facing, seed=3)
    turns = np.flatnonzero(np.abs(np.diff(made.angle)) > 1e-4) + 1
    skin = Skin.read(WORKSPACE.humans.shape(name).glb, made.body.skeleton)
    hand = [INDEX["right_hand"], *fingers("right")]
    chosen = np.flatnonzero(np.isin(skin.link, hand))
    faces = np.searchsorted(chosen, skin.faces[np.isin(skin.faces, chosen).all(axis=1)])
    for k in turns[::8].tolist():
        points = skin.posed(made.shown[k].rotations, made.shown[k].root, chosen)
        points = np.concatenate([points, points[faces].mean(axis=1)])
        assert SOLIDS.depth("door", made.leaf(k).row(), {}, points).max() < 0.0015, k
    rotations = np.array([pose.rotations for pose in made.shown])
    steps = np.abs((rotations[2:] * rotations[1:-1]).sum(axis=-1))[
        :, [INDEX["right_upper_arm"], INDEX["right_lower_arm"], *hand]
    ]
    assert np.degrees(2.0 * np.arccos(np.clip(steps, 0.0, 1.0))).max() < 5.5


def on_lever(made: Swung, k: int) -> dict[str, tuple[float, Array]]:
    """By finger how far its skin is from the leaf, metres, and on which sides of its axis it touches (n, 3)."""
    skin = Skin.read(WORKSPACE.humans.shape(made.name).glb, made.body.skeleton)
    leaf = kind("door")
    leaf = leaf[np.linalg.norm(leaf.mean(axis=1) - np.array([0.68, 0.0, 1.02]), axis=1) < 1.2]
    found: dict[str, tuple[float, Array]] = {}
    for finger in ("thumb", "index", "middle", "ring", "little"):
        chosen = np.flatnonzero(np.isin(skin.link, [i for i in fingers("right") if f"right_{finger}" in LINKS[i]]))
        points = made.leaf(k).inverse().apply(skin.posed(made.shown[k].rotations, made.shown[k].root, chosen))
        faces = skin.faces[np.isin(skin.faces, chosen).all(axis=1)]
        points = np.concatenate([points, points[np.searchsorted(chosen, faces)].mean(axis=1)])
        apart = outside(points, leaf)
        aside = (points[apart < 0.003] - np.array([0.68, -0.075, 1.02])) * np.array([0.0, 1.0, 1.0])
        found[finger] = float(apart.min()), aside / np.linalg.norm(aside, axis=1, keepdims=True)
    return found


@pytest.mark.parametrize("busy", ["", "right"])
@pytest.mark.parametrize(("action", "at", "facing"), CASES)
def test_the_arm_is_within_its_limits(busy: str, action: str, at: Array, facing: float) -> None:
    made = swung("ken", action, at, facing, seed=5, busy=(busy,) if busy else ())
    side = "left" if busy == "right" else "right"
    arm, first = Arm.of(made.body.skeleton, side), INDEX[f"{side}_upper_arm"]
    held = [pose.rotations[first : first + 3] for pose in made.shown if pose.targets[int(side == "left"), 7] > 0.0]
    assert len(held) > 250
    assert np.degrees(excess(arm, arm.from_pose(np.array(held))).max()) < 8.0


@pytest.mark.parametrize("busy", ["right", pytest.param("left", marks=pytest.mark.long)])  # else the right one does it
@pytest.mark.parametrize(("action", "at", "facing"), CASES)
def test_the_free_hand_does_it(busy: str, action: str, at: Array, facing: float) -> None:
    made = swung("ken", action, at, facing, seed=9, busy=(busy,))
    assert abs(made.angle[-1] - (WIDE if action == "open" else 0.0)) < np.radians(3.0)
    links = [INDEX[f"{busy}_{part}"] for part in ("upper_arm", "lower_arm", "hand")]
    assert all((pose.importance[links] == 0.0).all() for pose in made.shown)


@pytest.mark.parametrize("seed", range(3))
def test_it_is_done_from_a_step_or_two_elsewhere(seed: int) -> None:
    random = np.random.default_rng(seed)
    at = BEFORE + np.append(random.uniform((-0.5, -0.8), (0.3, 0.1)), 0.0)
    made = swung("aiko", "open", at, float(random.uniform(0.0, 180.0)), seed)
    assert made.angle[-1] > WIDE - np.radians(3.0)


def test_a_leaf_left_half_way_is_swung_on() -> None:
    made = swung("ken", "close", BEFORE, 90.0, angle=0.7)
    assert abs(made.angle[-1]) < np.radians(2.0)


def test_who_has_pushed_it_open_pulls_it_shut_from_where_they_stand() -> None:
    opened = swung("ken", "open", BEFORE, 90.0)
    where = opened.closed.inverse().apply(opened.body.root)
    assert where[1] > 0.05  # where the leaf was
    ahead = opened.closed.inverse().then(Transform(opened.body.root, opened.body.rotations[0])).rotation
    facing = rotate(ahead, np.array([0.0, 0.0, -1.0]))
    made = swung("ken", "close", where * [1.0, 1.0, 0.0], float(np.degrees(np.arctan2(facing[1], facing[0]))))
    assert abs(made.angle[-1]) < np.radians(2.0)
    assert made.closed.inverse().apply(made.shown[-1].root)[1] < -0.3
    first = np.flatnonzero(np.abs(np.diff(made.angle)) > 1e-4)[0]
    assert np.abs(np.array([pose.root for pose in made.shown[:first]]) - made.shown[0].root).max() < 0.02


def drawn_in(x: float, y: float) -> Body:
    """ken at a place, the left hand before the belly: a walk that ended beside a thing has left it so."""
    body = Body("ken", x, y, 125.0)
    targets, heading = np.zeros((5, 8)), from_axis_angle(UP, np.radians(125.0))
    palm = from_matrix(np.array([[-0.8, 0.0, -0.6], [0.0, -1.0, 0.0], [-0.6, 0.0, 0.8]]))  # to the belly, the thumb up
    targets[1, :3], targets[1, 3:7] = body.root + rotate(heading, np.array([0.2, 0.08, 0.13])), multiply(heading, palm)
    targets[1, 7] = 1.0
    body.rotations = solve(body.skeleton, body.rotations, body.root, targets)
    return body


def left_arm_turns(rotations: Array) -> float:
    """Degrees by which a joint of the left arm turns in a frame of (n, 43, 4), at the most."""
    arm = [INDEX[f"left_{link}"] for link in ("upper_arm", "lower_arm", "hand")]
    steps = np.abs((rotations[1:, arm] * rotations[:-1, arm]).sum(axis=-1))
    return float(np.degrees(2.0 * np.arccos(np.clip(steps, 0.0, 1.0))).max())


@pytest.mark.parametrize("beside", [True, False])
def test_a_hand_that_was_drawn_in_stays_clear_of_the_table_or_is_let_down_and_nothing_jumps(*, beside: bool) -> None:
    closed, body = Transform(np.zeros(3), from_axis_angle(UP, 0.0)), drawn_in(0.43, -0.42)
    table = record(TABLE, Transform(np.array([-0.27, -1.0, 0.0]), closed.rotation))
    start = body.start(DOOR, "open", frame=closed, hand="")
    start = msgspec.structs.replace(
        start, object=outlined(start.object, 3), world=[outlined(table, 11)] if beside else []
    )
    before = body.rotations.copy()
    shown = body.do("swing", start)
    rotations, root = np.array([pose.rotations for pose in shown]), np.array([pose.root for pose in shown])
    points, radii = skin_of(Reacher.of(body.skeleton, "left"), rotations, root)
    assert (float((clearance(prisms(table), points) - radii).min()) > 0.0) is beside
    assert left_arm_turns(rotations) < 5.0
    arm = [INDEX[f"left_{link}"] for link in ("upper_arm", "lower_arm", "hand")]
    np.testing.assert_allclose(np.abs((rotations[0, arm] * before[arm]).sum(axis=-1)), 1.0, atol=1e-4)


def test_a_hand_that_was_drawn_in_is_let_down_softly_on_the_steps_to_the_door_and_stays_so() -> None:
    closed, body = Transform(np.zeros(3), from_axis_angle(UP, 0.0)), drawn_in(0.13, -1.12)
    table = record(TABLE, Transform(np.array([-0.67, -1.6, 0.0]), closed.rotation))
    start = body.start(DOOR, "open", frame=closed, hand="")
    before = body.rotations
    shown = body.do(
        "swing", msgspec.structs.replace(start, object=outlined(start.object, 3), world=[outlined(table, 11)])
    )
    assert left_arm_turns(np.array([before, *(pose.rotations for pose in shown)])) < 6.0


@pytest.mark.parametrize("aside", [0.0, 0.5])
def test_no_frame_waits_for_much_thought_and_who_has_steps_to_make_stands_for_none(
    aside: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    own, costly, waits = module("swing"), list[str](), list[int]()

    def counted(where: Any, name: str) -> None:
        function = getattr(where, name)

        def counting(*given: Any, **named: Any) -> Any:
            costly.append(name)
            return function(*given, **named)

        monkeypatch.setattr(where, name, counting)

    for where, name in (
        (sys.modules["lever"], "closed"), (rolling, "close_thumb"), (own, "follow"), (own, "Trip"), (own, "Tucking"),
        (own.Taking, "_coming"), (own.Taking, "_leaving"),
    ):  # fmt: skip
        counted(where, name)
    standing = own._standing
    monkeypatch.setattr(own, "_standing", lambda task, stance, n: waits.append(n) or standing(task, stance, n))
    closed = Transform(np.zeros(3), from_axis_angle(UP, 0.0))
    body = Body("ken", 0.43 - aside, -0.42 - aside, 125.0)
    start = body.start(DOOR, "open", frame=closed, hand="")
    before, most = 0, 0
    for _ in frames(program("swing"), msgspec.structs.replace(start, object=outlined(start.object, 3))):
        before, most = len(costly), max(most, len(costly) - before)
    assert len(costly) > 15
    assert most <= 4, most
    assert (1 in waits) is (aside == 0.0)


def test_the_eyes_are_on_the_lever_before_the_hand_sets_out_and_leave_it_as_the_leaf_turns() -> None:
    made = swung("ken", "open", np.array([0.43, -0.42, 0.0]), 125.0)
    looks = np.array([pose.targets[GAZE, 7] for pose in made.shown])
    first = np.flatnonzero([pose.targets[RIGHT_HAND, 7] for pose in made.shown])[0]
    assert looks[first] > 0.3
    lever = made.closed.apply(np.array([0.68, -0.075, 1.02]))
    np.testing.assert_allclose(made.shown[first].targets[GAZE, :3], lever, atol=0.01)
    assert looks[-1] == 0.0
    head = np.array([pose.rotations[INDEX["head"]] for pose in made.shown])
    turned = 2.0 * np.arccos(np.clip(np.abs((head[1:] * head[:-1]).sum(axis=-1)), 0.0, 1.0))
    assert np.degrees(turned[1:]).max() < 4.5


def test_who_is_far_is_told_to_walk_there_first() -> None:
    with pytest.raises(AlgorithmError, match=r"door is \d\.\d m from here; `do floor walk to door` first"):
        swung("ken", "open", np.array([0.5, -3.5, 0.0]), 90.0)


@pytest.mark.parametrize(
    ("action", "at", "facing", "place", "hinders"),
    [
        ("open", BEFORE, 90.0, (0.5, 0.6), True),  # where the leaf swings
        ("open", BEFORE, 90.0, (-0.05, 0.85), True),  # where it comes to rest
        ("open", BEFORE, 90.0, (0.45, -0.4), True),  # where one steps along
        ("open", BEFORE, 90.0, (1.6, 0.6), False),  # beyond it
        ("open", BEFORE, 90.0, (-0.6, -0.9), False),
        ("close", BEHIND, -90.0, (0.6, 0.2), True),
        ("close", BEHIND, -90.0, (-0.5, 0.3), False),  # behind the open leaf
    ],
)
def test_others_are_not_hit_by_the_leaf(
    action: str, at: Array, facing: float, place: tuple[float, float], *, hinders: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    closed, angle = closed_door(4), 0.0 if action == "open" else WIDE
    x, y, _ = closed.apply(at).tolist()
    heading = float(np.degrees(2.0 * np.arctan2(closed.rotation[3], closed.rotation[0])))
    body = Body("ken", x, y, heading + facing)
    leaf = Transform(closed.place, multiply(closed.rotation, from_axis_angle(UP, angle)))
    start = body.start(DOOR, action, frame=leaf, states={"angle": angle}, hand="right")
    own, there = module("swing"), closed.apply(np.array([*place, 0.0]))
    task = HumanTask(start)
    assert own.Taking(task, own.door_of(task)).hindered(there[:2]) is hinders
    if hinders:
        monkeypatch.setattr(stepping, "_PATIENCE", 0.2)
        monkeypatch.setattr(own, "stepped", lambda *_, **__: _stands(body))
        somebody = ObjectRecord(-7, "aiko", "human", tuple(there.tolist()), (1.0, 0.0, 0.0, 0.0))
        with pytest.raises(AlgorithmError, match="aiko is where room/doorway/door is swung"):
            list(frames(program("swing"), msgspec.structs.replace(start, world=[somebody])))


def _stands(body: Body) -> Iterator[Array]:  # -> Stance
    """No steps: one stands there."""
    yield from ()
    return stepping.Stance(body.rotations, body.root)


@pytest.mark.parametrize("name", ["ken", pytest.param("aiko", marks=pytest.mark.long)])
@pytest.mark.parametrize("action", ["open", pytest.param("close", marks=pytest.mark.long)])
def test_no_finger_of_the_left_hand_is_in_the_door_while_it_turns(name: str, action: str) -> None:
    made = swung(name, action, BEFORE, 90.0, seed=3, busy=("right",))
    turns = np.flatnonzero(np.abs(np.diff(made.angle)) > 1e-4)
    skin = Skin.read(WORKSPACE.humans.shape(name).glb, made.body.skeleton)
    chosen = np.flatnonzero(np.isin(skin.link, [INDEX["left_hand"], *fingers("left")]))
    door = kind("door")
    for k in turns[:: len(turns) // 8].tolist():
        points = skin.posed(made.shown[k + 1].rotations, made.shown[k + 1].root, chosen)
        assert float(outside(made.leaf(k + 1).inverse().apply(points), door).min()) > -0.002, k


@pytest.mark.parametrize("name", ["ken", pytest.param("aiko", marks=pytest.mark.long)])
def test_a_hand_that_holds_something_goes_through_the_opening_and_not_through_its_frame(name: str) -> None:
    doorway = frame_of("room/doorway")
    x, y, _ = doorway.apply(np.array([-0.03, 0.42, 0.0])).tolist()
    body = holding(name, "right", (x, y, -55.0))
    start = body.start(DOOR, "open", states={"angle": 0.0}, hand="", busy=["right"])
    assert start.object is not None
    world = [outlined(record("room/doorway"), 20)]
    start = msgspec.structs.replace(start, object=outlined(start.object, 3), world=world)
    shown = body.do("swing", start)
    depths = [(*deepest(name, pose, doorway, JAMBS), k) for k, pose in enumerate(shown[::4])]
    assert max(depths)[0] < 0.002, max(depths)
