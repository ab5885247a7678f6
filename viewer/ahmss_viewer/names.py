"""Names of objects and humans over the picture, where their things are."""

from __future__ import annotations

import numpy as np

from ahmss.body.links import INDEX
from ahmss_viewer.camera import View, project
from ahmss_viewer.caption import Flat, Writer
from ahmss_viewer.stage import Stage

__all__ = ["name_flats"]

_FARTHEST = 14.0
_OBJECT, _HUMAN = (38, 44, 52, 190), (150, 74, 30, 210)


def name_flats(stage: Stage, view: View, size: tuple[int, int], writer: Writer) -> list[Flat]:
    """One label a thing; of two that overlap the nearer is shown. Things without a surface have none."""
    things = [thing for thing in stage.things.values() if thing.pieces]
    actors = list(stage.actors.values())
    if not things and not actors:
        return []
    places = [thing.centre() + np.array([0.0, 0.0, 0.5 * float(np.ptp(thing.box[:, 2]))]) for thing in things]
    places += [actor.places[INDEX["head"]] + np.array([0.0, 0.0, 0.34]) for actor in actors]
    texts = [(thing.name.rsplit("/", 1)[-1], _OBJECT) for thing in things] + [(a.name, _HUMAN) for a in actors]
    seen = project(np.array(places), view, size)
    shown: list[Flat] = []
    for i in np.argsort(seen[:, 2]):
        x, y, depth = seen[i]
        if 0.1 < depth < _FARTHEST and 0 <= x < size[0] and 0 <= y < size[1]:
            text, paper = texts[i]
            flat = writer.flat(text, float(x), float(y) - 12.0, paper=paper, centred=True)
            if not any(_overlap(flat, other) for other in shown):
                shown.append(flat)
    return shown


def _overlap(a: Flat, b: Flat) -> bool:
    """Whether two labels cover each other."""
    across = a.left < b.left + b.width and b.left < a.left + a.width
    return across and a.top < b.top + b.height and b.top < a.top + a.height
