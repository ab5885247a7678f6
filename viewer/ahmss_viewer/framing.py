"""Finds a good view: the humans and what they touch, from the front and one side, with nothing in between."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.links import INDEX, LINKS
from ahmss_viewer.camera import View, project
from ahmss_viewer.painter import Painter
from ahmss_viewer.stage import Actor, Stage, Thing
from ahmss_viewer.target import Target

__all__ = ["Follower", "Interest", "best_view", "fit", "interest", "preset", "shape_of", "without_hidden"]

_SIDES = (40, -40, 60, -60, 22, -22, 85, -85, 120, -120)  # degrees from straight in front
_HEIGHTS = (14, 27)
_SMALL = 96  # pixels high
_NEAR_COST, _SIDE_COST, _HEIGHT_COST = 0.8, 0.45, 0.1
_INSIDE = 0.14  # metres: a joint lies about so deep under the skin
_ALWAYS = 0.5  # what weighs more is in the picture whether it is hidden or not
_REACH, _LARGE = 0.75, 1.8  # what is so near to a hand counts, unless it is so large
_HANDS = (INDEX["right_hand"], INDEX["left_hand"])
_PRESETS = {"front": (0, 8), "back": (180, 8), "right": (-90, 8), "left": (90, 8), "top": (0, 80), "close": (-40, 14)}


@dataclass(frozen=True)
class Interest:
    """What should be in the picture: points (n, 3) in the world, how much each matters (n,), where the first human
    faces (3,)."""

    points: Array
    weights: Array
    facing: Array

    def joined(self, other: Interest) -> Interest:
        """Both."""
        points, weights = np.concatenate([self.points, other.points]), np.concatenate([self.weights, other.weights])
        return Interest(points, weights, self.facing)


def interest(stage: Stage, name: str = "", touched: Collection[int] = ()) -> Interest | None:
    """The humans (or the one of that name), what is near their hands, and the objects (ids) that they `touched`.

    Without humans all objects; None: there is nothing.
    """
    actors = [actor for actor in stage.actors.values() if not name or actor.name == name]
    if not actors:
        if not stage.things:
            return None
        points = np.array([thing.centre() for thing in stage.things.values()])
        return Interest(points, np.ones(len(points)), np.array([1.0, 0.0, 0.0]))
    points = [_body(actor) for actor in actors]
    weights = [_BODY_WEIGHTS for _ in actors]
    hands = np.concatenate([actor.places[list(_HANDS)] for actor in actors])
    for thing in stage.things.values():
        centre = thing.centre()
        if thing.id in touched:
            points.append(_inner(thing))
            weights.append(np.full(len(points[-1]), 2.0 / len(points[-1])))
        elif float(np.ptp(thing.box, axis=0).max()) < _LARGE and np.linalg.norm(hands - centre, axis=1).min() < _REACH:
            points.append(centre[None])
            weights.append(np.ones(1))
    return Interest(np.concatenate(points), np.concatenate(weights), actors[0].facing)


def _inner(thing: Thing) -> Array:
    """Points (9, 3) that stand for an object: its box's middle and, not quite in its corners, eight more."""
    middle, half = thing.box.mean(axis=0), 0.35 * np.ptp(thing.box, axis=0)
    sides = np.array([[0, 0, 0], *([x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1))])
    T = thing.matrix
    return (middle + sides * half) @ T[:3, :3].T + T[:3, 3]


def _body_weights() -> Array:
    """Of the 43 joints and the head's top: face and hands say most, a hand's 14 finger joints together as one."""
    weight = {"head": 1.5, "leg": 0.3, "foot": 0.3, "hand": 1.0, "arm": 0.7, "spine": 0.7}
    joints = [next((w for part, w in weight.items() if name.endswith(part)), 1.0 / 14.0) for name in LINKS]
    return np.array([*joints, 1.5])


_BODY_WEIGHTS = _body_weights()


def _body(actor: Actor) -> Array:
    """Joints, and the head's top: points (44, 3)."""
    head = actor.places[INDEX["head"]]
    up = head - actor.places[INDEX["hips"]]
    return np.concatenate([actor.places, (head + 0.26 * up / max(float(np.linalg.norm(up)), 1e-9))[None]])


def fit(view: View, points: Array, aspect: float, filled: float = 0.74) -> View:
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


def shape_of(view: View, points: Array) -> float:
    """Width over height of what the view shows of these points."""
    seen = project(points, view, (1000, 1000))[:, :2]
    width, height = np.ptp(seen, axis=0)
    return float(width / max(float(height), 1.0))


def preset(name: str, wanted: Interest, aspect: float) -> View:
    """`front`, `back`, `left`, `right`, `top` of the human, or `close`: at the upper body. KeyError: none of these."""
    side, height = _PRESETS[name]
    view = _facing(wanted.facing, side, height)
    points = wanted.points
    if name == "close":
        points = points[points[:, 2] > np.quantile(points[:, 2], 0.2)]
    return fit(view, points, aspect)


def best_view(
    stage: Stage, painter: Painter, wanted: Interest, aspect: float, moments: Iterable[Interest] | None = None
) -> View:
    """The view, of some from the front and the sides, that shows most: each is drawn, small, and looked at.

    Args:
        wanted: all that should be in the picture.
        moments: brings the stage to some moments of the motion, one after the other, and gives what matters then;
            None: only what is on the stage now.
    """
    target = Target(round(_SMALL * aspect), _SMALL)
    views: list[View] = []
    scores: list[float] = []
    for height in _HEIGHTS:
        for side in _SIDES:
            views.append(fit(_facing(wanted.facing, side, height), wanted.points, aspect))
            aside = max(0.0, abs(side) - 50.0) / 90.0
            scores.append(-_SIDE_COST * aside - _HEIGHT_COST * abs(height - 16.0) / 16.0)
    looked = [wanted] if moments is None else moments
    faults = np.zeros(len(views))
    count = 0
    for moment in looked:
        count += 1
        for i, view in enumerate(views):
            painter.draw_depth(stage, view, target)
            faults[i] += _faults(moment, view, target)
    target.delete()
    return views[int(np.argmax(np.array(scores) - faults / max(count, 1)))]


def _facing(facing: Array, side: float, height: float) -> View:
    """A view at some degrees from straight in front (left of the human is positive), and above level."""
    azimuth = float(np.arctan2(facing[1], facing[0])) + np.radians(side)
    return View(azimuth=azimuth, elevation=float(np.radians(height)))


def without_hidden(
    stage: Stage, painter: Painter, wanted: Interest, view: View, aspect: float, moments: Iterable[Interest]
) -> Array:
    """What is to be seen of `wanted`, points (n, 3): heads, arms and hands, and of the rest what nothing hides."""
    target = Target(round(_SMALL * aspect), _SMALL)
    points = [wanted.points[wanted.weights > _ALWAYS]]
    for moment in moments:
        painter.draw_depth(stage, view, target)
        points.append(moment.points[~_hidden(moment.points, view, target, target.read_depth())])
    target.delete()
    return np.concatenate(points)


def _hidden(points: Array, view: View, target: Target, depth: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Which of the points (n, 3) lie behind what was drawn."""
    P = view.projection(target.drawn[0] / target.drawn[1])
    metres = P[2, 3] / (2.0 * depth.astype(float) - 1.0 + P[2, 2])
    seen = project(points, view, target.drawn)
    column = np.clip(seen[:, 0].astype(int), 0, target.drawn[0] - 1)
    row = np.clip(seen[:, 1].astype(int), 0, target.drawn[1] - 1)
    return metres[row, column] < seen[:, 2] - _INSIDE


def _faults(wanted: Interest, view: View, target: Target) -> float:
    """The share of what matters that something hides, and some of the share of the picture that stands too near."""
    depth = target.read_depth()
    P = view.projection(target.drawn[0] / target.drawn[1])
    near = P[2, 3] / (2.0 * depth.astype(float) - 1.0 + P[2, 2]) < 0.45 * view.distance
    hidden = np.average(_hidden(wanted.points, view, target, depth), weights=wanted.weights)
    return float(hidden + _NEAR_COST * near.mean())


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
        ideal = fit(view, wanted.points, aspect)
        target = view.target + share * (ideal.target - view.target)
        return replace(view, target=target, distance=view.distance + share * (ideal.distance - view.distance))
