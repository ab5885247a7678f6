"""A server in a process of its own, for who needs one just now: a script's run, a test, a bench."""

from __future__ import annotations

import json
import select
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from types import TracebackType

from ahmss.errors import WorldError

__all__ = ["ServerProcess"]

_START_S = 20.0
_STOP_S = 10.0


class ServerProcess:
    """Starts `python -m ahmss.world` and waits until it listens; a context manager.

    Args:
        address: HOST:PORT; port 0 lets the system choose.
        lockstep: names of the humans to wait for; empty: real time.
        directory, recording, keys, rate, lease_s, grace_s: as in `server.Settings`.
        log: a file for its log; None: this process's standard error.

    Attributes:
        address: where it listens, for `WorldClient`.

    Raises:
        WorldError: it did not start, with what it said.
    """

    def __init__(
        self,
        address: str = "127.0.0.1:0",
        *,
        lockstep: Sequence[str] = (),
        directory: Path | None = None,
        recording: Path | None = None,
        keys: Path | None = None,
        rate: float = 60.0,
        lease_s: float = 3.0,
        grace_s: float = 10.0,
        log: Path | None = None,
        prefix: Sequence[str] = (),
    ) -> None:
        options = {
            "--lockstep": ",".join(lockstep), "--directory": directory, "--record": recording, "--keys": keys,
        }  # fmt: skip
        command = [*prefix, sys.executable, "-m", "ahmss.world", "--address", address, "--rate", str(rate)]
        command += ["--lease", str(lease_s), "--grace", str(grace_s)]
        for option, value in options.items():
            command += [option, str(value)] if value else []
        errors = None if log is None else log.open("ab")
        self._process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=errors)
        if errors is not None:
            errors.close()
        self.address = self._wait(log)

    @property
    def pid(self) -> int:
        """Its process id."""
        return self._process.pid

    @property
    def running(self) -> bool:
        """Whether it has not ended by itself."""
        return self._process.poll() is None

    def __enter__(self) -> ServerProcess:
        """The process itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Stop it."""
        self.stop()

    def stop(self) -> None:
        """End it, its recording and journal finished."""
        self._process.terminate()
        try:
            self._process.wait(_STOP_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
        self._close()

    def kill(self) -> None:
        """End it at once, nothing finished."""
        self._process.kill()
        self._close()

    def _close(self) -> None:
        self._process.wait()
        if self._process.stdout is not None:
            self._process.stdout.close()

    def _wait(self, log: Path | None) -> str:
        output = self._process.stdout
        ready = output is not None and select.select([output], [], [], _START_S)[0]
        line = output.readline() if output is not None and ready else b""
        if line:
            return json.loads(line)["address"]
        self.kill()
        said = log.read_text().strip().splitlines()[-1:] if log is not None else []
        raise WorldError(f"the virtual-space server did not start: {' '.join(said) or 'see its log'}")
