"""The time from the start of an algorithm process to its first frame (table 5.8 of the thesis)."""

from __future__ import annotations

import shutil
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

from ahmss.algorithm.messages import ObjectRecord, PoseRecord, SiteRecord, Start, encode_frame
from ahmss.bench.compute import clip_of, rig
from ahmss.bench.meeting import meeting_site
from ahmss.body.inverse import grips
from ahmss.body.skeleton import Skeleton
from ahmss.database.records import AlgorithmEntry
from ahmss.database.workspace import Workspace
from ahmss.errors import AlgorithmError, DependencyError
from ahmss.processes.launcher import Launcher

__all__ = ["start_ms"]

_REPEATS = 60
_PAUSE = 0.15  # seconds between starts, as between a person's commands


WALKS = {
    "walk_100m": ("do thing walk to 100 0",),
    "walk": ("add room", "do floor walk to 2.4 2.2"),  # 3.8 m: past the table and the chair
}
"""What is carried out before, and the walk whose start is measured."""


def start_ms(workspace: Workspace) -> dict[str, float | None]:
    """Medians in ms.

    `python` (playback of a shipped clip), `native` (the C example; None without a compiler), `walk` (3.8 m in the room,
    round what stands there) and `walk_100m` (over an empty floor), both planned before their first frame.
    """
    start = _start(workspace)
    report: dict[str, float | None] = {}
    with Launcher() as launcher:
        report["python"] = _median(launcher, workspace.algorithms.find("playback"), start)
        with rig(workspace) as one:
            for name, lines in WALKS.items():
                for line in lines[:-1]:
                    one.carry_out(line)
                report[name] = _median(launcher, *one.start_of(lines[-1]))
        with tempfile.TemporaryDirectory() as folder:
            try:
                entry = _compile(workspace, Path(folder))
            except DependencyError:
                report["native"] = None
            else:
                report["native"] = _median(launcher, entry, start)
    return report


def _start(workspace: Workspace) -> Start:
    """START of a playback of the largest shipped clip."""
    clip = clip_of(workspace, "playback")
    skeleton = Skeleton.of()
    rotations, root = skeleton.upright()
    x, y, z, *rotation = meeting_site(clip, skeleton).row().tolist()
    w, i, j, k = rotation
    place = ObjectRecord(1, "thing", "thing", (x, y, z), (w, i, j, k), {"here": SiteRecord((0, 0, 0))})
    return Start(
        kind="human", human=skeleton.to_record(), pose=PoseRecord.of(rotations, root), frames=120,
        object=place, site="here", motion=str(clip), directory=str(workspace.root),
    )  # fmt: skip


def _median(launcher: Launcher, entry: AlgorithmEntry, start: Start) -> float:
    """Start it again and again; the first few, which warm the caches, don't count."""
    skeleton = Skeleton.from_record(start.human)
    rotations, root = skeleton.upright()
    frame = encode_frame(1, root, rotations, grips(skeleton, rotations, root))
    took = [_once(launcher, entry, start, frame) for _ in range(_REPEATS)]
    return 1e3 * statistics.median(took[_REPEATS // 6 :])


def _once(launcher: Launcher, entry: AlgorithmEntry, start: Start, frame: bytes) -> float:
    begun = time.perf_counter()
    process = launcher.start(entry, start)
    process.ask(frame)
    launcher.wait([process], 10.0)
    if not process.receive():
        raise AlgorithmError(f"algorithm {entry.name}: no first frame within 10 s")
    took = time.perf_counter() - begun
    process.stop()
    until = time.monotonic() + _PAUSE
    while time.monotonic() < until:
        launcher.tend()
        time.sleep(0.01)
    return took


def _compile(workspace: Workspace, folder: Path) -> AlgorithmEntry:
    """The C example, compiled into a folder of its own."""
    compiler = shutil.which("cc") or shutil.which("gcc")
    if compiler is None:
        raise DependencyError("no C compiler; apt-get install gcc")
    source = workspace.root / "algorithms" / "nod" / "nod.c"
    program = folder / "nod"
    subprocess.run([compiler, "-O2", "-o", str(program), str(source), "-lm"], check=True)
    return AlgorithmEntry("nod", "human", (str(program),), folder)
