"""How the parts of an object look in its present states."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, to_matrix
from ahmss.states.behaviour import Appearance, Behaviour

__all__ = ["Look", "Paint", "looks"]


@dataclass(frozen=True, slots=True)
class Paint:
    """Colour and light of a part: what two objects in the same states share.

    color: sRGB, 0 to 255, in place of its own colours and picture; None: its own. lit: how much of its light is its
    own, 0 (none) to 1 (it is as bright in the dark).
    """

    color: tuple[int, int, int] | None = None
    lit: float = 0.0


@dataclass(frozen=True, slots=True)
class Look:
    """One part: whether it is to be seen, how it is painted, and where it is: T_object_part (4, 4), None: at rest."""

    shown: bool = True
    paint: Paint = Paint()
    matrix: Array | None = None


def looks(behaviour: Behaviour, states: Mapping[str, object]) -> dict[str, Look]:
    """How each part looks whose look depends on states, by its name.

    All appearances that hold count, in their order: the last that says something of a colour, of light or whether the
    part is shown is right; moves and turns add up.
    """
    out = {part: Look() for part in behaviour.parts}
    words = {name: value for name, value in states.items() if isinstance(value, str | float | int)}
    for one in behaviour.appearances:
        if one.when is not None and not one.when.holds(words):
            continue
        share = behaviour.states[one.by].share(states.get(one.by)) if one.by in behaviour.states else 1.0
        matrix = _matrix(one, share)
        for part in one.parts:
            out[part] = _changed(out[part], one, share, matrix)
    return out


def _changed(look: Look, one: Appearance, share: float, matrix: Array | None) -> Look:
    """The look with one appearance more."""
    if matrix is not None and look.matrix is not None:
        matrix = look.matrix @ matrix
    return Look(
        look.shown if one.shown is None else one.shown,
        Paint(
            look.paint.color if one.color is None else one.color,
            look.paint.lit if one.lit is None else round(one.lit * share, 3),
        ),
        look.matrix if matrix is None else matrix,
    )


def _matrix(one: Appearance, share: float) -> Array | None:
    """Where a share of its move and turn puts a part; None where it has neither."""
    if not (one.turn or any(one.move)):
        return None
    T = np.eye(4)
    axis = np.array(one.axis)
    T[:3, :3] = to_matrix(from_axis_angle(axis / np.linalg.norm(axis), share * one.turn))
    pivot = np.array(one.pivot)
    T[:3, 3] = pivot - T[:3, :3] @ pivot + share * np.array(one.move)
    return T
