"""A keyboard under two hands: the keys go in as far as pads of fingers push them, and what they write is gathered.

A key writes once, where it is nearly all the way in, and again only after it has come out by half. States, where the
kind has them: `text` (what was written since the line was begun), `entered` (the line that the key enter sent), `key`
(which one is pressed) and `depth` (of its travel).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from ahmss.algorithm import ObjectPose, ObjectTask, Transform, run
from ahmss.body.array import Array
from ahmss.body.fingertip import pad
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.skills.keystrokes import BACK, CLICK, Key, keys_of, pushed

TIPS = [INDEX[f"{side}_{finger}_distal"] for side in ("right", "left")
        for finger in ("thumb", "index", "middle", "ring", "little")]  # fmt: skip
MOST = 200  # characters that are kept, the last ones


def typed(task: ObjectTask) -> Iterator[ObjectPose]:
    """The keyboard's states at each frame of the human; the object itself stays where it is."""
    keys = keys_of(task.object.properties, task.object.name)
    travel = float(task.object.properties.get("travel", 0.0035))
    site = task.object.sites[task.message.site]
    tops = Transform(np.array(site.position), np.array(site.rotation))
    states = dict(task.object.states)
    down: set[str] = set()
    for _ in task.frames():
        depth = _pushed(task, tops, keys, travel)
        told: dict[str, Any] = {}
        for name, share in depth.items():
            if share >= CLICK and name not in down:
                down.add(name)
                told |= _written(keys[name], task.object.properties, {**states, **told})
        down = {name for name in down if depth.get(name, 0.0) > BACK}
        deepest = max(depth, key=lambda name: depth[name], default="none")
        told |= {"key": deepest, "depth": round(depth.get(deepest, 0.0), 2)}
        told = {name: value for name, value in told.items() if name in states and states[name] != value}
        states |= told
        yield task.pose(None, None, told)


def _pushed(task: ObjectTask, tops: Transform, keys: Mapping[str, Key], travel: float) -> dict[str, float]:
    """How deep keys are pushed, of their travel, by name; those that nothing pushes are left out."""
    frame = task.object.frame.then(tops)
    places, turned = forward(task.present.rotations, task.present.root, task.human.offsets)
    along = rotate(turned[TIPS], np.array([1.0, 0.0, 0.0]))
    into = -rotate(frame.rotation, np.array([0.0, 0.0, 1.0]))
    radii: Array = task.human.radii[TIPS][:, None]
    ends = places[TIPS] + rotate(turned[TIPS], task.human.tips[TIPS])
    pads = frame.inverse().apply(np.array([pad(*one, into) for one in zip(ends, along, radii, strict=True)]))
    return {name: float(depth[0]) for name, depth in pushed(pads[None], keys, travel).items()}


def _written(key: Key, properties: Mapping[str, Any], states: Mapping[str, Any]) -> dict[str, Any]:
    """What a key that is pressed changes."""
    text = str(states.get("text", ""))
    if key.name == properties.get("enter", "enter"):
        return {"entered": text, "text": ""}
    if key.name == properties.get("back", "back"):
        return {"text": text[:-1]}
    return {"text": (text + key.writes)[-MOST:]}


if __name__ == "__main__":
    run(typed)
