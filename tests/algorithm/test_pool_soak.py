"""Hundreds of motions, good and bad, one after the other: nothing piles up."""

from __future__ import annotations

import contextlib
import os
import random
import subprocess

import pytest
from algorithm_rig import Entry, frame, peer, wait_for

from ahmss.errors import AlgorithmError
from ahmss.processes.deadlines import Deadlines
from ahmss.processes.launcher import Launcher

HOWS = ("good", "crashes", "exits", "writes_garbage", "length_two", "floods_log", "closes_output", "leaves_child")


def children() -> int:
    return len(subprocess.run(["ps", "--ppid", str(os.getpid()), "-o", "pid="], capture_output=True).stdout.split())


@pytest.mark.long
@pytest.mark.timeout(600)
def test_many_motions_leave_nothing_behind(pool, make_start):
    start = make_start()
    choose = random.Random(7)
    with Launcher(deadlines=Deadlines(start=20.0, frame=1.0, stop=0.2)) as launcher:

        def some_motions(count: int) -> None:
            for _ in range(count):
                entries = [peer(choose.choice(HOWS)), Entry("tells", ("python", "tells.py"))]
                processes = [launcher.start(entry, start) for entry in entries]
                for k in range(1, choose.randrange(2, 40)):
                    for process in processes:
                        if not process.pending:
                            process.ask(frame(k))
                    launcher.wait(processes, 5.0)
                    for process in processes:
                        try:
                            process.receive()
                        except AlgorithmError:
                            continue
                    launcher.tend()
                for process in processes:
                    process.stop()

        some_motions(10)
        assert wait_for(lambda: launcher.tend() or not launcher.processes)
        descriptors, before = len(os.listdir("/proc/self/fd")), children()
        some_motions(150)
        assert wait_for(lambda: launcher.tend() or not launcher.processes)
        assert len(os.listdir("/proc/self/fd")) == descriptors
        assert children() <= before


@pytest.mark.long
@pytest.mark.timeout(300)
def test_random_bytes_are_refused_whatever_they_are(launcher, make_start, tmp_path):
    """A program that writes a valid header now and then among noise."""
    program = tmp_path / "noise.py"
    program.write_text(
        "import os, random, struct, sys\n"
        "draw = random.Random(int(sys.argv[1]))\n"
        "while True:\n"
        "    size = draw.choice((0, 1, 8, 64, 2080))\n"
        "    head = struct.pack('<IB', size, draw.choice((16, 17, 18, 19, 20, 21, 99)))\n"
        "    os.write(1, head + draw.randbytes(size) if draw.random() < 0.9 else draw.randbytes(37))\n"
    )
    for seed in range(60):
        entry = Entry("noise", ("/usr/bin/env", "python3", str(program), str(seed)), tmp_path)
        process = launcher.start(entry, make_start())
        process.ask(frame(1))
        launcher.wait([process], 10.0)
        with contextlib.suppress(AlgorithmError):
            process.receive()
        assert process.failure is None or "\n" not in str(process.failure)
        process.stop()
        assert wait_for(lambda process=process: launcher.tend() or process.ended)
