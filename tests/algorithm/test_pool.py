"""The pool of warm Python processes: shared, private, replaced when it is gone, and leaving nothing behind."""

from __future__ import annotations

import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time
from pathlib import Path

import msgspec
import numpy as np
import pytest
from algorithm_rig import PEERS, Entry, failure, frame, gone, play, wait_for, walk_clip

from ahmss.errors import AlgorithmError
from ahmss.motion.clip import Clip, save
from ahmss.processes.answers import Answer, Note, Phase
from ahmss.processes.child import Request
from ahmss.processes.deadlines import Deadlines
from ahmss.processes.hire import Pool
from ahmss.processes.launcher import Launcher
from ahmss.processes.runtime import Meeting, private_directory, sweep
from ahmss.walking.catalogue import STRAIGHT
from ahmss.walking.library import Library
from ahmss.walking.library import save as save_library

SLOW_MACHINE = Deadlines(start=20.0, frame=10.0, stop=0.5)


def tells(*arguments: str) -> Entry:
    return Entry("tells", ("python", "tells.py", *arguments))


def facts(launcher, process):
    """What the algorithm said of its process."""
    process.ask(frame(1))
    assert launcher.wait([process], 20.0)
    process.receive()
    return json.loads(process.stderr_tail().splitlines()[0])


@pytest.fixture
def own_pool(tmp_path):
    """A pool of this test alone, that ends soon when unused."""
    made = Pool(Meeting(tmp_path, "test"), linger=0.5)
    yield made
    made.close()


def launcher_of(pool: Pool, complaints=None) -> Launcher:
    made = Launcher(warm=False, deadlines=SLOW_MACHINE, notice=(complaints or []).append)
    made._pool = Pool(pool.meeting, linger=0.5)
    return made


def test_algorithms_come_from_one_pool_in_sessions_of_their_own(warm_launcher, make_start):
    first, second = (warm_launcher.start(tells("one", "two"), make_start()) for _ in range(2))
    told, other = facts(warm_launcher, first), facts(warm_launcher, second)
    assert told["pid"] != other["pid"]
    assert told["parent"] == other["parent"] != os.getpid()
    assert told["session"] == told["pid"]  # so that Ctrl-C at the console does not reach it
    assert told["directory"] == str(PEERS)
    assert told["argv"] == [str(PEERS / "tells.py"), "one", "two"]
    assert told["threads"] == 1
    assert not told["zmq"]


def test_an_algorithm_holds_no_descriptor_of_its_siblings(warm_launcher, make_start):
    processes = [warm_launcher.start(tells(), make_start()) for _ in range(4)]
    for process in processes:
        descriptors = facts(warm_launcher, process)["descriptors"]
        assert len(descriptors) == 5  # 0, 1, 2, the output, and the one that lists them
        assert descriptors[:4] == [0, 1, 2, 3]


def test_main_has_no_descriptor_more_after_a_motion(warm_launcher, make_start):
    def motion():
        process = warm_launcher.start(tells(), make_start(frames=2))
        play(warm_launcher, process, 2)
        assert wait_for(lambda: warm_launcher.tend() or process.ended)

    motion()
    before = sorted(os.listdir("/proc/self/fd"))
    motion()
    assert sorted(os.listdir("/proc/self/fd")) == before


def test_two_mains_share_the_pool(warm_launcher, make_start):
    mine = facts(warm_launcher, warm_launcher.start(tells(), make_start()))["parent"]
    program = (
        "import sys; sys.path.insert(0, sys.argv[1])\n"
        "from ahmss.processes.hire import Pool\n"
        "pool = Pool(); print(pool.meeting.socket)"
    )
    theirs = subprocess.run([sys.executable, "-c", program, "."], capture_output=True, text=True, check=True)
    assert theirs.stdout.strip() == str(Pool().meeting.socket)
    assert f"{theirs.stdout.strip()}".encode() in Path(f"/proc/{mine}/cmdline").read_bytes()


def test_a_changed_file_is_seen_at_the_next_start(warm_launcher, make_start, tmp_path):
    program = tmp_path / "grows.py"
    entry = Entry("grows", ("python", "grows.py"), tmp_path)
    for weight in (0.25, 0.5):
        program.write_text(
            "from ahmss.algorithm import run\n"
            f"run(lambda task: (task.pose({{}}, importance={{'head': {weight}}}) for _ in task.frames()))\n"
        )
        process = warm_launcher.start(entry, make_start(frames=1))
        (answer,) = (m for m in play(warm_launcher, process, 1) if isinstance(m, Answer))
        assert answer.row[176 + 2] == weight


def test_a_module_beside_the_algorithm_is_found(warm_launcher, make_start, tmp_path):
    (tmp_path / "weights.py").write_text("HEAD = 0.75\n")
    (tmp_path / "uses.py").write_text(
        "from weights import HEAD\nfrom ahmss.algorithm import run\n"
        "run(lambda task: (task.pose({}, importance={'head': HEAD}) for _ in task.frames()))\n"
    )
    process = warm_launcher.start(Entry("uses", ("python", "uses.py"), tmp_path), make_start(frames=1))
    (answer,) = (m for m in play(warm_launcher, process, 1) if isinstance(m, Answer))
    assert answer.row[176 + 2] == 0.75


def test_a_clip_reaches_the_algorithm(warm_launcher, make_start, tmp_path):
    rotations = np.tile([1.0, 0.0, 0.0, 0.0], (12, 43, 1))
    clip = Clip(rotations, np.zeros((12, 3)), np.ones((12, 44)), np.ones((12, 2)), 60.0)
    save(clip, tmp_path / "wave.npz")
    for _ in range(2):
        process = warm_launcher.start(tells(), make_start(motion=str(tmp_path / "wave.npz")))
        assert facts(warm_launcher, process)["clip"] == 12


def test_a_walk_library_reaches_the_algorithm(warm_launcher, make_start, tmp_path):
    save_library(Library("tester", 0.9, {STRAIGHT: walk_clip()}), tmp_path / "walk.npz")
    for _ in range(2):
        process = warm_launcher.start(tells(), make_start(frames=0, motion=str(tmp_path / "walk.npz")))
        assert facts(warm_launcher, process)["walk"] == ["straight"]


def test_what_is_prepared_is_read_ahead_and_not_run(own_pool, make_start, tmp_path):
    (tmp_path / "walks.py").write_text("import shapely\nopen('it-ran', 'w').close()\n")
    save_library(Library("tester", 0.9, {STRAIGHT: walk_clip()}), tmp_path / "walk.npz")
    with launcher_of(own_pool) as launcher:
        assert not facts(launcher, launcher.start(tells(), make_start()))["shapely"]
        launcher.prepare(Entry("walks", ("python", "walks.py"), tmp_path), tmp_path / "walk.npz")
        assert wait_for(lambda: facts(launcher, launcher.start(tells(), make_start()))["shapely"])
        launcher.prepare(Entry("native", ("nod",), tmp_path), tmp_path / "walk.npz")  # of which nothing can be read
        launcher.prepare(Entry("gone", ("python", "gone.py"), tmp_path), tmp_path / "gone.npz")
        assert facts(launcher, launcher.start(tells(), make_start()))["pid"]
    assert not (tmp_path / "it-ran").exists()


def test_what_may_be_started_some_time_is_read_ahead_however_much_it_is(own_pool, make_start, tmp_path):
    programs = [Entry(f"p{i}", ("python", f"p{i}.py"), tmp_path) for i in range(40)]
    for entry in programs:
        (tmp_path / entry.argv[1]).write_text("import json\n")
    (tmp_path / "p39.py").write_text("import shapely\nopen('it-ran', 'w').close()\n")
    with launcher_of(own_pool) as launcher:
        assert not facts(launcher, launcher.start(tells(), make_start()))["shapely"]
        launcher.expect((entry, None, 0) for entry in [Entry("native", ("nod",), tmp_path), *programs])
        assert wait_for(lambda: facts(launcher, launcher.start(tells(), make_start()))["shapely"])
    assert not (tmp_path / "it-ran").exists()


def test_what_hands_will_ask_of_shapes_is_made_beside_all_else(own_pool, tmp_path, make_start, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))  # of main alone: the pool has been there before
    fields = tmp_path / "cache" / "ahmss" / "fields"
    with launcher_of(own_pool) as launcher:
        launcher.foresee(Path(__file__).resolve().parents[2], ["no such kind", "cup"])
        launcher.foresee(tmp_path / "gone", ["cup"])
        assert wait_for(lambda: fields.is_dir() and any(path.stat().st_size for path in fields.iterdir()), 60.0)
        assert facts(launcher, launcher.start(tells(), make_start()))["pid"]


def test_notes_come_before_the_pose_the_end_and_the_error(warm_launcher, make_start, tmp_path):
    (tmp_path / "says.py").write_text(
        "from ahmss.algorithm import run\ndef says(task):\n    task.note('one')\n    yield task.pose({})\n"
        "    task.note('two')\n    if task.hand == 'left':\n        raise ValueError('too far')\nrun(says)\n"
    )
    for hand in ("right", "left"):
        entry = Entry("says", ("python", "says.py"), tmp_path)
        process = warm_launcher.start(entry, make_start(frames=0, hand=hand))
        first = play(warm_launcher, process, 1)
        assert [m.text if isinstance(m, Note) else m.k for m in first] == ["one", 1]
        process.ask(frame(2))
        assert warm_launcher.wait([process], 20.0)
        assert process.receive()[0] == Note("two")
        if hand == "left":
            with pytest.raises(AlgorithmError, match="too far"):
                process.receive()
        else:
            assert process.phase is Phase.DONE


def test_a_python_algorithm_that_crashes_is_told_by_its_signal(warm_launcher, make_start):
    process = warm_launcher.start(tells("abort"), make_start())
    assert "tells at frame 3: it was killed by SIGABRT" in failure(warm_launcher, process, 4)


def test_who_was_asked_by_a_main_that_has_gone_does_not_die_for_it_in_the_service_of_another(own_pool, make_start):
    # A pool ends the workers of a main that is gone, a second later.
    with launcher_of(own_pool) as launcher, open(os.devnull, "r+b", buffering=0) as nowhere:
        request = msgspec.json.encode(Request((str(PEERS / "tells.py"),), str(PEERS)))
        for _ in range(3):
            gone_at_once = own_pool.connect()
            socket.send_fds(gone_at_once, [request], [nowhere.fileno()] * 3)
            gone_at_once.close()
            time.sleep(0.1)  # the pool sees it go
        processes = [launcher.start(tells(), make_start()) for _ in range(8)]
        until = time.monotonic() + 1.5
        for process in processes:
            facts(launcher, process)
        while time.monotonic() < until:
            time.sleep(0.05)
            launcher.tend()
        assert [process.phase for process in processes] == [Phase.RUNNING] * 8, [p.failure for p in processes]


def test_the_waiting_workers_of_a_pool_that_was_killed_end(own_pool, make_start):
    with launcher_of(own_pool) as launcher:
        pool = facts(launcher, launcher.start(tells(), make_start()))["parent"]
        children = Path(f"/proc/{pool}/task/{pool}/children")
        assert wait_for(lambda: len(children.read_text().split()) > 8)
        workers = [int(word) for word in children.read_text().split()]
        os.kill(pool, signal.SIGKILL)
    assert wait_for(lambda: all(gone(worker) for worker in workers))


def test_a_pool_that_was_killed_is_replaced_and_what_ran_goes_on(own_pool, make_start):
    complaints: list[str] = []
    with launcher_of(own_pool, complaints) as launcher:
        running = launcher.start(tells(), make_start(frames=5))
        pool = facts(launcher, running)["parent"]
        os.kill(pool, signal.SIGKILL)
        assert wait_for(lambda: gone(pool))
        later = launcher.start(tells(), make_start())
        assert facts(launcher, later)["parent"] not in (pool, os.getpid())
        for k in range(2, 6):
            running.ask(frame(k))
            assert launcher.wait([running], 20.0)
        assert running.last == 5
        assert wait_for(lambda: launcher.tend() or running.ended)
    assert complaints == []


def test_a_pool_that_was_busy_does_not_take_a_new_main_for_one_that_has_gone(own_pool, make_start):
    """What a pool finds after a pause: one has ended, others were asked for, and the main of the one has closed."""
    with launcher_of(own_pool) as launcher:
        ends = launcher.start(tells(), make_start())
        told = facts(launcher, ends)
        children = Path(f"/proc/{told['parent']}/task/{told['parent']}/children")
        assert wait_for(lambda: len(children.read_text().split()) > 8)
        os.kill(told["parent"], signal.SIGSTOP)
        os.kill(told["pid"], signal.SIGKILL)
        assert wait_for(lambda: gone(told["pid"]))
        others = [launcher.start(tells(), make_start(frames=2)) for _ in range(6)]
        for other in others:  # workers that were waiting do them; the pool will hear of it
            facts(launcher, other)
        ends._child._pool.close()
        os.kill(told["parent"], signal.SIGCONT)
        time.sleep(1.5)  # longer than the children of a main that has gone are let be
        for other in others:
            other.ask(frame(2))
            assert launcher.wait([other], 20.0)
            other.receive()
            assert other.last == 2


def test_the_children_of_a_main_that_was_killed_end(own_pool, make_start, tmp_path):
    """Even one that computes for ever and never sees the end of its input."""
    program = tmp_path / "main.py"
    program.write_text(
        "import sys, time\n"
        f"sys.path.insert(0, {str(Path(__file__).parent)!r})\n"
        "from pathlib import Path\n"
        "from algorithm_rig import *\n"
        "from ahmss.processes.hire import Pool\n"
        "from ahmss.algorithm.messages import PoseRecord, Start\n"
        "from ahmss.processes.runtime import Meeting\n"
        "launcher = Launcher(warm=False)\n"
        f"launcher._pool = Pool(Meeting(Path({str(tmp_path)!r}), 'test'))\n"
        "start = Start(kind='human', frames=60, human=HUMAN.to_record(), pose=PoseRecord.of(ROTATIONS, ROOT))\n"
        "process = launcher.start(Entry('tells', ('python', 'tells.py', 'hang')), start)\n"
        "for k in (1, 2):\n"
        "    process.ask(frame(k)); launcher.wait([process], 20.0); process.receive()\n"
        "process.ask(frame(3))\n"
        "print(process.stderr_tail().splitlines()[0], flush=True)\n"
        "time.sleep(60)\n"
    )
    with subprocess.Popen([sys.executable, str(program)], stdout=subprocess.PIPE, text=True) as main:
        assert main.stdout is not None
        worker = json.loads(main.stdout.readline())["pid"]
        assert not gone(worker)
        main.kill()
        main.wait()
    assert wait_for(lambda: gone(worker))


def test_a_pool_that_nobody_uses_ends(tmp_path):
    meeting = Meeting(tmp_path, "brief")
    pool = Pool(meeting, linger=0.1)
    assert meeting.socket.exists()
    pool.close()
    assert wait_for(lambda: not meeting.socket.exists(), 20.0)
    again = Pool(meeting, linger=0.1)
    assert meeting.socket.exists()
    again.close()
    assert wait_for(lambda: not list(tmp_path.iterdir()), 20.0)


def test_what_killed_pools_left_is_swept_away_and_what_is_used_stays(tmp_path):
    for name in ("dead", "used", "taken"):
        for path in vars(Meeting(tmp_path, name)).values():
            path.touch()
    locks = [Meeting(tmp_path, "used").use(), Meeting(tmp_path, "taken").lock()]
    sweep(tmp_path)
    left = {path.name.partition(".")[0] for path in tmp_path.iterdir()}
    for lock in locks:
        os.close(lock)
    assert left == {"pool-used", "pool-taken"}


def opened(path: Path) -> int:
    """How often this process has the file open."""
    return [os.path.realpath(f"/proc/self/fd/{n}") for n in os.listdir("/proc/self/fd")].count(str(path))


def test_who_waits_for_a_lock_whose_file_is_removed_gets_one_that_counts(tmp_path):
    meeting = Meeting(tmp_path, "busy")
    first = meeting.lock()
    taken: list[int] = []
    other = threading.Thread(target=lambda: taken.append(meeting.lock()))
    other.start()
    assert wait_for(lambda: opened(meeting.making) > 1)
    meeting.remove()
    os.close(first)
    other.join()
    assert os.path.samestat(os.fstat(taken[0]), meeting.making.stat())
    os.close(taken[0])


def test_random_bytes_at_the_pools_socket_do_no_harm(own_pool, make_start):
    for content in (b"", b"\0" * 500, b'{"argv": []}', os.urandom(5000)):
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as stranger:
            stranger.connect(str(own_pool.meeting.socket))
            stranger.send(content)
    with launcher_of(own_pool) as launcher:
        process = launcher.start(tells(), make_start(frames=2))
        assert [m.k for m in play(launcher, process, 2)][:2] == [1, 2]


def test_without_a_pool_python_runs_alone_and_it_is_said_once(make_start, monkeypatch, tmp_path):
    foreign = tmp_path / f"ahmss-{os.getuid()}"
    foreign.mkdir(mode=0o755)
    monkeypatch.delenv("XDG_RUNTIME_DIR", raising=False)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    complaints: list[str] = []
    with Launcher(deadlines=SLOW_MACHINE, notice=complaints.append) as launcher:
        for _ in range(2):
            process = launcher.start(tells(), make_start(frames=2))
            assert facts(launcher, process)["parent"] == os.getpid()
            play_rest = [process.ask(frame(2)), launcher.wait([process], 20.0)]
            assert play_rest[1]
    (complaint,) = complaints
    assert "is not a directory of yours alone" in complaint


def test_a_pool_that_does_not_take_the_request_is_gone_around(make_start, tmp_path):
    """Somebody listens at the socket, takes the connection and hangs up."""
    meeting = Meeting(tmp_path, "deaf")
    complaints: list[str] = []
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as deaf:
        deaf.bind(str(meeting.socket))
        deaf.listen(8)
        launcher = Launcher(warm=False, deadlines=SLOW_MACHINE, notice=complaints.append)
        launcher._pool = Pool(meeting)
        deaf.accept()[0].close()
        with launcher:
            process = launcher.start(tells(), make_start(frames=2))
            deaf.accept()[0].close()
            process.receive()
            deaf.accept()[0].close()
            assert [m.k for m in play(launcher, process, 2)][:2] == [1, 2]
            assert process.phase is Phase.DONE
    (complaint,) = complaints
    assert complaint == "Python algorithms start more slowly, because the pool can't be used: it closed the connection"


def test_the_runtime_directory_must_be_private(monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    assert private_directory().stat().st_mode & 0o777 == 0o700
    (tmp_path / "ahmss").chmod(0o750)
    with pytest.raises(AlgorithmError, match="chmod 700"):
        private_directory()
