"""Algorithms that ask for the other humans are told where they are, and of every move."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from ahmss.algorithm.messages import HEADER
from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle
from ahmss.body.skeleton import Skeleton
from ahmss.main.control import Control
from ahmss.main.motion import Motion
from ahmss.main.people import People, records
from ahmss.main.process import MainProcess
from ahmss.main.surroundings import among, known, latest
from ahmss.world.process import ServerProcess
from ahmss.world.schema import HumanRecord
from ahmss.world.view import World
from tests.main.conftest import write_algorithm
from tests.main.ground import steps

Start = Callable[..., ServerProcess]
Join = Callable[..., MainProcess]

STALK = '''
from ahmss.algorithm import HumanTask, run

def stalk(task: HumanTask):
    """Stays two metres behind the other."""
    (other,) = task.world.values()
    assert other.id < 0 and other.kind == "human" and other.name == "ken"
    for _ in task.frames():
        root = task.present.root.copy()
        root[:2] = other.place[:2] - [2.0, 0.0]
        yield task.pose({}, root)

run(stalk)
'''


def crowd(*places: tuple[float, float, float]) -> World:
    """A world of humans at x, y and a heading in radians; the first is `me`."""
    world = World()
    rotations, root = Skeleton.of(1.7).upright()
    rows: list[Array] = []
    for number, (x, y, facing) in enumerate(places, 3):
        name = "me" if number == 3 else f"other_{number}"
        world.humans[name] = HumanRecord(number, name, "ken")
        turned = rotations.copy()
        half = from_axis_angle(np.array([0.0, 0.0, 1.0]), facing)
        turned[0] = [
            half[0] * rotations[0, 0] - half[3] * rotations[0, 3],
            half[0] * rotations[0, 1] - half[3] * rotations[0, 2],
            half[0] * rotations[0, 2] + half[3] * rotations[0, 1],
            half[0] * rotations[0, 3] + half[3] * rotations[0, 0],
        ]
        rows.append(np.concatenate([[x, y, root[2]], turned.ravel()]))
    world.human_ids = np.arange(3, 3 + len(places), dtype=np.uint32)
    world.human_poses = np.array(rows)
    world.human_ways = np.full((len(places), 6, 2), np.nan)
    return world


def test_humans_are_told_of_by_where_they_stand_and_face() -> None:
    (record,) = records(crowd((0.0, 0.0, 0.0), (1.0, -2.0, 0.7)), "me")
    assert (record.id, record.name, record.kind) == (-4, "other_4", "human")
    np.testing.assert_allclose(record.place, [1.0, -2.0, 0.0])
    np.testing.assert_allclose(record.rotation, from_axis_angle(np.array([0.0, 0.0, 1.0]), 0.7), atol=1e-9)


def test_those_that_moved_are_told_and_no_others() -> None:
    people = People()
    assert people.moved(crowd((0, 0, 0), (1, 0, 0), (2, 0, 0)), "me")[:, 0].tolist() == [-4.0, -5.0]
    assert len(people.moved(crowd((9, 9, 0), (1, 0, 0), (2, 0, 0)), "me")) == 0
    moved = people.moved(crowd((9, 9, 0), (1, 0, 0), (2, 0.5, np.pi / 2)), "me")
    np.testing.assert_allclose(moved, [[-5, 2, 0.5, 0, np.sqrt(0.5), 0, 0, np.sqrt(0.5)]], atol=1e-9)
    assert len(people.moved(crowd((9, 9, 0), (1, 0, 0), (2, 0.5, np.pi / 2), (3, 0, 0)), "me")) == 3
    people.forget()
    assert len(people.moved(crowd((9, 9, 0), (1, 0, 0)), "me")) == 1


def test_rows_are_chosen_by_what_is_known_and_the_newest_of_each_counts() -> None:
    rows = np.array([[7.0, 1, 0, 0, 1, 0, 0, 0], [-2.0, 2, 0, 0, 1, 0, 0, 0], [9.0, 3, 0, 0, 1, 0, 0, 0]])
    assert among(rows, known((9, -2, 4)))[:, 0].tolist() == [-2.0, 9.0]
    assert len(among(rows, known(()))) == len(among(rows[:0], known((7,)))) == len(among(rows, known((8, 100)))) == 0
    newer = rows[1:] + np.array([0, 10, 0, 0, 0, 0, 0, 0])
    assert latest(rows, newer)[:, :2].tolist() == [[-2.0, 12.0], [7.0, 1.0], [9.0, 13.0]]
    assert latest(rows[:0], newer) is newer


class Slow:
    """A process that is asked for frames and answers when it likes."""

    def __init__(self) -> None:
        self.active, self.pending = True, 1
        self.asked: list[Array] = []

    def ask(self, frame: bytes) -> None:
        self.asked.append(np.frombuffer(frame, "<f8", offset=HEADER.size)[190:].reshape(-1, 8))


def test_what_moved_while_an_algorithm_was_late_is_told_with_its_next_frame() -> None:
    communication, process = SimpleNamespace(world=crowd((0, 0, 0), (1, 0, 0), (2, 0, 0)), human="me"), Slow()
    control = Control(SimpleNamespace(workspace=None), communication, None, print, print, None, rate=60.0)  # type: ignore[arg-type]
    wants = SimpleNamespace(
        after=0, frames=0, wish=True, human_algorithm=SimpleNamespace(humans=True, ways=False, carries=False)
    )
    motion = Motion(wants, 1)  # type: ignore[arg-type]
    motion.process, motion.knows = process, known((-4, -5))  # type: ignore[assignment]
    control._motions.append(motion)
    body = SimpleNamespace(root=np.zeros(3), rotations=np.zeros((43, 4)), grips=np.zeros((2, 7)))
    for x, y in ((1, 0), (1.5, 0), (1.7, 0), (1.7, 3)):
        communication.world = crowd((0, 0, 0), (x, 0, 0), (2, y, 0))
        control.see(body)  # type: ignore[arg-type]
        control.ask_humans()
    assert process.asked == []
    process.pending = 0
    for _ in range(2):
        control.see(body)  # type: ignore[arg-type]
        control.ask_humans()
    first, second = process.asked
    assert first[:, :3].tolist() == [[-5.0, 2.0, 3.0], [-4.0, 1.7, 0.0]]
    assert len(second) == 0


def test_who_comes_after_an_algorithm_has_begun_is_told_of() -> None:
    communication, process = SimpleNamespace(world=crowd((0, 0, 0), (1, 0, 0)), human="me"), Slow()
    process.pending = 0
    control = Control(SimpleNamespace(workspace=None), communication, None, print, print, None, rate=60.0)  # type: ignore[arg-type]
    body = SimpleNamespace(root=np.zeros(3), rotations=np.zeros((43, 4)), grips=np.zeros((2, 7)))
    for humans in (True, False):
        algorithm = SimpleNamespace(humans=humans, ways=False, carries=False)
        motion = Motion(SimpleNamespace(after=0, frames=0, wish=True, human_algorithm=algorithm), 1)  # type: ignore[arg-type]
        motion.process, motion.knows = process, known((-4,))  # type: ignore[assignment]
        control._motions[:] = [motion]
        for places in (((0, 0, 0), (1, 0, 0)), ((0, 0, 0), (1, 0, 0), (5, 6, 0))):
            communication.world = crowd(*places)
            control.see(body)  # type: ignore[arg-type]
        control.ask_humans()
        told = process.asked.pop()
        assert sorted(told[:, 0].tolist()) == ([-5.0, -4.0] if humans else [])


def test_an_algorithm_follows_a_human_that_moves(server: Start, join: Join, workspace: Path) -> None:
    write_algorithm(workspace, "stalk", "human", 'world = "none"\nhumans = true\n', STALK)
    with (workspace / "objectdb/box/object.toml").open("a") as file:
        file.write('\n[affordances.stalk]\nhuman_algorithm = "stalk"\nframes = 0\n')
    one = server()
    ken, aiko = join(one, place=(1.0, 0.0)), join(one, "aiko", place=(-1.0, 0.0))
    ken.play(steps("add box as b at 0.3 0 1"))
    while "b" not in aiko.communication.objects:
        aiko.frame()
        time.sleep(0.005)
    for step in steps("do b stalk"):
        aiko.agenda.add(step)
    for step in steps("wait 0.3", "do b step to 1.4 0.5 frames 10"):
        ken.agenda.add(step)
    until = time.monotonic() + 30.0
    while time.monotonic() < until:
        ken.frame()
        aiko.frame()
        time.sleep(0.005)
        apart = aiko.blending.root[:2] - ken.blending.root[:2] + [2.0, 0.0]
        if ken.agenda.done and ken.blending.resting and np.abs(apart).max() < 1e-3:
            break
    assert aiko.report.messages == ken.report.messages == []
    assert ken.blending.root[0] > 1.1
    assert ken.blending.root[1] > 0.1
    np.testing.assert_allclose(aiko.blending.root[:2], ken.blending.root[:2] - [2.0, 0.0], atol=1e-3)
