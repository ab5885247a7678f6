"""Chooses a view by looking: candidates are drawn, small, and the one in which least is hidden is taken."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss_viewer.camera import View
from ahmss_viewer.framing import Interest, fit
from ahmss_viewer.looking import Looking
from ahmss_viewer.painter import Painter
from ahmss_viewer.stage import Stage

__all__ = ["best_view", "clear_preset", "preset", "without_hidden"]

# Degrees from straight in front; who walks about faces all ways in the end.
_SIDES = (40, -40, 60, -60, 22, -22, 75, -75, 90, -90, 105, -105, 120, -120, 150, -150, 180)
_HEIGHTS = (8, 14, 24, 40)
_SIDE_COST, _HEIGHT_COST, _FAR_COST = 0.35, 0.1, 0.15
_ASIDE = 0.42  # metres: what is so far before a joint is not the human's own other side
_ALWAYS = 0.5  # what weighs more is in the picture whether it is hidden or not
_LENS = float(np.radians(28.0))  # from farther away a table in front hides less
_FILLED = 0.86  # share of the picture, where the whole motion is known

_PRESETS = {"front": (0, 8), "back": (180, 8), "right": (-90, 8), "left": (90, 8), "top": (0, 80), "close": (-40, 14)}
_TURNS, _RAISES = (0, 12, -12, 24, -24, 36, -36), (0, 14, 30)  # a preset's detours around what is in the way
_CLOSE_TURNS = (0, 20, -20, 80, 60, 100, 120, -50)  # `close` only has to show the human, from whatever side
_TURN_COST = 0.25  # of 90 degrees


@dataclass(frozen=True)
class _Choice:
    """The view that was taken, and the points (n, 3) that are to be seen in it over all moments."""

    view: View
    seen: Array


def preset(name: str, wanted: Interest, aspect: float) -> View:
    """`front`, `back`, `left`, `right`, `top` of the human, or `close`: at the upper body. KeyError: none of these."""
    return _turned(name, wanted, aspect, 0, 0)


def clear_preset(
    name: str, stage: Stage, painter: Painter, wanted: Interest, aspect: float, moments: Iterable[Interest] | None
) -> View:
    """A preset, turned or raised as little as is needed to look past what hides the human.

    `moments` as for best_view. KeyError: there is no such preset.
    """
    turns = {"close": _CLOSE_TURNS, "top": (0,)}.get(name, _TURNS)
    raises = (0,) if name == "top" else _RAISES
    steps = [(turn, up) for up in raises for turn in turns]
    views = [_turned(name, wanted, aspect, turn, up) for turn, up in steps]
    costs = [_TURN_COST * (abs(turn) + up) / 90.0 for turn, up in steps]
    looked = (_upper(m) if name == "close" else m for m in ([wanted] if moments is None else moments))
    return _least_hidden(stage, painter, views, costs, looked, aspect, _ASIDE).view


def _turned(name: str, wanted: Interest, aspect: float, turn: float, up: float) -> View:
    """A preset, so many degrees to the human's left and up."""
    side, height = _PRESETS[name]
    points = _upper(wanted).points if name == "close" else wanted.points
    return fit(_facing(wanted.facing, side + turn, height + up), points, aspect)


def _upper(wanted: Interest) -> Interest:
    """Heads, arms, hands and what they hold."""
    return wanted.only(wanted.weights > _ALWAYS)


def best_view(
    stage: Stage, painter: Painter, wanted: Interest, aspect: float, moments: Iterable[Interest] | None = None
) -> View:
    """The view, of some from the front and the sides, that shows most: each is drawn, small, and looked at.

    Args:
        wanted: all that should be in the picture.
        moments: brings the stage to some moments of the motion, one after the other, and gives what matters then;
            the view is then as near as what is to be seen in it allows. None: only what is on the stage now.
    """
    steps = [(side, height) for height in _HEIGHTS for side in _SIDES]
    views = [fit(_facing(wanted.facing, side, height), wanted.points, aspect) for side, height in steps]
    nearest = min(view.distance for view in views)
    costs = [
        _SIDE_COST * max(0.0, abs(side) - 65.0) / 90.0
        + _HEIGHT_COST * abs(height - 16.0) / 16.0
        + _FAR_COST * (view.distance / nearest - 1.0)
        for (side, height), view in zip(steps, views, strict=True)
    ]
    choice = _least_hidden(stage, painter, views, costs, [wanted] if moments is None else moments, aspect)
    if moments is None or not len(choice.seen):
        return choice.view
    always = wanted.points[wanted.weights > _ALWAYS]
    return fit(choice.view, np.concatenate([always, choice.seen]), aspect, _FILLED)


def _facing(facing: Array, side: float, height: float) -> View:
    """A view at some degrees from straight in front (left of the human is positive), and above level."""
    azimuth = float(np.arctan2(facing[1], facing[0])) + np.radians(side)
    return View(azimuth=azimuth, elevation=float(np.radians(height)), field_of_view=_LENS)


def _least_hidden(
    stage: Stage,
    painter: Painter,
    views: Sequence[View],
    costs: Sequence[float],
    moments: Iterable[Interest],
    aspect: float,
    before: float | None = None,
) -> _Choice:
    """The view with the lowest sum of its cost and, over the moments' mean, of what is wrong with it.

    A point is hidden by what is at least `before` metres before it; None: as deep as it lies inside.
    """
    looking = Looking(stage, painter, aspect, before)
    faults = np.zeros(len(views))
    seen: list[list[Array]] = [[np.zeros((0, 3))] for _ in views]
    count = 0
    for moment in moments:
        count += 1
        for i, view in enumerate(views):
            hidden, fault = looking.look(view, moment)
            seen[i].append(moment.points[~hidden])
            faults[i] += fault
    looking.close()
    best = int(np.argmin(np.array(costs) + faults / max(count, 1)))
    return _Choice(views[best], np.concatenate(seen[best]))


def without_hidden(
    stage: Stage, painter: Painter, wanted: Interest, view: View, aspect: float, moments: Iterable[Interest]
) -> Array:
    """What is to be seen of `wanted`, points (n, 3): heads, arms and hands, and of the rest what nothing hides."""
    choice = _least_hidden(stage, painter, [view], [0.0], moments, aspect)
    return np.concatenate([wanted.points[wanted.weights > _ALWAYS], choice.seen])
