"""What is thought of in parts while frames are given."""

from __future__ import annotations

from collections.abc import Generator

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.motion.steps import Steps
from ahmss.skills.meanwhile import Thinking, alongside, waited


def counting(parts: int, done: list[int]) -> Steps[str]:
    for k in range(parts):
        done.append(k)
        yield
    return "found"


def test_a_part_is_done_with_each_frame_but_the_first() -> None:
    done, rows = list[int](), np.arange(12.0).reshape(6, 2)
    thinking = Thinking(counting(3, done))
    frames = alongside(rows, thinking)
    given = [next(frames)]
    assert done == []
    given.append(next(frames))
    assert done == [0]
    given += frames
    assert done == [0, 1, 2]
    assert [len(block) for block in given] == [1, 1, 1, 1, 2]  # the rest at once when nothing is left to be thought of
    np.testing.assert_array_equal(np.concatenate(given), rows)
    assert thinking.found == "found"


def test_what_is_left_is_done_when_it_is_asked_for() -> None:
    done, rows = list[int](), np.zeros((3, 2))
    thinking = Thinking(counting(8, done))
    assert [len(block) for block in alongside(rows, thinking)] == [1, 1, 1]
    assert done == [0, 1]
    assert thinking.found == "found"
    assert done == list(range(8))
    assert not thinking.part()


@pytest.mark.parametrize(("most", "at_once", "given"), [(None, 1, 7), (None, 3, 2), (2, 1, 2), (0, 1, 0)])
def test_frames_are_given_while_something_is_found(most: int | None, at_once: int, given: int) -> None:
    done, row = list[int](), np.ones((1, 2))
    found = list[tuple[str, int]]()

    def work() -> Generator[Array, None, None]:
        found.append((yield from waited(counting(7, done), row, most, at_once)))

    for k, shown in enumerate(work(), 1):
        assert shown is row
        assert len(done) == k * at_once
    assert found == [("found", given)]
