"""Which OpenGL is taken, and what is said where there is none."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from ahmss_viewer import graphics

from ahmss.errors import DependencyError

DRAW = """
import sys
import numpy as np
from ahmss_viewer.graphics import Offscreen
with Offscreen() as context:
    from ahmss_viewer.camera import View
    from ahmss_viewer.figure import plain_figure
    from ahmss_viewer.painter import Painter
    from ahmss_viewer.stage import Stage
    from ahmss_viewer.target import Target
    from ahmss.body.skeleton import Skeleton
    stage, painter, target, skeleton = Stage(), Painter(), Target(160, 120), Skeleton.of()
    stage.add_human(1, "ken", skeleton.offsets, plain_figure(skeleton))
    rotations, root = skeleton.upright()
    for k in range(12):
        stage.pose_human(1, rotations, root)
        painter.draw(stage, View(), target.drawn, target)
        picture = target.read()
    programs = len(painter._programs)
    blue = (picture[..., 2] > picture[..., 0].astype(int) + 20) & (picture[..., 2] < 200)
    print(context.name, programs, int(blue.sum()))
"""


def run(code: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """A program of its own: OpenGL is bound once a process."""
    kept = {key: value for key, value in os.environ.items() if key not in ("DISPLAY", "PYOPENGL_PLATFORM")}
    return subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, env=kept | environment, timeout=50, check=False
    )


def test_pictures_can_be_drawn_here() -> None:
    if graphics.find_headless() is None:
        pytest.skip(f"nothing draws without a window here; run: {graphics.HEADLESS_CURE}")
    assert graphics.find_headless() in ("egl", "osmesa")


def test_osmesa_draws_the_same_and_compiles_once() -> None:
    if graphics._library("libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so") is None:
        pytest.skip("no libOSMesa here")
    done = run(DRAW, PYOPENGL_PLATFORM="osmesa")
    assert done.returncode == 0, done.stderr
    name, programs, blue = done.stdout.split()
    assert name == "osmesa"
    assert int(programs) == 2, "the skinned figure and its shadow"
    assert int(blue) > 100, "its shirt"


def test_without_any_opengl_the_command_that_mends_it_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(graphics, "find_headless", lambda: None)
    monkeypatch.setattr(graphics, "sys", type("Bare", (), {"modules": {}, "platform": "linux"}))
    with pytest.raises(DependencyError, match="apt-get install libegl1"):
        graphics.use_headless()


def test_without_a_display_a_window_is_refused_with_the_way_out(tmp_path: Path) -> None:
    code = (
        "from ahmss_viewer.app import ViewOptions, view\n"
        "from ahmss.errors import DependencyError\n"
        "try: view(ViewOptions())\n"
        "except DependencyError as error: print(error)"
    )
    done = run(code)
    assert "there is no display" in done.stdout
    assert "--headless" in done.stdout


def test_a_recording_that_is_not_there_is_told_before_a_display_that_is_not(tmp_path: Path) -> None:
    code = "from ahmss_viewer.app import ViewOptions, view\nview(ViewOptions(replay=Path(sys.argv[1]) / 'nosuch.rec'))"
    answer = run(f"import sys\nfrom pathlib import Path\nsys.argv = ['', {str(tmp_path)!r}]\n{code}")
    assert "nosuch.rec: the recording can't be read" in answer.stderr
    assert "display" not in answer.stderr
