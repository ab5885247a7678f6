"""A motion tells where the human means to be, and is told of the others: rows, checks, and what an author sees."""

from __future__ import annotations

import re
from collections.abc import Iterator

import msgspec
import numpy as np
import pytest
from algorithm_rig import ROOT, ROTATIONS

from ahmss.algorithm.messages import ObjectRecord
from ahmss.algorithm.performance import Performance, frames
from ahmss.algorithm.task import HumanTask, ObjectTask
from ahmss.errors import ProtocolError, ShapeError
from ahmss.motion.way import AHEAD, UNKNOWN
from ahmss.processes.check import check_human
from ahmss.skills.stepping import in_time, walkers
from ahmss.walking.pieces import Piece

WAY = np.arange(12.0).reshape(6, 2) / 4.0 + 1.0
OTHER = ObjectRecord(-4, "aiko", "human", (1.0, 1.0, 0.0), (1.0, 0.0, 0.0, 0.0), way=[(9.0, 9.0)] * 6)
TAP = ObjectRecord(9, "tap", "tap", (1.0, 1.0, 1.0), (1.0, 0.0, 0.0, 0.0))


def stand(count: int) -> tuple[np.ndarray, np.ndarray]:
    return np.tile(ROTATIONS, (count, 1, 1)), np.tile(ROOT, (count, 1))


def test_ways_go_with_the_frames_of_a_block_and_with_a_pose_and_may_be_left_out(make_start):
    def walk(task: HumanTask):
        yield task.block(*stand(2), ways=np.array([WAY, WAY + 1.0]))
        yield task.block(*stand(1))
        yield task.pose({}, way=WAY + 2.0)
        yield task.pose({})
        yield task.block(*stand(2), targets=np.full((5, 8), 0.5), ways=WAY + 3.0)
        yield task.block(*stand(1), ways=UNKNOWN)

    poses = list(frames(walk, make_start(frames=9)))
    assert [None if pose.way is None else pose.way[0, 0] - WAY[0, 0] for pose in poses] == [
        0.0, 1.0, None, 2.0, None, 3.0, 3.0, None,
    ]  # fmt: skip
    np.testing.assert_array_equal(poses[3].way, WAY + 2.0)
    assert (poses[5].targets == 0.5).all()
    np.testing.assert_array_equal(poses[5].way, WAY + 3.0)


def test_a_row_is_wider_by_the_way_alone(make_start):
    performance = Performance(lambda task: iter([task.pose({}, way=WAY), task.pose({})]), make_start())
    widths = []
    for _ in range(2):
        performance.step(performance.task.start.row.copy())
        widths.append(len(performance.row))
        check_human(performance.row, 0)
    assert widths == [272, 260]


def test_a_way_of_another_shape_is_refused(make_start):
    task = HumanTask(make_start())
    with pytest.raises(ShapeError, match=r"ways \(6, 2\) or \(N, 6, 2\); these are .*\(3, 5, 2\)"):
        task.block(*stand(3), ways=np.zeros((3, 5, 2)))
    with pytest.raises(ShapeError, match=r"a way \(6, 2\); these are .* and \(6, 3\)"):
        list(frames(lambda task: iter([task.pose({}, way=np.zeros((6, 3)))]), make_start()))
    with pytest.raises(
        ShapeError, match=re.escape("a block of poses is (N, 260) or (N, 272) (see task.block), not (3, 265)")
    ):
        list(frames(lambda _: np.zeros((3, 265)), make_start()))


@pytest.mark.parametrize(("number", "value"), [(3, np.nan), (0, np.inf), (11, -1e300)])
def test_a_way_that_is_none_is_refused_with_the_number(make_start, number, value):
    row = HumanTask(make_start()).block(*stand(1), ways=WAY)[0]
    check_human(row, 0)
    row[260 + number] = value
    with pytest.raises(
        ProtocolError, match=re.escape(f"number {number} of its way is {value:g}; metres are expected, or NaN")
    ):
        check_human(row, 0)
    row[260:] = np.nan
    check_human(row, 0)
    row[5] = np.nan  # the rest is looked at all the same
    with pytest.raises(ProtocolError, match="number 5 of its pose is nan"):
        check_human(row, 0)


def test_an_author_sees_where_others_mean_to_be(make_start):
    task = HumanTask(make_start(world=[OTHER, TAP], ways=True))
    aiko, tap = task.world[-4], task.world[9]
    np.testing.assert_array_equal(aiko.way, np.full((6, 2), 9.0))
    assert tap.way is None
    there, new = [-4, 1.5, 2, 0, 1, 0, 0, 0], [-3, 0, 0, 0, 1, 0, 0, 0]
    told = np.concatenate([np.zeros(190), there, WAY.ravel(), new, UNKNOWN.ravel(), [9, 2, 3, 4, 0, 1, 0, 0]])
    told[0] = 3.0
    task.see(told)
    np.testing.assert_array_equal(aiko.way, WAY)
    np.testing.assert_array_equal(aiko.place, [1.5, 2, 0])
    np.testing.assert_array_equal(tap.place, [2, 3, 4])
    assert task.world[-3].way is None
    told[190 + 8 : 190 + 20] = np.nan  # it is told no more, and they have not moved
    told[0] = 4.0
    task.see(told)
    assert aiko.way is None
    assert [k for k, *_ in aiko.seen] == [3.0]


def test_who_does_not_ask_is_told_as_ever(make_start):
    task = HumanTask(make_start(world=[TAP]))
    task.see(np.concatenate([np.zeros(190), [-4, 1, 2, 0, 1, 0, 0, 0], [9, 2, 3, 4, 0, 1, 0, 0]]))
    assert task.world[-4].way is None
    np.testing.assert_array_equal(task.world[9].place, [2, 3, 4])


def test_an_object_algorithm_is_told_too(make_start):
    task = ObjectTask(make_start("object", world=[OTHER], ways=True))
    task.see(np.concatenate([np.zeros(197), [-4, 1, 2, 0, 1, 0, 0, 0], WAY.ravel()]))
    np.testing.assert_array_equal(task.world[-4].way, WAY)


def test_a_frame_of_another_length_is_refused(make_start):
    task = HumanTask(make_start(ways=True))
    with pytest.raises(ProtocolError, match="FRAME has 198 numbers; 190 and 8 for each that moved, 20 for each human,"):
        task.see(np.concatenate([np.zeros(190), [-4, 1, 2, 0, 1, 0, 0, 0]]))
    task.see(np.concatenate([np.zeros(190), [4, 1, 2, 0, 1, 0, 0, 0]]))


def test_who_tells_that_they_go_and_is_heard_of_no_more_is_taken_to_stand(make_start):
    start = make_start(world=[OTHER], ways=True)
    task = HumanTask(start)
    goes = np.array([1.0, 1.0]) + AHEAD[:, None] * [1.2, 0.0]
    told = np.concatenate([[-4.0, 1.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0], goes.ravel()])
    ways = []
    for k in range(1, 61):
        own = task.start.row.copy()
        own[0] = k
        if k <= 20:
            told[1] += 0.02
            told[8::2] += 0.02
        task.see(np.concatenate([own, told]) if k <= 20 else own)
        ways.append(walkers(task)[0])
    assert all(other.way is not None for other in ways[:25])
    assert all(other.way is None and other.stays for other in ways[30:])
    np.testing.assert_allclose(ways[-1].place, [1.4, 1.0])


def test_who_tells_that_they_stay_is_believed_though_nothing_moves(make_start):
    task = HumanTask(make_start(world=[msgspec.structs.replace(OTHER, way=[(1.0, 1.0)] * 6)], ways=True))
    row = task.start.row.copy()
    row[0] = 400
    task.see(row)
    assert walkers(task)[0].way is not None


class Looks:
    """Asked after frames whether a piece is over."""

    def __init__(self, over: int) -> None:
        self.over, self.asked = over, list[int]()

    def __call__(self, made: int) -> bool:
        self.asked.append(made)
        return made == self.over


@pytest.mark.parametrize(("over", "shown"), [(9, 9), (99, 14)])
def test_of_a_piece_that_is_looked_at_no_more_is_given_than_until_it_is_over(over: int, shown: int) -> None:
    rows, look = np.arange(14.0)[:, None], Looks(over)
    piece = Piece(*(np.zeros((14, 1)) for _ in range(5)), look=look)
    given: list[float] = []

    def all_of_it() -> Iterator[np.ndarray]:
        given.append((yield from in_time(piece, rows)))

    made = np.concatenate(list(all_of_it()))[:, 0]
    assert given == [shown]
    assert made.tolist() == rows[:shown, 0].tolist()
    assert look.asked == [3, 6, 9, 12][: len(look.asked)]
