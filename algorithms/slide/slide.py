"""Sliding a lever along its slot: thumb and fingers take its knob, go with it, and let it go.

The property `slide` is its way in the object's frame, metres, from where the shape has it to the other end.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanTask, Transform, run
from ahmss.body.array import Array
from ahmss.body.quaternion import IDENTITY, rotate
from ahmss.errors import AlgorithmError
from ahmss.skills.pinching import Part, pinched

LEAST, A_METRE = 0.35, 4.0  # seconds that it takes at least, and for a metre more
NEXT_TO, OFF = 0.01, 0.015  # of its way: nobody sees that it was moved; that it may come to rest beside where it is to
LOST = 0.05  # of its way: so far beside it the fingers have lost it


def slide(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260): the hand comes, closes, slides, opens, and goes back.

    Raises:
        AlgorithmError: the action names no site, the object has no shape or does not say its way, the human is carried.
    """
    thing = task.object
    if task.site is None or thing is None or thing.shape is None or "slide" not in thing.properties:
        raise AlgorithmError(
            "slide needs an object that has a shape and a property `slide`, and a site where its knob is"
        )
    if task.carried:
        raise AlgorithmError("a lever is moved standing; walk there first, then slide it")
    along = rotate(thing.rotation, np.array(thing.properties["slide"], float))
    state = task.parameter("state", "level")
    now, to = float(thing.states.get(state, 0.0)), task.parameter("level", -1.0)
    if to < 0.0:
        to = 0.0 if now > 0.5 else 1.0
    if abs(to - now) < NEXT_TO:
        task.note(f"it is at {now:.2f} already")
    in_vain = f"it stands at {{{state}}} instead of {to:.2f}, for the fingers lost it; do it again, or from elsewhere"
    task.means(in_vain, **{state: (to - LOST, to + LOST)})
    site = Transform(task.site.place + now * along, task.site.rotation)
    way = (to - now) * along

    def gone(share: Array) -> tuple[Array, Array]:
        return site.place + share[:, None] * way, np.tile(IDENTITY, (len(share), 1))

    def came(first: Array, last: Array) -> float:
        """As `slid` has it: as far as the palm that holds the knob brings that."""
        knob = Transform.of(last).apply(Transform.of(first).inverse().apply(site.place))
        brought = now + float((knob - site.place) @ along) / float(along @ along)
        return (float(np.clip(brought, 0.0, 1.0)) - now) / (to - now) if to != now else 1.0

    def short(first: Array, last: Array) -> str:
        rests = now + came(first, last) * (to - now)
        if abs(rests - to) <= OFF:
            return ""
        return f"the hand would bring {thing.name} to {rests:.2f} instead of {to:.2f} from here; stand elsewhere"

    seconds = LEAST + A_METRE * float(np.linalg.norm(way))
    return pinched(task, Part(site, gone, seconds, short=short, came=came))


if __name__ == "__main__":
    run(slide)
