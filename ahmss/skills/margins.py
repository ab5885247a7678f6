"""The margins of something flat that is held at one of them: where another hand takes it.

What has a site with a precision grip at an edge of its outline, its property `size`, is as thick at the others; the
site is turned about the vertical to each of these.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import msgspec
import numpy as np

from ahmss.algorithm.messages import SiteRecord
from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.grasping.hand import Hand
from ahmss.grasping.precision import precision
from ahmss.motion.steps import finished
from ahmss.reaching.pointing import palms_pointing
from ahmss.skills.meeting import again

__all__ = ["Margin", "margins"]

_NAME = "margin"
_TURNS = (np.pi, 0.5 * np.pi, -0.5 * np.pi)
_OVER = (0.0, np.pi)  # the thumb above, and below
_Z = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class Margin:
    """A margin, and palms (n, 7) in the world of a hand that holds it there."""

    site: SiteRecord
    palms: Array

    def task(self, task: HumanTask, **fields: object) -> HumanTask:
        """The task as if it began now, its action at this margin."""
        now = again(task, **fields)
        thing = now.message.object
        assert thing is not None
        thing = msgspec.structs.replace(thing, sites={**thing.sites, _NAME: self.site})
        return again(task, **(fields | {"object": thing, "site": _NAME}))


def margins(task: HumanTask, side: str, aslant: float = 0.0) -> Sequence[Margin]:
    """The margins of the task's object but the one where its site is; none of what is not flat, or has no such site.

    aslant: radians by which the hand comes from aside of square to the margin, as a wrist may need it.
    """
    thing = task.object
    if thing is None or thing.shape is None or "size" not in thing.properties:
        return []
    site = next((site for site in thing.sites.values() if site.grip == "precision"), None)
    if site is None:
        return []
    half, at = 0.5 * np.array(thing.properties["size"], float)[:2], np.array(site.position)
    along = int(np.abs(at[:2] / half).argmax())
    inset, out = half[along] - abs(at[along]), np.sign(at[along]) * np.eye(3)[along]
    found: list[Margin] = []
    for turn in _TURNS:
        q = from_axis_angle(_Z, np.array(turn))
        way = rotate(q, out).round()
        place = way * (np.append(half, 0.0) - inset) + at[2] * _Z
        made = SiteRecord(tuple(place.tolist()), tuple(multiply(q, np.array(site.rotation)).tolist()), "", "precision")  # type: ignore[arg-type]
        palms = _palms(task, side, made, aslant)
        if len(palms):
            found.append(Margin(made, palms))
    return found


def _palms(task: HumanTask, side: str, site: SiteRecord, aslant: float) -> Array:
    """Palms (n, 7) in the world that hold the object at a site."""
    thing = task.object
    assert thing is not None
    assert thing.shape is not None
    rotation = multiply(np.array(site.rotation), from_axis_angle(_Z, np.array(aslant)))
    local = Transform(np.array(site.position), rotation)
    into = rotate(thing.frame.then(local).rotation, np.array([1.0, 0.0, 0.0]))
    level = palms_pointing(task.human, side, thing.frame.apply(local.place), into, None, exactly=True)
    made: list[Array] = []
    for over in _OVER:
        turned = Transform(level[0, :3], multiply(from_axis_angle(into, np.array(over)), level[0, 3:]))
        present = thing.frame.inverse().then(turned)
        field = thing.shape.field(local.place)
        holding = finished(precision(Hand.of(task.human, side), field, present.row(), local.row()))
        if holding is not None and holding.holds:
            made.append(thing.frame.then(Transform.of(holding.palm)).row())
    return np.array(made).reshape(-1, 7)
