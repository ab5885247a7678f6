"""A known motion as files of other makers would have it: other names, other axes, another zero pose."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, from_rotation_vector, multiply, normalize, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.source import SourceMotion

RATE = 60.0


def stepping(skeleton: Skeleton, frames: int = 90) -> tuple[Array, Array]:
    """Standing, then bending knees, elbows, trunk and head in several ways over feet that stay: rotations, root."""
    pose, place = skeleton.relaxed()
    t = np.arange(frames) / RATE
    s = np.sin(np.pi * t / t[-1]) ** 2
    rotations = np.repeat(pose[None], frames, axis=0)

    def turn(link: str, x: float, y: float, z: float) -> None:
        vectors = s[:, None] * np.array([x, y, z])
        rotations[:, INDEX[link]] = multiply(rotations[:, INDEX[link]], from_rotation_vector(vectors))

    for side, sign in (("right", 1.0), ("left", -1.0)):
        turn(f"{side}_upper_leg", 0.0, -0.4, 0.0)
        turn(f"{side}_lower_leg", 0.0, 0.8, 0.0)
        turn(f"{side}_foot", 0.0, -0.4, 0.0)
        turn(f"{side}_upper_arm", 0.0, 0.5, sign * 0.4)
        turn(f"{side}_lower_arm", 0.0, 1.0 + 0.2 * sign, 0.0)
        turn(f"{side}_hand", 0.0, 0.1, -sign * 0.3)
    turn("spine", 0.2, 0.2, 0.0)
    turn("head", -0.3, 0.1, 0.0)
    thigh, shank = (float(np.linalg.norm(skeleton.offsets[INDEX[f"right_{link}"]])) for link in ("lower_leg", "foot"))
    root = np.repeat(place[None], frames, axis=0)
    root[:, 2] -= (thigh + shank) * (1.0 - np.cos(0.4 * s))
    root[:, 0] -= (thigh - shank) * np.sin(0.4 * s)
    return rotations, root


def remounted(source: SourceMotion, seed: int = 0) -> SourceMotion:
    """The same motion of the same bones, every joint with axes of its own: its zero pose is nobody's.

    With m the turn of each joint's axes, q becomes m_parent* q m, and the offset m_parent* o.
    """
    rng = np.random.default_rng(seed)
    mounts = normalize(rng.normal(size=(len(source.names), 4)))
    parents = np.array(source.parents)
    before = mounts[np.maximum(parents, 0)]
    before[parents < 0] = (1.0, 0.0, 0.0, 0.0)
    return replace(
        source,
        rotations=multiply(multiply(conjugate(before), source.rotations), mounts),
        offsets=rotate(conjugate(before), source.offsets),
        translations=rotate(conjugate(before), source.translations),
    )


def save_bvh(source: SourceMotion, path: Path, order: str = "XYZ", unit: float = 1.0) -> Path:
    """The source as a BVH file with rotation channels in any order, positions on the root alone."""
    channels = " ".join(f"{axis}rotation" for axis in order)
    lines = ["HIERARCHY"]

    def joint(i: int, depth: int) -> None:
        children = [k for k, parent in enumerate(source.parents) if parent == i]
        end, root = source.names[i].endswith("_end"), source.parents[i] < 0
        lines.append("End Site" if end else f"{'ROOT' if root else 'JOINT'} {source.names[i]}")
        lines.append("{")
        lines.append("OFFSET " + " ".join(f"{v / unit:.9f}" for v in source.offsets[i]))
        if not end:
            written.append(i)
            lines.append(f"CHANNELS 6 Zposition Xposition Yposition {channels}" if root else f"CHANNELS 3 {channels}")
        for child in children:
            joint(child, depth + 1)
        lines.append("}")

    written: list[int] = []
    joint(source.parents.index(-1), 0)
    lines += ["MOTION", f"Frames: {source.frames}", f"Frame Time: {1.0 / source.rate:.9f}"]
    angles = np.degrees([_euler(source.rotations[:, i], order) for i in written])  # (joints, frames, 3)
    for frame in range(source.frames):
        root = source.translations[frame, written[0], [2, 0, 1]] / unit
        values = np.concatenate([root, angles[:, frame].ravel()])
        lines.append(" ".join(f"{value:.9f}" for value in values))
    path.write_text("\n".join(lines))
    return path


def save_amc(source: SourceMotion, path: Path, unit: float = 1.0) -> Path:
    """The source as AMC with its ASF beside it: a bone without length turns at each joint, others lead to the next."""
    joints = [i for i, name in enumerate(source.names) if not name.endswith("_end")]
    names = {i: "root" if source.parents[i] < 0 else source.names[i] for i in joints}
    bones, tree = [], []
    for i in joints:
        parent = source.parents[i]
        if parent < 0:
            continue
        length = float(np.linalg.norm(source.offsets[i]))
        way = source.offsets[i] / max(length, 1e-9)
        for name, long, dof in ((f"to_{names[i]}", length / unit, ""), (names[i], 0.0, "dof rx ry rz")):
            direction = " ".join(f"{v:.12f}" for v in way)
            bones.append(f"begin\nname {name}\ndirection {direction}\nlength {long:.12f}\naxis 0 0 0 XYZ\n{dof}\nend")
        tree += [f"{names[parent]} to_{names[i]}", f"to_{names[i]} {names[i]}"]
    root = ":root\norder TX TY TZ RX RY RZ\naxis XYZ\nposition 0 0 0\norientation 0 0 0"
    text = "\n".join([root, ":bonedata", *bones, ":hierarchy", "begin", *tree, "end"])
    path.with_suffix(".asf").write_text(text)
    angles = {i: np.degrees(_euler(source.rotations[:, i], "xyz")) for i in joints}
    lines = [":FULLY-SPECIFIED", ":DEGREES"]
    for frame in range(source.frames):
        lines.append(str(frame + 1))
        for i in joints:
            values = angles[i][frame]
            if source.parents[i] < 0:
                values = np.concatenate([source.translations[frame, i] / unit, values])
            lines.append(names[i] + " " + " ".join(f"{v:.9f}" for v in values))
    path.write_text("\n".join(lines))
    return path


def _euler(rotations: Array, order: str) -> Array:
    return Rotation.from_quat(rotations[:, [1, 2, 3, 0]]).as_euler(order)
