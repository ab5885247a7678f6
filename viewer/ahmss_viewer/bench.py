"""How many pictures a second the viewer draws by itself, without a window: from the world to the pixels in memory."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np

from ahmss_viewer.surface import Surface

__all__ = ["cost_ms", "display_rate"]

_WARM = 10


def display_rate(recording: Path | str, size: tuple[int, int], seconds: float = 5.0) -> dict[str, Any]:
    """Play a recording as fast as it can be drawn, over and over.

    Args:
        recording: a file of `ahmss play --record`.
        size: width and height of the picture in pixels.
        seconds: how long to measure, after some pictures that are not counted.

    Returns:
        fps (1 / the median time of a picture), pictures, faces (triangles a picture), ms {p50, p99}, renderer.

    Raises:
        DependencyError: nothing here draws without a window.
    """
    from ahmss_viewer.graphics import use_headless

    use_headless()
    from OpenGL import GL

    from ahmss_viewer.aim import Aim
    from ahmss_viewer.mirror import Mirror
    from ahmss_viewer.options import ViewOptions
    from ahmss_viewer.source import Replay
    from ahmss_viewer.studio import Studio

    source = Replay(Path(recording))
    with Studio() as studio:
        mirror = Mirror(studio.stage, source.asset, source.skeleton)
        mirror.show(source.show(0))
        view = Aim(ViewOptions(size=size)).begin(studio.stage, studio.painter)
        steps: list[float] = []
        limit = 0.0
        tick = 0
        while tick <= _WARM or time.perf_counter() < limit:
            begin = time.perf_counter()
            mirror.show(source.show(tick % len(source)))
            studio.picture(view, size)
            steps.append(time.perf_counter() - begin)
            tick += 1
            if tick == _WARM:
                steps.clear()
                limit = time.perf_counter() + seconds
        name: Any = GL.glGetString(GL.GL_RENDERER)
        faces = studio.stage.faces()
        renderer = f"{studio.context.name}, {name.decode('ascii', 'replace')}"
    source.close()
    p50, p99 = (1e3 * float(q) for q in np.quantile(steps, (0.5, 0.99)))
    return {
        "fps": round(1e3 / p50, 1), "pictures": len(steps), "faces": faces,
        "ms": {"p50": round(p50, 2), "p99": round(p99, 2)}, "renderer": renderer,
    }  # fmt: skip


def cost_ms(polygons: int, size: tuple[int, int] = (640, 480), pictures: int = 15) -> float:
    """What a picture of about so many polygons costs, milliseconds: waves in rows, all in sight, nothing moving.

    Raises:
        DependencyError: nothing here draws without a window.
    """
    from ahmss_viewer.graphics import use_headless

    use_headless()
    from ahmss_viewer.camera import look_at
    from ahmss_viewer.studio import Studio

    with Studio() as studio:
        surface = _wave(1000)
        side = max(1, int(np.ceil(np.sqrt(polygons / len(surface.faces)))))
        for number in range(max(1, round(polygons / len(surface.faces)))):
            place = np.array([number % side - 0.5 * side, number // side - 0.5 * side, 0.0])
            studio.stage.add_object(number, f"wave {number}", (surface,), place, np.array([1.0, 0.0, 0.0, 0.0]))
        view = look_at(np.array([-0.9 * side, 0.0, 0.7 * side]), np.zeros(3))
        steps: list[float] = []
        for _ in range(pictures + 3):
            begin = time.perf_counter()
            studio.picture(view, size)
            steps.append(time.perf_counter() - begin)
    return 1e3 * float(np.median(steps[3:]))


def _wave(faces: int) -> Surface:
    """A square metre of waves, of about so many faces."""
    cells = max(1, round(np.sqrt(faces / 2)))
    line = np.linspace(0.0, 1.0, cells + 1)
    x, y = (axis.ravel() for axis in np.meshgrid(line, line))
    slope = 2.0 * np.pi
    positions = np.stack([x, y, 0.03 * np.sin(slope * x)], axis=1)
    normals = np.stack([-0.03 * slope * np.cos(slope * x), np.zeros_like(x), np.ones_like(x)], axis=1)
    first = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).ravel()
    halves = (
        np.stack([first, first + 1, first + cells + 1]),
        np.stack([first + 1, first + cells + 2, first + cells + 1]),
    )
    return Surface(
        positions.astype(np.float32),
        (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32),
        np.tile(np.array([150, 170, 190, 255], np.uint8), (len(x), 1)),
        np.concatenate([half.T for half in halves]).astype(np.uint32),
    )
