"""What should be in the picture, how far away the camera stands for it, and how it follows."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.links import INDEX, LINKS
from ahmss_viewer.camera import View, project
from ahmss_viewer.stage import Actor, Stage, Thing

__all__ = ["Follower", "Interest", "fit", "inner_points", "interest", "shape_of", "work"]

_REACH, _LARGE = 0.75, 1.8  # what is so near to a hand counts, unless it is so large
_INSIDE, _HAND_INSIDE = 0.14, 0.06  # metres: a joint lies about so deep under the skin, one of a hand
_TOUCHED_WEIGHT = 3.0  # of an object that is acted on: as much as a face and two hands, or it goes out of sight
_HANDS = (INDEX["right_hand"], INDEX["left_hand"])
_FINGERS = ("hand", "thumb", "index", "middle", "ring", "little")
_PALMS = [np.array([INDEX[name] for name in LINKS if name.startswith(side) and any(part in name for part in _FINGERS)])
          for side in ("right", "left")]  # fmt: skip
_ROOM = 3.0  # metres: what is larger is what things are in, or on
_AT_WORK, _AT_WORK_WEIGHT = 0.05, 6.0  # metres from a hand to what it works at, and how much more that hand counts


@dataclass(frozen=True)
class Interest:
    """What should be in the picture: points (n, 3) in the world, how much each matters (n,), how deep it lies under
    what is drawn of it (n,) in metres, and where the first human faces (3,)."""

    points: Array
    weights: Array
    inside: Array
    facing: Array

    def only(self, which: NDArray[np.bool_]) -> Interest:
        """Some of the points, by a mask (n,)."""
        return Interest(self.points[which], self.weights[which], self.inside[which], self.facing)

    def joined(self, other: Interest) -> Interest:
        """Both."""
        points, weights, inside = (
            np.concatenate(pair)
            for pair in zip(
                (self.points, self.weights, self.inside), (other.points, other.weights, other.inside), strict=True
            )
        )
        return Interest(points, weights, inside, self.facing)


def interest(stage: Stage, name: str = "", touched: Collection[int] = ()) -> Interest | None:
    """The humans (or the one of that name), what is near their hands, and the objects (ids) that they `touched`.

    Without humans all objects; None: there is nothing.
    """
    actors = [actor for actor in stage.actors.values() if not name or actor.name == name]
    if not actors:
        if not stage.things:
            return None
        points = np.array([thing.centre() for thing in stage.things.values()])
        return Interest(points, np.ones(len(points)), np.full(len(points), _INSIDE), np.array([1.0, 0.0, 0.0]))
    points = [_body(actor) for actor in actors]
    weights = [_BODY_WEIGHTS for _ in actors]
    hands = np.concatenate([actor.places[list(_HANDS)] for actor in actors])
    for thing in stage.things.values():
        centre = thing.centre()
        if thing.id in touched:
            points.append(inner_points(thing))
            weights.append(np.full(len(points[-1]), _TOUCHED_WEIGHT / len(points[-1])))
        elif float(np.ptp(thing.box, axis=0).max()) < _LARGE and np.linalg.norm(hands - centre, axis=1).min() < _REACH:
            points.append(centre[None])
            weights.append(np.full(1, 0.5))
    bodies = len(actors) * [_BODY_INSIDE]
    things = sum(len(some) for some in points[len(actors) :])
    inside = np.concatenate([*bodies, np.full(things, _INSIDE)])
    return Interest(np.concatenate(points), np.concatenate(weights), inside, actors[0].facing)


def work(stage: Stage, name: str = "", touched: Collection[int] = ()) -> Interest | None:
    """`interest` in what hands do now: of what is touched only what is at hand, and hands at something most.

    None: nobody is there.
    """
    actors = [actor for actor in stage.actors.values() if not name or actor.name == name]
    if not actors:
        return None
    things = [thing for thing in stage.things.values() if float(np.ptp(thing.box, axis=0).max()) < _ROOM]
    gaps = np.array([[[_gap(t, actor.places[palm]) for t in things] for palm in _PALMS] for actor in actors])
    near = {things[i].id for i in np.flatnonzero((gaps < _REACH).any(axis=(0, 1)))}
    seen = interest(stage, name, near.intersection(touched))
    assert seen is not None
    weights = seen.weights.copy()
    for i, k in zip(*np.nonzero((gaps < _AT_WORK).any(axis=2)), strict=True):
        weights[i * len(_BODY_WEIGHTS) + _PALMS[k]] *= _AT_WORK_WEIGHT
    return replace(seen, weights=weights)


def _gap(thing: Thing, points: Array) -> float:
    """Metres from the nearest of some points (n, 3) to an object's box; 0 within."""
    T = thing.matrix
    local = (points - T[:3, 3]) @ T[:3, :3]
    return float(np.linalg.norm(local - np.clip(local, thing.box[0], thing.box[1]), axis=1).min())


def inner_points(thing: Thing) -> Array:
    """Points (9, 3) that stand for an object: its box's middle and, not quite in its corners, eight more."""
    middle, half = thing.box.mean(axis=0), 0.35 * np.ptp(thing.box, axis=0)
    sides = np.array([[0, 0, 0], *([x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1))])
    T = thing.matrix
    return (middle + sides * half) @ T[:3, :3].T + T[:3, 3]


def _body_weights() -> Array:
    """Of the 43 joints, the head's top and the face: these and the hands say most, a hand's 14 finger joints together
    as one hand."""
    weight = {"head": 0.8, "leg": 0.5, "foot": 0.5, "hand": 0.8, "arm": 0.55, "spine": 0.55}
    joints = [next((w for part, w in weight.items() if name.endswith(part)), 1.0 / 14.0) for name in LINKS]
    return np.array([*joints, 0.6, 1.2])


_BODY_WEIGHTS = _body_weights()
_BODY_INSIDE = np.full(len(_BODY_WEIGHTS), _INSIDE)
_BODY_INSIDE[np.concatenate(_PALMS)] = _HAND_INSIDE


def _body(actor: Actor) -> Array:
    """Joints, the head's top and the face: points (45, 3)."""
    head = actor.places[INDEX["head"]]
    up = head - actor.places[INDEX["hips"]]
    up = up / max(float(np.linalg.norm(up)), 1e-9)
    return np.concatenate([actor.places, [head + 0.26 * up, head + 0.1 * up + 0.12 * actor.facing]])


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
