"""The shipped humans with their skins, read once."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from ahmss_viewer.glb import read_glb
from ahmss_viewer.surface import Skin, Surface

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.quaternion import to_matrix
from ahmss.body.skeleton import Skeleton
from ahmss.database.workspace import Workspace

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Shipped:
    """One human of humandb/: its skeleton as the file says, its only surface and that surface's skin."""

    name: str
    skeleton: Skeleton
    surface: Surface
    skin: Skin

    def posed(self, rotations: Array, root: Array) -> Array:
        """The skin's vertices (n, 3) in a pose, by linear blend skinning."""
        places, world = forward(rotations, root, self.skeleton.offsets)
        frames = np.tile(np.eye(4), (43, 1, 1))
        frames[:, :3, :3], frames[:, :3, 3] = to_matrix(world), places
        of_joints = (frames @ self.skin.inverse_binds)[self.skin.joints]
        moves = np.einsum("nk,nkij->nij", self.skin.weights / 255.0, of_joints)
        return np.einsum("nij,nj->ni", moves[:, :3, :3], self.surface.positions.astype(float)) + moves[:, :3, 3]


def _read(name: str) -> Shipped:
    human = Workspace(ROOT).humans.get(name)
    (surface,) = read_glb(human.shape.read_bytes(), name)
    assert surface.skin is not None
    return Shipped(name, human.skeleton, surface, surface.skin)


@pytest.fixture(scope="package", params=["aiko", "ken"])
def human(request: pytest.FixtureRequest) -> Shipped:
    return _read(request.param)
