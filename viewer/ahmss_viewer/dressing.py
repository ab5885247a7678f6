"""Objects dressed by their states: which parts are shown, in which colour and light, and where."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ahmss.states.behaviour import Behaviour
from ahmss.states.look import Look, Paint, looks
from ahmss_viewer.stage import Stage
from ahmss_viewer.surface import Surface
from ahmss_viewer.thing import Piece

__all__ = ["Wardrobe"]

_STEPS = 16  # of light: a lamp that is dimmed makes so many surfaces, not one for each picture
States = Mapping[str, str | float | bool]


@dataclass
class _Dressed:
    """An object whose look depends on its states, and those that it shows."""

    id: int
    behaviour: Behaviour
    surfaces: tuple[Surface, ...]
    states: States


class Wardrobe:
    """Dresses the objects of a stage by their names. Objects that look the same share their surfaces."""

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        self._dressed: dict[str, _Dressed] = {}
        self._painted: dict[tuple[int, Paint], tuple[Surface, Surface]] = {}

    def add(
        self, number: int, name: str, behaviour: Behaviour | None, surfaces: tuple[Surface, ...], states: States
    ) -> Sequence[Surface | Piece]:
        """What an object is to be added with; if its look depends on states, it is dressed from now on."""
        if behaviour is None or not behaviour.appearances:
            self._dressed.pop(name, None)
            return surfaces
        self._dressed[name] = _Dressed(number, behaviour, surfaces, states)
        return self._pieces(behaviour, surfaces, states)

    def remove(self, number: int) -> None:
        """The object is gone."""
        self._dressed = {name: one for name, one in self._dressed.items() if one.id != number}

    def follow(self, states: Iterable[tuple[str, States]]) -> None:
        """Dress again what shows other states than these."""
        for name, now in states:
            one = self._dressed.get(name)
            if one is not None and one.states != now:
                one.states = now
                self._stage.dress_object(one.id, self._pieces(one.behaviour, one.surfaces, now))

    def _pieces(self, behaviour: Behaviour, surfaces: Sequence[Surface], states: States) -> list[Piece]:
        seen = looks(behaviour, states)
        return [self._piece(surface, seen.get(surface.part)) for surface in surfaces]

    def _piece(self, surface: Surface, look: Look | None) -> Piece:
        if look is None:
            return Piece(surface)
        return Piece(self._paint(surface, look.paint), look.shown, look.matrix)

    def _paint(self, surface: Surface, paint: Paint) -> Surface:
        """The surface in another colour and light."""
        lit = round(paint.lit * _STEPS) / _STEPS
        if paint.color is None and not lit:
            return surface
        key = (id(surface), Paint(paint.color, lit))
        if key not in self._painted:
            painted = replace(surface, lit=lit)
            if paint.color is not None:
                colours = np.tile(np.array([*paint.color, 255], np.uint8), (len(surface.positions), 1))
                painted = replace(painted, colours=colours, image=None)
            self._painted[key] = (surface, painted)  # holds the surface, so that its id stays its own
        return self._painted[key][1]
