"""A display that an index finger touches: what a field sets is set when the finger comes onto it, a slider follows it.

The property `screen` says how wide and high it is, about the site that the action names; the property `fields` what
can be touched: `at` its middle, metres from the lower left corner, its `size`, the `page` (a value of the state `page`)
that it is on, what it `sets`, and of a slider the state (`slider`, 0 to 1) and the length of its `track`. While a
finger is on a field, the state `touched` has its name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ahmss.algorithm import ObjectPose, ObjectTask, Transform, run
from ahmss.body.array import Array
from ahmss.body.quaternion import IDENTITY, rotate

DEEPEST = 0.03  # metres behind the glass from which on the finger is somewhere else
EXACT = 0.002  # of a slider's range: how finely it is told


def touched(task: ObjectTask) -> Iterator[ObjectPose]:
    """The display's states at each frame of the human; the object itself stays where it is."""
    site = task.object.sites[task.message.site]
    width, height = (float(number) for number in task.object.properties["screen"])
    fields: Mapping[str, Mapping[str, Any]] = task.object.properties.get("fields", {})
    states = dict(task.object.states)
    middle = Transform(np.array(site.position), np.array(site.rotation))
    corner = Transform(np.array([0.0, 0.5 * width, 0.5 * height]), IDENTITY)
    on, came = False, False  # from before it: a hand that begins behind the glass touches nothing
    field = ""
    for _ in task.frames():
        out, x, y = corner.apply(_pad(task, middle))
        came = came or out > 0.0
        touches = came and -DEEPEST < out <= 0.0 and 0.0 <= x <= width and 0.0 <= y <= height
        told: dict[str, Any] = {}
        if touches and not on:
            field = _field(fields, states.get("page"), x, y)
            told |= {"touched": field} | dict(fields.get(field, {}).get("sets", {}))
        elif on and not touches:
            field, told["touched"] = "", ""
        on = touches
        if on and "slider" in fields.get(field, {}):
            told[fields[field]["slider"]] = _value(fields[field], x)
        told = {name: value for name, value in told.items() if name in states and states[name] != value}
        states |= told
        yield task.pose(None, None, told)


def _pad(task: ObjectTask, site: Transform) -> Array:
    """The pad (3,) of the acting hand's index finger, in the frame of the screen's middle: x is how far it is off."""
    screen = task.object.frame.then(site)
    into = -rotate(screen.rotation, np.array([1.0, 0.0, 0.0]))
    hands = (task.hand,) if task.hand else ("right", "left")
    pads = [screen.inverse().apply(task.fingerpad(hand, into)) for hand in hands]
    return min(pads, key=lambda pad: float(pad @ pad))


def _field(fields: Mapping[str, Mapping[str, Any]], page: object, x: float, y: float) -> str:
    """The field at a place, on a page; "" where there is none."""
    for name, field in fields.items():
        off = np.abs(np.array([x, y]) - field["at"])
        if field.get("page") in (None, page) and (off <= 0.5 * np.array(field["size"])).all():
            return name
    return ""


def _value(field: Mapping[str, Any], x: float) -> float:
    """How far up its track a slider is, 0 to 1."""
    track = float(field["track"])
    share = float(np.clip((x - float(field["at"][0])) / track + 0.5, 0.0, 1.0))
    return round(round(share / EXACT) * EXACT, 4)


if __name__ == "__main__":
    run(touched)
