"""A way on which what a hand carries goes past oneself: past the head at which it is held, or the other arm."""

from __future__ import annotations

from collections.abc import Callable, Generator
from typing import TypeVar

from ahmss.body.array import Array
from ahmss.reaching.performing import Performed
from ahmss.reaching.plan import Plan

__all__ = ["past_oneself"]

Given = TypeVar("Given")
_PASSES, _BRUSHES, _AIR = 4, 0.002, 0.1  # ways that are tried; metres: what is in it; by which a way is moved more


def past_oneself(
    plan: Plan,
    perform: Callable[[Plan], Generator[Given, None, Performed]],
    sunk: Callable[[Performed], tuple[float, Array]],
) -> Generator[Given, None, Performed]:
    """What is made of a plan by the first way that is clear of oneself; else of those tried the one that is most so.

    Args:
        plan: whose middle is moved where it is not. perform: makes the frames of one.
        sunk: how deep, metres, what is carried is in oneself at the most, and to where (3,), of length 1, from there.
    """
    best: tuple[float, Performed] | None = None
    for _ in range(_PASSES):
        made = yield from perform(plan)
        deep, away = sunk(made)
        if best is None or deep < best[0]:
            best = deep, made
        if deep <= _BRUSHES:
            break
        plan = plan.moved((deep + _AIR) * away)
    assert best is not None
    return best[1]
