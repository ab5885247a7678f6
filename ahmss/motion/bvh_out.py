"""BVH, written: any motion of a human, so that Blender and its like open it upright and in scale.

Y is up and the human at heading 0 faces z, as BVH files have it; lengths are metres, Blender's own unit. The zero pose
is a T-pose with the palms down, whose joints' axes are the world's: R = Rz Rx Ry turns each away from it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import CHILDREN, INDEX, LINKS, PARENTS
from ahmss.body.quaternion import conjugate, from_rotation_vector, multiply, rotate, to_matrix
from ahmss.body.skeleton import Skeleton

__all__ = ["t_pose", "write_bvh"]

_TO_BVH = np.array([0.5, -0.5, -0.5, -0.5])  # our x (ahead) becomes z, y (left) x, z (up) y
_GIMBAL = 1.0 - 1e-9  # above this sine of the middle angle the two others turn about one axis


def t_pose(skeleton: Skeleton) -> tuple[Array, Array]:
    """The upright pose with the arms out to the sides: rotations (43, 4), root (3,)."""
    rotations, root = skeleton.upright()
    for side, sign in (("right", 1.0), ("left", -1.0)):
        arm = INDEX[f"{side}_upper_arm"]
        rotations[arm] = multiply(rotations[arm], from_rotation_vector(np.array([0.0, 0.0, sign * np.pi / 2.0])))
    return rotations, root


def write_bvh(path: Path, skeleton: Skeleton, rotations: Array, root: Array, rate: float) -> None:
    """Write a motion as BVH, its joints named as our links.

    Args:
        path: the file; its folder is made where it is missing.
        skeleton: the human's measures.
        rotations: (frames, 43, 4) unit quaternions, parent <- child.
        root: (frames, 3) metres, the hips' joint in the world.
        rate: frames a second.
    """
    places, world = forward(*t_pose(skeleton), skeleton.offsets)
    ends = places + rotate(world, skeleton.tips)
    lines = ["HIERARCHY", *_joint(0, rotate(_TO_BVH, places), rotate(_TO_BVH, ends), 0)]
    lines += ["MOTION", f"Frames: {len(rotations)}", f"Frame Time: {1.0 / rate:.8f}"]
    angles = np.degrees(_angles(_from_t_pose(rotations, world)))
    values = np.concatenate([rotate(_TO_BVH, root), angles[:, _written_order()].reshape(len(root), -1)], axis=1)
    lines += [" ".join(f"{value:.6f}" for value in row) for row in np.round(values, 6) + 0.0]
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(lines) + "\n", encoding="ascii", newline="\n")


def _joint(link: int, places: Array, ends: Array, depth: int) -> list[str]:
    """The lines of a link and of what hangs on it."""
    pad, inner = "\t" * depth, "\t" * (depth + 1)
    parent = PARENTS[link]
    offset = places[link] - places[parent] if parent >= 0 else np.zeros(3)
    turns = "Zrotation Xrotation Yrotation"
    lines = [f"{pad}{'JOINT' if parent >= 0 else 'ROOT'} {LINKS[link]}", f"{pad}{{", f"{inner}OFFSET {_text(offset)}"]
    lines.append(f"{inner}CHANNELS " + (f"3 {turns}" if parent >= 0 else f"6 Xposition Yposition Zposition {turns}"))
    for child in CHILDREN[link]:
        lines += _joint(child, places, ends, depth + 1)
    if not CHILDREN[link]:
        lines += [f"{inner}End Site", f"{inner}{{", f"{inner}\tOFFSET {_text(ends[link] - places[link])}", f"{inner}}}"]
    return [*lines, f"{pad}}}"]


def _text(vector: Array) -> str:
    return " ".join(f"{value:.6f}" for value in np.round(vector, 6) + 0.0)


def _written_order() -> list[int]:
    """The links in the order in which the hierarchy names them, depth first."""
    order: list[int] = []

    def visit(link: int) -> None:
        order.append(link)
        for child in CHILDREN[link]:
            visit(child)

    visit(0)
    return order


def _from_t_pose(rotations: Array, rest: Array) -> Array:
    """Rotations (frames, 43, 4) of BVH joints, whose axes are the world's in the T-pose of world rotations (43, 4).

    With W the world rotation of a link and W0 that of the T-pose, its joint has G = W W0*, and against its parent
    G_parent* G = W0_parent q W0*, as q = W_parent* W.
    """
    before = rest[np.maximum(np.array(PARENTS), 0)].copy()
    before[0] = (1.0, 0.0, 0.0, 0.0)
    turned = multiply(multiply(before, rotations), conjugate(rest))
    return multiply(multiply(_TO_BVH, turned), conjugate(_TO_BVH))


def _angles(rotations: Array) -> Array:
    """Angles (frames, 43, 3) about z, x, y of R = Rz Rx Ry, radians, without jumps of a whole turn."""
    m = to_matrix(rotations)
    sine = m[..., 2, 1]
    locked = np.abs(sine) > _GIMBAL
    x = np.arcsin(np.clip(sine, -1.0, 1.0))
    z = np.where(locked, np.arctan2(m[..., 1, 0], m[..., 0, 0]), np.arctan2(-m[..., 0, 1], m[..., 1, 1]))
    y = np.where(locked, 0.0, np.arctan2(-m[..., 2, 0], m[..., 2, 2]))
    return np.stack([np.unwrap(z, axis=0), x, np.unwrap(y, axis=0)], axis=-1)
