"""Each shipped program as main starts it: found in its folder, run from the pool, its frames those of the function."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from ahmss.algorithm import frames
from ahmss.algorithm.messages import Start, encode_frame
from ahmss.algorithm.pose import HumanPose, ObjectPose
from ahmss.processes.answers import Answer
from ahmss.processes.launcher import Launcher

from .scene import CUP, DOOR, FLOOR, WORKSPACE, Body, program

SHIPPED = [
    ("slerp", CUP, "lift", "human"), ("reach", CUP, "reach", "human"),
    ("grasp", CUP, "release", "human"), ("playback", DOOR, "play_open", "human"),
    ("hold_arm", FLOOR, "stand", "human"), ("door", DOOR, "play_open", "object"),
    ("follow_hand", CUP, "grasp", "object"),
    ("stay", "room/chair", "sit", "object"), ("pressed", "room/television/switch", "press", "object"),
    ("turned", "room/sink/tap", "turn", "object"),
]  # fmt: skip


@pytest.fixture(scope="module")
def launcher() -> Iterator[Launcher]:
    with Launcher() as made:
        yield made
        made.close()


def played(launcher: Launcher, name: str, start: Start, rows: list[np.ndarray]) -> list[np.ndarray]:
    """The numbers that a process answers to these FRAMEs."""
    process = launcher.start(WORKSPACE.algorithms.find(name), start)
    answers: list[np.ndarray] = []
    for row in rows:
        process.ask(frame(start, row))
        assert launcher.wait([process], 20.0)
        answers += [message.row for message in process.receive() if isinstance(message, Answer)]
    process.stop()
    return answers


def frame(start: Start, row: np.ndarray) -> bytes:
    assert start.object is not None
    pose = np.array([*start.object.place, *start.object.rotation]) if start.kind == "object" else None
    return encode_frame(int(row[0]), row[1:4], row[4:176].reshape(43, 4), row[176:190].reshape(2, 7), pose)


@pytest.mark.parametrize(("name", "thing", "action", "kind"), SHIPPED)
def test_a_process_answers_as_the_function_does(
    launcher: Launcher, name: str, thing: str, action: str, kind: str
) -> None:
    body = Body(x=-0.47) if thing == DOOR else Body()
    parameters = {"open": True} if action == "release" else {}
    start = body.start(thing, action, kind=kind, frames=12, parameters=parameters)
    rows = [body.row(k) for k in range(1, 13)]
    answers = played(launcher, name, start, rows)
    expected = list(frames(program(name), start, rows))
    assert len(answers) == len(expected) == 12
    of = HumanPose.of if kind == "human" else ObjectPose.of
    for answer, pose in zip(answers, expected, strict=True):
        got = of(answer)
        for field in ("rotations", "root", "targets") if kind == "human" else ("place", "rotation"):
            np.testing.assert_allclose(getattr(got, field), getattr(pose, field), atol=1e-9)


def test_every_shipped_algorithm_says_what_it_is() -> None:
    for name in ("slerp", "grasp", "playback", "hold_arm", "door", "follow_hand"):
        entry = WORKSPACE.algorithms.find(name)
        assert entry.sentence
        assert entry.kind == ("object" if name in ("door", "follow_hand") else "human")
