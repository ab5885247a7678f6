"""Inverse kinematics: hands, feet and gaze solved onto their targets after blending.

The same closed forms serve a batch and the one pose of the frame loop (see `components`); a target without weight
costs nothing.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from ahmss.body.array import Array
from ahmss.body.components import ARRAYS, FLOATS, Functions, Quaternion, Vector, conjugate, multiply, relative, rotate
from ahmss.body.gaze import solve_gaze
from ahmss.body.limb import Goal, Limb, solve_limb
from ahmss.body.limb_one import end_of, solve_usual
from ahmss.body.links import INDEX
from ahmss.body.skeleton import Skeleton
from ahmss.errors import ShapeError

__all__ = ["GAZE", "LEFT_FOOT", "LEFT_HAND", "RIGHT_FOOT", "RIGHT_HAND", "ends", "grips", "solve"]

RIGHT_HAND, LEFT_HAND, RIGHT_FOOT, LEFT_FOOT, GAZE = range(5)  # rows of a targets array

_HIPS, _SPINE, _HEAD = INDEX["hips"], INDEX["spine"], INDEX["head"]
_FIRST = ("right_upper_arm", "left_upper_arm", "right_upper_leg", "left_upper_leg")  # in the order of targets
_ROWS = INDEX["left_foot"] + 1  # the body without the fingers
_SOFT_ARM, _SOFT_LEG = 0.02, 0.008  # shares of the reach; a planted foot may give less than a hand
_NOWHERE: Vector = (0.0, 0.0, 0.0)
_UNTURNED: Quaternion = (1.0, 0.0, 0.0, 0.0)


class _Measures(NamedTuple):
    """A skeleton's numbers as plain floats."""

    limbs: tuple[Limb, ...]
    spine: Vector
    head: Vector
    eye: Vector


def solve(skeleton: Skeleton, rotations: Array, root: Array, targets: Array) -> Array:
    """Rotations whose hands, feet and gaze meet their targets, as near to the given ones as may be.

    A hand's target is the pose of its grip frame, a foot's that of its link (the ankle), the gaze's a place. A weight
    below 1 meets a pose that far on the way from the given one to the target. Out of reach, the limb stretches towards
    it. Fingers, hips and root stay as they are; the spine turns a little for a gaze far aside.

    Args:
        skeleton: the human's measures.
        rotations: (..., 43, 4) unit quaternions, parent <- child.
        root: (..., 3) metres, world.
        targets: (..., 5, 8) rows right hand, left hand, right foot, left foot, gaze; columns place, rotation (all 0:
            free), weight; world.

    Returns:
        (..., 43, 4) unit quaternions on the hemisphere of those given.

    Raises:
        ShapeError: the shapes disagree.
    """
    if rotations.shape[:-2] != root.shape[:-1] or targets.shape != (*root.shape[:-1], 5, 8):
        raise ShapeError(
            f"solve: rotations {rotations.shape}, root {root.shape} and targets {targets.shape} disagree; they must be "
            "(..., 43, 4), (..., 3) and (..., 5, 8)"
        )
    out = rotations.copy()
    if targets.ndim == 2:
        _solve_one(_measures(skeleton), out, root, targets.tolist())
    elif targets[..., 7].any():
        flat = out.reshape(-1, *rotations.shape[-2:])
        _solve_many(_measures(skeleton), flat, root.reshape(-1, 3), targets.reshape(-1, 5, 8))
        out = flat.reshape(rotations.shape)
    return out


def _solve_one(measures: _Measures, out: Array, root: Array, targets: list[list[float]]) -> None:
    """Solve one pose (43, 4) in place."""
    if not (targets[0][7] or targets[1][7] or targets[2][7] or targets[3][7] or targets[4][7]):
        return
    rows: list[Any] = out[:_ROWS].tolist()
    body = _Body(FLOATS, measures, rows, root.tolist())
    if targets[GAZE][7] > 0.0:
        body.look(targets[GAZE])
    trunk = _trunk(measures, rows, body.root)
    for limb, target in zip(measures.limbs, targets, strict=False):
        if target[7] > 0.0:
            free = target[3] == target[4] == target[5] == target[6] == 0.0
            solved = None if free else solve_usual(limb, *trunk[limb.first in _ON_SPINE], rows, target)
            rows[limb.first : limb.first + 3] = solved or body.reach(limb, target, free=free)
    out[:_ROWS] = rows


def _solve_many(measures: _Measures, out: Array, root: Array, targets: Array) -> None:
    """Solve poses (n, 43, 4) in place, each target on those alone that have it."""
    weighted: Any = targets[..., 7] > 0.0
    free: Any = ~targets[..., 3:7].any(axis=-1)
    looking = np.flatnonzero(weighted[:, GAZE])
    if len(looking):
        body = _body_of(measures, out, root, looking)
        body.look(targets[looking, GAZE].T)
        for link in (_SPINE, _HEAD):
            out[looking, link] = np.stack(body.rows[link], axis=-1)
    for row, limb in enumerate(measures.limbs):
        for is_free in (False, True):
            chosen = np.flatnonzero(weighted[:, row] & (free[:, row] == is_free))
            if len(chosen):
                body = _body_of(measures, out, root, chosen)
                solved = body.reach(limb, targets[chosen, row].T, free=is_free)
                for i, rotation in enumerate(solved):
                    out[chosen, limb.first + i] = np.stack(rotation, axis=-1)


def _body_of(measures: _Measures, rotations: Array, root: Array, chosen: Any) -> _Body:
    """Some poses of a batch, component by component."""
    rows = [tuple(link) for link in np.ascontiguousarray(rotations[chosen, :_ROWS].transpose(1, 2, 0))]
    return _Body(ARRAYS, measures, rows, tuple(root[chosen].T))


class _Body:
    """The given pose by components, and what its limbs hang on."""

    def __init__(self, m: Functions, measures: _Measures, rows: list[Any], root: Any) -> None:
        self.m, self.measures, self.rows, self.root = m, measures, rows, root

    def look(self, target: Any) -> None:
        """Turn head and spine, in the rows, to the place of a target (8)."""
        place = self._seen_from_hips((target[0], target[1], target[2]))
        spine, measures = self.measures.spine, self.measures
        place = (place[0] - spine[0], place[1] - spine[1], place[2] - spine[2])
        given = (self.rows[_SPINE], self.rows[_HEAD])
        solved = solve_gaze(self.m, measures.head, measures.eye, given, place, target[7])
        self.rows[_SPINE], self.rows[_HEAD] = solved

    def reach(self, limb: Limb, target: Any, *, free: bool) -> tuple[Quaternion, Quaternion, Quaternion]:
        """The three rotations of a limb for a target (8) in the world."""
        place = self._seen_from_hips((target[0], target[1], target[2]))
        rotation = None if free else (target[3], target[4], target[5], target[6])
        parent = self.rows[_HIPS]
        if limb.first in _ON_SPINE:
            spine, q_spine = self.measures.spine, self.rows[_SPINE]
            from_spine = (place[0] - spine[0], place[1] - spine[1], place[2] - spine[2])
            place = rotate(conjugate(q_spine), from_spine)
            parent = multiply(parent, q_spine) if rotation is not None else parent
        if rotation is not None:
            rotation = relative(parent, rotation)
        given = (self.rows[limb.first], self.rows[limb.first + 1], self.rows[limb.first + 2])
        return solve_limb(self.m, limb, given, Goal(place, rotation, target[7]))

    def _seen_from_hips(self, place: Vector) -> Vector:
        """A place of the world in the hips' frame."""
        x, y, z = self.root
        return rotate(conjugate(self.rows[_HIPS]), (place[0] - x, place[1] - y, place[2] - z))


_ON_SPINE = (INDEX["right_upper_arm"], INDEX["left_upper_arm"])


@lru_cache(maxsize=256)
def _measures(skeleton: Skeleton) -> _Measures:
    limbs = tuple(_limb(skeleton, row, INDEX[name]) for row, name in enumerate(_FIRST))
    offsets = skeleton.offsets
    return _Measures(limbs, _floats(offsets[_SPINE]), _floats(offsets[_HEAD]), _floats(skeleton.eye))


def _limb(skeleton: Skeleton, row: int, first: int) -> Limb:
    lower = skeleton.offsets[first + 2]
    grip, rotation = _NOWHERE, _UNTURNED
    if row in (RIGHT_HAND, LEFT_HAND):
        grip, rotation = _floats(skeleton.grips[row, :3]), tuple(skeleton.grips[row, 3:].tolist())
    turn, flexion = skeleton.limits[first + 1, 0], skeleton.limits[first + 1, 1]
    return Limb(
        first=first,
        base=_floats(skeleton.offsets[first]),
        upper=_floats(skeleton.offsets[first + 1]),
        lower=_floats(lower),
        lower_axis=_floats(lower / np.linalg.norm(lower)),
        grip=grip,
        grip_conjugate=conjugate(rotation),
        turn=(float(turn[0]), float(turn[1])),
        most_bent=float(np.cos(flexion[1])),
        soft=_SOFT_ARM if row in (RIGHT_HAND, LEFT_HAND) else _SOFT_LEG,
    )


def _floats(v: Array) -> Vector:
    x, y, z = v.tolist()
    return (x, y, z)


def grips(skeleton: Skeleton, rotations: Array, root: Array) -> Array:
    """The grip frames (..., 2, 7) of right and left hand in the world: place in metres, rotation wxyz.

    Args:
        skeleton: the human's measures.
        rotations: (..., 43, 4) unit quaternions, parent <- child.
        root: (..., 3) metres, world.
    """
    return _ends(skeleton, rotations, root, _HANDS)


def ends(skeleton: Skeleton, rotations: Array, root: Array) -> Array:
    """What meets the targets (..., 4, 7): grip frames of right and left hand, ankles of right and left foot, world."""
    return _ends(skeleton, rotations, root, _HANDS_AND_FEET)


_HANDS, _HANDS_AND_FEET = slice(0, 2), slice(0, 4)  # of the limbs


def _ends(skeleton: Skeleton, rotations: Array, root: Array, chosen: slice) -> Array:
    measures = _measures(skeleton)
    if rotations.ndim == 2:
        return np.array(_chains_one(measures, chosen, rotations[:_ROWS].tolist(), root.tolist()))
    rows = [tuple(np.moveaxis(rotations[..., link, :], -1, 0)) for link in range(_ROWS)]
    frames = _chains(measures, chosen, rows, tuple(np.moveaxis(root, -1, 0)))
    return np.stack([np.stack(frame, axis=-1) for frame in frames], axis=-2)


def _chains_one(measures: _Measures, chosen: slice, rows: Any, root: Any) -> list[Any]:
    """The same for one pose in plain floats."""
    trunk = _trunk(measures, rows, root)
    return [end_of(limb, *trunk[limb.first in _ON_SPINE], rows) for limb in measures.limbs[chosen]]


def _trunk(measures: _Measures, rows: Any, root: Any) -> tuple[tuple[Vector, Quaternion], tuple[Vector, Quaternion]]:
    """What legs hang on, the hips, and what arms do, the spine: place and rotation in the world."""
    q_hips = rows[_HIPS]
    return (root, q_hips), (_add(root, rotate(q_hips, measures.spine)), multiply(q_hips, rows[_SPINE]))


def _chains(measures: _Measures, chosen: slice, rows: Any, root: Any) -> list[Any]:
    """Place and rotation of the ends of some limbs, component by component, along their chains only."""
    trunk = _trunk(measures, rows, root)
    frames: list[Any] = []
    for limb in measures.limbs[chosen]:
        place, q_parent = trunk[limb.first in _ON_SPINE]
        q_upper = multiply(q_parent, rows[limb.first])
        q_lower = multiply(q_upper, rows[limb.first + 1])
        q_end = multiply(q_lower, rows[limb.first + 2])
        place = _add(place, rotate(q_parent, limb.base))
        place = _add(place, rotate(q_upper, limb.upper))
        place = _add(place, rotate(q_lower, limb.lower))
        place = _add(place, rotate(q_end, limb.grip))
        frames.append((*place, *multiply(q_end, conjugate(limb.grip_conjugate))))
    return frames


def _add(u: Vector, v: Vector) -> Vector:
    return (u[0] + v[0], u[1] + v[1], u[2] + v[2])
