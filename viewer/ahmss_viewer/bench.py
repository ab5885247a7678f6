"""How many pictures a second the viewer draws by itself, without a window: from the world to the pixels in memory."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["display_rate"]

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
