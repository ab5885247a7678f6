"""A display of a test's own, its pixels read from its memory; and a terminal."""

from __future__ import annotations

import os
import shutil
import struct
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

needs_display = pytest.mark.skipif(
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


def eventually(condition: Callable[[], bool], seconds: float = 25.0) -> bool:
    limit = time.monotonic() + seconds
    while time.monotonic() < limit:
        if condition():
            return True
        time.sleep(0.1)
    return False
