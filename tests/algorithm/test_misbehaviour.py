"""Programs that misbehave: each is one clear sentence and then gone, and another motion goes on beside it."""

from __future__ import annotations

import os
import re
import signal

import pytest
from algorithm_rig import Entry, failure, frame, gone, object_frame, peer, play, wait_for

from ahmss.errors import AlgorithmError
from ahmss.processes.answers import Answer, Note, Phase
from ahmss.processes.deadlines import Deadlines
from ahmss.processes.launcher import Launcher
from ahmss.processes.silence import threads_of

SENTENCES = {
    "crashes": "crashes at frame 30: it was killed by SIGABRT before its motion was over; "
    'its log ends with "the reason is in this line"',
    "exits": "exits at frame 30: it ended with exit code 7 before its motion was over",
    "hangs": "hangs at frame 3: it gave no pose within 0.5 s",
    "loops": "loops at frame 3: it gave no pose within 0.5 s",
    "stops": "stops at frame 3: it gave no pose within 0.5 s",
    "writes_garbage": r"writes_garbage at frame 3: it sent a message that would be 50462976 bytes long \(does it print",
    "prints": r"prints at frame 3: it sent a message that would be 1819043176 bytes long \(does it print",
    "wrong_size": "wrong_size at frame 3: its POSE is 2072 bytes long, not 2080 or 2176",
    "half_a_way": "half_a_way at frame 3: its POSE is 2128 bytes long, not 2080 or 2176",
    "way_to_nowhere": "way_to_nowhere at frame 3: number 7 of its way is nan; metres are expected, or NaN for all",
    "not_a_number": "not_a_number at frame 3: number 100 of its pose is nan",
    "infinite_root": "infinite_root at frame 3: number 2 of its pose is inf",
    "length_two": "length_two at frame 3: the rotation of hips has length 2, not 1",
    "negative_importance": "negative_importance at frame 3: the importance of root is -1; it can't be negative",
    "heavy_target": "heavy_target at frame 3: the weight of target right_hand is 2; 0 to 1 is allowed",
    "wrong_frame": "wrong_frame at frame 3: it sent frame 7 where frame 3 was asked for",
    "too_eager": "it sent (a frame though none was asked for|frame 4 where frame 5 was asked for)",
    "wrong_kind": "wrong_kind at frame 3: it sent a message of kind 18; "
    "READY, POSE, STATE, NOTE, ARRIVED, MEANT, DONE and ERROR are allowed",
    "bad_state": "bad_state at frame 3: STATE: Expected `int`, got `str`",
    "half_a_message": "half_a_message at frame 3: it ended with exit code 0 before its motion was over",
    "closes_output": "closes_output at frame 3: it closed its standard output before its motion was over",
    "says_error": "says_error at frame 3: the cup is out of reach",
    "other_version": "other_version at frame 1: READY is of protocol version 99; this main speaks version 1",
}


@pytest.mark.parametrize("how", SENTENCES)
def test_a_misbehaving_program_is_dropped_with_one_sentence(launcher, make_start, how):
    process = launcher.start(peer(how), make_start())
    sentence = failure(launcher, process, 40)
    assert re.search(SENTENCES[how], sentence)
    assert "\n" not in sentence
    assert process.phase is Phase.FAILED
    assert process.receive() == []  # said once
    process.ask(frame(31))  # and nothing more happens
    assert wait_for(lambda: launcher.tend() or not launcher.processes)


def test_a_good_motion_beside_bad_ones_gets_all_of_its_frames(launcher, make_start):
    good = launcher.start(peer("good"), make_start(frames=40))
    bad = [launcher.start(peer(how), make_start()) for how in ("crashes", "hangs", "length_two", "floods_log")]
    answers, failures = [], []
    for k in range(1, 41):
        for process in (good, *bad):
            if not process.pending:
                process.ask(frame(k))
        assert launcher.wait([good, *bad] if k < 3 else [good], 30.0)
        answers += [m for m in good.receive() if isinstance(m, Answer)]
        for process in bad:
            try:
                process.receive()
            except AlgorithmError as error:
                failures.append(str(error))
        launcher.tend()
    assert [answer.k for answer in answers] == list(range(1, 41))
    assert any("length_two" in failure for failure in failures)


def test_a_slow_start_is_waited_for(launcher, make_start):
    process = launcher.start(peer("starts_slowly", "1"), make_start(frames=3))
    process.ask(frame(1))
    assert not launcher.wait([process], 0.1)
    assert process.receive() == []
    assert process.phase is Phase.STARTING
    assert launcher.wait([process], 20.0)
    assert [m.k for m in process.receive()] == [1]


@pytest.mark.skipif(threads_of(os.getpid()) is None, reason="this system does not say who waits")
def test_one_that_gets_no_processor_is_waited_for_and_one_that_hangs_beside_it_is_not(launcher, make_start):
    starved = launcher.start(
        peer("is_starved"), make_start(frames=4)
    )  # at frame 3 for far longer than it may be silent
    hangs = launcher.start(peer("hangs"), make_start(frames=4))
    for process in (starved, hangs):
        assert [m.k for m in play(launcher, process, 2)] == [1, 2]
        process.ask(frame(3))
    launcher.wait([hangs], 30.0)
    with pytest.raises(AlgorithmError, match=r"hangs at frame 3: it gave no pose within 0\.5 s"):
        hangs.receive()
    assert starved.receive() == []
    assert starved.pending == 3
    assert launcher.wait([starved], 30.0)
    assert [m.k for m in starved.receive()] == [3]


def test_notes_are_told_once_each_and_fail_nothing(launcher, make_start):
    process = launcher.start(peer("notes"), make_start(frames=3))
    said = [m for m in play(launcher, process, 3) if isinstance(m, Note)]
    assert said == [Note("a note of two lines"), Note("another")]
    assert wait_for(lambda: (process.receive() and False) or process.phase is Phase.DONE)


def test_a_flood_of_notes_is_bounded(launcher, make_start):
    process = launcher.start(peer("floods_notes"), make_start(frames=3))
    said = play(launcher, process, 3)
    assert [m.k for m in said if isinstance(m, Answer)] == [1, 2, 3]
    assert [m.text for m in said if isinstance(m, Note)] == [f"note {i}" for i in range(20)]


def test_one_that_never_speaks_is_given_up(make_start):
    with Launcher(warm=False, deadlines=Deadlines(start=0.3, stop=0.1)) as launcher:
        process = launcher.start(peer("silent"), make_start())
        process.ask(frame(1))
        launcher.wait([process], 20.0)
        with pytest.raises(AlgorithmError, match=r"silent at frame 1: it did not answer within 0\.3 s of its start"):
            process.receive()


def test_one_that_ignores_sigterm_is_killed(launcher, make_start):
    process = launcher.start(peer("ignores_sigterm"), make_start())
    assert len(play(launcher, process, 3)) == 3
    process.stop()
    assert process.phase is Phase.STOPPED
    assert wait_for(lambda: launcher.tend() or process.ended)


def test_a_flood_of_log_lines_blocks_nobody_and_is_bounded(launcher, make_start):
    process = launcher.start(peer("floods_log"), make_start(frames=5))
    assert [m.k for m in play(launcher, process, 5)][:5] == [1, 2, 3, 4, 5]
    assert process.stderr_tail().endswith("still here\n")
    assert len(process.stderr_tail()) < 20_000


def test_what_a_program_left_running_is_ended_with_it(launcher, make_start):
    process = launcher.start(peer("leaves_child"), make_start())
    assert re.search("exit code 3", failure(launcher, process, 4))
    child = int(process.stderr_tail())
    assert wait_for(lambda: launcher.tend() or gone(child))


def test_one_that_forgets_to_say_done_is_done_after_its_last_frame(launcher, make_start):
    process = launcher.start(peer("no_done"), make_start(frames=3))
    play(launcher, process, 3)
    assert wait_for(lambda: (process.receive() and False) or process.phase is Phase.DONE)


def test_a_shell_script_that_does_not_know_the_protocol_is_dropped(launcher, make_start):
    process = launcher.start(Entry("shell", ("./shell.sh",)), make_start())
    sentence = r"shell at frame 1: it sent a message .* \(does it print to its standard output\?\)"
    assert re.search(sentence, failure(launcher, process, 1))


@pytest.mark.parametrize(
    ("content", "mode", "reason"),
    [
        (None, 0, "there is no such program"),
        ("#!/bin/sh\n", 0o600, "it may not be executed"),
        ("echo no line that names a shell\n", 0o700, "it is no program for this machine"),
        ("#!/no/such/shell\n", 0o700, "the program that its #! line names"),
    ],
)
def test_a_program_that_cannot_be_started_says_why(launcher, make_start, tmp_path, content, mode, reason):
    program = tmp_path / "program"
    if content is not None:
        program.write_text(content)
        program.chmod(mode)
    before = len(os.listdir("/proc/self/fd"))
    with pytest.raises(AlgorithmError, match=reason):
        launcher.start(Entry("program", ("./program",), tmp_path), make_start())
    assert len(os.listdir("/proc/self/fd")) == before


def test_prints_go_to_the_log(warm_launcher, make_start):
    process = warm_launcher.start(Entry("prints", ("python", "prints.py")), make_start(frames=5))
    messages = play(warm_launcher, process, 5)
    assert [m.k for m in messages if isinstance(m, Answer)] == [1, 2, 3, 4, 5]
    assert "printed before run\nprinted at the start\nprinted by a child\nprinted at frame 1" in process.stderr_tail()


def test_an_exception_names_its_line_and_leaves_its_traceback_in_the_log(warm_launcher, make_start):
    process = warm_launcher.start(Entry("raises", ("python", "raises.py")), make_start())
    assert re.search(r"raises at frame 30: KeyError: 'haed' \(raises.py:8\)", failure(warm_launcher, process, 40))
    assert "Traceback" in process.stderr_tail()


def test_what_a_library_raises_names_the_line_that_asked_it(warm_launcher, make_start, tmp_path):
    (tmp_path / "asks.py").write_text(
        "import numpy as np\nfrom ahmss.algorithm import run\n\ndef asks(task):\n"
        "    yield task.pose({'head': np.sinn(1.0)})\n\nrun(asks)\n"
    )
    process = warm_launcher.start(Entry("asks", ("python", "asks.py"), tmp_path), make_start())
    sentence = r"asks at frame 1: AttributeError: .*'sinn' \(asks.py:5\)"
    assert re.search(sentence, failure(warm_launcher, process, 1))


def test_a_syntax_error_names_file_and_line(warm_launcher, make_start, tmp_path):
    (tmp_path / "broken.py").write_text("def broken(task)\n    return\n")
    process = warm_launcher.start(Entry("broken", ("python", "broken.py"), tmp_path), make_start())
    sentence = r"broken at frame 1: SyntaxError: expected ':' \(broken.py, line 1\)"
    assert re.search(sentence, failure(warm_launcher, process, 1))


def test_a_missing_python_file_is_one_sentence(warm_launcher, make_start):
    process = warm_launcher.start(Entry("missing", ("python", "missing.py")), make_start())
    assert re.search(r"missing at frame 1: .*No such file.*missing.py", failure(warm_launcher, process, 1))


def test_a_python_algorithm_that_computes_for_ever_is_killed(warm_launcher, make_start):
    process = warm_launcher.start(Entry("holds", ("python", "holds.py")), make_start("object"))
    messages = play(warm_launcher, process, 2, object_frame)
    assert [m.k for m in messages] == [1, 2]
    process.ask(object_frame(3))
    assert not warm_launcher.wait([process], 0.2)
    process.fail("it was too slow for this test")
    with pytest.raises(AlgorithmError, match="holds at frame 3: it was too slow for this test"):
        process.receive()
    assert wait_for(lambda: warm_launcher.tend() or process.ended)


def test_a_native_program_gets_the_signals_that_it_expects(launcher, make_start, tmp_path):
    """SIGPIPE and SIGINT are at their defaults, whatever Python has made of them for itself."""
    program = tmp_path / "mask.sh"
    program.write_text("#!/bin/sh\ngrep SigIgn /proc/self/status >&2\n")
    program.chmod(0o700)
    process = launcher.start(Entry("mask", ("./mask.sh",), tmp_path), make_start())
    failure(launcher, process, 1)
    ignored = int(process.stderr_tail().split()[1], 16)
    assert not ignored & (1 << signal.SIGPIPE - 1)
    assert not ignored & (1 << signal.SIGINT - 1)
