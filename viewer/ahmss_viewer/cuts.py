"""Cuts a recording into shots, each from the side on which most is to be seen of what hands do while it lasts.

Within a shot the camera looks one way, and goes along with the humans.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import groupby, pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator

from ahmss.body.array import Array
from ahmss_viewer.camera import View
from ahmss_viewer.framing import Interest, fit
from ahmss_viewer.looking import Looking

__all__ = ["Shot", "shots"]

_WINDOW, _GLANCES = 1.0, 2  # seconds that are judged as one, and how often one looks in each
_SIDES, _HEIGHTS = 16, (10.0, 24.0, 42.0)  # directions from which it may be seen; degrees above level
_LENS = float(np.radians(28.0))
_FILLED = 0.84  # share of the picture that what matters takes
_CUT = 0.3  # what a cut costs: so much of what matters must be hidden for a second not to be worth it
_LEAP, _LEAP_COST = 30.0, 0.6  # degrees: what turns by less is no cut but a jerk, and costs so much more
_HEIGHT_COST, _FAR_COST = 0.06, 0.1  # of a window, for each 16 degrees from 16; for each time as far as the nearest


@dataclass(frozen=True)
class Shot:
    """The ticks from `first` to before `end`, and the camera that sees them: by its direction, and by its target
    (n, 3) and the logarithm of its distance (n, 1) at some ticks (n,)."""

    first: int
    end: int
    direction: View
    ticks: Array
    track: Array

    def view(self, tick: int) -> View:
        """Where the camera is at a tick; it comes along without a jerk."""
        *target, distance = self._along(float(np.clip(tick, self.ticks[0], self.ticks[-1])))
        return replace(self.direction, target=np.array(target), distance=float(np.exp(distance)))

    @cached_property
    def _along(self) -> Callable[[float], Array]:
        """The track at a tick between the first and the last."""
        if len(self.ticks) == 1:
            return lambda _: self.track[0]
        return PchipInterpolator(self.ticks, self.track)


def shots(look: Looking, show: Callable[[int], Interest | None], ticks: int, rate: float, aspect: float) -> list[Shot]:
    """The shots of a recording, one after the other; none for the parts in which nobody is there.

    Args:
        show: brings the stage to a tick, and tells what matters then.
    """
    count = max(1, round(ticks / (rate * _WINDOW)))
    edges = np.linspace(0, ticks, count + 1).astype(int)
    windows = [_glances(show, int(a), int(b)) for a, b in pairwise(edges.tolist())]
    directions = [View(azimuth=2.0 * np.pi * k / _SIDES, elevation=float(np.radians(height)), field_of_view=_LENS)
                  for height in _HEIGHTS for k in range(_SIDES)]  # fmt: skip
    costs = np.stack([_costs(look, show, glances, directions, aspect) for glances in windows])
    middles = 0.5 * (edges[:-1] + edges[1:])
    found: list[Shot] = []
    for number, group in groupby(range(count), key=_cheapest(costs, directions).__getitem__):
        mine = [k for k in group if windows[k]]
        if mine:
            points = [np.concatenate([interest.points for _, interest in windows[k]]) for k in mine]
            first, end, direction = int(edges[mine[0]]), int(edges[mine[-1] + 1]), directions[number]
            found.append(Shot(first, end, direction, middles[mine], _track(points, direction, aspect)))
    return found


def _track(points: list[Array], direction: View, aspect: float) -> Array:
    """Targets and logarithms of distances (n, 4): each holds what matters in its window and in those beside it."""
    near = [np.concatenate(points[max(k - 1, 0) : k + 2]) for k in range(len(points))]
    views = [fit(direction, some, aspect, _FILLED) for some in near]
    return np.array([[*view.target, np.log(view.distance)] for view in views])


def _glances(show: Callable[[int], Interest | None], first: int, end: int) -> list[tuple[int, Interest]]:
    """What matters at some ticks of a window."""
    ticks = np.unique(np.linspace(first, end - 1, _GLANCES).astype(int)).tolist()
    looked = ((tick, show(tick)) for tick in ticks)
    return [(tick, interest) for tick, interest in looked if interest is not None]


def _costs(
    look: Looking, show: Callable[[int], Interest | None], glances: list[tuple[int, Interest]],
    directions: list[View], aspect: float,
) -> Array:  # fmt: skip
    """What is wrong in a window with each direction (n,): what is hidden, and how odd and how far it is."""
    if not glances:
        return np.zeros(len(directions))
    points = np.concatenate([interest.points for _, interest in glances])
    views = [fit(direction, points, aspect, _FILLED) for direction in directions]
    faults = np.zeros(len(views))
    for tick, _ in glances:
        interest = show(tick)
        assert interest is not None
        faults += [look.look(view, interest)[1] / len(glances) for view in views]
    nearest = min(view.distance for view in views)
    odd = [_HEIGHT_COST * abs(np.degrees(view.elevation) - 16.0) / 16.0 for view in views]
    return faults + odd + [_FAR_COST * (view.distance / nearest - 1.0) for view in views]


def _cheapest(costs: Array, directions: list[View]) -> NDArray[np.intp]:
    """The direction of each window (m,) with the least sum of costs (m, n) and cuts (Viterbi)."""
    turn = np.array([[_turn(a, b) for b in directions] for a in directions])
    cut = np.where(turn > 0.0, _CUT + _LEAP_COST * (turn < _LEAP), 0.0)
    came = np.zeros(costs.shape, dtype=np.intp)
    total = costs[0]
    for k in range(1, len(costs)):
        ways = total[:, None] + cut
        came[k] = ways.argmin(axis=0)
        total = ways.min(axis=0) + costs[k]
    path = [int(total.argmin())]
    for k in range(len(costs) - 1, 0, -1):
        path.append(int(came[k, path[-1]]))
    return np.array(path[::-1])


def _turn(a: View, b: View) -> float:
    """Degrees between two directions."""
    backs = [view.pose()[:3, 2] for view in (a, b)]
    return float(np.degrees(np.arccos(np.clip(backs[0] @ backs[1], -1.0, 1.0)))) if a is not b else 0.0
