"""hold_arm keeps what is in the hand level; hands that swing are drawn in beside things."""

from __future__ import annotations

import itertools
from collections.abc import Iterable

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import Transform, frames
from ahmss.algorithm.messages import Goal
from ahmss.algorithm.task import HumanFrame, HumanTask
from ahmss.body.inertialisation import Inertialiser
from ahmss.body.inverse import grips, solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, from_axis_angle, from_matrix, multiply, rotate, slerp, to_rotation_vector
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.prism import clearance
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import skin_of
from ahmss.skills.keeping import kept_clear
from ahmss.skills.letting_down import let_down, let_down_free
from ahmss.skills.tucking import Tucking

from .reached import outlined, prisms
from .scene import CUP, WORKSPACE, Body, frame_of, program, record

UP = np.array([0.0, 0.0, 1.0])
SINK = "room/sink"
OVER, CLOSE = (3.15, 0.35, 1.02), (3.15, 0.3, 0.92)  # where a palm is over it; where it is to be kept clear
WALKS = str(WORKSPACE.objects.get("floor").affordances["walk"].motion)


def test_what_is_held_comes_upright_and_stays_so_without_end() -> None:
    body = Body()
    leant = from_axis_angle(np.array([1.0, 0.0, 0.0]), 0.35)
    cup = Transform(body.grip().place, multiply(leant, frame_of(CUP).rotation))
    start = body.start(CUP, "carry", frames=0, wish=True, parameters={"level": True}, hand="right")
    start = msgspec.structs.replace(start, object=record(CUP, cup))
    hand = INDEX["right_hand"]
    _, world = forward(body.rotations, body.root, body.skeleton.offsets)
    in_hand = rotate(conjugate(world[hand]), rotate(cup.rotation, UP))
    poses = list(itertools.islice(frames(program("hold_arm"), start), 90))
    assert len(poses) == 90
    heights = [
        rotate(multiply(world[INDEX["right_lower_arm"]], pose.rotations[hand]), in_hand)[2]
        for pose in (poses[0], poses[-1])
    ]
    assert heights[0] < np.cos(0.33)  # it begins as it was
    assert heights[1] > np.cos(np.radians(2.0))
    assert poses[-1].importance[hand] == 1.0
    assert poses[-1].importance[INDEX["left_hand"]] == 0.0


def stood(place: np.ndarray, hand: str = "") -> tuple[HumanTask, np.ndarray]:
    """Rows (60, 260) of one who stands at a place beside the sink and faces along it, arms hanging; and the task."""
    body = Body(x=float(place[0]), y=float(place[1]), facing=90.0)
    start = body.start(CUP, "carry", frames=0, wish=True, parameters={})
    busy = {"busy": [hand]} if hand else {}
    start = msgspec.structs.replace(start, object=None, world=[outlined(record(SINK), 11)], **busy)
    task = HumanTask(start)
    rows = task.block(
        np.repeat(body.rotations[None], 60, axis=0), np.repeat(body.root[None], 60, axis=0), np.full(44, 0.15)
    )
    return task, rows


def walked(place: np.ndarray, hand: str = "") -> np.ndarray:
    """The same as drawn in."""
    task, rows = stood(place, hand)
    return Tucking(task).over(rows)


def palms(rows: np.ndarray) -> np.ndarray:
    return grips(Body().skeleton, rows[:, 4:176].reshape(-1, 43, 4), rows[:, 1:4])[..., :3]


def test_a_hand_that_hangs_in_a_counter_comes_up_and_the_other_does_not() -> None:
    at = palms(walked(np.array([2.86, 0.25, 0.0])))
    right, left = at[:, 0], at[:, 1]
    assert right[-1, 2] > right[0, 2] + 0.2
    assert right[-1, 0] < 2.86 + 0.2  # before the belly, off the counter
    assert np.abs(np.diff(right, n=2, axis=0)).max() < 0.003  # softly
    np.testing.assert_allclose(left[-1], left[0], atol=1e-9)


def test_who_waits_beside_a_counter_keeps_still_and_goes_on_as_if_each_frame_were_thought_of() -> None:
    task, rows = stood(np.array([2.86, 0.25, 0.0]))
    goes = rows.copy()
    goes[:, 1] -= 0.4 * minimum_jerk(np.arange(1, 61) / 60)
    made = []
    for nudge in (0.0, 1e-12):  # the same row each time, and never the same twice
        tucking = Tucking(task, first=30)
        for k in range(300):
            made.append(tucking.over(rows[:1] + nudge * k))
            task.present = HumanFrame(made[-1][0])
        tucking.over(rows[:1])[:] = 0.0  # what is done with a frame does not come back with the next
        made.append(tucking.over(goes))
        task.present = task.start
    singly, nudged = np.concatenate(made[:301]), np.concatenate(made[301:])
    np.testing.assert_allclose(singly[:300], nudged[:300], atol=2e-5)
    np.testing.assert_allclose(palms(singly), palms(nudged), atol=0.01)
    assert (singly[299] == singly[298]).all()
    heights = palms(singly)[[0, 299, -1], 0, 2]
    assert heights[1] > heights[0] + 0.2
    assert heights[2] < heights[1] - 0.1  # down again, where there is room


def test_who_waits_beside_a_counter_looks_for_others_now_and_then() -> None:
    task, rows = stood(np.array([2.86, 0.25, 0.0]))
    looked, made = list[int](), list[np.ndarray]()
    tucking = Tucking(task, first=30, others=lambda: (looked.append(len(made)), [])[1])
    for _ in range(400):
        made.append(tucking.over(rows[:1])[0])
        task.present = HumanFrame(made[-1])
    assert looked[:100] == list(range(100))  # while arms move
    assert np.diff(looked[-10:]).tolist() == [5] * 9


def test_who_sets_out_with_a_hand_drawn_in_beside_a_counter_keeps_it_so_until_there_is_room() -> None:
    task, rows = stood(np.array([2.86, 0.25, 0.0]))
    task.start = HumanFrame(Tucking(task).over(rows)[-1])  # as one came there
    goes = np.repeat(rows[:1], 200, axis=0)
    goes[:, 1] -= 0.8 * minimum_jerk(np.arange(-60, 140) / 90)
    right = palms(Tucking(task, first=0).over(goes))[:, 0]
    before = palms(task.start.row[None])[0, 0]
    assert np.abs(right[:40] - before).max() < 0.03
    assert right[-1, 2] < before[2] - 0.2  # and hangs again


def set_out(*, held: bool) -> np.ndarray:
    """Rows (160, 260) as drawn in, in pieces, of one who sets out beside the sink with the right arm raised ahead.

    held: by another motion, which keeps it there; else it is let down, as a body does that has a new source.
    """
    task, rows = stood(np.array([2.86, 0.25, 0.0]))
    rows = np.repeat(rows[:1], 160, axis=0)
    row, arm = task.start.row.copy(), 4 + 4 * INDEX["right_upper_arm"]
    row[arm : arm + 4] = multiply(from_axis_angle(np.array([0.0, 1.0, 0.0]), -1.5), row[arm : arm + 4])
    task.start = task.present = HumanFrame(row)
    tucking, smooth, made = Tucking(task), Inertialiser(60.0), list[np.ndarray]()
    smooth.place(task.start.rotations, task.start.root)
    for begin, end in itertools.pairwise((0, 7, 33, 60, 110, 160)):
        for piece in tucking.over(rows[begin:end]):
            given = piece[4:176].reshape(43, 4)
            shown, root = smooth.step(given, piece[1:4], np.full(43, not made), False)
            smooth.settle(shown, root)
            made.append(piece)
            if not held:
                task.present = HumanFrame(np.concatenate([piece[:4], shown.ravel(), piece[176:190]]))
    return np.array(made)


@pytest.mark.parametrize("held", [False, True])
def test_an_arm_that_was_raised_as_one_sets_out_is_drawn_in_where_no_other_motion_has_it(held: bool) -> None:
    made = set_out(held=held)
    turns = made[:, 4:176].reshape(-1, 43, 4)
    step = np.linalg.norm(to_rotation_vector(multiply(conjugate(turns[:-1]), turns[1:])), axis=-1)
    assert np.degrees(step.max()) < 6.0
    right = INDEX["right_lower_arm"]
    drawn_in = made[:, 176 + right] - made[0, 176 + right]
    if held:
        assert drawn_in[-1] < 0.01
        assert drawn_in.max() < 0.7
    else:
        assert drawn_in[20:].min() > 1.4
        assert palms(made)[-1, 0, 2] > palms(made)[0, 0, 2] + 0.2


def test_a_hand_that_comes_from_elsewhere_is_drawn_in_no_faster_than_arms_move() -> None:
    task, rows = stood(np.array([2.86, 0.25, 0.0]))
    row, hand = task.start.row.copy(), 4 + 4 * INDEX["right_hand"]
    tucked = Tucking(task).over(np.repeat(rows[:1], 160, axis=0))[-1]
    drawn_in = to_rotation_vector(multiply(conjugate(row[hand : hand + 4]), tucked[hand : hand + 4]))
    axis = drawn_in / np.linalg.norm(drawn_in)
    row[hand : hand + 4] = multiply(row[hand : hand + 4], from_axis_angle(axis, -1.1))  # the other way than it goes
    task.start = task.present = HumanFrame(row)
    smooth, shown = Inertialiser(60.0), [task.start.rotations]
    smooth.place(task.start.rotations, task.start.root)
    for piece in Tucking(task).over(np.repeat(rows[:1], 160, axis=0)):
        made, root = smooth.step(piece[4:176].reshape(43, 4), piece[1:4], np.full(43, len(shown) == 1), False)
        smooth.settle(made, root)
        shown.append(made)
    turns = np.array(shown)[:, INDEX["right_hand"]]
    step = np.degrees(np.linalg.norm(to_rotation_vector(multiply(conjugate(turns[:-1]), turns[1:])), axis=-1))
    assert 4.0 < step.max() < 7.0


def test_where_there_is_room_hands_hang_and_a_hand_that_holds_something_is_left_alone() -> None:
    for at in (palms(walked(np.array([2.0, 1.2, 0.0]))), palms(walked(np.array([2.86, 0.25, 0.0]), "right"))):
        np.testing.assert_allclose(at[-1], at[0], atol=1e-9)


def over_the_sink(hand: str, at: tuple[float, float, float] = OVER) -> tuple[HumanTask, HumanFrame, np.ndarray]:
    """A task of one at the sink, one hand busy if it is named; how the right one is over it; a row of hanging arms."""
    task, rows = stood(np.array([2.8, 0.25, 0.0]), hand)
    row, targets = task.start.row.copy(), np.zeros((5, 8))
    ahead = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])  # the palm to the sink, the thumb up
    targets[0, :3], targets[0, 3:7], targets[0, 7] = at, from_matrix(ahead), 1.0
    row[4:176] = solve(task.human, row[4:176].reshape(43, 4), row[1:4], targets).reshape(172)
    return task, HumanFrame(row), rows[:1]


def going_off(hanging: np.ndarray, frames: int = 200) -> np.ndarray:
    """Rows (n, 260) of one who walks off the sink, the arms hanging."""
    rows = np.repeat(hanging, frames, axis=0)
    rows[:, 1] -= 0.9 * minimum_jerk(np.arange(-40, frames - 40) / 100)
    return rows


def in_the_sink(task: HumanTask, rows: np.ndarray) -> float:
    """Metres by which skin of the right arm is in the sink at the most."""
    points, radii = skin_of(Reacher.of(task.human, "right"), rows[:, 4:176].reshape(-1, 43, 4), rows[:, 1:4])
    return float((radii - clearance(prisms(record(SINK)), points)).max())


def test_a_hand_that_holds_something_over_a_thing_is_let_down_where_there_is_room() -> None:
    task, held, hanging = over_the_sink("right")
    task.start = task.present = held
    made = []
    for some in let_down(task, iter(np.split(going_off(hanging), 5))):
        made.append(some)
        task.present = HumanFrame(some[-1])
    rows = np.concatenate(made)
    at = palms(rows)[:, 0] - rows[:, 1:4]
    np.testing.assert_allclose(at[:30], np.broadcast_to(at[0], (30, 3)), atol=1e-6)
    assert at[-1, 2] < at[0, 2] - 0.2
    assert in_the_sink(task, rows) < 0.0
    assert np.abs(np.diff(at, n=2, axis=0)).max() < 0.003  # softly


@pytest.mark.parametrize("ends", [88, 98])
def test_an_arm_over_a_thing_that_another_motion_has_had_is_let_down_where_there_is_room(ends: int) -> None:
    task, held, hanging = over_the_sink("")
    rows, made = np.concatenate([np.repeat(hanging, 100, axis=0), going_off(hanging)]), []
    for some in let_down_free(task, iter(np.split(rows, [100]))):  # in one piece, as a walk's end may be
        made.append(some)
        theirs = 20 < sum(map(len, made)) < ends  # a reach and a grasp
        task.present = held if theirs else HumanFrame(some[-1])
    after = np.concatenate(made)[ends:]
    np.testing.assert_allclose(palms(after)[0, 0], palms(held.row[None])[0, 0], atol=0.03)
    assert in_the_sink(task, after) < 0.0
    turns = np.concatenate(made)[:, 4:176].reshape(-1, 43, 4)
    step = np.linalg.norm(to_rotation_vector(multiply(conjugate(turns[:-1]), turns[1:])), axis=-1)
    assert np.degrees(step.max()) < 13.0  # of which an eighth is seen at the most while the arm is another's
    assert palms(after)[-1, 0, 2] < palms(after)[0, 0, 2] - 0.2


def led(task: HumanTask, made: Iterable[np.ndarray], ends: int) -> np.ndarray:
    """Rows (n, ...) as shown, the right arm blended with a motion that keeps it as it begins, for so many frames."""
    arm, kept = Reacher.of(task.human, "right").links, task.start.rotations.copy()
    shown = list[np.ndarray]()
    for rows in made:
        for row in np.atleast_2d(np.array(rows)):
            if len(shown) < ends:
                share = 1.0 / (1.0 + row[176 + arm.start])
                own = row[4:176].reshape(43, 4)
                own[arm] = slerp(own[arm], kept[arm], np.full(3, share))
            shown.append(row)
        task.present = HumanFrame(shown[-1][:190])
    return np.array(shown)


def test_a_hand_that_is_led_is_not_let_down_by_the_walk_that_one_sets_out_on() -> None:
    """The walk, which kept it clear of the sink, had it at once, and let its cup fall by 26 cm."""
    task, held, _ = over_the_sink("right", CLOSE)
    told = {"object": None, "frames": 0, "motion": WALKS, "goal": Goal(place=(1.6, 0.4, 0.0)), "led": ["right"]}
    task = HumanTask(msgspec.structs.replace(task.message, **told))
    task.start = task.present = held
    rows = led(task, program("walk")(task), 10**6)
    at = palms(rows)[:, 0] - rows[:, 1:4]
    assert len(rows) > 120
    assert at[:, 2].min() > at[0, 2] - 0.05


def test_a_hand_that_is_led_no_more_is_kept_clear_again() -> None:
    task, held, hanging = over_the_sink("right", CLOSE)
    task = HumanTask(msgspec.structs.replace(task.message, led=["right"]))
    task.start = task.present = held
    goes = going_off(hanging, 260)
    there = np.concatenate([goes, goes[::-1]])
    rows = led(task, kept_clear(task, let_down(task, iter(np.split(there, 4)))), 150)
    assert in_the_sink(task, there[300:]) > 0.01
    assert in_the_sink(task, rows[300:]) < -0.01


@pytest.mark.parametrize("narrow", [False, True])
def test_a_hand_that_is_led_is_kept_clear_all_the_same_where_there_is_no_room_for_it(narrow: bool) -> None:
    """As it is by who goes through a door with a cup: hand and cup were in the frame else."""
    task, held, hanging = over_the_sink("right", CLOSE)
    task = HumanTask(msgspec.structs.replace(task.message, led=["right"]))
    task.start = task.present = held
    rows = led(task, kept_clear(task, iter(np.split(going_off(hanging, 260), 4)), narrow=narrow), 10**6)
    cares = rows[:, 176 + Reacher.of(task.human, "right").links.start].max()
    assert cares > 100.0 if narrow else cares < 1.0


def carried(leans: float, *, beside: bool) -> tuple[Body, list[np.ndarray], list[np.ndarray]]:
    """How arm (3, 4) and importance (44,) go while a cup is carried by one who leans so far, radians, at the sink."""
    body = Body(x=2.8 if beside else 1.5, y=0.25, facing=0.0)
    reacher = Reacher.of(body.skeleton, "left")
    targets = np.zeros((5, 8))
    ahead = np.array([0.36, 0.1, 1.0 - body.root[2]])
    palm = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # to the right, the thumb up
    targets[1, :3], targets[1, 3:7], targets[1, 7] = body.root + ahead, from_matrix(palm), 1.0
    body.rotations = solve(body.skeleton, body.rotations, body.root, targets)
    start = body.start(CUP, "carry", frames=0, wish=True, parameters={}, hand="left")
    cup = Transform(body.grip(1).place, frame_of(CUP).rotation)
    start = msgspec.structs.replace(start, object=record(CUP, cup), world=[outlined(record(SINK), 11)])
    task, spine = HumanTask(start), INDEX["spine"]
    rows, arms, cares = program("hold_arm")(task), list[np.ndarray](), list[np.ndarray]()
    left, upright = np.array([0.0, 1.0, 0.0]), body.rotations[spine].copy()
    for k in range(150):
        turned = from_axis_angle(left, leans * float(minimum_jerk(np.array(k / 60.0))))
        body.rotations[spine] = multiply(multiply(turned, body.rotations[0]), upright)
        body.rotations[spine] = multiply(conjugate(body.rotations[0]), body.rotations[spine])
        task.see(body.row(k + 1))
        row = next(rows)[0]
        body.rotations[reacher.links] = row[4:176].reshape(43, 4)[reacher.links]
        arms.append(body.rotations[reacher.links].copy())
        cares.append(row[176:220])
    return body, arms, cares


def gap(body: Body) -> float:
    points, radii = skin_of(Reacher.of(body.skeleton, "left"), body.rotations, body.root)
    return float((clearance(prisms(record(SINK)), points) - radii).min())


def test_an_arm_that_holds_something_gives_way_to_a_counter_that_one_leans_over() -> None:
    body, arms, cares = carried(0.55, beside=True)
    assert gap(body) > 0.02
    hand = INDEX["left_hand"]
    assert cares[-1][hand] > 5.0 > cares[0][hand]  # nothing else brings it back
    turns = to_rotation_vector(multiply(conjugate(np.array(arms[:-1])), np.array(arms[1:])))
    assert np.degrees(np.linalg.norm(turns, axis=-1)).max() < 4.0
    body.rotations[Reacher.of(body.skeleton, "left").links] = arms[0]
    assert gap(body) < -0.05  # where it would be


def test_far_from_things_it_stays_as_it_was() -> None:
    _, arms, cares = carried(0.55, beside=False)
    np.testing.assert_allclose(arms[-1], arms[0], atol=1e-12)
    assert cares[-1][INDEX["left_hand"]] == 1.0


def test_of_a_piece_that_was_broken_off_the_arms_go_on_from_what_was_shown() -> None:
    task, rows = stood(np.array([2.86, 0.25, 0.0]))
    whole, broken, deaf = (Tucking(task, first=0) for _ in range(3))
    whole.over(rows[:12])
    np.testing.assert_array_equal(broken.over(rows), deaf.over(rows))
    broken.keep(12)
    deaf.keep(60)
    goes, other, late = (palms(tucking.over(rows[12:]))[:, 0] for tucking in (whole, broken, deaf))
    np.testing.assert_allclose(other, goes, atol=1e-3)
    assert np.abs(late - goes).max() > 0.05
