"""Which view the options ask for, and how it goes on."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ahmss.body.array import Array
from ahmss_viewer.camera import View, look_at
from ahmss_viewer.choosing import best_view, clear_preset
from ahmss_viewer.eyes import view_of
from ahmss_viewer.framing import Follower, Interest, interest
from ahmss_viewer.options import ViewOptions
from ahmss_viewer.painter import Painter
from ahmss_viewer.stage import Stage

__all__ = ["Aim", "Arrivals"]

_EYE_HEIGHT = 1.6
_STILL = 2e-4  # metres from one picture to the next


class Arrivals:
    """Says when the view is to be chosen anew: a scene comes piece by piece, and what comes may hide the human."""

    def __init__(self) -> None:
        self._humans: set[int] | None = None
        self._things: set[int] = set()
        self._places: dict[int, Array] = {}
        self._begun = self._due = False

    def due(self, stage: Stage) -> bool:
        """Whether humans or objects have come that were never here before; to be asked once for each picture.

        Of objects it is said when nobody moves, for the camera must not jump during a motion; but until the first
        motion has begun the scene counts as still arriving.
        """
        humans, things = set(stage.actors), set(stage.things)
        places = {number: actor.places for number, actor in stage.actors.items()}
        moves = any(_moved(place, self._places[number]) for number, place in places.items() if number in self._places)
        first = self._humans is None
        known = self._humans or set()
        self._due |= not things <= self._things
        due = first or not humans <= known or (self._due and not (moves and self._begun))
        self._due &= not due
        self._begun |= moves
        self._humans, self._things, self._places = known | humans, self._things | things, places
        return due


def _moved(places: Array, before: Array) -> bool:
    """Whether a human's joints (43, 3) are elsewhere than before."""
    return float(np.abs(places - before).max()) > _STILL


class Aim:
    """The camera of a headless run, or a window's first one."""

    def __init__(self, options: ViewOptions) -> None:
        self.options = options
        self.view: View | None = None
        self._follower = Follower(options.follow)

    def begin(
        self,
        stage: Stage,
        painter: Painter,
        wanted: Interest | None = None,
        moments: Iterable[Interest] | None = None,
    ) -> View:
        """Choose the view; `wanted` is what is known of the whole motion, else what is on the stage now counts."""
        if self.options.eyes:
            self.view = view_of(stage, self.options.eyes, self.options.look_at)
            return self.view
        options, aspect = self.options, self.options.size[0] / self.options.size[1]
        wanted = wanted or interest(stage, options.follow)
        if wanted is None:
            self.view = View()
        elif options.position is not None or options.look_at is not None:
            self.view = self._fixed(wanted)
        elif options.camera == "auto":
            self.view = best_view(stage, painter, wanted, aspect, moments)
        else:
            self.view = clear_preset(options.camera, stage, painter, wanted, aspect, moments)
        return self.view

    def step(self, stage: Stage, seconds: float, *, whole: bool = False) -> View:
        """The view a moment later: it follows whom it should; a view made for the `whole` motion stays."""
        if self.options.eyes and stage.actors:
            self.view = view_of(stage, self.options.eyes, self.options.look_at)
            return self.view
        view = self.view if self.view is not None else View()
        fixed = self.options.position is not None or self.options.look_at is not None or self.options.camera != "auto"
        if self.options.follow or not (whole or fixed):
            view = self._follower.step(view, stage, self.options.size[0] / self.options.size[1], seconds)
        self.view = view
        return view

    def _fixed(self, wanted: Interest) -> View:
        """From a place, at a place; what was left out is chosen."""
        middle = 0.5 * (wanted.points.min(axis=0) + wanted.points.max(axis=0))
        target = np.array(self.options.look_at, float) if self.options.look_at is not None else middle
        if self.options.position is not None:
            return look_at(np.array(self.options.position, float), target)
        back = wanted.facing * 2.6 + np.array([-wanted.facing[1], wanted.facing[0], 0.0]) * 1.6
        return look_at(target + back + np.array([0.0, 0.0, max(0.3, _EYE_HEIGHT - float(target[2]))]), target)
