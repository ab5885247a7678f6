"""Table 5.9 of the thesis: the 21 actions and transitions that five people judged, and the two that it left out.

The actions are found in what was played by the objects that they are done to, so that a script may say them in any
words: an action lasts from the first to the last frame of its motions, a walk is what carries the body between two.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

__all__ = ["ACTIONS", "MEAN", "TRANSITIONS", "Action", "Doing", "Span", "actions_in", "between"]

MEAN = 2.9
"""The mean of the 21, of 4: natural 4, rather natural 3, rather unnatural 2, unnatural 1."""


@dataclass(frozen=True, slots=True)
class Doing:
    """A motion that is being made in a frame: the kind of its object, its action, whether it takes the body along."""

    kind: str
    action: str
    carries: bool = False


@dataclass(frozen=True, slots=True)
class Action:
    """One of the twelve. kinds, actions (all, if none is named): of the motions that it is made of; a walk has none.

    score: the thesis's, None for what it left out.
    """

    name: str
    score: float | None
    kinds: tuple[str, ...] = ()
    actions: tuple[str, ...] = ()

    def has(self, doings: Sequence[Doing]) -> bool:
        """Whether one of the motions of a frame is its own."""
        return any(d.kind in self.kinds and (not self.actions or d.action in self.actions) for d in doings)


@dataclass(frozen=True, slots=True)
class Span:
    """From a frame to the one after the last."""

    first: int
    end: int


ACTIONS = (
    Action("opens, closes the door", 3.2, ("door", "doorway")),
    Action("walks", 3.0),
    Action("presses the switch", 3.4, ("switch", "television"), ("press",)),
    Action("walks", 2.8),
    Action("reaches, walking", 2.6, ("cup",), ("reach",)),
    Action("grasps, walking", 2.4, ("cup",), ("grasp",)),
    Action("walks with the cup", 2.8),
    Action("turns the tap", 2.2, ("tap", "sink"), ("turn", "reach")),
    Action("walks with the cup", 3.0),
    Action("drinks, walking", 3.4, ("cup",), ("drink",)),
    Action("walks with the cup", None),
    Action("sits down", 3.6, ("chair",), ("sit",)),
)
"""The order of figure 5.3. The walk before sitting down is not in the table."""

TRANSITIONS: tuple[float | None, ...] = (2.4, 3.4, 2.8, 2.4, 2.4, 2.8, 3.0, 3.0, 3.4, 3.0, None)
"""From each action to the next. The table has ten, and its tenth leads from drinking to sitting down: it stands here
for the one after drinking, and the one before sitting down is the second that was left out."""


def actions_in(frames: Sequence[Sequence[Doing]]) -> list[Span | None]:
    """Where each of the twelve is in what was played, frame by frame; None for one that was not.

    Args:
        frames: the motions that were being made, for each frame.
    """
    firsts = _firsts(frames)
    spans: list[Span | None] = [None] * len(ACTIONS)
    for number, first in firsts.items():
        until = min((other for other in firsts.values() if other > first), default=len(frames))
        last = max(k for k in range(first, until) if ACTIONS[number].has(frames[k]))
        spans[number] = Span(first, last + 1)
    for number, action in enumerate(ACTIONS):
        if not action.kinds:
            spans[number] = _walk(frames, spans[number - 1], spans[number + 1])
    return spans


def _firsts(frames: Sequence[Sequence[Doing]]) -> dict[int, int]:
    """The first frame of each action that has an object, in their order; one that never comes is left out."""
    firsts: dict[int, int] = {}
    after = 0
    for number, action in enumerate(ACTIONS):
        first = next((k for k in range(after, len(frames)) if action.has(frames[k])), None)
        if first is not None:
            firsts[number] = first
            after = first + 1
    return firsts


def _walk(frames: Sequence[Sequence[Doing]], before: Span | None, after: Span | None) -> Span | None:
    """What carries the body from the end of one action to the beginning of another."""
    if before is None or after is None:
        return None
    moving = [k for k in range(before.end, after.first) if any(doing.carries for doing in frames[k])]
    return Span(moving[0], moving[-1] + 1) if moving else None


def between(before: Span | None, after: Span | None, margin: int, frames: int) -> Span | None:
    """The frames of a transition: what lies between two actions, and `margin` frames of each; None without both."""
    if before is None or after is None:
        return None
    return Span(max(before.end - margin, before.first, 0), min(after.first + margin, after.end, frames))
