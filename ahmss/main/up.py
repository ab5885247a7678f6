"""`ahmss up`: server, viewer and main with its console on this machine."""

from __future__ import annotations

import tempfile
import threading
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType

from ahmss.errors import CommandError, WorldError
from ahmss.main.beside import WindowBeside
from ahmss.main.command import Add
from ahmss.main.console import run_console
from ahmss.main.demo import has_display
from ahmss.main.process import Setup
from ahmss.port.address import address_of
from ahmss.world.address import Address, parse
from ahmss.world.ports import check_host
from ahmss.world.process import ServerProcess

__all__ = ["KeptServer", "run_up"]

_LOOK_S = 0.2
_TRIES = 5


class KeptServer:
    """A server that is started again when it dies, at the same address with all that was placed; a context manager.

    Raises:
        WorldError: it can't be started at first.
    """

    def __init__(self, address: str) -> None:
        self._directory = tempfile.TemporaryDirectory(prefix="ahmss-")
        self._over = threading.Event()
        try:
            self.process = self._start(address)
        except WorldError:
            self._directory.cleanup()
            raise
        self.address = self.process.address
        self._thread = threading.Thread(target=self._keep, name="server", daemon=True)
        self._thread.start()

    def __enter__(self) -> KeptServer:
        """The server itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Stop it."""
        self._over.set()
        self._thread.join()
        self.process.stop()
        self._directory.cleanup()

    def _start(self, address: str) -> ServerProcess:
        own = Path(self._directory.name)
        return ServerProcess(address, directory=own / "world", log=own / "server.log")

    def _keep(self) -> None:
        failed = 0
        while not self._over.wait(_LOOK_S) and failed < _TRIES:
            if self.process.running:
                continue
            self.process.kill()  # closes what is left of it
            try:
                self.process = self._start(self.address)
                failed = 0
            except WorldError as error:
                failed += 1
                print(f"{error}; tried {failed} times of {_TRIES}", flush=True)


def run_up(human: str, body: str, scene: str, address: str, workspace: Path | None, port: str = "") -> int:
    """Run all until the console is left; returns how many things went wrong.

    Raises:
        AhmssError: the port is taken, the address is not this machine's own, or no such body.
    """
    with ExitStack() as stack:
        server = stack.enter_context(_server(parse(address)))
        if has_display():
            stack.enter_context(WindowBeside(server.address, _say))
        else:
            print(f"no display for a window; pictures: ahmss view --server {server.address} --snapshot picture.png")
        first = [Add(scene)] if scene else []
        reached = address_of(port) if port else None
        return run_console(Setup(human, body, server=server.address, workspace=workspace, port=reached), first)


def _server(address: Address) -> KeptServer:
    """The server, on this machine and for it alone."""
    if not address.is_loopback:
        check_host(address)
        raise CommandError(
            f"`ahmss up` listens for this machine alone, as on 127.0.0.1:{address.port}, not on {address}; for others: "
            f"ahmss keys, ahmss server --address {address} --keys keys, then ahmss main and ahmss view"
        )
    return KeptServer(str(address))


def _say(text: str) -> None:
    """A line for the person; the terminal keeps it above the prompt."""
    print(text, flush=True)
