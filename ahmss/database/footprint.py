"""The area on the floor that an object occupies for one who walks: what of its shape is between ankle and head height.

A floor, a rug and a lamp overhead occupy none; a doorway's frame leaves its opening free. Made once for each shape and
kept on disk like the shapes themselves.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Any

import msgspec
import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import about_z, conjugate, multiply, normalize, rotate
from ahmss.database import store
from ahmss.database.shape import Shape
from ahmss.motion.glbfile import GlbReader
from ahmss.states.behaviour import PART

__all__ = ["HIGH", "LOW", "Footprints", "Rings", "parts_of", "triangles_of"]

LOW, HIGH = 0.05, 1.9  # metres over the floor between which a walker meets things
_LIMIT = 4096  # footprints that are remembered
_VERSION = 1  # of what is made: a new one leaves what was kept aside

Rings = tuple[tuple[tuple[float, float], ...], ...]


class Footprints:
    """Footprints by shape, height and tilt."""

    def __init__(self) -> None:
        self._known: dict[tuple[Any, ...], Rings] = {}

    def of(self, shape: Shape, height: float, rotation: Array) -> Rings:
        """The footprint of a shape whose origin is `height` metres over the floor.

        Args:
            shape: as it travels.
            height: to the centimetre.
            rotation: (4,) world <- object. Its turn about z turns the footprint, and is left to who places it.

        Returns:
            Outlines in the object's frame as it is when turned `about_z` only, metres (see `outlines`).
        """
        tilt = np.round(multiply(conjugate(about_z(rotation)), rotation), 3)
        raised = round(100.0 * height)
        if (tilt[1:3] != 0.0).any():
            return self._made((shape.hash, raised, *tilt.tolist()), lambda: _tilted(shape, raised, normalize(tilt)))
        low, high = shape.bounds[0][2] + height, shape.bounds[1][2] + height
        if high <= LOW or low >= HIGH:
            return ()
        part = "all" if low >= LOW and high <= HIGH else f"{raised}cm"
        return self._made((shape.hash, part), lambda: _level(shape, raised, part))

    def _made(self, key: tuple[Any, ...], make: Callable[[], Rings]) -> Rings:
        """What is remembered under a key, or is made now."""
        known = self._known.get(key)
        if known is None:
            if len(self._known) >= _LIMIT:
                del self._known[next(iter(self._known))]
            known = self._known[key] = make()
        return known


def _level(shape: Shape, raised: int, part: str) -> Rings:
    """The footprint of a shape that stands as it was made; from the disk's store where it has it."""
    kept = store.place("footprints", f"{shape.hash}-{part}-{_VERSION}")
    data = store.take(kept)
    if data is not None:
        with contextlib.suppress(msgspec.DecodeError):
            return msgspec.msgpack.decode(data, type=Rings)
    made = _footprint(triangles_of(shape.glb), raised)
    store.keep(kept, msgspec.msgpack.encode(made))
    return made


def _tilted(shape: Shape, raised: int, tilt: Array) -> Rings:
    """The footprint of a shape that leans or lies."""
    return _footprint(rotate(tilt, triangles_of(shape.glb)), raised)


def _footprint(triangles: Array, raised: int) -> Rings:
    """The footprint of triangles (n, 3, 3) whose origin is raised by centimetres."""
    from ahmss.database.outline import outlines  # its library is slow to load and, with a store, seldom needed

    return outlines(triangles, LOW - 0.01 * raised, HIGH - 0.01 * raised)


def triangles_of(glb: bytes, *, fixed: bool = False) -> Array:
    """The triangles (n, 3, 3) of a shape as it travels; fixed: but those of parts that states may move or hide."""
    own = parts_of(glb)
    return np.concatenate([np.zeros((0, 3, 3)), *(own[name] for name in own if not (fixed and name))])


def parts_of(glb: bytes) -> dict[str, Array]:
    """The triangles (n, 3, 3) of the parts of a shape that states may move or hide, by name; "" of the rest."""
    reader, found = GlbReader(glb), dict[str, list[Array]]()
    for mesh in reader.tree["meshes"]:
        name = str(mesh.get("name", ""))
        for one in mesh["primitives"]:
            corners = reader.array(one["attributes"]["POSITION"])[reader.array(one["indices"])[:, 0]]
            own = found.setdefault(name.removeprefix(PART) if name.startswith(PART) else "", [])
            own.append(corners.astype(np.float64).reshape(-1, 3, 3))
    return {name: np.concatenate(own) for name, own in found.items()}
