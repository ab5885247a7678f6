"""The least BVH reader that the tests need: joint rotations and places of real motion capture, z up, metres."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.motion.contact import speeds

MOCAP = Path(__file__).parents[2].parent / "shared" / "mocap" / "accad_female1"
_AXES = {"X": (1.0, 0.0, 0.0), "Y": (0.0, 1.0, 0.0), "Z": (0.0, 0.0, 1.0)}


@dataclass
class Motion:
    names: list[str]
    parents: list[int]
    offsets: Array  # (nodes, 3), end sites included
    rotations: Array  # (frames, nodes, 4)
    root: Array  # (frames, 3)
    rate: float

    def places(self) -> Array:
        """(frames, nodes, 3) in the world."""
        places, world = np.empty((*self.rotations.shape[:-1], 3)), np.empty(self.rotations.shape)
        for i, parent in enumerate(self.parents):
            if parent < 0:
                places[:, i], world[:, i] = self.root, self.rotations[:, i]
            else:
                places[:, i] = places[:, parent] + rotate(world[:, parent], self.offsets[i])
                world[:, i] = multiply(world[:, parent], self.rotations[:, i])
        return places


def read(name: str) -> Motion:
    """A clip of the real capture by its name; the test is skipped where it is missing."""
    found = sorted(MOCAP.glob(f"*{name}*.bvh"))
    if not found:
        pytest.skip(f"no motion capture in {MOCAP}")
    words = iter(found[0].read_text().split())
    names: list[str] = []
    parents: list[int] = []
    offsets: list[list[float]] = []
    channels: list[tuple[int, str]] = []
    stack: list[int] = []
    for word in words:
        if word in ("ROOT", "JOINT", "End"):
            names.append(next(words) if word != "End" else f"{names[-1]} end{next(words)[:0]}")
            parents.append(stack[-1] if stack else -1)
        elif word == "{":
            stack.append(len(names) - 1)
        elif word == "}":
            stack.pop()
        elif word == "OFFSET":
            offsets.append([float(next(words)) for _ in range(3)])
        elif word == "CHANNELS":
            channels += [(len(names) - 1, next(words)) for _ in range(int(next(words)))]
        elif word == "MOTION":
            break
    assert next(words) == "Frames:"
    frames = int(next(words))
    step = float([next(words) for _ in range(3)][-1])
    values = np.array(list(words), float).reshape(frames, len(channels))
    rotations = np.zeros((frames, len(names), 4))
    rotations[..., 0] = 1.0
    for (node, channel), column in zip(channels, values.T, strict=True):
        if channel.endswith("rotation"):
            turn = from_axis_angle(np.array(_AXES[channel[0]]), np.radians(column))
            rotations[:, node] = multiply(rotations[:, node], turn)
    lift = from_axis_angle(np.array(_AXES["X"]), np.pi / 2)  # y up to z up
    rotations[:, 0] = multiply(lift, rotations[:, 0])
    root = rotate(lift, values[:, :3]) / 100.0
    return Motion(names, parents, np.array(offsets) / 100.0, rotations, root, 1.0 / step)


def foot_points(motion: Motion) -> Array:
    """Ankle, ball and toe tip of both feet (frames, 2, 3, 3), each at height 0 where it stands.

    The skeleton's joints lie within the feet, so what stands is known by its low speed, not by the floor.
    """
    parts = ("Foot", "ToeBase", "ToeBase end")
    rows = [[motion.names.index(f"{side}{part}") for part in parts] for side in ("Right", "Left")]
    points = motion.places()[:, rows]
    speed = speeds(points, motion.rate)
    for foot in range(2):
        for part in range(3):
            height = points[:, foot, part, 2]
            height -= np.median(height[speed[:, foot, part] < 0.3])
    return points
