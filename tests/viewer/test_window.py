"""The window, on a display of its own, its pixels read from the display's memory."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from .display import Display, eventually, needs_display
from .scenes import record

SIZE = (400, 300)
SHOW = """
import json, sys
from pathlib import Path
from ahmss_viewer.app import ViewOptions, view
report = view(ViewOptions(replay=Path(sys.argv[1]), size=(400, 300), seconds=40.0))
print(json.dumps(report.to_json()))
"""

pytestmark = needs_display


@pytest.fixture
def display(tmp_path: Path) -> Iterator[Display]:
    (tmp_path / "screen").mkdir()
    shown = Display(tmp_path / "screen")
    yield shown
    shown.close()


def red(pixels: np.ndarray) -> int:
    return int(((pixels[..., 0] > 80) & (pixels[..., 0] > 2.2 * pixels[..., 1])).sum())


def rests(display: Display) -> bool:
    """Whether the picture (less the texts above and below) stands still for most of a second."""
    before = display.pixels()[80:180, :400]
    time.sleep(0.8)
    return bool((display.pixels()[80:180, :400] == before).all())


def press(display: Display, key: str) -> None:
    """A key into the window, as a person would."""
    environment = os.environ | {"DISPLAY": display.name}
    command = ["xdotool", "search", "--sync", "--name", "^AHMSS$", "windowfocus", "key", "--clearmodifiers", key]
    subprocess.run(command, env=environment, check=True, timeout=20, stdout=subprocess.DEVNULL)


def test_the_window_shows_the_world_obeys_keys_and_closes(display: Display, tmp_path: Path) -> None:
    recording = record(tmp_path / "a.ahmss", 60, lambda k: abs(k - 30) / 30)
    environment = {key: value for key, value in os.environ.items() if key != "PYOPENGL_PLATFORM"}
    viewer = subprocess.Popen(
        [sys.executable, "-c", SHOW, str(recording)], env=environment | {"DISPLAY": display.name},
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    try:
        assert eventually(lambda: red(display.pixels()) > 100), "the red box is seen"
        if shutil.which("xdotool") is not None:
            first = display.pixels()
            assert eventually(lambda: bool((np.abs(display.pixels() - first)[:300, :400] > 60).any())), "it plays"
            assert not rests(display)
            press(display, "space")
            assert eventually(lambda: rests(display)), "space pauses the view"
            plates = (np.abs(display.pixels() - first) > 60).sum()
            press(display, "n")
            assert eventually(lambda: bool((np.abs(display.pixels() - first) > 60).sum() > plates + 100)), "names"
            press(display, "q")
        else:
            viewer.terminate()
        out, error = viewer.communicate(timeout=20)
        if shutil.which("xdotool") is not None:
            assert viewer.returncode == 0, error
            assert json.loads(out.splitlines()[-1])["pictures"] > 0
    finally:
        viewer.kill()
        viewer.wait(10)
        for pipe in (viewer.stdout, viewer.stderr):
            if pipe is not None:
                pipe.close()
