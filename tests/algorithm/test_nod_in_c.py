"""The C program: compiled, and run through the real launcher."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from algorithm_rig import ROTATIONS, Entry, play, wait_for

from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, norm, to_rotation_vector
from ahmss.processes.answers import Answer, Done, Phase

SOURCE = Path(__file__).parents[2] / "algorithms" / "nod"
GOLDEN = Path(__file__).parent / "golden"


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    if shutil.which("cc") is None or shutil.which("make") is None:
        pytest.skip("no C compiler (cc) or no make: the example in C is not tested")
    folder = tmp_path_factory.mktemp("nod")
    for name in ("nod.c", "Makefile"):
        shutil.copy(SOURCE / name, folder)
    subprocess.run(["make", "-s", "CFLAGS=-O2 -std=c99 -Wall -Wextra -Wpedantic -Werror"], cwd=folder, check=True)
    return folder


def test_it_nods_and_is_done(launcher, make_start, compiled):
    depth = 0.3
    parameters = {"depth": depth, "decoy": {"frames": 3}}
    process = launcher.start(Entry("nod", ("./nod",), compiled), make_start(frames=40, parameters=parameters))
    messages = play(launcher, process, 40)
    rows = np.array([m.row for m in messages if isinstance(m, Answer)])
    assert wait_for(lambda: messages.extend(process.receive()) or process.phase is Phase.DONE)
    assert messages[-1] == Done(40)
    head = rows[:, 4:176].reshape(-1, 43, 4)[:, INDEX["head"]]
    np.testing.assert_allclose(norm(head), 1.0, atol=1e-12)
    turn = to_rotation_vector(multiply(conjugate(ROTATIONS[INDEX["head"]]), head))
    assert turn[:, 1].argmax() == 19  # deepest in the middle,
    assert abs(turn[19, 1] - depth) < 1e-3  # as deep as asked,
    np.testing.assert_allclose(turn[:, [0, 2]], 0.0, atol=1e-12)  # about one axis,
    np.testing.assert_allclose(turn[-1], 0.0, atol=1e-12)  # and up again
    assert (rows[:, 176:220] == np.eye(44)[INDEX["head"]]).all()


def test_the_golden_bytes_are_enough_for_it(compiled):
    said = b"".join((GOLDEN / f"{name}.bin").read_bytes() for name in ("start", "frame", "stop"))
    answer = subprocess.run(["./nod"], cwd=compiled, input=said, capture_output=True, check=True).stdout
    ready = (GOLDEN / "ready.bin").read_bytes()
    assert answer.startswith(ready)
    assert answer[len(ready) : len(ready) + 5] == b"\x20\x08\0\0\x11"
    assert len(answer) == len(ready) + 5 + 2080


def test_it_ends_with_its_input(launcher, make_start, compiled):
    process = launcher.start(Entry("nod", ("./nod",), compiled), make_start())
    play(launcher, process, 2)
    process.stop()
    assert wait_for(lambda: launcher.tend() or process.ended)
    assert process.failure is None
