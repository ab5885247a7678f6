"""How a trunk goes from one posture to another beside things: straight, or drawn towards a third one on its way.

Whoever bends to the floor beside a table would bring the head through its edge: the knees go first then, or the lean,
or it goes a little to the side, whichever leaves head, shoulders, trunk and knees most room.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import multiply, rotate, slerp
from ahmss.motion.steps import Steps
from ahmss.reaching.leaning import looking
from ahmss.reaching.prism import Prism, clearance
from ahmss.reaching.standing import Posture, Standing
from ahmss.reaching.trunk import trunk_points

__all__ = ["between", "drawn_towards"]

_AIR = 0.02  # metres that are kept
_ON_WAY = np.linspace(0.0, 1.0, 11)  # shares of it that are looked at
_LEANS, _DROPS, _ASIDE = (0.5, 0.0, 1.0), (0.5, 1.0, 0.0), np.radians([0.0, 35.0, -35.0, 70.0, -70.0])
_AT_ONCE = 5  # ways
_TRUNK = (INDEX["hips"], INDEX["spine"])
_X = np.array([1.0, 0.0, 0.0])


def between(start: Posture, end: Posture, towards: Posture | None, done: Array) -> Posture:
    """Hips, spine and root at shares (n,) of the way between postures (43, 4), (3,); the rest as at the start."""
    rotations = np.repeat(start.rotations[None], len(done), axis=0)
    share = done[:, None]
    root = start.root + share * (end.root - start.root)
    for link in _TRUNK:
        rotations[:, link] = slerp(start.rotations[link], end.rotations[link], done)
    if towards is not None:
        for link in _TRUNK:
            first = slerp(start.rotations[link], towards.rotations[link], done)
            rotations[:, link] = slerp(first, slerp(towards.rotations[link], end.rotations[link], done), done)
        root = root + share * (1.0 - share) * (2.0 * towards.root - start.root - end.root)
    return Posture(rotations, root)


def drawn_towards(
    standing: Standing, start: Posture, end: Posture, gaze: Array | None, prisms: Sequence[Prism]
) -> Steps[Posture | None]:
    """The posture that a trunk is drawn towards on its way, so that it is in no thing; None where straight is well.

    Args:
        standing: whose feet stay. start, end: postures (43, 4), (3,), the head as at the start.
        gaze: (3,) what is looked at in the end; None: nothing. prisms: the things. Either end may be as near to them as
            it is.
    """
    if not prisms:
        return None
    least, best = _lacks(standing, start, end, [None], gaze, prisms)[0], None
    if least <= 0.0:
        return None
    yield
    candidates = _candidates(standing, min(start, end, key=lambda one: float(one.root[2])))
    for first in range(0, len(candidates), _AT_ONCE):
        some = candidates[first : first + _AT_ONCE]
        lacks = _lacks(standing, start, end, some, gaze, prisms)
        i = int(lacks.argmin())
        if lacks[i] < least:
            least, best = float(lacks[i]), some[i]
        if least <= 0.0:
            break
        yield
    return best


def _candidates(standing: Standing, bent: Posture) -> list[Posture]:
    """Postures (43, 4), (3,) leant and lowered by shares of what a bent one is, those that go straight on first."""
    trunk = rotate(multiply(bent.rotations[_TRUNK[0]], bent.rotations[_TRUNK[1]]), _X)
    lean, toward = float(np.arccos(np.clip(trunk[2], -1.0, 1.0))), float(np.arctan2(trunk[1], trunk[0]))
    drop = max(float(standing.base.root[2] - bent.root[2]), 0.0)
    grid = np.meshgrid(_ASIDE, _LEANS, _DROPS, indexing="ij")
    aside, leans, drops = (axis.ravel()[1:] for axis in grid)
    made = standing.postures(np.zeros(len(aside)), lean * leans, toward + aside, drop * drops, np.zeros(3))
    return [Posture(rotations, root) for rotations, root in zip(made.rotations, made.root, strict=True)]


def _lacks(
    standing: Standing,
    start: Posture,
    end: Posture,
    ways: Sequence[Posture | None],
    gaze: Array | None,
    prisms: Sequence[Prism],
) -> Array:
    """Metres (n,) by which a trunk on its ways comes nearer to things than it is to, at the worst; below 0: not."""
    made = [between(start, end, way, _ON_WAY) for way in ways]
    rotations, root = np.stack([one.rotations for one in made]), np.stack([one.root for one in made])
    rotations = standing.on_feet(rotations, root)
    if gaze is not None:
        rotations = looking(standing.skeleton, rotations, root, gaze, _ON_WAY)
    points, radii = trunk_points(standing.skeleton, rotations, root)
    gap = clearance(prisms, points, _AIR + float(radii.max())) - radii
    room = np.minimum(np.minimum(gap[:, :1], gap[:, -1:]), _AIR)
    return (room - gap).max(axis=(1, 2))
