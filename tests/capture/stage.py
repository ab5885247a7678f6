"""The simulator as a user starts it, in a process of its own."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

ROOT = Path(__file__).parents[2]
AHMSS = [sys.executable, "-m", "ahmss"]


@contextmanager
def simulated(folder: Path, *options: str) -> Iterator[Path]:
    """The simulator with these options, over when the block is; gives the configuration that it wrote."""
    config = folder / "tracker.toml"
    command = [*AHMSS, "capture", "simulate", *options, "--config-out", str(config), "--workspace", str(ROOT)]
    child = subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=os.environ
    )  # fmt: skip
    try:
        assert child.stdout is not None
        said: list[str] = []
        for line in child.stdout:
            said.append(line)
            if line.startswith("wrote"):
                break
        assert config.is_file(), "".join(said)
        yield config
    finally:
        child.terminate()
        child.communicate(timeout=20.0)
