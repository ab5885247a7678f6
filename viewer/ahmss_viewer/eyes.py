"""What a human sees: the camera between its eyes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.body.links import INDEX
from ahmss.body.sight import line_of_sight
from ahmss.errors import CommandError
from ahmss_viewer.camera import View, look_at
from ahmss_viewer.stage import Stage

__all__ = ["view_of"]

_FIELD = np.radians(75.0)  # from top to bottom: near to what two eyes take in at once


def view_of(stage: Stage, name: str, target: Sequence[float] | None = None) -> View:
    """The view from a human's eyes at a place, or along its line of sight; level, as one sees the world.

    Of its own body the limbs alone are in the picture, wherever the eyes turn.

    Args:
        stage: with the human on it.
        name: of the human.
        target: (3,) metres in the world; the eyes turn to it whatever the head does.

    Raises:
        CommandError: no such human; says who is there.
    """
    for actor in stage.actors.values():
        if actor.name == name:
            stage.see_by(actor.id)
            place, ahead = line_of_sight(actor.places[INDEX["head"]], actor.head, actor.eye)
            at = place + ahead if target is None else np.array(target, float)
            return look_at(place, at, float(_FIELD))
    there = ", ".join(actor.name for actor in stage.actors.values()) or "nobody"
    raise CommandError(f'no human "{name}" to see by; there is: {there}')
