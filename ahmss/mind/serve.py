"""`ahmss mcp`: the server on standard input and output, for a main that runs or one of its own."""

from __future__ import annotations

import contextlib
import json
import select
import subprocess
import sys
import tempfile
from collections.abc import Generator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from ahmss.errors import CommandError, DependencyError, WorldError
from ahmss.world.process import ServerProcess

__all__ = ["Own", "serve"]

_START_S, _STOP_S = 60.0, 10.0


@dataclass(frozen=True)
class Own:
    """The world and the human that `ahmss mcp` starts itself; address: where its server listens."""

    scene: str
    human: str = "ken"
    body: str = ""
    place: tuple[float, float] = (0.0, 0.0)
    facing_deg: float = 0.0
    address: str = "127.0.0.1:0"
    workspace: Path | None = None


def serve(
    port: str = "", keys: Path | None = None, server: str = "", server_keys: Path | None = None,
    own: Own | None = None,
) -> None:  # fmt: skip
    """Serve until the client closes standard input.

    Raises:
        AhmssError: the `mcp` package is missing, no main answers, or no world could be started.
    """
    try:
        from ahmss.mind.tools import Mind, make_server
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in ("mcp", "mcp_types"):
            raise
        raise DependencyError("the package mcp is missing; install it: pip install 'ahmss[mcp]'") from None
    if own is not None and port:
        raise CommandError("--scene starts a main of its own, and --port names one that runs; leave one out")
    with ExitStack() as stack:
        if own is not None:
            port = stack.enter_context(_started(own))
        make_server(Mind(port, keys, server, server_keys)).run("stdio")


@contextmanager
def _started(own: Own) -> Generator[str]:
    """A server and a main; the address of the main's port."""
    command = [sys.executable, "-m", "ahmss", "main", "--human", own.human, "--body", own.body, "--scene", own.scene]
    command += ["--at", *(str(value) for value in own.place), "--facing", str(own.facing_deg)]
    command += ["--port", "127.0.0.1:0", "--no-console", "--json"]
    command += ["--workspace", str(own.workspace)] if own.workspace else []
    with ExitStack() as stack:
        directory = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="ahmss-")))
        server = stack.enter_context(ServerProcess(own.address, log=directory / "server.log"))
        command += ["--server", server.address]
        main = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)
        stack.callback(_end, main)
        yield _address_of(main)


def _address_of(main: subprocess.Popen[bytes]) -> str:
    """Where a main that has just been started is reached."""
    output = main.stdout
    ready = output is not None and select.select([output], [], [], _START_S)[0]
    try:
        told = json.loads(output.readline()) if output is not None and ready else {}
    except ValueError:
        told = {}
    if "port" not in told:
        with contextlib.suppress(subprocess.TimeoutExpired):
            main.wait(_STOP_S)  # it has said why, and ends by itself
        raise WorldError(f"the main process did not start: {told.get('error', 'it gave no reason')}")
    print(f"ahmss: the world is at {told['server']}; to watch: ahmss view --server {told['server']}", file=sys.stderr)
    return told["port"]


def _end(main: subprocess.Popen[bytes]) -> None:
    main.terminate()
    try:
        main.wait(_STOP_S)
    except subprocess.TimeoutExpired:
        main.kill()
        main.wait()
    if main.stdout is not None:
        main.stdout.close()
