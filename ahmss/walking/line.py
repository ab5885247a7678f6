"""The line of a walk, and how far along it the joined clips get: where they are shrunk, and by how much (A.3.2)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.walking.course import Course
from ahmss.walking.pacing import Paced

__all__ = ["Line"]

_STEEPEST = 0.2  # of its length that a part of the way keeps at least where all of it is shrunk


@dataclass(frozen=True)
class Line:
    """The line of the way, and how far along it each part gets.

    course: the line. length: nominal, in all. first, last: where on the nominal line the start is over and the end
    begins, metres; who walks already has no start, and one clip alone is all start. start, end: by which those two are
    shrunk. turn_first, turn_last: how much the body is turned more than in the clips at its beginning and its end,
    radians.
    """

    course: Course | Paced
    length: float
    first: float
    last: float
    start: float
    end: float
    turn_first: float = 0.0
    turn_last: float = 0.0

    def along(self, x: Array) -> tuple[Array, Array]:
        """Nominal places x (...) as arc lengths (...) on the course, and by how much lengths shrink there.

        What is shrunk is shrunk more towards its outer end, so that nothing changes suddenly where parts meet.
        """
        if self.first >= self.length:
            return self.start * x, np.full(np.shape(x), self.start)
        middle = self.start * self.first
        s, ratio = middle + (x - self.first), np.ones(np.shape(x))
        if self.first > 0.0:
            way, slope = _shrunk((self.first - x) / self.first, self.start)
            before = x <= self.first
            s, ratio = np.where(before, middle - self.first * way, s), np.where(before, slope, ratio)
        part = self.length - self.last
        way, slope = _shrunk((x - self.last) / part, self.end)
        after = x > self.last
        s = np.where(after, middle + (self.last - self.first) + part * way, s)
        return s, np.where(after, slope, ratio)


def _shrunk(u: Array, ratio: float) -> tuple[Array, Array]:
    """The way (...) done at shares u of a part, of `ratio` in all; outside it goes on as at its end.

    It begins unshrunk and ends as shrunk as it must, the sooner the more is to be lost.
    """
    end = 2.0 * ratio - 1.0
    over = 1.0  # the share by which it is as shrunk as at the end
    if end < _STEEPEST:
        end = min(_STEEPEST, 0.5 * ratio)
        over = 2.0 * (ratio - end) / (1.0 - end)
    inside = np.clip(u, 0.0, 1.0)
    v = np.minimum(inside / over, 1.0)
    square = v * v
    slope = 1.0 - (1.0 - end) * square * (3.0 - 2.0 * v)
    way = inside - (1.0 - end) * (over * square * v * (1.0 - 0.5 * v) + np.maximum(inside - over, 0.0))
    return way + (u - inside) * slope, slope
