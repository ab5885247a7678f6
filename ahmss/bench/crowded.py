"""What many objects cost: the time to find an action among an object's own (3.3.1), and the memory."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

from ahmss.bench.compute import rig
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, DependencyError
from ahmss.main.catalogue import WorldCatalogue
from ahmss.main.command import Do
from ahmss.main.dialogue import Dialogue
from ahmss.main.process import MainProcess, Setup
from ahmss.world.process import ServerProcess
from ahmss.world.schema import NewObject

__all__ = ["BUTTONS", "COUNTS", "fill", "lookup_us", "memory_mb"]

COUNTS = (10, 10_000)
"""Objects in the world while an action is looked up."""

BUTTONS = 10_000
"""Push buttons of one kind in one world, of which the memory is told."""

_HUMAN, _KIND, _ACTION = "bench", "other", "slerp"
_ROUNDS, _EACH, _WARM = 9, 300, 30
_A_REQUEST, _SETTLE = 1000, 60


def lookup_us(workspace: Workspace) -> dict[str, float]:
    """Microseconds from the name that a person types to what is to be started, with few and with many in the world.

    `10` and `10000`: a line, `do NAME ACTION` with the last part of the object's name, read, its object and its action
    found, and asked whether it may be done now. `asked_10` and so on: the dialogue's question after the object was
    chosen, what it affords now, and the answer to that. The best of some rounds: other work only adds.
    """
    report: dict[str, float] = {}
    for count in COUNTS:
        with rig(workspace) as one:
            fill(one.main, _KIND, count)
            names = [f"part_{i * (count - 1) // 7}" for i in range(8)]
            report[str(count)] = round(_best(one.main, names, _line), 1)
            report[f"asked_{count}"] = round(_best(one.main, names, _asked), 1)
    return report


def fill(main: MainProcess, kind: str, count: int, hall: str = "hall") -> None:
    """Fill a hall in the world with so many objects of a kind, called hall/part_0 and so on, far away."""
    client = main.communication.client
    upright = (1.0, 0.0, 0.0, 0.0)
    client.add([NewObject(hall, kind, (50.0, -1.0, 0.0), upright)])
    for first in range(0, count, _A_REQUEST):
        numbers = range(first, min(first + _A_REQUEST, count))
        client.add([NewObject(f"{hall}/part_{i}", kind, (50.0, float(i), 0.0), upright) for i in numbers])
    client.refresh()


def _best(main: MainProcess, names: list[str], way: Callable[[MainProcess], Callable[[str], None]]) -> float:
    """The mean of many look-ups of objects from all over the world, in the best round; µs."""
    once = way(main)
    for name in names * (_WARM // len(names) + 1):
        once(name)
    took: list[float] = []
    for _ in range(_ROUNDS):
        began = time.perf_counter()
        for i in range(_EACH):
            once(names[i % len(names)])
        took.append((time.perf_counter() - began) / _EACH)
    return 1e6 * min(took)


def _line(main: MainProcess) -> Callable[[str], None]:
    """A line of the dialogue, from its text to an order that may start."""
    dialogue = Dialogue(WorldCatalogue(main.workspace, main.communication, lambda: main.actor))
    database, scene, actor = main.database, main.communication, main.actor

    def once(name: str) -> None:
        line = dialogue.answer(f"do {name} {_ACTION}")
        assert isinstance(line, Do)
        order = database.order(line.acts[0], scene, actor)
        database.check(order, scene, actor)

    return once


def _asked(main: MainProcess) -> Callable[[str], None]:
    """The dialogue's question for the action, and its answer."""
    catalogue = WorldCatalogue(main.workspace, main.communication, lambda: main.actor)

    def once(name: str) -> None:
        listing = catalogue.actions(name)
        if _ACTION not in listing.names:
            raise AhmssError(f"{name} does not afford {_ACTION}")
        catalogue.asks(name, _ACTION)

    return once


def memory_mb(workspace: Workspace) -> dict[str, float]:
    """MB by which a main grows when so many push buttons come into its world; all share one kind's record."""
    command = [sys.executable, "-m", "ahmss.bench.crowded", str(workspace.root)]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode:
        raise AhmssError(f"the main with {BUTTONS} buttons ended with exit code {done.returncode}")
    return {f"buttons_{BUTTONS}": round(json.loads(done.stdout)["mb"], 2)}


def _grown(root: Path) -> float:
    """MB that this process grows by the buttons."""
    with (
        tempfile.TemporaryDirectory(prefix="ahmss-bench-") as folder,
        ServerProcess(lockstep=(_HUMAN,), log=Path(folder) / "server.log") as server,
    ):
        setup = Setup(_HUMAN, server=server.address, workspace=root, fast=True, names=(_HUMAN,))
        main = MainProcess(setup, lambda _: None)
        try:
            fill(main, "push_button", 10, "lobby")  # what the first of a kind needs is not counted
            for _ in range(_SETTLE):
                main.frame()
            before = _resident()
            fill(main, "push_button", BUTTONS)
            for _ in range(_SETTLE):
                main.frame()
            return (_resident() - before) / 1e6
        finally:
            main.close()


def _resident() -> int:
    """Bytes of this process that are in memory."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
    except OSError:
        raise DependencyError("a process's memory is read from /proc, which is not here") from None
    return pages * os.sysconf("SC_PAGE_SIZE")


if __name__ == "__main__":
    print(json.dumps({"mb": _grown(Path(sys.argv[1]))}))
