"""The window, on a display of its own, its pixels read from the display's memory."""

from __future__ import annotations

import json
import os
import shutil
import struct
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from .scenes import record

SIZE = (400, 300)
SHOW = """
import json, sys
from pathlib import Path
from ahmss_viewer.app import ViewOptions, view
report = view(ViewOptions(replay=Path(sys.argv[1]), size=(400, 300), seconds=40.0))
print(json.dumps(report.to_json()))
"""

pytestmark = pytest.mark.skipif(
    shutil.which("Xvfb") is None, reason="no display to test a window on; run: apt-get install xvfb"
)


class Display:
    """An Xvfb and what it shows."""

    def __init__(self, folder: Path) -> None:
        reading, writing = os.pipe()
        self._file = folder / "Xvfb_screen0"
        self._process = subprocess.Popen(
            ["Xvfb", "-displayfd", str(writing), "-screen", "0", "640x480x24", "-fbdir", str(folder)],
            pass_fds=[writing], stderr=subprocess.DEVNULL,
        )  # fmt: skip
        os.close(writing)
        with os.fdopen(reading) as pipe:
            self.name = f":{pipe.readline().strip()}"

    def pixels(self) -> np.ndarray:
        """What stands on the screen, (480, 640, 3) as signed integers (an XWD file in the display's memory)."""
        data = self._file.read_bytes()
        header = struct.unpack(">25I", data[:100])
        width, height, line, colours = header[4], header[5], header[12], header[19]
        rows = np.frombuffer(data, np.uint8, line * height, header[0] + 12 * colours).reshape(height, line)
        return rows[:, : 4 * width].reshape(height, width, 4)[..., 2::-1].astype(int)

    def close(self) -> None:
        self._process.terminate()
        self._process.wait(10)


@pytest.fixture
def display(tmp_path: Path) -> Iterator[Display]:
    (tmp_path / "screen").mkdir()
    shown = Display(tmp_path / "screen")
    yield shown
    shown.close()


def eventually(condition: Callable[[], bool], seconds: float = 25.0) -> bool:
    limit = time.monotonic() + seconds
    while time.monotonic() < limit:
        if condition():
            return True
        time.sleep(0.1)
    return False


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
