"""Rotations and poses that hypothesis draws: every shape, near the identity, near half a turn."""

from __future__ import annotations

import numpy as np
from hypothesis import strategies as st

from ahmss.body.array import Array
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import from_rotation_vector, multiply, normalize
from ahmss.body.skeleton import Skeleton

shapes = st.sampled_from([(), (1,), (3,), (2, 3), (0,), (300,)])
seeds = st.integers(0, 2**32 - 1)
angles = st.one_of(
    st.floats(0.0, 1e-7), st.floats(1e-7, np.pi - 1e-6), st.floats(np.pi - 1e-6, np.pi), st.sampled_from([0.0, np.pi])
)


@st.composite
def rotations(draw: st.DrawFn, shape: tuple[int, ...] = ()) -> Array:
    """Unit quaternions (*shape, 4), of either sign."""
    rng = np.random.default_rng(draw(seeds))
    axis = rng.normal(size=(*shape, 3))
    axis /= np.linalg.norm(axis, axis=-1, keepdims=True)
    q = from_rotation_vector(axis * draw(angles))
    return q * rng.choice([-1.0, 1.0], size=(*shape, 1))


def turn(x: float, y: float, z: float) -> Array:
    """The rotation by a rotation vector, radians."""
    return from_rotation_vector(np.array([x, y, z]))


def random_rotations(rng: np.random.Generator, *shape: int) -> Array:
    return normalize(rng.normal(size=(*shape, 4)))


def natural_pose(skeleton: Skeleton, rng: np.random.Generator) -> tuple[Array, Array]:
    """A pose that a person could take: elbows and knees bent their own way, everything else turned somewhat."""
    pose, root = skeleton.upright()
    for link, name in enumerate(LINKS):
        if not name.endswith(("lower_arm", "lower_leg")):
            pose[link] = multiply(pose[link], from_rotation_vector(rng.normal(size=3) * 0.3))
    for side in ("right", "left"):
        pronation = turn(rng.uniform(-0.8, 0.8), 0.0, 0.0)
        pose[INDEX[f"{side}_lower_arm"]] = multiply(turn(0.0, rng.uniform(0.1, 2.4), 0.0), pronation)
        pose[INDEX[f"{side}_lower_leg"]] = turn(0.0, rng.uniform(0.1, 1.8), 0.0)
    return pose, root + rng.normal(size=3)
