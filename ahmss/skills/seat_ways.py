"""How one comes down onto a seat, and up from it, where something stands close: at ease, or held back."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.motion.steps import Steps
from ahmss.reaching.whole_body import body_points
from ahmss.skills.near_shapes import Faces

__all__ = ["AT_EASE", "MANNERS", "REACH", "Found", "Manner", "lacking", "roomiest"]

REACH = 0.6
"""Metres from where one stands to sit down within which a body comes that does."""

_AIR, _IN = 0.012, -0.003  # metres: so much air is enough; at least so much there is, as balls tell it
_EACH = 6  # frames: every so many are looked at
_MOST, _FINE = 0.6, 0.01  # metres that may be lacking, and how finely it is told


@dataclass(frozen=True)
class Manner:
    """How one goes down, and up.

    lean: of how far the trunk leans at ease. back: exponent, above 1 the hips go down before they go back.
    hands: shares of the time in which free hands go to the thighs.
    """

    lean: float = 1.0
    back: float = 1.35
    hands: tuple[float, float] = (0.35, 0.95)


AT_EASE = Manner()
MANNERS = (AT_EASE, Manner(0.65, 1.1, (0.1, 0.7)), Manner(0.3, 0.85, (0.1, 0.7)))
"""The farther down the list, the less room before the seat is taken."""


@dataclass(frozen=True, eq=False)
class Found:
    """A manner, how deep a body that goes down so is in things (negative: away from them), metres, and in what.

    points (m, n, 3), radii (n,): of the body.
    """

    manner: Manner
    deep: float
    thing: str
    points: Array
    radii: Array

    @property
    def fits(self) -> bool:
        """Whether the body is in nothing."""
        return self.deep <= _IN


def roomiest(skeleton: Skeleton, made: Callable[[Manner], tuple[Array, Array]], faces: Faces) -> Steps[Found]:
    """The first manner with air about the body; where none has any, the one in which it is least deep in things.

    made: the poses (m, 43, 4), (m, 3) of who goes down, or up, in a manner.
    """
    found: list[Found] = []
    for manner in MANNERS:
        rotations, root = made(manner)
        yield
        points, radii = body_points(skeleton, rotations[::-_EACH], root[::-_EACH])
        found.append(Found(manner, *faces.deepest(points, radii), points, radii))
        if found[-1].deep <= -_AIR:
            break
        yield
    return min(found, key=lambda one: one.deep)


def lacking(found: Found, faces: Faces, ahead: Array) -> Steps[float]:
    """Metres by which the seat is too near to things: back by so much, (3,) the other way than ahead, it would fit."""
    low, high = 0.0, _MOST
    while high - low > _FINE:
        middle = 0.5 * (low + high)
        if faces.deepest(found.points - middle * ahead, found.radii)[0] <= -_AIR:
            high = middle
        else:
            low = middle
        yield
    return high
