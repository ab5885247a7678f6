"""Small worlds for the viewer's tests: coloured boxes, a plain figure, recordings of them."""

from __future__ import annotations

import io
import json
import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import imageio_ffmpeg
import numpy as np
import trimesh
from PIL import Image

from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, multiply
from ahmss.body.skeleton import Skeleton
from ahmss.world.recording import Writer
from ahmss.world.schema import HumanRecord, ObjectRecord, Scene, Snapshot, content_hash

RED, GREEN, WHITE = (210, 30, 30), (40, 160, 60), (240, 240, 240)
UNTURNED = np.array([1.0, 0.0, 0.0, 0.0])
SKELETON = Skeleton.of(1.70, "male", "ken")


def box_glb(size: tuple[float, float, float], colour: tuple[int, int, int]) -> bytes:
    """A box about its own origin, as an object's shape travels."""
    mesh = trimesh.creation.box(size)
    mesh.visual.vertex_colors = np.tile([*colour, 255], (len(mesh.vertices), 1))
    return mesh.export(file_type="glb")


def floor_glb(side: float = 6.0, cells: int = 12) -> bytes:
    """A white floor of many faces at z = 0."""
    line = np.linspace(-side / 2, side / 2, cells + 1)
    x, y = np.meshgrid(line, line)
    vertices = np.c_[x.ravel(), y.ravel(), np.zeros(x.size)]
    first = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    faces = np.r_[
        np.c_[first, first + 1, first + cells + 1],
        np.c_[first + 1, first + cells + 2, first + cells + 1],
    ]
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    mesh.visual.vertex_colors = np.tile([*WHITE, 255], (len(vertices), 1))
    return mesh.export(file_type="glb")


def png(top: tuple[int, int, int], bottom: tuple[int, int, int]) -> bytes:
    """A picture of two colours, one above the other."""
    pixels = np.zeros((16, 16, 3), np.uint8)
    pixels[:8], pixels[8:] = top, bottom
    out = io.BytesIO()
    Image.fromarray(pixels).save(out, "PNG")
    return out.getvalue()


def raised(amount: float) -> tuple[np.ndarray, np.ndarray]:
    """The upright pose with the right arm lifted forward by `amount` of a right angle; and the root."""
    rotations, root = SKELETON.upright()
    arm = INDEX["right_upper_arm"]
    rotations[arm] = multiply(rotations[arm], from_axis_angle(np.array([0.0, 1.0, 0.0]), np.array(amount * np.pi / 2)))
    return rotations, root


def record(path: Path, frames: int, arm: Callable[[int], float] = lambda k: k / 30.0) -> Path:
    """A recording: a floor, a red box, a human that lifts its right arm."""
    assets: dict[str, bytes] = {}

    def put(data: bytes) -> str:
        assets[content_hash(data)] = data
        return content_hash(data)

    objects = [
        ObjectRecord(1, "floor", "floor", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), shape=put(floor_glb())),
        ObjectRecord(2, "box", "box", (0.6, -0.6, 0.25), (1.0, 0.0, 0.0, 0.0), shape=put(box_glb((0.5,) * 3, RED))),
    ]
    humans = [HumanRecord(9, "ken", "ken", skeleton=put(json.dumps(SKELETON.to_record()).encode()))]
    scene = Scene(1, objects, humans)
    writer = Writer(path, assets.get)
    for k in range(frames):
        rotations, root = raised(arm(k))
        pose = np.concatenate([root, rotations.ravel()]).astype("<f4").tobytes()
        ids, count = np.array([9], "<u4").tobytes(), np.array([k], "<u4").tobytes()
        writer.write(Snapshot(k, k / 60.0, 1, ids, count, pose), lambda: scene)
    writer.close()
    return path


def decode(path: Path, size: tuple[int, int]) -> tuple[np.ndarray, float]:
    """All frames of a film (n, height, width, 3), as signed integers, and its rate, as ffmpeg reads them."""
    command = [imageio_ffmpeg.get_ffmpeg_exe(), "-i", str(path), "-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    done = subprocess.run(command, capture_output=True, check=True)
    rate = re.search(rb"([\d.]+) fps", done.stderr)
    assert rate is not None
    pictures = np.frombuffer(done.stdout, np.uint8).reshape(-1, size[1], size[0], 3)
    return pictures.astype(int), float(rate[1])
