"""The six cases of the thesis (5.4.1) as scripts and as processes: what is shown a second, and how soon each starts."""

from __future__ import annotations

import statistics
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from ahmss.algorithm.messages import Start, encode_frame
from ahmss.bench.compute import own_workspace, rig
from ahmss.bench.display import watch
from ahmss.body.inverse import grips
from ahmss.body.skeleton import Skeleton
from ahmss.database.records import AlgorithmEntry
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, AlgorithmError
from ahmss.processes.launcher import Launcher
from ahmss.processes.process import AlgorithmProcess

__all__ = ["CASES", "shown_fps", "start_ms_of"]

CASES = {
    "playback": "do thing playback frames {n}",
    "walk": "do thing walk to {x} 1.6 frames {n}",
    "slerp": "do thing slerp frames {n}",
    "walk_fusion": "do thing walk to {x} 1.6 frames {n} with other slerp frames {n}",
    "walk_object": "do thing stroll to {x} 1.6 frames {n}",
    "walk_fusion_object": "do thing stroll to {x} 1.6 frames {n} with other slerp frames {n}",
}
"""Playback; a walk; slerp; 2 and 3 fused; a walk and follow_hand; all three. Walks go to and fro through the room."""

_SIZE = "640x480"
_WAYS = (1.2, -0.8, 1.2, -0.8)  # metres along the room, one walk after the other
_SECONDS = 3.5  # of each: nobody walks the two metres faster
_REPEATS = 30
_PAUSE = 0.1  # seconds between starts, as between a person's commands


def shown_fps(workspace: Workspace, say: Callable[[str], object]) -> dict[str, float]:
    """Pictures a second of each case in real time, in the room with one human and its twelve objects (table 5.5).

    A case in which a motion failed (on a busy machine one may be given up) is left out, and `say` is told why.
    """
    with tempfile.TemporaryDirectory(prefix="ahmss-bench-") as folder:
        own = own_workspace(workspace, Path(folder) / "workspace")
        rates: dict[str, float] = {}
        for case, line in CASES.items():
            script = Path(folder) / f"{case}.txt"
            script.write_text(script_of(line))
            try:
                rates[case] = watch(script, _SIZE, seconds=len(_WAYS) * _SECONDS - 3, workspace=own.root)
            except AhmssError as error:
                say(str(error))
        return rates


def script_of(line: str) -> str:
    """A script that carries a case out again and again in the room."""
    lines = ["add room", "human bench body ken at -0.8 1.6", "add thing at -0.5 1.6", "add other at -0.5 1.8"]
    lines += [line.format(x=x, n=round(60 * _SECONDS)) for x in _WAYS]
    return "\n".join(lines) + "\n"


def start_ms_of(workspace: Workspace, repeats: int = _REPEATS) -> dict[str, dict[str, float]]:
    """Milliseconds from a start to its first frame, medians, for each algorithm of each case (table 5.8).

    The algorithms of a case are started one after the other and answer beside each other, as a main starts them.
    """
    with Launcher() as launcher, rig(workspace) as one:
        report: dict[str, dict[str, float]] = {}
        for case, line in CASES.items():
            started = one.starts_of(line.format(x=3.0, n=180))
            took = [_once(launcher, started) for _ in range(repeats)][repeats // 6 :]
            report[case] = {
                entry.name: 1e3 * statistics.median(times[number] for times in took)
                for number, (entry, _) in enumerate(started)
            }
        return report


def _once(launcher: Launcher, started: Sequence[tuple[AlgorithmEntry, Start]]) -> list[float]:
    """Seconds that each of the algorithms takes, started together."""
    begun: list[tuple[float, AlgorithmProcess]] = []
    for entry, start in started:
        at = time.perf_counter()
        process = launcher.start(entry, start)
        process.ask(_frame(start))
        begun.append((at, process))
    took: dict[int, float] = {}
    until = time.perf_counter() + 10.0
    while len(took) < len(begun):
        launcher.wait([process for _, process in begun if process.pending], 0.0005)
        now = time.perf_counter()
        for number, (at, process) in enumerate(begun):
            if number not in took and not process.pending:
                took[number] = now - at
        if now > until:
            raise AlgorithmError("an algorithm of the bench made no first frame within 10 s")
    for _, process in begun:
        process.receive()
        process.stop()
    rests = time.monotonic() + _PAUSE
    while time.monotonic() < rests:
        launcher.tend()
        time.sleep(0.01)
    return [took[number] for number in range(len(begun))]


def _frame(start: Start) -> bytes:
    """FRAME 1 for a human or an object algorithm."""
    skeleton = Skeleton.from_record(start.human)
    rotations, root = np.array(start.pose.rotations), np.array(start.pose.root)
    pose = None
    if start.kind == "object" and start.object is not None:
        pose = np.array([*start.object.place, *start.object.rotation])
    return encode_frame(1, root, rotations, grips(skeleton, rotations, root), pose)
