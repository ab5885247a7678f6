"""A picture from a human's eyes, drawn by the viewer in a process of its own."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from ahmss.errors import DependencyError

__all__ = ["picture"]

_PATIENCE_S = 120.0  # a loaded machine without a GPU takes a while for the first one
_SIZE = "640x480"


def picture(
    server: str, human: str, target: Sequence[float] = (), *, names: bool = True, keys: Path | None = None
) -> bytes:
    """What a human sees now, as PNG.

    Args:
        server: the world's address.
        human: whose eyes.
        target: x, y, z to look at, metres; left out: where the head faces.
        names: write the names of objects into the picture.
        keys: this client's keys, for a server on another machine.

    Raises:
        DependencyError: nothing can be drawn here; says what the viewer said.
    """
    with tempfile.TemporaryDirectory(prefix="ahmss-") as directory:
        file = Path(directory) / "seen.png"
        command = [sys.executable, "-m", "ahmss", "view", "--server", server, "--eyes", human, "--size", _SIZE]
        command += ["--snapshot", str(file), *(["--names"] if names else []), *(["--keys", str(keys)] if keys else [])]
        command += ["--look-at", *(f"{value:.4f}" for value in target)] if target else []
        try:
            done = subprocess.run(
                command, stdin=subprocess.DEVNULL, capture_output=True, timeout=_PATIENCE_S, check=False
            )
        except subprocess.TimeoutExpired:
            raise DependencyError(f"no picture in {_PATIENCE_S:g} s; look again when less runs here") from None
        if done.returncode or not file.is_file():
            said = done.stderr.decode(errors="replace").strip().splitlines()
            reason = said[-1].removeprefix("ahmss: ") if said else "it gave no reason"
            raise DependencyError(f"no picture could be drawn: {reason}; `ahmss doctor` says what is missing")
        return file.read_bytes()
