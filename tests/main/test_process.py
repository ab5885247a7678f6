"""The frame loop with a real server and real algorithm processes, most of it in lockstep."""

from collections import deque
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate, to_rotation_vector
from ahmss.main import agenda, layout
from ahmss.main.process import MainProcess, Setup
from ahmss.world.process import ServerProcess
from tests.main.conftest import ALGORITHMS, make_workspace, write_algorithm, write_peer
from tests.main.ground import steps

Start = Callable[..., ServerProcess]
Join = Callable[..., MainProcess]
ARM, SPINE = INDEX["right_upper_arm"], INDEX["spine"]


@pytest.fixture
def ken(server: Start, join: Join) -> MainProcess:
    """A main in lockstep with a box beside its right hand."""
    main = join(server(lockstep=["ken"]), fast=True, names=("ken",))
    hand = main.blending.grips[0]
    x, y, z = (hand[:3] + np.array([0.03, 0.0, -0.05])).tolist()
    main.play(steps(f"add box as b at {x} {y} {z}"))
    return main


@pytest.fixture(scope="module")
def patient_ken(tmp_path_factory: pytest.TempPathFactory, pool: None) -> Iterator[MainProcess]:
    """A main in lockstep with a box, for many tests that change nothing for good."""
    workspace = make_workspace(tmp_path_factory.mktemp("patient") / "workspace")
    with ServerProcess(lockstep=["ken"]) as server:
        setup = Setup("ken", "ken", server=server.address, workspace=workspace, fast=True, names=("ken",))
        main = MainProcess(setup, lambda _: None)
        main.play(steps("add box as b at 0.3 0 1"))
        yield main
        main.close()


class Film:
    """Every frame of a run: angles of joints, and where the box is."""

    def __init__(self, main: MainProcess, *lines: str) -> None:
        self.rotations: list[Array] = []
        self.roots: list[Array] = []
        self.grips: list[Array] = []
        self.box: list[Array] = []
        publish = main.communication.publish

        def look(root: Array, rotations: Array, moved: Array | None, way: Array) -> None:
            publish(root, rotations, moved, way)
            self.rotations.append(rotations.copy())
            self.roots.append(root.copy())
            self.grips.append(main.blending.grips.copy())
            if "b" in main.communication.objects:
                self.box.append(main.communication.pose("b").copy())

        main.communication.publish = look  # type: ignore[method-assign]
        main.play(deque(steps(*lines)))
        main.communication.publish = publish  # type: ignore[method-assign]

    def angles(self, joint: int) -> Array:
        """Radians that a joint is away from its first frame."""
        turned = [multiply(conjugate(self.rotations[0][joint]), rotation[joint]) for rotation in self.rotations]
        return np.linalg.norm([to_rotation_vector(q) for q in turned], axis=1)

    def pops(self) -> float:
        """The largest step of any joint against the mean of its neighbours, degrees."""
        rotations = np.array(self.rotations)
        steps_ = to_rotation_vector(multiply(conjugate(rotations[:-1]), rotations[1:]))
        return float(np.degrees(np.abs(steps_[1:-1] - 0.5 * (steps_[:-2] + steps_[2:])).max()))


def test_a_motion_is_made_by_a_process_and_seen_in_the_world(ken: MainProcess) -> None:
    before = ken.blending.rotations.copy()
    report = ken.play(steps("do b wave frames 30"))
    assert report.messages == []
    turned = to_rotation_vector(multiply(conjugate(before[ARM]), ken.blending.rotations[ARM]))
    assert abs(np.linalg.norm(turned) - 0.6) < 1e-6
    others = [link for link in range(43) if link != ARM]
    assert np.abs(ken.blending.rotations[others] - before[others]).max() < 1e-12
    ken.communication.client.refresh()
    _, seen = ken.communication.world.human("ken")
    assert np.abs(seen - ken.blending.rotations).max() < 1e-6


def test_fused_motions_start_each_after_its_own_delay(ken: MainProcess) -> None:
    film = Film(ken, "do b wave frames 40 with b bow frames 30 after 20")
    arm, spine = film.angles(ARM), film.angles(SPINE)
    assert arm[5] > 1e-3
    assert spine[:20].max() < 1e-9
    assert spine[25] > 1e-3
    assert abs(arm[39] - 0.6) < 1e-3
    assert abs(spine[-1] - 0.6) < 1e-3
    assert ken.report.messages == []


def test_in_lockstep_a_motion_is_asked_before_its_first_frame_is_awaited(
    ken: MainProcess, monkeypatch: pytest.MonkeyPatch
) -> None:
    told: list[tuple[int, str, int]] = []

    def left() -> float:
        told.extend((ken.report.frames, title, k) for title, k, _ in ken.control.progress)
        return 0.0

    monkeypatch.setattr(ken.pace, "left", left)
    first = ken.report.frames
    film = Film(ken, "do b wave frames 5")
    assert told[:3] == [(first + k, "b wave", k + 1) for k in range(3)]
    assert film.angles(ARM)[1] > 1e-6  # and it is shown in the frame that is awaited then
    assert ken.report.messages == []


def test_one_motion_follows_on_another_without_a_jump(ken: MainProcess) -> None:
    # The second begins in the middle of the first one's sweep: the same joint, another source.
    film = Film(
        ken, "do b wave frames 20 angle=1.2", "do b bow frames 20", "do b wave frames 20 angle=-0.8", "wait 0.5"
    )
    assert ken.report.messages == []
    assert film.pops() < 1.5


def test_the_root_follows_its_one_owner_exactly(ken: MainProcess) -> None:
    start = ken.blending.root.copy()
    film = Film(ken, "do b step to 1 0.5 frames 60 with b wave frames 40", "wait 0.5")
    assert np.abs(film.roots[-1] - [1.0, 0.5, start[2]]).max() < 1e-6
    assert np.abs(np.diff(np.array(film.roots), n=2, axis=0)).max() < 0.01


def test_a_motion_that_takes_as_long_as_it_needs_is_asked_until_it_is_done(ken: MainProcess) -> None:
    said: list[str] = []
    ken.agenda.said = said.append
    x, y, _ = ken.blending.root.tolist()
    film = Film(ken, f"do b stroll to {x + 0.5} {y}", "do b wave frames 10")
    assert said[0] == "b stroll: as long as it needs"
    assert ken.report.messages == []
    there = next(k for k, root in enumerate(film.roots) if abs(root[0] - x - 0.5) < 1e-9)
    waving = next(k for k, angle in enumerate(film.angles(ARM)) if angle > 1e-3)
    assert 50 <= there < waving < there + 10
    again = Film(ken, f"do b stroll to {x + 10} {y} frames 20", "do b bow frames 10")
    assert next(k for k, angle in enumerate(again.angles(SPINE)) if angle > 1e-3) < 25


def test_what_an_algorithm_notes_is_said_with_its_title_and_is_no_failure(ken: MainProcess) -> None:
    x, y, _ = ken.blending.root.tolist()
    report = ken.play(steps(f"do b stroll to {x + 0.5} {y} frames 20"))
    assert report.notes == ["b stroll: 20 frames are few"]
    assert (report.failures, report.messages, ken.control.failures) == (0, [], 0)


def test_a_target_is_met_at_the_end_without_a_jump_on_the_way(ken: MainProcess) -> None:
    x, y, z = (ken.blending.grips[0, :3] + [0.2, 0.0, 0.2]).tolist()
    film = Film(ken, f"add box as c at {x} {y} {z - 0.05}", "do c touch hand right frames 40")
    assert np.abs(film.grips[39][0, :3] - [x, y, z]).max() < 1e-3
    assert film.pops() < 1.5


def test_what_was_taken_follows_the_hand_until_it_is_released(ken: MainProcess) -> None:
    film = Film(ken, "do b take frames 30", "do b bow frames 20", "do b shake frames 20")
    held = [in_hand(grips, box) for grips, box in zip(film.grips[6:], film.box[6:], strict=True)]
    assert np.abs(np.array(held) - held[0]).max() < 1e-6
    assert np.abs(film.box[-1] - film.box[0]).max() > 0.05
    assert ken.communication.world.objects["b"].holder == "ken"
    assert ken.communication.world.objects["b"].hand == "right"
    released = Film(ken, "do b drop frames 10", "do b bow frames 40")
    assert fell(released)
    assert ken.communication.world.objects["b"].holder == ""
    assert ken.report.messages == []


def fell(film: Film) -> bool:
    """Whether the box fell straight down and rests upright on the floor, half its side above it."""
    first, last = film.box[0], film.box[-1]
    upright = abs(last[4]) + abs(last[5]) < 1e-9
    return bool(np.abs(last[:2] - first[:2]).max() < 1e-9 and first[2] > 0.4 and abs(last[2] - 0.05) < 1e-6 and upright)


def in_hand(grips: Array, box: Array) -> Array:
    """The box's place in the right palm."""
    return rotate(conjugate(grips[0, 3:]), box[:3] - grips[0, :3])


def test_an_object_algorithm_that_dies_leaves_the_box_fixed_to_the_hand(ken: MainProcess) -> None:
    film = Film(ken, "do b grip_and_die frames 30", "do b bow frames 20")
    assert len(ken.report.messages) == 1
    assert "algorithm carry at frame 10" in ken.report.messages[0]
    assert "it was dropped" in ken.report.messages[0]
    assert ken.report.messages[0].endswith("b stays fixed to the hand until it is released")
    held = [in_hand(grips, box) for grips, box in zip(film.grips[6:], film.box[6:], strict=True)]
    assert np.abs(np.array(held) - held[0]).max() < 1e-6
    assert fell(Film(ken, "do b drop frames 10", "do b bow frames 40"))
    assert ken.communication.world.objects["b"].holder == ""


@pytest.mark.parametrize(
    ("how", "reason"),
    [
        ("crashes", "at frame 30: it was killed by SIGABRT"),
        pytest.param("writes_garbage", "at frame 3: ", marks=pytest.mark.long),
        ("prints", "at frame 3: "),
        ("not_a_number", "number 100 of its pose is nan"),
        pytest.param("length_two", "has length 2, not 1", marks=pytest.mark.long),
        pytest.param("exits", "it ended with exit code 7", marks=pytest.mark.long),
    ],
)
def test_a_bad_algorithm_costs_one_line_and_disturbs_nothing_else(
    ken: MainProcess, workspace: Path, how: str, reason: str
) -> None:
    write_peer(workspace, how)
    film = Film(ken, f"do b {how} frames 60 with b wave frames 50", "do b bow frames 20")
    assert len(ken.report.messages) == 1
    assert reason in ken.report.messages[0]
    assert abs(film.angles(ARM)[-1] - 0.6) < 1e-3 or how == "crashes"
    assert film.angles(SPINE)[-1] > 0.5
    assert film.pops() < 1.5


@pytest.mark.parametrize(
    ("line", "error"),
    [
        ("do c wave", 'line 1: no object "c" in the world; there is: b'),
        ("do b fly", 'line 1: b does not afford "fly"; it affords: wave, bow'),
        ("do b wave speed=3", 'line 1: b wave: no parameter "speed"; it takes: angle, link'),
        ("do b wave angle=fast", "line 1: b wave: parameter angle: 'fast' is no finite number"),
        ("do b shake", "b shake: ken does not hold it"),
        ("do b step", "line 1: b step: asks for a place; add `to X Y Z`, or `to` and an object"),
        ("do b reach_high", "b reach_high: it takes a reach of 3 m, and ken's is 2."),
        ("set b lid ajar", 'line 1: b lid can\'t be "ajar"; allowed: shut, open'),
        ("set b colour red", 'line 1: b has no state "colour"; it has: lid'),
        ("aiko: do b wave", "line 1: this main moves ken, not aiko; humans here: ken"),
        ("add boxes", 'line 1: no kind of object "boxes"'),
        ("remove c", 'line 1: no object "c" in the world'),
        ("human aiko", "line 1: another human needs a main of its own; type: ahmss main --human aiko"),
        ("wait b lamp == on", 'line 1: b has no state "lamp"; it has: lid'),
    ],
)
def test_what_can_not_be_done_is_said_in_one_line_and_the_rest_goes_on(
    patient_ken: MainProcess, line: str, error: str
) -> None:
    ken = patient_ken
    ken.report.messages.clear()
    film = Film(ken, line, "do b wave frames 20")
    assert len(ken.report.messages) == 1
    assert error in ken.report.messages[0].replace("there are:", "there is:")
    assert film.angles(ARM)[-1] > 0.5


def test_an_action_is_afforded_in_some_states_only(ken: MainProcess) -> None:
    ken.play(steps("do b open frames 10", "set b lid open", "do b open frames 10"))
    assert ken.report.messages == ["b open: only when its lid is shut; its lid is open"]


def test_nobody_takes_what_somebody_else_holds(server: Start, join: Join) -> None:
    here = server()
    ken, aiko = join(here), join(here, "aiko", body="aiko", place=(0.0, 1.0))
    ken.play(steps("add box as b at 0.3 0.5 1", "do b take frames 20"))
    aiko.play(steps("wait 0.3", "do b take patience=0 frames 10", "do b wave frames 10"))
    assert len(aiko.report.messages) == 1
    assert aiko.report.messages[0].startswith("b take: ")
    assert "ken" in aiko.report.messages[0]
    assert aiko.communication.update(complete=True).objects["b"].holder == "ken"


def test_a_motion_that_is_stopped_leaves_the_body_where_it_is(server: Start, join: Join) -> None:
    main = join(server())
    main.play(steps("add box as b at 0.3 0 1"))
    before = main.blending.rotations.copy()
    for step in steps("do b wave frames 600", "do b bow frames 600"):
        main.agenda.add(step)
    for _ in range(60):
        main.frame()
    main.stop_motion()
    for _ in range(60):
        main.frame()
    assert main.agenda.done
    assert main.blending.resting
    assert np.abs(main.blending.rotations[ARM] - before[ARM]).max() > 1e-4
    assert main.report.messages == []


@pytest.fixture
def looks_often(monkeypatch: pytest.MonkeyPatch) -> None:
    """The files are looked at five times a second."""
    monkeypatch.setattr(layout, "_EVERY", 12)


def parts(main: MainProcess) -> set[str]:
    return {name for name in main.communication.world.objects if "/" in name}


def wait_until(main: MainProcess, happens: Callable[[], bool]) -> None:
    """It goes on until something happens, and for a second more, in which what is said again and again is said."""
    for _ in range(200):
        main.play(steps("wait 0.1"))
        if happens():
            break
    main.play(steps("wait 1"))


@pytest.mark.usefixtures("looks_often")
def test_new_and_moved_entries_follow_the_file_while_the_world_runs(server: Start, join: Join, workspace: Path) -> None:
    shelf = workspace / "objectdb" / "shelf"
    shelf.mkdir()
    entry = '[[contains]]\nkind = "box"\nname = "{}"\nposition = [{}, 0.0, 0.0]\n'
    (shelf / "object.toml").write_text('name = "shelf"\n' + entry.format("one", 0.0) + entry.format("two", 0.2))
    main = join(server())
    main.play(steps("add shelf at 1 0 0 facing 90"))
    (shelf / "object.toml").write_text('name = "shelf"\n' + entry.format("one", 0.1) + entry.format("three", 0.3))
    wait_until(main, lambda: parts(main) == {"shelf/one", "shelf/three"})
    assert main.report.messages == []
    world = main.communication.world
    assert parts(main) == {"shelf/one", "shelf/three"}
    assert np.abs(world.pose("shelf/one")[:3] - [1.0, 0.1, 0.0]).max() < 1e-6
    assert np.abs(world.pose("shelf/three")[:3] - [1.0, 0.3, 0.0]).max() < 1e-6
    (shelf / "object.toml").write_text('nam = "shelf"\n')
    wait_until(main, lambda: bool(main.report.messages))
    assert len(main.report.messages) == 1
    assert "objectdb/shelf/object.toml" in main.report.messages[0]


@pytest.mark.parametrize(("within", "frames"), [(" within 0.5", 30), ("", 60)])
def test_what_never_comes_is_waited_for_so_long_and_told(
    ken: MainProcess, monkeypatch: pytest.MonkeyPatch, within: str, frames: int
) -> None:
    monkeypatch.setattr(agenda, "_LONGEST_WAIT", 1.0)
    begun = ken.report.frames
    ken.play(steps(f"wait b lid == open{within}"))
    assert frames <= ken.report.frames - begun < frames + 5
    assert ken.report.messages == [f"line 1: b lid == open has not come in {frames / 60:g} s; it is shut"]


@pytest.mark.usefixtures("looks_often")
def test_what_is_in_use_follows_its_file_when_it_is_let_go(server: Start, join: Join, workspace: Path) -> None:
    shelf = workspace / "objectdb" / "shelf"
    shelf.mkdir()
    entry = '[[contains]]\nkind = "box"\nname = "{}"\nposition = [{}, 0.0, 0.0]\n'
    (shelf / "object.toml").write_text('name = "shelf"\n' + entry.format("one", 0.0) + entry.format("two", 0.2))
    main = join(server())
    main.play(steps("add shelf at 1 0 0"))
    client = main.communication.client
    client.claim("ken", ["shelf/one", "shelf/two"], "")
    (shelf / "object.toml").write_text('name = "shelf"\n' + entry.format("one", 0.1))
    wait_until(main, lambda: len(main.report.messages) == 2)
    world = main.communication.world
    assert parts(main) == {"shelf/one", "shelf/two"}
    held = [
        f"shelf/{what} when it is let go"
        for what in ("one is held by ken; it can be moved", "two is held by ken; it can be removed")
    ]
    assert sorted(main.report.messages) == held  # each said once
    client.release("ken", ["shelf/one", "shelf/two"])
    wait_until(main, lambda: parts(main) == {"shelf/one"})
    assert parts(main) == {"shelf/one"}
    assert np.abs(world.pose("shelf/one")[:3] - [1.1, 0.0, 0.0]).max() < 1e-6


@pytest.mark.usefixtures("looks_often")
@pytest.mark.parametrize("patient", [True, False])
def test_a_whole_whose_part_is_in_use_is_moved_with_it_when_it_is_let_go(
    server: Start, join: Join, workspace: Path, monkeypatch: pytest.MonkeyPatch, patient: bool
) -> None:
    monkeypatch.setattr(layout, "_LOOKS", 1000 if patient else 2)
    for kind, within in (("board", "box"), ("shelf", "board")):
        (workspace / "objectdb" / kind).mkdir()
        entry = f'name = "{kind}"\n[[contains]]\nkind = "{within}"\nposition = [0.2, 0.0, 0.0]\n'
        (workspace / "objectdb" / kind / "object.toml").write_text(entry)
    main = join(server())
    main.play(steps("add shelf at 1 0 0"))
    world, client = main.communication.world, main.communication.client
    client.claim("ken", ["shelf/board/box"], "")
    file = workspace / "objectdb" / "shelf" / "object.toml"
    file.write_text(file.read_text() + "facing_deg = 90\n")
    if patient:
        wait_until(main, lambda: bool(main.report.messages))
        assert np.abs(world.pose("shelf/board")[3:] - [1.0, 0.0, 0.0, 0.0]).max() < 1e-6
    else:
        wait_until(main, lambda: abs(world.pose("shelf/board")[3] - 1.0) > 0.1)
    assert np.abs(world.pose("shelf/board/box")[:3] - [1.4, 0.0, 0.0]).max() < 1e-6  # under the finger, where it was
    assert main.report.messages == ["shelf/board/box is held by ken; shelf/board can be moved when it is let go"]
    client.release("ken", ["shelf/board/box"])
    wait_until(main, lambda: abs(world.pose("shelf/board/box")[0] - 1.4) > 0.1)
    assert np.abs(world.pose("shelf/board/box")[:3] - [1.2, 0.2, 0.0]).max() < 1e-6
    assert np.abs(world.pose("shelf/board")[3:] - np.sqrt([0.5, 0.0, 0.0, 0.5])).max() < 1e-6


def test_a_new_affordance_and_its_algorithm_work_without_a_restart(ken: MainProcess, workspace: Path) -> None:
    ken.play(steps("do b hail"))
    write_algorithm(workspace, "hail", "human", "", ALGORITHMS["swing"][2])
    with (workspace / "objectdb/box/object.toml").open("a") as file:
        file.write('\n[affordances.hail]\nhuman_algorithm = "hail"\nframes = 40\n')
    film = Film(ken, "do b hail")
    assert len(ken.report.messages) == 1
    assert 'does not afford "hail"' in ken.report.messages[0]
    assert film.angles(ARM)[-1] > 0.5


REFUSES = """
from ahmss.algorithm import HumanTask, run
from ahmss.errors import AlgorithmError

def refuse(task: HumanTask):
    for k in task.frames():
        if k == task.parameter("stuck", 10):
            raise AlgorithmError("the lid is stuck; open it first")
        yield task.pose({})

run(refuse)
"""
STUCK = '[parameters.stuck]\ntype = "int"\ndefault = 10\n'


@pytest.mark.parametrize(("stuck", "holder"), [(1, "ken"), (10, "")])
def test_what_is_not_put_down_is_still_held_and_is_let_go_where_the_hand_has_begun_to(
    workspace: Path, ken: MainProcess, stuck: int, holder: str
) -> None:
    """A carton fell out of the hands of who stood where it can't be put down."""
    write_algorithm(workspace, "refuse", "human", STUCK, REFUSES)
    with (workspace / "objectdb/box/object.toml").open("a") as file:
        file.write('\n[affordances.lay]\nhuman_algorithm = "refuse"\nobject_algorithm = "carry"\n')
        file.write('hold = "release"\nframes = 20\n')
    film = Film(ken, "do b take frames 30", f"do b lay stuck={stuck}", "do b bow frames 40")
    assert ken.communication.world.objects["b"].holder == holder
    assert (film.box[-1][2] < 0.06) == (not holder)


@pytest.mark.parametrize(
    ("line", "why"),
    [("do b shake", "b shake: ken does not hold it"), ("do b pry", "b pry: the lid is stuck; open it first")],
)
def test_what_is_refused_is_not_announced_first_and_is_said_in_the_words_of_who_refuses(
    workspace: Path, ken: MainProcess, line: str, why: str
) -> None:
    write_algorithm(workspace, "refuse", "human", STUCK, REFUSES)
    with (workspace / "objectdb/box/object.toml").open("a") as file:
        file.write('\n[affordances.pry]\nhuman_algorithm = "refuse"\nframes = 60\n')
    said: list[str] = []
    ken.agenda.said = said.append
    ken.play(steps(line))
    assert (said, ken.report.messages) == ([], [why])
    ken.play(steps("do b wave frames 20"))
    assert said == ["b wave: 0.3 s", "b wave: done"]
    said.clear()
    ken.play(steps(f"do b wave frames 60 with {line.removeprefix('do ')}"))
    assert said[-1] == f"b wave with {line.removeprefix('do ')}: done, but for what could not be"


def test_a_note_comes_after_what_it_is_about(ken: MainProcess) -> None:
    told: list[str] = []
    ken.agenda.said = told.append
    ken._say = told.append
    x, y, _ = ken.blending.root.tolist()
    ken.play(steps(f"do b stroll to {x + 0.5} {y} frames 20"))
    assert told == ["b stroll: 0.3 s, or as long as it needs", "b stroll: 20 frames are few", "b stroll: done"]
