"""Scripts played with all processes: servers, mains and algorithms of their own."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import ahmss
from ahmss import cli
from ahmss.main.judging import motion_of
from ahmss.main.play import PlaySetup, play_script
from ahmss.main.process import MainProcess
from ahmss.world.client import WorldClient
from ahmss.world.process import ServerProcess
from ahmss.world.recording import Reader
from ahmss.world.schema import NewObject
from ahmss.world.view import World
from tests.main.conftest import make_workspace
from tests.main.ground import steps

pytestmark = pytest.mark.usefixtures("pool")

TWO = """
human ken body ken at 0 0
human aiko body aiko at 0 1 facing -90
add box as b at 0.3 0.5 1
add box as c at 0.3 -0.2 1
ken: do b take patience=0 frames 20
aiko: do b take frames 20 with c wave frames 30 after 5
sync
ken: do b shake frames 20
aiko: do c take frames 20
aiko: wait 0.2
ken: do b drop frames 10
ken: do c bow frames 20
"""


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory, pool: None) -> list[Path]:
    """The script of two, played twice: recordings."""
    del pool
    home = tmp_path_factory.mktemp("played")
    workspace, script = make_workspace(home / "workspace"), home / "two.txt"
    script.write_text(TWO)
    recordings = [home / "1.rec", home / "2.rec"]
    for recording in recordings:
        report = play_script(script, PlaySetup(fast=True, seed=1, record=recording, workspace=workspace))
        # Both take one box in the same frame: the first by name has it, the other is told.
        ken, aiko = (main["messages"] for main in report.mains)
        assert aiko == []
        assert ken[0] == "b take: b is held by aiko; wait until it is let go"
    return recordings


def test_two_humans_play_the_same_twice(played: list[Path]) -> None:
    first, second = (recording.read_bytes() for recording in played)
    assert first == second
    with Reader(played[0]) as reader:
        for name in ("ken", "aiko"):
            rotations, _, _ = motion_of(reader, name)
            assert len(rotations) > 30
            assert np.abs(rotations[-1] - rotations[0]).max() > 0.1


@pytest.mark.parametrize("names", [("ada", "bea"), pytest.param(("ada", "bea", "cay", "dan"), marks=pytest.mark.long)])
def test_nobody_begins_before_the_scene_is_there_in_real_time_too(
    names: tuple[str, ...], workspace: Path, tmp_path: Path
) -> None:
    lines = ["add box as b at 0.3 0 1"]
    lines += [f"human {name} body ken at {i} 0" for i, name in enumerate(names)]
    lines += [f"{name}: do b wave frames 5" for name in names]
    script = tmp_path / "many.txt"
    script.write_text("\n".join(lines))
    report = play_script(script, PlaySetup(workspace=workspace))
    assert [main["messages"] for main in report.mains] == [[]] * len(names)


def test_a_recording_is_played_back_into_a_server(played: list[Path], tmp_path: Path) -> None:
    original, copy = played[0], tmp_path / "copy.rec"
    done = run("play", str(original), "--record", str(copy))
    assert done.returncode == 0, done.stderr
    with Reader(original) as reader, Reader(copy) as again:
        for name in ("ken", "aiko"):
            there, here = motion_of(reader, name)[0], motion_of(again, name)[0]
            assert len(here) > 0.5 * len(there)
        last, shown = World(), World()
        reader.show(len(reader) - 1, last)
        ticks = [tick for tick in range(len(again)) if len(again.scene(tick).humans) == 2]
        again.show(ticks[-1], shown)
        assert shown.objects.keys() == last.objects.keys()
        for name in last.objects:
            assert np.abs(shown.pose(name) - last.pose(name)).max() < 1e-6


def run(*arguments: str, given: str = "", directory: Path | None = None) -> subprocess.CompletedProcess[str]:
    """`ahmss` with these arguments."""
    return subprocess.run(
        [sys.executable, "-m", "ahmss", *arguments], input=given, capture_output=True, text=True, timeout=50,
        cwd=directory, check=False,
    )  # fmt: skip


@dataclass(frozen=True)
class Done:
    """What a command ended with, and wrote."""

    returncode: int
    stdout: str
    stderr: str


@pytest.fixture
def typed(monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]) -> Callable[..., Done]:
    """`ahmss` with these arguments, in this process: there all that it imports is here already."""

    def run_here(*arguments: str) -> Done:
        capfd.readouterr()
        with monkeypatch.context() as patched:
            patched.setattr(sys, "argv", ["ahmss", *arguments])
            with pytest.raises(SystemExit) as end:
                cli.main()
        code = end.value.code
        return Done(code if isinstance(code, int) else int(code is not None), *capfd.readouterr())

    return run_here


def test_a_script_that_fails_says_where_and_ends_with_1(workspace: Path, tmp_path: Path) -> None:
    script = tmp_path / "one.txt"
    script.write_text("human ken body ken\nadd box as b at 0.3 0 1\ndo b fly\ndo b wave frames 5\n")
    done = run("play", str(script), "--fast", "--workspace", str(workspace))
    assert done.returncode == 1
    assert f'{script}:3: b does not afford "fly"; it affords: wave' in done.stderr
    assert "Traceback" not in done.stderr


def test_a_main_that_can_not_begin_is_a_failure_in_the_summary(
    workspace: Path, tmp_path: Path, typed: Callable[..., Done]
) -> None:
    script = tmp_path / "one.txt"
    script.write_text("human ken body nobody\n")
    done = typed("play", str(script), "--fast", "--workspace", str(workspace))
    assert done.returncode == 1
    assert 'no human "nobody"' in done.stderr
    assert "ken: 0 frames in 0.0 s" in done.stdout
    assert done.stdout.splitlines()[0].endswith("1 failure")
    assert "fault of the program" not in done.stderr


def test_a_recording_that_can_not_be_kept_costs_no_summary(workspace: Path, tmp_path: Path) -> None:
    script = tmp_path / "one.txt"
    script.write_text("human ken body ken\nadd box as b at 0.3 0 1\ndo b wave frames 300\n")
    command = [sys.executable, "-m", "ahmss", "play", str(script), "--fast", "--record", str(tmp_path / "run.rec")]
    done = subprocess.run(
        ["sh", "-c", 'ulimit -f 200; trap "" XFSZ; exec "$@"', "sh", *command, "--workspace", str(workspace)],
        capture_output=True, text=True, timeout=50, check=False,
    )  # fmt: skip
    assert done.returncode == 1, done.stderr
    assert "ken: 3" in done.stdout
    assert "0 failures" in done.stdout
    assert "run.rec" in done.stdout.splitlines()[-1]


def test_the_server_may_be_killed_and_come_back_in_mid_motion(
    tmp_path: Path, server: Callable[..., ServerProcess], join: Callable[..., MainProcess]
) -> None:
    directory = tmp_path / "world"
    first = server(directory=directory)
    main = join(first)
    main.play(steps("add box as b at 0.3 0 1", "do b take frames 10"))
    for step in steps("do b shake frames 150"):
        main.agenda.add(step)
    over = False
    frames = threading.Thread(target=main.run, args=(lambda: over,))
    frames.start()
    try:
        time.sleep(0.3)
        first.kill()
        time.sleep(0.3)
        server(address=first.address, directory=directory)
        deadline = time.monotonic() + 20.0
        while not (main.agenda.done and main.communication.client.connected) and time.monotonic() < deadline:
            time.sleep(0.05)
        time.sleep(0.5)
    finally:
        over = True
        frames.join()
    assert main.agenda.done
    main.communication.client.refresh()
    world = main.communication.world
    assert world.objects["b"].holder == "ken"
    assert np.abs(world.pose("b") - main.communication.pose("b")).max() < 1e-6
    _, seen = world.human("ken")
    assert np.abs(seen - main.blending.rotations).max() < 1e-6
    assert main.report.late < main.report.frames


def test_a_server_that_forgot_the_world_does_not_freeze_the_human(
    server: Callable[..., ServerProcess], join: Callable[..., MainProcess]
) -> None:
    first = server()
    main = join(first)
    main.play(steps("add box as b at 0.3 0 1", "do b take frames 10"))
    over = False
    frames = threading.Thread(target=main.run, args=(lambda: over,))
    frames.start()
    try:
        first.kill()
        time.sleep(0.3)
        server(address=first.address)
        deadline = time.monotonic() + 20.0
        while main.control.holds and time.monotonic() < deadline:
            time.sleep(0.05)
        for step in steps("add box as b at 0.3 0 1", "do b wave frames 20", "do b take frames 10"):
            main.agenda.add(step)
        while not main.agenda.done and time.monotonic() < deadline:
            time.sleep(0.05)
        time.sleep(0.5)
    finally:
        over = True
        frames.join()
    assert main.control.holds == {"b": "right"}
    main.communication.client.refresh()
    world = main.communication.world
    assert world.objects["b"].holder == "ken"
    _, seen = world.human("ken")
    assert np.abs(seen - main.blending.rotations).max() < 1e-6
    assert len(main.report.messages) <= 3, main.report.messages


def test_a_recording_begins_when_the_scene_is_set(workspace: Path, tmp_path: Path) -> None:
    script = tmp_path / "two.txt"
    script.write_text(TWO.replace("ken: do b take", "add box as d\nremove d\nadd box as e at 0 2 0\nken: do b take", 1))
    play_script(script, PlaySetup(fast=True, record=tmp_path / "1.rec", workspace=workspace))
    world = World()
    with Reader(tmp_path / "1.rec") as reader:
        reader.show(0, world)
        assert set(world.objects) == {"b", "c", "e"}
        assert set(world.humans) == {"ken", "aiko"}


def test_a_script_that_was_played_before_on_this_server_says_so_in_one_sentence_and_begins_afresh_where_asked(
    workspace: Path, server: Callable[..., ServerProcess], tmp_path: Path, typed: Callable[..., Done]
) -> None:
    script = tmp_path / "one.txt"
    script.write_text("add box as b at 0.3 0 1\nhuman ken body ken at 0 0\ndo b wave frames 5\n")
    address = server().address
    arguments = ("play", str(script), "--server", address, "--workspace", str(workspace))
    first = typed(*arguments)
    assert first.returncode == 0, first.stderr
    again = typed(*arguments)
    assert again.returncode == 1
    assert f"one.txt:1: the world at {address} has b already" in again.stderr
    assert "--fresh" in again.stderr
    assert len(again.stderr.splitlines()) == 1
    with WorldClient(address) as client:  # what was taken out of an object keeps its name
        client.add([NewObject("b/part", "box", (2.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))])
    afresh = typed(*arguments, "--fresh")
    assert afresh.returncode == 0, afresh.stderr
    with WorldClient(address) as client:
        assert list(client.refresh().objects) == ["b"]


def test_a_script_that_takes_away_what_it_adds_can_be_played_again(
    workspace: Path, server: Callable[..., ServerProcess], tmp_path: Path, typed: Callable[..., Done]
) -> None:
    script = tmp_path / "one.txt"
    script.write_text("human ken body ken at 0 0\nremove box\nadd box at 0.3 0 1\ndo box wave frames 5\n")
    address = server().address
    with WorldClient(address) as client:
        client.add([NewObject("box", "box")])
    done = typed("play", str(script), "--server", address, "--workspace", str(workspace))
    assert done.returncode == 0, done.stderr


def _listens_to_interrupts() -> None:
    """A program that is started in the background is born deaf to them."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def test_interrupt_stops_the_motion_and_not_the_console(workspace: Path, server: Callable[..., ServerProcess]) -> None:
    address = server().address
    command = [sys.executable, "-m", "ahmss", "main", "--server", address, "--workspace", str(workspace)]
    console = subprocess.Popen(
        [*command, "--human", "ken"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        preexec_fn=_listens_to_interrupts,
    )  # fmt: skip
    assert console.stdin is not None
    assert console.stdout is not None
    try:
        console.stdin.write("add box as b at 0.3 0 1\nwait 600\n")
        console.stdin.flush()
        for line in console.stdout:
            if "wait 600" in line:
                break
        time.sleep(0.3)
        os.kill(console.pid, signal.SIGINT)
        rest, _ = console.communicate("stop\nremove b\nquit\n", timeout=30)
    finally:
        console.kill()
        console.wait()
    assert rest.count("stopped") == 2  # as it was interrupted, and as `stop` was typed
    assert "b is gone" in rest
    assert console.returncode == 0


def test_the_dialogue_runs_over_a_pipe(workspace: Path, server: Callable[..., ServerProcess]) -> None:
    answers = [
        "add",
        "box",
        "0.3 0 1",
        "",
        "box",
        "wave",
        "10",
        "yes",
        "3",
        "box",
        "bow",
        "",
        "undo",
        "10",
        "no",
        "help",
    ]
    done = run("main", "--server", server().address, "--workspace", str(workspace), given="\n".join(answers))
    assert done.returncode == 0, done.stdout
    text = done.stdout
    order = [
        "object to add> box", "position (x y [z] in metres)> 0.3 0 1", "box is in the world", "object> box",
        "what to do with box> wave", "number of frames (nothing for 20)> 10",
        "fuse with another motion? (yes, or nothing for no)> yes",
        "start the next motion after how many frames", "what to do with box> bow", "> undo", "> 10", "> no", "> help",
    ]  # fmt: skip
    at = 0
    for words in order:
        assert words in text[at:], words
        at = text.index(words, at) + len(words)


def test_the_console_lists_the_objects_when_they_change_and_says_when_a_motion_ends(
    workspace: Path, server: Callable[..., ServerProcess]
) -> None:
    lines = "add box as b at 0.3 0 1\ndo b wave frames 10\nset b lid open\nwait 0.1\ndo b fly\nlist\n"
    done = run("main", "--server", server().address, "--workspace", str(workspace), given=lines)
    text = done.stdout
    assert text.count("objects in the world") == 3  # at the start, with the box in it, and when asked for
    assert text.index("b wave: 0.2 s") < text.index("b wave: done") < text.index("b lid is open")
    assert "b fly: done" not in text


@pytest.mark.parametrize(
    ("arguments", "code", "error"),
    [
        (["play", "nothing.txt"], 1, "nothing.txt: can't be read as a script: No such file or directory"),
        (["play"], 2, "Missing argument"),
        (["view", "nothing.rec", "--snapshot", "a.png"], 1, "nothing.rec"),
        (["main", "--server", "localhost:x"], 1, '"x" is no port'),
        (["list", "nothing"], 1, 'no list "nothing"; type objects or humans or algorithms, or a kind of object to see'),
        (["new", "object", "cup"], 1, "exists already"),
        (["view", "--size", "big"], 2, '"big" is no size'),
    ],
)
def test_an_error_is_one_sentence_and_a_code(
    arguments: list[str], code: int, error: str, typed: Callable[..., Done]
) -> None:
    done = typed(*arguments)
    assert done.returncode == code
    assert error in " ".join(done.stderr.replace("│", " ").split())
    assert "Traceback" not in done.stderr


def test_the_version_and_where_errors_come_from_are_offered(typed: Callable[..., Done]) -> None:
    assert typed("--version").stdout == f"ahmss {ahmss.__version__}\n"
    assert {"--version", "--debug"} <= set(typed("--help").stdout.split())
    assert "Traceback" in run("play", "nothing.txt", "--debug").stderr


def test_the_list_tells_what_is_wrong_with_a_kind(workspace: Path, typed: Callable[..., Done]) -> None:
    (workspace / "objectdb" / "loop").mkdir()
    (workspace / "objectdb" / "loop" / "object.toml").write_text('name = "loop"\n[[contains]]\nkind = "loop"\n')
    fault = "objectdb/loop/object.toml: contains[0].kind: a circle: loop contains loop; take one of them out"
    box, loop = json.loads(typed("list", "objects", "--json", "--workspace", str(workspace)).stdout)["objects"]
    assert "error" not in box
    assert loop["error"] == fault
    assert f"loop\t{fault}" in typed("list", "objects", "--workspace", str(workspace)).stdout.splitlines()


def test_lists_and_checks_are_json_where_asked(workspace: Path, typed: Callable[..., Done]) -> None:
    kinds = json.loads(typed("list", "--json", "--workspace", str(workspace)).stdout)
    assert [kind["name"] for kind in kinds["objects"]] == ["box"]
    actions = json.loads(typed("list", "box", "--json", "--workspace", str(workspace)).stdout)
    assert "wave" in {action["action"] for action in actions["box"]}
    checked = typed("check", "--json", "--workspace", str(workspace))
    assert checked.returncode == 0, checked.stdout
    assert json.loads(checked.stdout)["problems"] == []
    found = json.loads(typed("doctor", "--json").stdout)
    assert {"what", "ok", "found", "cure", "needed"} <= found["findings"][0].keys()
