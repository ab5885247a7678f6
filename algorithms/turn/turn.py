"""Turning a lever, a knob or a cover: thumb and fingers take it, go with it about the object's axis, and let it go.

The palm turns along for a part of it, half if nothing else is said; the rest is made between the pads.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ahmss.algorithm import HumanTask, Transform, run
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, rotate
from ahmss.errors import AlgorithmError
from ahmss.skills.pinching import Part, pinched

TURNS = 0.75  # seconds
HALF = 0.5  # of the turn: a wrist that can't make more of it does so much
NEAR = 0.02  # radians: so near to a position it is in it
OFF = 0.35  # radians that what has no positions may come to rest from where it is to
ON_AXIS = 0.01  # metres from the axis within which the hand is at its middle, as `turned` has it


def turn(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260): the hand comes, closes, turns, opens, and goes back.

    Raises:
        AlgorithmError: the action names no site, the object has no shape or no such position, the human is carried.
    """
    thing = task.object
    if task.site is None or thing is None or thing.shape is None:
        raise AlgorithmError("turn needs an object that has a shape, and a site where its lever is taken")
    if task.carried:
        raise AlgorithmError("a lever is turned standing; walk there first, then turn it")
    told = _told(task)
    axis = np.array(told.get("axis", (0.0, 0.0, 1.0)), float)
    pivot = thing.frame.apply(np.array(told.get("pivot", (0.0, 0.0, 0.0)), float))
    axis = rotate(thing.rotation, axis / np.linalg.norm(axis))
    state = task.parameter("state", "turn")
    now = float(thing.states.get(state, 0.0))
    to = _wanted(task, told, now)
    angle = task.parameter("share", 1.0) * (to - now)
    along = task.parameter("along", 0.5)
    site = _about(pivot, axis, now, task.site)
    positions: dict[str, float] = {str(name): float(at) for name, at in told.get("positions", {}).items()}
    named = next((name for name, at in positions.items() if abs(at - to) < NEAR), f"{np.degrees(to):.0f} degrees")
    if abs(to - now) < NEAR:
        task.note(f"it is at {named} already")
    within = NEAR if positions else OFF
    in_vain = f"it did not come to {named}, for the fingers lost it; do it again, or from elsewhere"
    task.means(in_vain, **{state: (to - within, to + within)})
    off = site.place - pivot
    on_axis = float(np.linalg.norm(off - (off @ axis) * axis)) <= ON_AXIS

    def turned(along: float) -> Part:
        def way(share: Array) -> tuple[Array, Array]:
            around = from_axis_angle(axis, angle * share)
            return pivot + rotate(around, site.place - pivot), from_axis_angle(axis, along * angle * share)

        def own(share: Array) -> Array:
            return from_axis_angle(axis, angle * share)

        return Part(site, way, TURNS, short=short if on_axis else None, own=own)

    def short(before: Array, after: Array) -> str:
        """Why it comes to rest elsewhere, as `turned` has it: where the wrist does not turn so far."""
        turn = multiply(after[3:], conjugate(before[3:]))
        made = 2.0 * float(np.arctan2(turn[1:] @ axis, turn[0]))
        made = (made + np.pi) % (2.0 * np.pi) - np.pi
        rests = min(positions.values(), key=lambda position: abs(position - now - made / along), default=to)
        if abs(rests - to) < NEAR:
            return ""
        asked, by = np.degrees(abs(along * angle)), np.degrees(abs(made))
        low, high = sorted((now, now + angle))
        between = [name for name, at in positions.items() if low + NEAR < at < high - NEAR]
        other = f"turn it to {between[0]} first, or " if between else ""
        return f"the wrist turns {by:.0f} of {asked:.0f} degrees on {thing.name} from here; {other}come from elsewhere"

    # What is turned about its own middle is told by the palm's turn how far: there it has to make its share.
    other = turned(0.5 * along) if along > HALF and not on_axis else None
    return pinched(task, turned(along), other)


def _told(task: HumanTask) -> Mapping[str, Any]:
    """The properties of what is turned: of the object, or of the part of it that the action names."""
    assert task.object is not None
    part = task.parameter("part", "")
    return task.object.properties.get(part, {}) if part else task.object.properties


def _wanted(task: HumanTask, told: Mapping[str, Any], now: float) -> float:
    """The angle to turn it to, radians: as was said, or to its next position, or to its other end.

    Raises:
        AlgorithmError: it has no such position; says which it has.
    """
    largest = float(told.get("largest", np.pi / 2))
    positions: dict[str, float] = {str(name): float(at) for name, at in told.get("positions", {}).items()}
    name, to = task.parameter("position", ""), task.parameter("to", -1.0)
    if name and name not in positions:
        have = ", ".join(positions) or "none"
        raise AlgorithmError(f'no position "{name}"; it has: {have}')
    if name:
        to = positions[name]
    elif to < 0.0 and positions:
        to = min((at for at in positions.values() if at > now + NEAR), default=min(positions.values()))
    elif to < 0.0:
        to = largest if now < 0.5 * largest else 0.0
    return min(to, largest)


def _about(pivot: Array, axis: Array, angle: float, frame: Transform) -> Transform:
    """A frame turned about an axis through a pivot."""
    turned = from_axis_angle(axis, np.array(angle))
    return Transform(pivot + rotate(turned, frame.place - pivot), multiply(turned, frame.rotation))


if __name__ == "__main__":
    run(turn)
