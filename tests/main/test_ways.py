"""A way goes from the algorithm of one human to that of another: in lockstep and by the clock, all processes real."""

from __future__ import annotations

import re
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from ahmss.algorithm.messages import HEADER, encode_start
from ahmss.body.skeleton import Skeleton
from ahmss.main.blending import Blending, Contribution
from ahmss.main.command import Do, parse
from ahmss.main.control import Control
from ahmss.main.motion import Motion
from ahmss.main.people import People
from ahmss.main.play import PlaySetup, play_script
from ahmss.main.process import MainProcess
from ahmss.main.surroundings import known
from ahmss.motion.way import UNKNOWN
from ahmss.world.process import ServerProcess
from ahmss.world.recording import Reader
from ahmss.world.view import World
from tests.main.conftest import write_algorithm
from tests.main.ground import steps
from tests.main.test_people import Slow, crowd

pytestmark = pytest.mark.usefixtures("pool")

WAY = np.arange(12.0).reshape(6, 2) / 4.0 + 1.0  # float32 holds it

TELLS = '''
import numpy as np
from ahmss.algorithm import HumanTask, run

def tells(task: HumanTask):
    """Stands, and says at frame k that it will be at (k, 1), (k, 2), and so on."""
    for k in task.frames():
        yield task.pose({}, way=np.stack([np.full(6, float(k)), np.arange(1.0, 7.0)], axis=1))

run(tells)
'''

HEEDS = '''
import numpy as np
from ahmss.algorithm import HumanTask, run

def heeds(task: HumanTask):
    """Notes what it is told of the other, frame by frame, and how that ends."""
    (other,) = task.world.values()
    told = []
    for k in task.frames():
        way = other.way
        if way is not None:
            assert way.shape == (6, 2) and (way[:, 0] == way[0, 0]).all(), way
            assert (way[:, 1] == np.arange(1.0, 7.0)).all(), way
        told.append(None if way is None else int(way[0, 0]))
        if told[-1] is None and told[0] is None and any(told):
            break
        yield task.pose({})
    numbers = [number for number in told if number is not None]
    assert numbers == sorted(numbers)
    task.note(f"none, then {numbers[0]} to {numbers[-1]}, {len(set(numbers))} of them, then none")

run(heeds)
'''


@pytest.fixture
def asking(workspace: Path) -> Path:
    """The workspace with one who tells and one who heeds."""
    write_algorithm(workspace, "tells", "human", 'world = "none"\n', TELLS)
    write_algorithm(workspace, "heeds", "human", 'world = "none"\nhumans = true\nways = true\n', HEEDS)
    with (workspace / "objectdb/box/object.toml").open("a") as file:
        file.write('\n[affordances.tell]\nhuman_algorithm = "tells"\n')
        file.write('\n[affordances.heed]\nhuman_algorithm = "heeds"\nframes = 0\n')
    return workspace


SCRIPT = """
human ken body ken at 0 0
human aiko body aiko at 0 1
add box as b at 0.3 0.5 1
sync
aiko: do b heed
ken: wait 0.5
ken: do b tell frames 30
ken: wait 2
"""


@pytest.mark.parametrize("fast", [True, pytest.param(False, marks=pytest.mark.long)])
def test_a_way_comes_to_the_algorithm_of_another_human(asking: Path, tmp_path: Path, fast: bool) -> None:
    script, recording = tmp_path / "two.txt", tmp_path / "two.rec"
    script.write_text(SCRIPT)
    report = play_script(script, PlaySetup(fast=fast, seed=1, record=recording, workspace=asking))
    ken, aiko = report.mains
    assert ken["messages"] == aiko["messages"] == ken["notes"] == []
    (note,) = aiko["notes"]
    if fast:
        assert note == "b heed: none, then 1 to 30, 30 of them, then none"
    else:  # of what comes between two frames the newest is told
        assert re.fullmatch(r"b heed: none, then \d+ to \d+, \d+ of them, then none", note)
    with Reader(recording) as reader:
        shown = [reader.show(tick, World()) for tick in range(len(reader))]
        ways = [world.way("ken") for world in shown if "ken" in world.humans]
        assert all(world.way("aiko") is None for world in shown)
        assert ways[0] is ways[-1] is None
        numbers = [way[0, 0] for way in ways if way is not None]
        assert numbers == sorted(numbers)
        assert set(numbers) <= {*range(1, 31)}
        assert len(numbers) == 30 if fast else numbers


def test_mains_of_one_process_hear_of_each_other_and_forget_who_stops(
    asking: Path, server: Callable[..., ServerProcess], join: Callable[..., MainProcess]
) -> None:
    one = server()
    ken, aiko = join(one), join(one, "aiko", place=(0.0, 1.0))
    ken.play(steps("add box as b at 0.3 0.5 1"))
    for step in steps("do b tell frames 1000"):
        ken.agenda.add(step)

    def until(condition: Callable[[], bool]) -> None:
        limit = time.monotonic() + 20.0
        while not condition():
            assert time.monotonic() < limit, "it never came true"
            ken.frame()
            aiko.frame()
            time.sleep(0.005)

    def way() -> np.ndarray | None:
        return aiko.communication.way("ken")

    until(lambda: way() is not None and "b" in aiko.communication.objects)
    do = parse("do b heed")
    assert isinstance(do, Do)
    order = aiko.database.order(do.acts[0], aiko.communication, aiko.actor)
    start = aiko.database.start(order, "human", aiko.communication, aiko.actor, 1, 60.0)
    assert start.ways is True
    (record,) = start.world
    assert record.way is not None
    assert [y for _, y in record.way] == [1, 2, 3, 4, 5, 6]
    do = parse("do b wave")
    assert isinstance(do, Do)
    order = aiko.database.order(do.acts[0], aiko.communication, aiko.actor)
    assert b"way" not in encode_start(aiko.database.start(order, "human", aiko.communication, aiko.actor, 1, 60.0))
    ken.stop_motion()
    until(lambda: way() is None)
    assert aiko.report.messages == ken.report.messages == []


def row(way: np.ndarray | None, root: float) -> np.ndarray:
    """A POSE row of a motion to which the root matters so much, with a way or without."""
    made = np.zeros(260)
    made[[4 + 4 * link for link in range(43)]] = 1.0
    made[176:219], made[219] = 1.0, root
    return made if way is None else np.concatenate([made, way.ravel()])


def test_of_fused_motions_the_way_of_the_one_that_takes_the_root_is_told() -> None:
    skeleton = Skeleton.of(1.7)
    blending = Blending(skeleton, *skeleton.upright(), 60.0)
    nods, walks, stands = (
        Contribution(n, row(way, root)) for n, way, root in ((1, None, 1.0), (2, WAY, 0.7), (3, WAY + 9, 0.0))
    )
    unsure = Contribution(4, row(UNKNOWN, 1.0))
    for motions, told in (
        ([], UNKNOWN), ([nods], UNKNOWN), ([nods, stands, walks], WAY), ([stands, walks, unsure], WAY),
        ([stands], WAY + 9), ([walks], WAY), ([unsure], UNKNOWN),
    ):  # fmt: skip
        blending.step(motions)
        np.testing.assert_array_equal(blending.way, told)
    walks.advance(row(WAY + 1.0, 0.7))
    blending.step([walks])
    np.testing.assert_array_equal(blending.way, WAY + 1.0)
    walks.hold()  # its next frame is late: what it said last counts
    blending.step([walks])
    np.testing.assert_array_equal(blending.way, WAY + 1.0)
    walks.advance(row(None, 0.7))
    blending.step([walks])
    assert np.isnan(blending.way).all()
    blending.step([])
    assert np.isnan(blending.way).all()


def telling(*ways: np.ndarray | None) -> World:
    """A world in which `me` and others stand, the others with these ways."""
    world = crowd((0, 0, 0), *((float(i), 0, 0) for i in range(1, len(ways) + 1)))
    world.human_ways = np.array([UNKNOWN, *(UNKNOWN if way is None else way for way in ways)])
    return world


def test_who_means_to_be_elsewhere_is_told_of_and_who_has_gone_once_more() -> None:
    people = People()
    assert people.moved(telling(None, WAY), "me")[:, 0].tolist() == [-4, -5]
    assert len(people.moved(telling(None, WAY), "me")) == 0
    assert people.moved(telling(WAY, WAY), "me")[:, 0].tolist() == [-4]
    assert people.moved(telling(WAY, WAY + 1.0), "me")[:, 0].tolist() == [-5]
    np.testing.assert_array_equal(people.ways(np.array([-5.0, -4.0])), [(WAY + 1.0).ravel(), WAY.ravel()])
    assert people.moved(telling(None, WAY + 1.0), "me")[:, 0].tolist() == [-4]
    stays, gone = people.moved(telling(None), "me")
    assert stays[:3].tolist() == [-4, 1, 0]
    assert gone[0] == -5
    assert np.isnan(gone[1:]).all()
    assert np.isnan(people.ways(np.array([-5.0, -4.0, -77.0]))).all()
    assert len(people.moved(telling(None), "me")) == 0


def test_who_asks_gets_the_newest_way_with_each_human_and_who_does_not_the_old_rows() -> None:
    communication = SimpleNamespace(world=telling(WAY), human="me")
    database = SimpleNamespace(workspace=None)
    control = Control(database, communication, None, print, print, None, rate=60.0)  # type: ignore[arg-type]
    body = SimpleNamespace(root=np.zeros(3), rotations=np.zeros((43, 4)), grips=np.zeros((2, 7)))
    told: list[bytes] = []
    for ways in (True, False):
        algorithm = SimpleNamespace(humans=True, ways=ways, carries=False)
        order = SimpleNamespace(after=0, frames=0, wish=True, human_algorithm=algorithm)
        motion, process = Motion(order, 1), Slow()  # type: ignore[arg-type]
        process.ask = told.append  # type: ignore[method-assign]
        motion.process, motion.knows = process, known((-4, 9))  # type: ignore[assignment]
        control._motions.append(motion)
    thing = np.array([[9.0, 1, 2, 3, 1, 0, 0, 0]])
    control._showing._surroundings.moved = lambda *_: thing  # type: ignore[method-assign]
    for way in (WAY, WAY + 1.0):  # the first is not seen: both owe an answer
        communication.world = telling(way)
        control.see(body)  # type: ignore[arg-type]
        control.ask_humans()
    assert told == []
    for motion in control._motions:
        motion.process.pending = 0  # type: ignore[union-attr]
    control.ask_humans()
    asks, does_not = (np.frombuffer(frame, "<f8", offset=HEADER.size)[190:] for frame in told)
    human = [-4, 1, 0, 0, 1, 0, 0, 0]
    np.testing.assert_allclose(asks, [*human, *(WAY + 1.0).ravel(), *thing[0]], atol=1e-9)
    np.testing.assert_allclose(does_not, [*human, *thing[0]], atol=1e-9)
