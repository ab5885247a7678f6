"""What stands near as it really is, face by face: how deep a body is in it, of which only the bones are known.

An outline seen from above is not enough where legs go under a table's top and a head over it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.grasping.distance import distances

__all__ = ["Faces"]


@dataclass(frozen=True, eq=False)
class Faces:
    """Faces (n, 3, 3) in the world, metres, and the number in `names` of what each is of (n,)."""

    triangles: Array
    owners: NDArray[np.intp]
    names: tuple[str, ...]

    @classmethod
    def about(cls, task: HumanTask, place: Array, within: float, *, but: WorldObject) -> Faces:
        """Those of what stands so near to a place (2,), but of one thing; what states move of it is left out.

        algorithm.toml must ask for `footprints` and for `shapes`.

        Raises:
            DataError: a shape can't be read.
        """
        here = shapely.points(place)
        found: list[tuple[str, Array]] = []
        for thing in task.world.values():
            if thing.id == but.id or thing.shape is None:
                continue
            rings = [shapely.Polygon(ring) for ring in thing.occupied if len(ring) >= 3]
            if any(shapely.distance(here, ring) < within for ring in rings):
                corners = thing.frame.apply((thing.shape.rest or thing.shape).vertices)
                found.append((thing.name, corners.reshape(-1, 3, 3)))
        triangles = np.concatenate([np.zeros((0, 3, 3)), *(faces for _, faces in found)])
        owners = np.repeat(np.arange(len(found)), [len(faces) for _, faces in found])
        return cls(triangles, owners.astype(np.intp), tuple(name for name, _ in found))

    def deepest(self, points: Array, radii: Array) -> tuple[float, str]:
        """How deep, metres, balls of radii (n,) about points (m, n, 3) are in a face at the most, negative outside, and
        in what; no more than 5 cm outside, where it is "".
        """
        flat, thick = points.reshape(-1, 3), np.broadcast_to(radii, points.shape[:-1]).ravel()
        low, high = self.triangles.min(axis=1), self.triangles.max(axis=1)
        reach = thick[:, None] + _FAR
        near = np.flatnonzero(
            (
                (low <= (flat + reach).max(axis=0, initial=-np.inf))
                & (high >= (flat - reach).min(axis=0, initial=np.inf))
            ).all(axis=1)
        )
        i, j = np.nonzero(
            ((flat[:, None] >= low[near] - reach[:, None]) & (flat[:, None] <= high[near] + reach[:, None])).all(
                axis=-1
            )
        )
        if not len(i):
            return -_FAR, ""
        deep = thick[i] - distances(flat[i], self.triangles[near[j]])
        worst = int(deep.argmax())
        return (float(deep[worst]), self.names[self.owners[near[j[worst]]]]) if deep[worst] > -_FAR else (-_FAR, "")


_FAR = 0.05  # metres
