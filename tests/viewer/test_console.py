"""A person's terminal beside a viewer: what the viewer has to say does not stand in it."""

from __future__ import annotations

import os
import pty
import re
import select
import subprocess
import sys
import time
from pathlib import Path

from ahmss.world.process import ServerProcess

from .display import Display, eventually, needs_display

_CODES = re.compile(rb"\x1b\[[0-9;?]*[ -/]*[@-~]|\r")


class Terminal:
    """A pseudo-terminal with a program in it, and all that was written there."""

    def __init__(self, arguments: list[str], environment: dict[str, str]) -> None:
        self._end, inside = pty.openpty()
        self.process = subprocess.Popen(
            [sys.executable, "-m", "ahmss", *arguments],
            stdin=inside, stdout=inside, stderr=inside, env=os.environ | {"TERM": "xterm"} | environment,
            start_new_session=True,
        )  # fmt: skip
        os.close(inside)
        self._written = b""

    def text(self) -> str:
        """What stands there, without the codes that colour and place it."""
        while select.select([self._end], [], [], 0.0)[0]:
            try:
                data = os.read(self._end, 65536)
            except OSError:  # the program has ended
                break
            if b"\x1b[6n" in data:
                os.write(self._end, b"\x1b[1;1R")  # where the cursor is
            self._written += data
        return _CODES.sub(b"", self._written).decode(errors="replace")

    def type(self, line: str) -> None:
        """A line, as a person would."""
        os.write(self._end, f"{line}\r".encode())

    def close(self) -> None:
        if self.process.poll() is None:
            self.process.terminate()
        self.process.wait(20)
        os.close(self._end)


def test_a_live_view_shows_no_bar_that_never_fills() -> None:
    with ServerProcess() as server:
        terminal = Terminal(["view", "--server", server.address, "--headless", "--seconds", "1.5"], {})
        try:
            assert eventually(lambda: terminal.process.poll() is not None)
            assert "pictures of 1280x720" in terminal.text()
            assert "drawing" not in terminal.text()
        finally:
            terminal.close()


@needs_display
def test_the_prompt_of_up_stays_readable_beside_its_window(tmp_path: Path) -> None:
    (tmp_path / "screen").mkdir()
    display = Display(tmp_path / "screen")
    terminal = Terminal(
        ["up", "--scene", "", "--address", "127.0.0.1:0"],
        {"DISPLAY": display.name, "XDG_STATE_HOME": str(tmp_path), "PYOPENGL_PLATFORM": ""},
    )
    try:
        assert eventually(lambda: "object>" in terminal.text())
        assert eventually(lambda: bool(display.pixels().any())), "the window is open"
        time.sleep(0.5)
        shown = terminal.text().count("object>")
        terminal.type("wait 0.1")
        assert eventually(lambda: terminal.text().count("object>") > shown)
        terminal.type("quit")
        assert eventually(lambda: terminal.process.poll() is not None)
        assert "drawing" not in terminal.text()
        assert "━" not in terminal.text()
    finally:
        terminal.close()
        display.close()


@needs_display
def test_why_a_window_could_not_open_is_said_above_the_prompt(tmp_path: Path) -> None:
    terminal = Terminal(
        ["up", "--scene", "", "--address", "127.0.0.1:0"],
        {"DISPLAY": ":4242", "XDG_STATE_HOME": str(tmp_path), "PYOPENGL_PLATFORM": ""},
    )
    try:
        assert eventually(lambda: "the window is gone: no window can be opened: the display :4242" in terminal.text())
        terminal.type("quit")
        assert eventually(lambda: terminal.process.poll() is not None)
    finally:
        terminal.close()
