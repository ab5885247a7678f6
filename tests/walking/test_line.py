"""The line of the way: how far along it the clips get, and how they are shrunk."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.walking.course import Course, plan
from ahmss.walking.line import Line


def straight_course(length: float) -> Course:
    return plan(np.zeros(2), np.array([length, 0.0]), [], radius=0.27)


def line(start: float, end: float, first: float = 1.2, last: float = 3.2, length: float = 4.1) -> Line:
    return Line(straight_course(5.0), length, first, last, start, end)


RATIOS = [(1.0, 1.0), (1.0, 0.8), (0.7, 0.7), (0.62, 0.62), (0.45, 0.45), (0.3, 0.3), (1.1, 1.1), (1.0, 1.15)]


@pytest.mark.parametrize(("start", "end"), RATIOS)
def test_parts_are_shrunk_by_their_ratios(start: float, end: float) -> None:
    made = line(start, end)
    s, _ = made.along(np.array([0.0, 1.2, 3.2, 4.1]))
    np.testing.assert_allclose(s, np.cumsum([0.0, start * 1.2, 2.0, end * 0.9]), atol=1e-12)


@pytest.mark.parametrize(("start", "end"), RATIOS)
def test_one_never_goes_back_along_the_line(start: float, end: float) -> None:
    x = np.linspace(-0.2, 4.3, 2001)
    s, ratio = line(start, end).along(x)
    assert (np.diff(s) > 0.0).all()
    assert ratio.min() > 0.0
    inner = (np.abs(x[:, None] - [1.2, 3.2]) > 0.01).all(axis=-1)[5:-5]
    np.testing.assert_allclose(np.gradient(s, x)[5:-5][inner], ratio[5:-5][inner], atol=0.02)  # it is the slope


@pytest.mark.parametrize(("start", "end"), RATIOS)
def test_nothing_changes_suddenly_where_parts_meet(start: float, end: float) -> None:
    h = 1e-6
    made = line(start, end)
    for seam in (1.2, 3.2):
        s, ratio = made.along(np.array([seam - h, seam, seam + h]))
        assert np.abs(np.diff(s)).max() < 2.0 * h
        np.testing.assert_allclose(ratio, ratio[1], atol=1e-4)


@pytest.mark.parametrize("ratio", [1.0, 0.8, 0.55, 0.34])
def test_nor_where_the_start_is_followed_by_the_end(ratio: float) -> None:
    made = line(ratio, ratio, first=0.9, last=0.9, length=1.5)
    s, slope = made.along(0.9 + np.array([-1e-6, 0.0, 1e-6]))
    np.testing.assert_allclose(slope, slope[0], atol=1e-4)
    np.testing.assert_allclose(np.diff(s), 1e-6 * slope[0], rtol=1e-3)


def test_one_clip_alone_is_shrunk_evenly() -> None:
    s, ratio = line(0.6, 0.6, first=4.1, last=4.1).along(np.array([0.0, 1.0, 4.1]))
    np.testing.assert_allclose(s, [0.0, 0.6, 2.46])
    np.testing.assert_allclose(ratio, 0.6)
