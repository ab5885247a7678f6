"""Playing a script: a server and one main process for each human, each a process of its own."""

from __future__ import annotations

import json
import secrets
import signal
import subprocess
import sys
import tempfile
from collections.abc import Callable, Generator
from contextlib import ExitStack, contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from ahmss.errors import CommandError
from ahmss.main.command import Human
from ahmss.main.counting import counted
from ahmss.main.report import Report
from ahmss.main.script import Script, read_script
from ahmss.main.setting import make_room
from ahmss.world.process import ServerProcess

__all__ = ["PlayReport", "PlaySetup", "play_script", "running_server"]

_STOP_S = 10.0


@dataclass(frozen=True)
class PlaySetup:
    """How a script is played; without `server` it gets one of its own, which alone can record.

    `stay`: the bodies stay when it is over, as they do on a server of its own: its recording ends with them.
    `waits`: the server that is named runs in lockstep, for this script.
    `fresh`: what the script adds and the named server has already is taken away first.
    """

    fast: bool = False
    seed: int = 0
    record: Path | None = None
    server: str = ""
    keys: Path | None = None
    workspace: Path | None = None
    stay: bool = False
    waits: bool = False
    fresh: bool = False

    @property
    def lockstep(self) -> bool:
        """Whether the server waits for all mains each frame."""
        return self.fast or self.waits or self.record is not None


@dataclass
class PlayReport:
    """What became of a script: one report of each main, and what went wrong beside them."""

    mains: list[dict[str, Any]] = field(default_factory=list[dict[str, Any]])
    problems: list[str] = field(default_factory=list[str])

    @property
    def failures(self) -> int:
        """How many things went wrong."""
        return sum(int(main["failures"]) for main in self.mains) + len(self.problems)

    def __str__(self) -> str:
        """A line for each human and for each problem."""
        lines: list[str] = []
        for main in self.mains:
            failures = counted(int(main["failures"]), "failure")
            rate = main["frames"] / main["seconds"] if main["seconds"] else 0.0
            lines.append(
                f"{main['human']}: {main['frames']} frames in {main['seconds']:.1f} s ({rate:.0f}/s), "
                f"{main['late']} began late, {main['held']} held for a motion, {failures}"
            )
        return "\n".join(lines + self.problems)


@contextmanager
def running_server(setup: PlaySetup, names: tuple[str, ...], problems: list[str] | None = None) -> Generator[str]:
    """The address of the server to play on: the one that was named, or one of its own for as long as this lasts.

    `problems` is told at its end what went wrong with its recording.
    """
    if setup.server:
        if setup.record is not None:
            raise CommandError("--record needs a server of its own: leave --server out, or record there (ahmss server)")
        yield setup.server
        return
    with tempfile.TemporaryDirectory(prefix="ahmss-") as directory:
        log = Path(directory) / "server.log"
        # A recording misses no frame: the server waits for each main, also where a clock sets the pace.
        lockstep = names if setup.lockstep else ()
        with ServerProcess(
            f"ipc://{directory}/world" if setup.fast else "127.0.0.1:0",
            lockstep=lockstep,
            recording=setup.record,
            log=log,
        ) as server:
            yield server.address
        said = log.read_text(errors="replace").splitlines()
        if problems is not None:
            problems += [line for line in said if "can't be written" in line or "recording" in line]


def play_script(path: Path, setup: PlaySetup, ready: Callable[[str], None] = lambda _: None) -> PlayReport:
    """Play a script to its end; `ready` is told the server's address before the first frame.

    Raises:
        AhmssError: the script is wrong, or a process could not be started.
    """
    script = read_script(path)
    names = tuple(human.name for human in script.humans)
    problems: list[str] = []
    group = path.stem if setup.fast else f"{path.stem}-{secrets.token_hex(4)}"
    with ExitStack() as stack:
        address = stack.enter_context(running_server(setup, names, problems))
        if setup.server and not setup.waits:
            make_room(script, address, setup.keys, fresh=setup.fresh)
        ready(address)
        mains = [_start(script, human, setup, address, group) for human in script.humans]
        try:
            reports = [_finish(main, human.name) for main, human in zip(mains, script.humans, strict=True)]
        except BaseException:
            _stop(mains)
            raise
    return PlayReport(reports, problems)


def _start(script: Script, human: Human, setup: PlaySetup, address: str, group: str) -> subprocess.Popen[bytes]:
    """One human's main process."""
    command = [sys.executable, "-m", "ahmss", "main", "--server", address, "--human", human.name, "--json"]
    command += ["--script", str(script.path), "--group", group, "--seed", str(setup.seed)]
    command += ["--fast"] if setup.fast else ["--lockstep"] if setup.lockstep else []
    command += ["--stay"] if setup.stay or not setup.server else []
    for option, value in (("--workspace", setup.workspace), ("--keys", setup.keys)):
        command += [option, str(value)] if value else []
    return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE)


def _finish(main: subprocess.Popen[bytes], name: str) -> dict[str, Any]:
    """A main's report, once it has come to its end; one that could not begin or broke down counts as a failure."""
    output, _ = main.communicate()
    try:
        report = json.loads(output.splitlines()[-1])
    except (ValueError, IndexError):
        report = {"error": f"its main process ended with exit code {main.returncode} and no report"}
    if "error" in report:  # it has told standard error itself
        report = asdict(Report(name, failures=1, messages=[report["error"]]))
    return report


def _stop(mains: list[subprocess.Popen[bytes]]) -> None:
    """End all mains, politely first."""
    for main in mains:
        if main.poll() is None:
            main.send_signal(signal.SIGINT)
    for main in mains:
        try:
            main.wait(_STOP_S)
        except subprocess.TimeoutExpired:
            main.kill()
            main.wait()
        if main.stdout is not None:
            main.stdout.close()
