"""Finds a good view: the humans and what they touch, from the front and one side, with nothing in between."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss_viewer.camera import View, project
from ahmss_viewer.painter import Painter
from ahmss_viewer.stage import Actor, Stage
from ahmss_viewer.target import Target

__all__ = ["Follower", "Interest", "best_view", "fit", "interest", "preset"]

_SIDES = (40, -40, 60, -60, 25, -25, 85, -85, 115, -115, 150, -150)  # degrees from straight in front
_HEIGHTS = (14, 24, 36)
_SMALL = (128, 96)
_INSIDE = 0.14  # metres: a joint lies about so deep under the skin
_REACH, _LARGE = 0.75, 1.8  # what is so near to a hand counts, unless it is so large
_HANDS = (INDEX["right_hand"], INDEX["left_hand"])
_PRESETS = {"front": (0, 8), "back": (180, 8), "right": (-90, 8), "left": (90, 8), "top": (0, 80), "close": (-40, 14)}


@dataclass(frozen=True)
class Interest:
    """What should be in the picture: points (n, 3) in the world, and where the first human faces (3,)."""

    points: Array
    facing: Array

    def joined(self, other: Interest) -> Interest:
        """Both."""
        return Interest(np.concatenate([self.points, other.points]), self.facing)


def interest(stage: Stage, name: str = "") -> Interest | None:
    """The humans (or the one of that name) and what is near their hands; without humans all objects; None: nothing."""
    actors = [actor for actor in stage.actors.values() if not name or actor.name == name]
    if not actors:
        if not stage.things:
            return None
        return Interest(np.array([thing.centre() for thing in stage.things.values()]), np.array([1.0, 0.0, 0.0]))
    points = [_body(actor) for actor in actors]
    hands = np.concatenate([actor.places[list(_HANDS)] for actor in actors])
    for thing in stage.things.values():
        centre = thing.centre()
        if float(np.ptp(thing.box, axis=0).max()) < _LARGE and np.linalg.norm(hands - centre, axis=1).min() < _REACH:
            points.append(centre[None])
    return Interest(np.concatenate(points), actors[0].facing)


def _body(actor: Actor) -> Array:
    """Joints, and the head's top: points (44, 3)."""
    head = actor.places[INDEX["head"]]
    up = head - actor.places[INDEX["hips"]]
    return np.concatenate([actor.places, (head + 0.26 * up / max(float(np.linalg.norm(up)), 1e-9))[None]])


def fit(view: View, points: Array, aspect: float, filled: float = 0.84) -> View:
    """The same direction, from where all points lie within the filled share of the picture, centred."""
    size = (aspect, 1.0)
    view = replace(view, target=0.5 * (points.min(axis=0) + points.max(axis=0)))
    for _ in range(12):
        seen = project(points, view, size)  # type: ignore[arg-type]
        if (seen[:, 2] < 0.3).any():
            view = view.zoom(1.6)
            continue
        low, high = seen[:, :2].min(axis=0), seen[:, :2].max(axis=0)
        middle = 0.5 * (low + high) - np.array([0.5 * aspect, 0.5])
        view = view.pan(float(middle[0]), float(-middle[1])).zoom(float(max((high - low) / (filled * np.array(size)))))
    return view


def preset(name: str, wanted: Interest, aspect: float) -> View:
    """`front`, `back`, `left`, `right`, `top` of the human, or `close`: at the upper body. KeyError: none of these."""
    side, height = _PRESETS[name]
    view = _facing(wanted.facing, side, height)
    points = wanted.points
    if name == "close":
        points = points[points[:, 2] > np.quantile(points[:, 2], 0.2)]
    return fit(view, points, aspect)


def best_view(stage: Stage, painter: Painter, wanted: Interest, aspect: float) -> View:
    """The view, of some from the front and the sides, that shows most: each is drawn, small, and looked at."""
    target = Target(*_SMALL)
    best, best_score = _facing(wanted.facing, 40, 20), -np.inf
    points = wanted.points[:: max(1, len(wanted.points) // 200)]
    for height in _HEIGHTS:
        for side in _SIDES:
            view = fit(_facing(wanted.facing, side, height), points, aspect)
            painter.draw(stage, view, target.drawn, target)
            shown = _visible(points, view, target)
            score = shown - 0.2 * abs(abs(side) - 45.0) / 90.0 - 0.15 * abs(height - 18.0) / 20.0
            if score > best_score:
                best, best_score = view, score
    target.delete()
    return fit(best, wanted.points, aspect)


def _facing(facing: Array, side: float, height: float) -> View:
    """A view at some degrees from straight in front (left of the human is positive), and above level."""
    azimuth = float(np.arctan2(facing[1], facing[0])) + np.radians(side)
    return View(azimuth=azimuth, elevation=float(np.radians(height)))


def _visible(points: Array, view: View, target: Target) -> float:
    """The share of the points that nothing hides."""
    depth = target.read_depth()
    seen = project(points, view, target.drawn)
    column = np.clip(seen[:, 0].astype(int), 0, target.drawn[0] - 1)
    row = np.clip(seen[:, 1].astype(int), 0, target.drawn[1] - 1)
    P = view.projection(target.drawn[0] / target.drawn[1])
    clip = 2.0 * depth[row, column].astype(float) - 1.0
    metres = P[2, 3] / (clip + P[2, 2])
    return float(np.mean(metres > seen[:, 2] - _INSIDE))


class Follower:
    """Moves a view smoothly after the humans: at once with `name`'s, else only when they leave the picture."""

    def __init__(self, name: str = "") -> None:
        self.name = name
        self._leaving = False

    def step(self, view: View, stage: Stage, aspect: float, seconds: float) -> View:
        """The view a moment later."""
        wanted = interest(stage, self.name)
        if wanted is None or not stage.actors:
            return view
        share = 1.0 - np.exp(-max(seconds, 0.0) / 0.5)
        if self.name:
            middle = 0.5 * (wanted.points.min(axis=0) + wanted.points.max(axis=0))
            return replace(view, target=view.target + share * (middle - view.target))
        seen = project(wanted.points, view, (1000, round(1000 / aspect)))
        place = seen[:, :2] / np.array([1000.0, round(1000 / aspect)])
        outside = bool((np.abs(place - 0.5) > 0.49).any() or (seen[:, 2] < 0.2).any())
        self._leaving = outside or (self._leaving and bool((np.abs(place - 0.5) > 0.44).any()))
        if not self._leaving:
            return view
        ideal = fit(view, wanted.points, aspect, 0.78)
        target = view.target + share * (ideal.target - view.target)
        return replace(view, target=target, distance=view.distance + share * (ideal.distance - view.distance))
