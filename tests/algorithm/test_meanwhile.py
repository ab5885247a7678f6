"""What is thought of in parts while frames are given."""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.meanwhile import Thinking, alongside
from ahmss.reaching.steps import Steps


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
