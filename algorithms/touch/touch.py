"""Touching a display: the index finger comes onto the glass at a field or a place, and leaves it, or is drawn over it.

The reach is that of `press`, as are the steps to where one reaches it, where the action names a walk library, and the
room that is left to those beside one. A touch lasts some 130 ms; a finger that is drawn goes by a minimum-jerk profile
in the time that Fitts's law gives. The object's properties say how large the screen is and which fields are where.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ahmss.algorithm import HumanTask, Transform, WorldObject, run
from ahmss.algorithm.haste import least
from ahmss.body.array import Array
from ahmss.body.quaternion import rotate
from ahmss.errors import AlgorithmError
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.goal import Goal
from ahmss.reaching.pointing import palms_pointing
from ahmss.skills.at_ease import at_ease
from ahmss.skills.by_fingertip import Touching, by_fingertip
from ahmss.skills.keeping import kept_clear
from ahmss.skills.reaching import Looking, prisms_of, sides_of

BEFORE, BACK = 0.035, 0.13  # metres before the glass at which the finger is set, and to which it is drawn back
ONTO = 0.0003  # metres that the pad gives way
COMES, STAYS, LEAVES = 0.18, 0.1, 0.42  # seconds
DRAWN, A_BIT, FINELY = 0.3, 0.13, 0.012  # seconds at least, and for each bit; metres of how exactly it is to arrive
THERE = 0.32  # metres from the place within which a hand is there already
UNSAID = -0.5  # less than any place that is said
UNTOLD = -1.0e9  # the value that nobody says


def touch(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260) of it, what the other hand holds kept out of the way."""
    return kept_clear(task, _touch(task))


def _touch(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260): the hand comes, touches, is drawn where it shall, and goes back a little."""
    screen = task.site
    if screen is None or task.object is None:
        raise AlgorithmError("touch needs a site: the middle of the screen, its x out of it and its z up")
    if task.carried:
        raise AlgorithmError("a display is touched standing; walk there first, then touch it")
    begin, end = (_on_glass(screen, _size(task.object), place) for place in _places(task, task.object))
    out = rotate(screen.rotation, np.array([1.0, 0.0, 0.0]))
    middle = 0.5 * (begin + end)
    palms = {side: palms_pointing(task.human, side, middle, -out) for side in _sides(task, middle)}
    goal = Goal(middle, palms=palms)

    def drawn(palm: Array) -> Array:
        return _in_time(task, _drawn(task, palm, out, end - begin))

    touching = Touching(goal, BEFORE * out + begin - middle, out, begin, drawn, prisms_of(task))
    task, _, made = yield from by_fingertip(task, touching, Looking(task, middle))
    yield at_ease(task, task.block(made.rotations, made.root, made.importance, made.targets))


def _sides(task: HumanTask, place: Array) -> tuple[str, ...]:
    """The hands that may be used: of those that are free the one that is there already, if any is."""
    free = sides_of(task)
    there = [side for side in free if float(np.linalg.norm(task.start.grip(side).place - place)) < THERE]
    return tuple(there) if len(there) == 1 else free


def _size(thing: WorldObject) -> Array:
    """The screen's width and height (2,), metres.

    Raises:
        AlgorithmError: its properties do not say.
    """
    size = thing.properties.get("screen")
    if not isinstance(size, (list, tuple)) or len(size) != 2:
        raise AlgorithmError(f"{thing.name} has no property `screen`; give its width and height, metres")
    return np.array(size, float)


def _on_glass(screen: Transform, size: Array, place: Array) -> Array:
    """A place (2,) from the lower left corner, in the world (3,)."""
    across, up = place - 0.5 * size
    return screen.apply(np.array([0.0, across, up]))


def _places(task: HumanTask, thing: WorldObject) -> tuple[Array, Array]:
    """Where the finger comes onto the screen and where it leaves it (2,), metres from the lower left corner.

    Raises:
        AlgorithmError: there is no such field or place; says what there is.
    """
    name, drag = task.parameter("field", ""), task.parameter("drag", False)
    if name:
        return _of_field(task, thing, name)
    begin = np.array([task.parameter("x", -1.0), task.parameter("y", -1.0)])
    end = np.array([task.parameter("to_x", -1.0), task.parameter("to_y", -1.0)]) if drag else begin
    size = _size(thing)
    for place, keys in ((begin, "x= y="), (end, "to_x= to_y=")):
        if place.min() < UNSAID:
            have = ", ".join(_shown(thing)) or "none"
            raise AlgorithmError(f"touch it where? add field=, or {keys} in metres; fields that it shows: {have}")
        if (place < 0.0).any() or (place > size).any():
            asked = f"{place[0]:g} {place[1]:g}"
            raise AlgorithmError(f"{asked} is not on the screen, which is {size[0]:g} m wide and {size[1]:g} m high")
    return begin, end


def _of_field(task: HumanTask, thing: WorldObject, name: str) -> tuple[Array, Array]:
    """Where a field is touched, or where a slider is taken and where it is left.

    Raises:
        AlgorithmError: it is not shown, or no slider.
    """
    fields, shown = _fields(thing), _shown(thing)
    if name not in shown:
        where = f"is on the page {fields[name]['page']}" if name in fields else "is none of its fields"
        raise AlgorithmError(f'"{name}" {where}; it shows now: {", ".join(shown) or "none"}')
    field, middle = fields[name], np.array(fields[name]["at"], float)
    if not task.parameter("drag", False):
        return middle, middle
    value, state = task.parameter("value", UNTOLD), field.get("slider", "")
    if not state:
        sliders = [other for other in shown if "slider" in fields[other]]
        raise AlgorithmError(f'"{name}" is no slider; sliders that it shows: {", ".join(sliders) or "none"}')
    track_of = "0, the low end of its track, to 1"
    if value == UNTOLD:
        raise AlgorithmError(f"draw {name} to what? add value=, from {track_of}")
    if not 0.0 <= value <= 1.0:
        raise AlgorithmError(f"{name} can't be drawn to {value:g}; allowed: {track_of}")
    track = np.array([float(field["track"]), 0.0])
    now = float(thing.states.get(state, 0.0))
    return middle + (now - 0.5) * track, middle + (value - 0.5) * track


def _fields(thing: WorldObject) -> Mapping[str, Mapping[str, Any]]:
    return thing.properties.get("fields", {})


def _shown(thing: WorldObject) -> list[str]:
    """The fields of the page that it shows."""
    return [name for name, field in _fields(thing).items() if field.get("page") in (None, thing.states.get("page"))]


def _in_time(task: HumanTask, drawn: Array) -> Array:
    """Palms (n, 7) that touch, fewer of them where a short motion has few frames for it."""
    if not task.length:
        return drawn
    count = min(len(drawn), max(task.length // 2, least(task, len(drawn))))
    return drawn[np.linspace(0, len(drawn) - 1, count).round().astype(int)]


def _drawn(task: HumanTask, palm: Array, out: Array, way: Array) -> Array:
    """Palms (n, 7) from before the glass onto it, along a way (3,), and off it."""
    length = float(np.linalg.norm(way))
    seconds = max(DRAWN, DRAWN + A_BIT * float(np.log2(max(2.0 * length / FINELY, 1.0)))) if length > 1e-6 else 0.0
    steps = [(0.0, 0.0), (BEFORE + ONTO, COMES), (BEFORE + ONTO, 0.5 * STAYS), (BEFORE + ONTO, seconds)]
    steps += [(BEFORE + ONTO, 0.5 * STAYS), (BEFORE - BACK, LEAVES)]
    depth: list[Array] = []
    along: list[Array] = []
    for i, ((before, _), (after, time)) in enumerate(itertools.pairwise(steps)):
        count = round(time * task.rate)
        share = minimum_jerk(np.arange(1, count + 1) / max(count, 1))
        depth.append(before + share * (after - before))
        along.append(share if i == 2 else np.full(count, float(i > 2)))
    palms = np.repeat(palm[None], sum(map(len, depth)), axis=0)
    palms[:, :3] += np.concatenate(along)[:, None] * way - np.concatenate(depth)[:, None] * out
    return palms


if __name__ == "__main__":
    run(touch)
