"""The window that stands beside a console."""

from __future__ import annotations

import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable
from types import TracebackType

__all__ = ["WindowBeside"]


class WindowBeside:
    """`ahmss view` in a process of its own, which writes nothing into the console's terminal; a context manager.

    Args:
        address: of the server.
        say: is told, from any thread, why the window could not stay open.
    """

    def __init__(self, address: str, say: Callable[[str], None]) -> None:
        self._say = say
        self._log = tempfile.TemporaryFile()  # noqa: SIM115 - closed with the window
        self._process = subprocess.Popen(
            [sys.executable, "-m", "ahmss", "view", "--server", address],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=self._log,
        )  # fmt: skip
        self._thread = threading.Thread(target=self._wait, name="window", daemon=True)
        self._thread.start()

    def __enter__(self) -> WindowBeside:
        """The window itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Close it."""
        self._process.terminate()
        self._thread.join()
        self._log.close()

    def _wait(self) -> None:
        """Wait for its end; one that it did not choose has a reason."""
        if self._process.wait() > 0:
            self._log.seek(0)
            said = self._log.read().decode(errors="replace").strip().splitlines()
            self._say(f"the window is gone: {said[-1].removeprefix('ahmss: ') if said else 'it gave no reason'}")
