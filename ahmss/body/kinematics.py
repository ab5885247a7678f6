"""Forward kinematics: from joint rotations to the links in the world (Ichiguchi 2000, 4.9 and 4.10).

Here a quaternion is a pair of complex numbers, q = a + b j with a = w + x i and b = y + z i, and a place is its x and
y + z i. A product is then four complex ones where there were sixteen real ones, which halves the time of a batch.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ahmss.body.array import Array
from ahmss.body.components import multiply, rotate
from ahmss.body.links import INDEX, PARENTS

__all__ = ["forward"]

_CHUNK = 1000  # humans at a time, so that what a step needs stays in the cache
_BUFFER = 256  # elements: above the inner length numpy copies operands into buffers, which doubles the time
_MOST = 8  # links that one step computes
_KEPT = 4  # workspaces a thread keeps

Select = Callable[[Any], Any]


def forward(
    rotations: Array, root: Array, offsets: Array, out: tuple[Array, Array] | None = None
) -> tuple[Array, Array]:
    """Places and rotations of all links in the world.

    Args:
        rotations: (..., 43, 4) unit quaternions, parent <- child; row 0 is world <- hips.
        root: (..., 3) place of the hips' joint in the world, metres.
        offsets: (43, 3) each joint's place in its parent's frame, metres.
        out: the result of an earlier call, to be overwritten; spares a batch the allocation.

    Returns:
        places (..., 43, 3) in metres (4.9) and rotations (..., 43, 4), world <- link (4.10). In memory a batch lies
        component by component, which is also the fastest way to give one.
    """
    if rotations.ndim == 2 and out is None:
        return _forward_one(rotations.tolist(), root.tolist(), offsets.tolist())
    leading = rotations.shape[:-2]
    many = math.prod(leading)
    q = rotations.reshape(many, 43, 4).transpose(2, 1, 0)
    p = root.reshape(many, 3).T
    if out is None:
        places, world = np.empty((3, 43, many)), np.empty((4, 43, many))
    else:
        places, world = out[0].reshape(many, 43, 3).transpose(2, 1, 0), out[1].reshape(many, 43, 4).transpose(2, 1, 0)
    along, across = offsets[:, 0], offsets[:, 1] + 1j * offsets[:, 2]
    with np.errstate():  # on leaving it, numpy's buffer has its own size again
        np.setbufsize(_BUFFER)
        for first in range(0, many, _CHUNK):
            part = slice(first, first + _CHUNK)
            workspace = _workspace(min(_CHUNK, many - first))
            workspace.compute(q[..., part], p[..., part], along, across)
            workspace.give(places[..., part], world[..., part])
    return (_shaped(places, leading), _shaped(world, leading)) if out is None else out


def _forward_one(rotations: Any, root: Any, offsets: Any) -> tuple[Array, Array]:
    """One pose link by link: for a single one Python's floats are faster than arrays of one."""
    places: list[Any] = [root]
    world: list[Any] = [rotations[0]]
    for link in range(1, len(PARENTS)):
        q_world_parent = world[PARENTS[link]]
        x, y, z = rotate(q_world_parent, offsets[link])
        x0, y0, z0 = places[PARENTS[link]]
        places.append((x0 + x, y0 + y, z0 + z))
        world.append(multiply(q_world_parent, rotations[link]))
    return np.array(places), np.array(world)


def _shaped(components: Array, leading: tuple[int, ...]) -> Array:
    """(components, 43, n) as (..., 43, components)."""
    rows = components.transpose(2, 1, 0)
    return rows.reshape(*leading, *rows.shape[1:])


class _Step(NamedTuple):
    """Links that are computed at once: views of them and of their parents in the workspace."""

    q: Any  # own rotations (a, b), parent <- child
    q_world: Any
    q_world_parent: Any
    spare: Any
    place: tuple[Any, Any]  # x, y + z i
    place_parent: tuple[Any, Any]
    products: tuple[Any, Any]  # |b|^2 and a b of the parent's world rotation
    along: Any  # the offset s along the parent's x axis
    along_factors: tuple[Any, Any]  # -2 s and -2 i s, of the products' types, so that numpy need not convert
    across: Any  # the offset's y + z i


class _Workspace:
    """The arrays for n humans, and the views that the steps work on, made once."""

    def __init__(self, n: int) -> None:
        self.own, self.world = _complex(2, 43, n), _complex(2, 43, n)
        self.x, self.length_b, self.square = (np.empty((1, 43, n)) for _ in range(3))
        spare = _complex(2 * _MOST * n)  # one for all steps, so that it stays in the cache
        self.yz, self.a_b = _complex(1, 43, n), _complex(1, 43, n)
        self.along, self.factor_x = np.empty((1, 43, 1)), np.empty((1, 43, 1))
        self.factor_yz, self.across = _complex(1, 43, 1), _complex(1, 43, 1)
        self.steps = [
            _Step(
                child(self.own), child(self.world), parent(self.world), _like(child(self.own), spare),
                (child(self.x)[0], child(self.yz)[0]), (parent(self.x)[0], parent(self.yz)[0]),
                (parent(self.length_b)[0], parent(self.a_b)[0]), child(self.along)[0],
                (child(self.factor_x)[0], child(self.factor_yz)[0]), child(self.across)[0],
            )
            for child, parent in _STEPS
        ]  # fmt: skip

    def compute(self, q: Array, root: Array, along: Array, across: Any) -> None:
        """World rotations and places from rotations q (4, 43, n), root (3, n) and offsets (43,)."""
        self.along[0, :, 0], self.across[0, :, 0] = along, across
        self.factor_x[0, :, 0], self.factor_yz[0, :, 0] = -2.0 * along, -2j * along
        self.own.real, self.own.imag = q[0::2], q[1::2]
        self.world[:, 0] = self.own[:, 0]
        for step in self.steps:
            _multiply(step)
        a, b = self.world
        np.multiply(b.real, b.real, self.length_b[0])
        np.multiply(b.imag, b.imag, self.square[0])
        self.length_b += self.square
        np.multiply(a, b, self.a_b[0])
        self.x[0, 0], self.yz[0, 0].real, self.yz[0, 0].imag = root
        for step in self.steps:
            _place(step)

    def give(self, places: Array, world: Array) -> None:
        """Write the result, component by component: places (3, 43, n) and rotations (4, 43, n)."""
        places[0], places[1], places[2] = self.x[0], self.yz[0].real, self.yz[0].imag
        world[0::2], world[1::2] = self.world.real, self.world.imag


def _like(links: Any, spare: Any) -> Any:
    """A part of the spare memory in the shape of some links."""
    return spare[: links.size].reshape(links.shape)


def _complex(*shape: int) -> Any:
    return np.empty(shape, complex)


def _multiply(step: _Step) -> None:
    """(a1 + b1 j)(a2 + b2 j) = (a1 a2 - (b1* b2)*) + (a1 b2 + (b1* a2)*) j: (4.4), parent first (4.10)."""
    a, b = step.q_world_parent
    out, spare = step.q_world, step.spare
    np.multiply(a, step.q, out)
    np.multiply(b.conj(), step.q[::-1], spare)
    np.conjugate(spare, spare)
    np.subtract(out[0], spare[0], out[0])
    np.add(out[1], spare[1], out[1])


def _place(step: _Step) -> None:
    """The joints' places (4.9): the parent's, and the offset s i + c j turned by the parent's rotation.

    x' = s (1 - 2 |b|^2) + 2 Im(a b* c) and y' + z' i = -2 i s a b + a^2 c + b^2 c*.
    """
    x, yz = step.place
    np.multiply(step.along_factors[0], step.products[0], x)
    np.multiply(step.along_factors[1], step.products[1], yz)
    x += step.along
    c = step.across
    if c.any():
        a, b = step.q_world_parent
        x += (a * b.conj() * (2.0 * c)).imag
        yz += a * a * c
        yz += b * b * c.conj()
    x += step.place_parent[0]
    yz += step.place_parent[1]


_kept = threading.local()


def _workspace(n: int) -> _Workspace:
    """This thread's workspace for n humans."""
    if not hasattr(_kept, "workspaces"):
        _kept.workspaces = {}
    workspaces: dict[int, _Workspace] = _kept.workspaces
    found = workspaces.get(n)
    if found is None:
        if len(workspaces) >= _KEPT:
            workspaces.pop(next(iter(workspaces)))
        found = workspaces[n] = _Workspace(n)
    return found


def _limbs(segment: int) -> Select:
    """Of arms and legs, both sides, one segment: (k, side, arm or leg, n)."""
    return lambda rows: rows[:, 3:15].reshape(rows.shape[0], 2, 2, 3, -1)[:, :, :, segment]


def _fingers(which: int | slice) -> Select:
    """Of the 14 finger links of both hands: (k, side, ..., n)."""
    return lambda rows: rows[:, 15:43].reshape(rows.shape[0], 2, 14, -1)[:, :, which]


def _link(name: str) -> Select:
    return lambda rows: rows[:, INDEX[name]]


def _hands(rows: Any) -> Any:
    return rows[:, INDEX["right_hand"] : INDEX["left_hand"] + 1 : 6]


# Links and their parents by what can be computed at once, parents before children; rows are (k, 43, n).
_STEPS: tuple[tuple[Select, Select], ...] = (
    (_link("spine"), _link("hips")),
    (_link("head"), _link("spine")),
    (_limbs(0), lambda rows: rows[:, 1::-1][:, None]),  # arms hang on the spine, legs on the hips
    (_limbs(1), _limbs(0)),
    (_limbs(2), _limbs(1)),
    (_fingers(0), _hands),
    (_fingers(1), _fingers(0)),
    (_fingers(slice(2, None, 3)), lambda rows: _hands(rows)[:, :, None]),
    (_fingers(slice(3, None, 3)), _fingers(slice(2, None, 3))),
    (_fingers(slice(4, None, 3)), _fingers(slice(3, None, 3))),
)
