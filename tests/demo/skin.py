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


@dataclass(frozen=True)
class Skin:
    """Vertices (V, 3) as modelled, up to four links (V, 4) and their weights (V, 4), and what brings them to the links.

    link: (V,) the link that moves a vertex most. faces: (T, 3).
    """

    skeleton: Skeleton
    vertices: Array
    links: NDArray[np.intp]
    weights: Array
    from_model: Array
    faces: NDArray[np.intp]

    @classmethod
    def read(cls, glb: bytes, skeleton: Skeleton) -> Skin:
        """The shape's first mesh."""
        source = GlbReader(glb)
        [part] = source.tree["meshes"][0]["primitives"]
        of = part["attributes"]
        skin = source.tree["skins"][0]
        order = np.array([LINKS.index(source.tree["nodes"][node]["name"]) for node in skin["joints"]])
        inverse = source.array(skin["inverseBindMatrices"]).reshape(-1, 4, 4).transpose(0, 2, 1)
        weights = source.array(of["WEIGHTS_0"]).astype(float)
        return cls(
            skeleton, source.array(of["POSITION"]).astype(float), order[source.array(of["JOINTS_0"])],
            weights / weights.sum(axis=1, keepdims=True), inverse.astype(float)[np.argsort(order)],
            source.array(part["indices"]).reshape(-1, 3).astype(np.intp),
        )  # fmt: skip

    @property
    def link(self) -> NDArray[np.intp]:
        return self.links[np.arange(len(self.links)), self.weights.argmax(axis=1)]

    def posed(self, rotations: Array, root: Array, chosen: NDArray[np.intp]) -> Array:
        """Where the chosen vertices are in the world (n, 3)."""
        places, turned = forward(rotations, root, self.skeleton.offsets)
        moved = np.tile(np.eye(4), (len(LINKS), 1, 1))
        moved[:, :3, :3], moved[:, :3, 3] = to_matrix(turned), places
        bones = (moved @ self.from_model)[self.links[chosen]]
        blended = np.einsum("vk,vkij->vij", self.weights[chosen], bones)
        return np.einsum("vij,vj->vi", blended[:, :3, :3], self.vertices[chosen]) + blended[:, :3, 3]
