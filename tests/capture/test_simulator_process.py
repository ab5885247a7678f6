"""The simulator as a process: lines, signals, typed commands, the configuration; and the ULTRATRAK's datagrams."""

from __future__ import annotations

import os
import select
import signal
import socket
import subprocess
import sys
import termios
import threading
import time
import tty

import numpy as np
import pytest

from ahmss.capture.config import TransmitterConfig, load
from ahmss.capture.formats import liberty, ultratrak
from ahmss.capture.formats.layout import Layout
from ahmss.capture.formats.losses import Losses
from ahmss.capture.simulator.configuration import configuration
from ahmss.capture.simulator.console import Console
from ahmss.capture.simulator.faults import Faults
from ahmss.capture.simulator.options import SimulatorOptions
from ahmss.capture.simulator.run import Simulator
from ahmss.capture.simulator.stage import Stage
from ahmss.errors import CommandError
from tests.capture.simulated import angles_between, subject

PROGRAM = """
import sys
from ahmss.capture.simulator.options import SimulatorOptions
from ahmss.capture.simulator.run import run_simulator
from tests.capture.simulated import subject
run_simulator(SimulatorOptions(subject(), **eval(sys.argv[1])))
"""
LAYOUT = Layout((2, 7, 8, 9, 1))


@pytest.fixture
def started(request):
    """Starts simulators in processes of their own; ends those that a test leaves."""
    children: list[subprocess.Popen[str]] = []

    def start(options: str) -> subprocess.Popen[str]:
        command = [sys.executable, "-c", PROGRAM, options]
        pipe = subprocess.PIPE
        child = subprocess.Popen(command, stdin=pipe, stdout=pipe, stderr=pipe, text=True, cwd=request.config.rootpath)
        children.append(child)
        return child

    yield start
    for child in children:
        if child.poll() is None:
            child.kill()
        child.communicate()


def open_port(path: str) -> int:
    file = os.open(path, os.O_RDWR | os.O_NOCTTY)
    tty.setraw(file)
    settings = termios.tcgetattr(file)
    settings[4] = settings[5] = termios.B115200
    termios.tcsetattr(file, termios.TCSANOW, settings)
    return file


def read(file: int, size: int, seconds: float = 20.0) -> bytes:
    """So many bytes, or fewer where they take too long."""
    data, end = b"", time.monotonic() + seconds
    while len(data) < size and select.select([file], [], [], max(end - time.monotonic(), 0.0))[0]:
        data += os.read(file, size - len(data))
    return data


def say(child, line: str) -> None:
    child.stdin.write(line + "\n")
    child.stdin.flush()


def test_a_process_of_its_own_serves_its_line_in_real_time_and_ends_when_told(started, tmp_path):
    link = tmp_path / "tracker"
    child = started(f"dict(kind='liberty', stations=8, names=(__import__('pathlib').Path({str(link)!r}),))")
    assert child.stdout.readline() == f"line 1: {link} (stations 1 to 8, 115200 baud)\n"
    before = _cpu(child.pid)
    time.sleep(0.3)
    assert _cpu(child.pid) - before <= 0.05  # it sleeps while nobody asks
    file = open_port(str(link))
    os.write(file, b"F1\rO*,2,7,8,9,1\r")
    begun = time.monotonic()
    os.write(file, b"C\r")
    data = read(file, 8_000)
    # A pseudo-terminal would take all of it at once; the line can't have carried more than its ten bits a byte.
    assert time.monotonic() - begun >= 0.95 * len(data) * 10 / 115200
    counts = sorted({reading.count for reading in liberty.parser(LAYOUT).feed(data)})
    carried = (len(counts) - 1) / (counts[-1] - counts[0])
    assert carried == pytest.approx(11520 / (8 * 46) / 60.0, rel=0.06)
    os.close(file)
    child.send_signal(signal.SIGTERM)
    assert child.wait(10) == 0
    assert not link.is_symlink()


def _cpu(pid: int) -> float:
    """Seconds of processor time that a process has used."""
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def test_what_is_typed_breaks_it_and_mends_it_and_ctrl_c_ends_it(started):
    child = started("dict(kind='liberty', stations=2)")
    path = child.stdout.readline().split()[2]
    file = open_port(path)
    os.write(file, b"F1\rO*,2,7,8,9,1\rC\r")
    assert read(file, 460)
    say(child, "nonsense")
    assert "help lists the words" in child.stdout.readline()
    say(child, "weak 2")
    say(child, "status")
    assert "frames" in child.stdout.readline()
    read(file, 460)
    readings = liberty.parser(LAYOUT).feed(read(file, 920))
    assert {(reading.station, reading.status) for reading in readings} == {(1, ""), (2, "A")}
    say(child, "unplug")
    say(child, "status")
    assert "unplugged" in child.stdout.readline()
    with pytest.raises(OSError, match="Input/output error"):
        os.write(file, b"P")
    os.close(file)
    child.send_signal(signal.SIGINT)
    assert child.wait(10) == 0


@pytest.fixture
def running():
    """Simulators in threads of this process."""
    ends = []

    def run(options: SimulatorOptions) -> list[str]:
        said: list[str] = []
        simulator = Simulator(options, said.append)
        simulator.open()
        thread = threading.Thread(target=simulator.run)
        thread.start()
        ends.append((simulator, thread))
        return said

    yield run
    for simulator, thread in ends:
        simulator.end()
        thread.join(10)
        assert not thread.is_alive()


@pytest.mark.parametrize("kind", ["fastrak", "liberty", "patriot", "ultratrak"])
def test_the_configuration_that_it_writes_is_one_that_the_driver_takes(kind, tmp_path, running):
    file = tmp_path / "tracker.toml"
    options = SimulatorOptions(subject(), kind=kind, config_out=file)
    said = running(options)
    config = load(file)
    assert config.kind == kind
    assert config.rate == (30.0 if kind == "fastrak" else 60.0)
    assert len(config.stations) == 15
    assert config.transmitter == options.transmitter
    if kind != "ultratrak":
        assert [line.stations for line in config.line] == list(options.units())
        assert [line.port for line in config.line] == [sentence.split()[2] for sentence in said[:-1]]
    _, positions = measured(options)
    assert (positions @ np.array(config.hemisphere)).min() > 0.0  # no sensor leaves its half of space


@pytest.mark.parametrize(
    ("place", "upside_down", "half"),
    [
        ((0.0, 0.0, 2.4), False, (0.0, 0.0, 1.0)),  # overhead
        ((0.0, 0.0, 2.4), True, (0.0, 0.0, -1.0)),
        ((0.0, 0.0, -0.2), True, (0.0, 0.0, 1.0)),
        ((-1.5, 0.0, 1.0), False, (1.0, 0.0, 0.0)),  # on a table behind the subject
        ((0.0, -1.5, 1.0), False, (0.0, -1.0, 0.0)),  # at the right: y points to the right
    ],
)
def test_the_hemisphere_is_the_one_in_which_the_sensors_are(place, upside_down, half, tmp_path):
    transmitter = TransmitterConfig(place, 0.0, upside_down=upside_down)
    options = SimulatorOptions(subject(), kind="liberty", transmitter=transmitter)
    (tmp_path / "tracker.toml").write_text(configuration(options, ["/dev/ttyS0"]))
    hemisphere = load(tmp_path / "tracker.toml").hemisphere
    assert hemisphere == half
    _, positions = measured(options)
    assert (positions @ np.array(hemisphere)).min() > 0.0


def measured(options: SimulatorOptions):
    stage = Stage(options)
    sensed = [stage.sense(station, frame / 60.0, 0) for station in range(1, 16) for frame in range(90)]
    return np.array([one.rotation for one in sensed]), np.array([one.position for one in sensed])


def test_an_ultratrak_waits_for_a_listener_and_sends_it_every_frame(running):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind(("127.0.0.1", 0))
        host, port = listener.getsockname()
        listener.close()
        options = SimulatorOptions(subject(), kind="ultratrak", address=f"{host}:{port}")
        running(options)
        time.sleep(0.3)  # nobody listens
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as listener:
        listener.bind((host, port))
        listener.settimeout(10.0)
        frames = [ultratrak.decode(listener.recv(2000), "cm", Losses()) for _ in range(40)]
    numbers = [frame.number for frame in frames if frame]
    assert numbers[0] == 0
    begun = numbers[numbers.index(0) + numbers.count(0) - 1 :]
    assert begun == sorted(begun)
    assert begun[-1] >= 30
    stage = Stage(options)
    for frame in frames:
        assert frame is not None
        assert len(frame.readings) == 15
        sensed = stage.sense(9, frame.number / 60.0, frame.number)
        assert frame.readings[8].position == pytest.approx(sensed.position, abs=1e-5)
        assert angles_between(frame.readings[8].rotation, sensed.rotation)[0] < 1e-3


def test_quit_ends_it():
    reading, writing = os.pipe()
    simulator = Simulator(SimulatorOptions(subject(), kind="liberty"), print)
    simulator.open()
    thread = threading.Thread(target=simulator.run, args=(reading,))
    thread.start()
    os.write(writing, b"quit\n")
    thread.join(10)
    os.close(reading)
    os.close(writing)
    assert not thread.is_alive()


def test_options_that_do_not_fit_open_no_line():
    with pytest.raises(CommandError, match="use 4 to 15"):
        Simulator(SimulatorOptions(subject(), kind="fastrak", lines=2), print)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"baud": 0}, "baud 0; it must be above 0"),
        ({"baud": 12345}, "there are: 300, .*, 115200"),
        ({"rate": float("nan")}, "rate nan"),
        ({"measurements": -1.0}, "measurements -1"),
        ({"boot": -1.0}, "0 seconds or more"),
        ({"faults": Faults(flip=1.5)}, "flip 1.5; it is a share"),
        ({"faults": Faults(weak={16})}, "no station 16; there are 1 to 15"),
    ],
)
def test_what_can_not_be_is_one_sentence(options, words):
    with pytest.raises(CommandError, match=words):
        Simulator(SimulatorOptions(subject(), **options), print)


def test_an_address_that_is_none_is_refused():
    with pytest.raises(CommandError, match="write it as"):
        Simulator(SimulatorOptions(subject(), kind="ultratrak", address="12345"), print)


def test_faults_for_a_time_end_by_themselves():
    options = SimulatorOptions(subject())
    console = Console(options)
    console.obey("weak 3 5 for 2", 10.0)
    console.obey("drop 0.25 for 1", 10.0)
    console.obey("unplug 2", 10.0)
    faults = options.faults
    assert (faults.weak, faults.drop, faults.unplugged) == ({3, 5}, 0.25, {2})
    assert console.next_time() == 11.0
    console.pass_time(11.0)
    assert (faults.weak, faults.drop) == ({3, 5}, 0.0)
    console.pass_time(12.0)
    assert faults.weak == set()
    assert faults.unplugged == {2}
    console.obey("off", 13.0)
    assert faults.off
    console.obey("mend", 13.0)
    assert not faults.off
    assert faults.unplugged == set()


def test_none_given_means_all():
    options = SimulatorOptions(subject())
    Console(options).obey("silent", 0.0)
    Console(options).obey("unplug", 0.0)
    assert options.faults.silent == set(range(1, 16))
    assert options.faults.unplugged == {1, 2, 3, 4}


@pytest.mark.parametrize("line", ["weak 16", "weak x", "unplug 5", "drop", "drop 2", "flip x", "weak for x", "for 2"])
def test_what_is_typed_wrong_changes_nothing(line):
    options = SimulatorOptions(subject())
    with pytest.raises(CommandError):
        Console(options).obey(line, 0.0)
    assert options.faults == SimulatorOptions(subject()).faults
