"""The skin of a human as viewers show it: linear blend skinning of the shape's vertices."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import LINKS
from ahmss.body.quaternion import to_matrix
from ahmss.body.skeleton import Skeleton
from ahmss.motion.glbfile import GlbReader

__all__ = ["Skin"]


@dataclass(frozen=True)
class Skin:
    """Vertices (V, 4) as modelled, 1 last; up to four links (V, 4) with weights (V, 4); from_model (43, 4, 4)."""

    vertices: Array
    links: NDArray[np.intp]
    weights: Array
    from_model: Array

    @classmethod
    def read(cls, glb: bytes) -> Skin:
        """The first mesh of a human's shape."""
        source = GlbReader(glb)
        of = source.tree["meshes"][0]["primitives"][0]["attributes"]
        skin = source.tree["skins"][0]
        order = np.array([LINKS.index(source.tree["nodes"][node]["name"]) for node in skin["joints"]])
        inverse = source.array(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
        vertices = source.array(of["POSITION"]).astype(float)
        weights = source.array(of["WEIGHTS_0"]).astype(float)
        return cls(
            np.concatenate([vertices, np.ones((len(vertices), 1))], axis=1), order[source.array(of["JOINTS_0"])],
            weights / weights.sum(axis=1, keepdims=True), inverse.astype(float)[np.argsort(order)],
        )  # fmt: skip

    @property
    def link(self) -> NDArray[np.intp]:
        """(V,) the link that moves a vertex most."""
        return self.links[np.arange(len(self.links)), self.weights.argmax(axis=1)]

    def posed(self, skeleton: Skeleton, rotations: Array, root: Array) -> Array:
        """Where the vertices (V, 3) are in the world, for one pose (43, 4), (3,)."""
        places, turned = forward(rotations, root, skeleton.offsets)
        moved = np.tile(np.eye(4), (len(LINKS), 1, 1))
        moved[:, :3, :3], moved[:, :3, 3] = to_matrix(turned), places
        bones = (moved @ self.from_model)[:, :3]
        out = np.zeros((len(self.vertices), 3))
        for one in range(self.links.shape[1]):
            out += self.weights[:, one, None] * np.einsum("vij,vj->vi", bones[self.links[:, one]], self.vertices)
        return out
