"""The simulated line: a real pseudo-terminal that carries no more than its baud rate, on a clock of the test's own."""

from __future__ import annotations

import os
import termios
import tty
from itertools import pairwise

import pytest

from ahmss.capture.formats import liberty
from ahmss.capture.formats.layout import Layout
from ahmss.capture.simulator.faults import Damage, Faults
from ahmss.capture.simulator.line import Line
from ahmss.capture.simulator.options import SimulatorOptions
from ahmss.capture.simulator.stage import Stage
from ahmss.capture.simulator.uart import Uart
from ahmss.errors import CommandError
from tests.capture.simulated import subject

BAUD = {115200: termios.B115200, 921600: termios.B921600, 9600: termios.B9600}


class Cable:
    """A unit, its pseudo-terminal, and who reads it: nothing passes but by `run`."""

    def __init__(self, **options):
        self.said: list[str] = []
        self.options = SimulatorOptions(subject(), **options)
        self.line = Line(self.options, 0, Stage(self.options), self.said.append)
        self.now = 0.0
        self.line.open()
        self.reader = os.open(self.line.port.name, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
        tty.setraw(self.reader)
        self.listen_at(self.options.baud)

    def listen_at(self, baud: int) -> None:
        settings = termios.tcgetattr(self.reader)
        settings[4] = settings[5] = BAUD[baud]
        termios.tcsetattr(self.reader, termios.TCSANOW, settings)

    def run(self, seconds: float, step: float = 0.003) -> bytes:
        """What arrives in a time, if the simulator wakes up every `step`."""
        got = []
        end = self.now + seconds
        while self.now < end - 1e-9:
            self.now += step
            self.line.serve(self.now)
            got.append(self.read())
        return b"".join(got)

    def read(self) -> bytes:
        try:
            return os.read(self.reader, 65536)
        except BlockingIOError:
            return b""

    def write(self, data: bytes) -> None:
        os.write(self.reader, data)

    def close(self) -> None:
        os.close(self.reader)
        self.line.close()


@pytest.fixture
def plugged():
    cables: list[Cable] = []

    def plug(**options) -> Cable:
        cables.append(Cable(**options))
        return cables[-1]

    yield plug
    for cable in cables:
        cable.close()


def frames(data: bytes, layout: Layout) -> list[int]:
    """The numbers of the frames of a Liberty's stream, each once."""
    return sorted({reading.count or 0 for reading in liberty.parser(layout).feed(data)})


LAYOUT = Layout((2, 7, 8, 9, 1))
RECORD = 8 + 12 + 16 + 4 + 4 + 2
SETUP = b"F1\rO*,2,7,8,9,1\rC\r"


def test_a_byte_takes_ten_bits_and_comes_when_its_last_is_out():
    uart = Uart(1000)
    uart.load(b"ab", 1.0)
    uart.load(b"c", 1.0)
    assert uart.gone(1.0099) == b""
    assert uart.gone(1.01) == b"a"
    assert uart.gone(1.0299) == b"b"
    assert uart.free == pytest.approx(1.03)
    assert uart.gone(2.0) == b"c"
    uart.load(b"d", 5.0)
    assert uart.next_time() == pytest.approx(5.01)


@pytest.mark.parametrize("step", [0.002, 0.011])
def test_a_line_with_room_carries_every_frame(plugged, step):
    cable = plugged(kind="liberty", baud=921600)
    cable.write(SETUP)
    numbers = frames(cable.run(2.0, step), LAYOUT)
    assert numbers == list(range(numbers[0], numbers[0] + len(numbers)))
    assert len(numbers) >= 118


@pytest.mark.parametrize("step", [0.002, 0.011])
def test_an_over_full_line_drops_to_what_its_baud_rate_carries(plugged, step):
    cable = plugged(kind="liberty", baud=115200)
    cable.write(SETUP)
    data = cable.run(2.0, step)
    assert len(data) == pytest.approx(2.0 * 11520, rel=0.01)  # full, and no fuller
    numbers = frames(data, LAYOUT)
    carried = (len(numbers) - 1) / (numbers[-1] - numbers[0])
    assert carried == pytest.approx(11520 / (15 * RECORD) / 60.0, rel=0.02)  # 16.7 of 60 frames/s
    gaps = {after - before for before, after in pairwise(numbers)}
    assert gaps <= {3, 4}  # the newest each time: even gaps, no queue that grows


@pytest.mark.parametrize(("active", "rate"), [(1, 120), (2, 60), (3, 40), (4, 30)])
def test_a_fastraks_stations_share_120_measurements_a_second(plugged, active, rate):
    cable = plugged(rate=120.0, stations=4)
    cable.write(b"f" + b"".join(b"O%d,2,11,1\r" % n for n in range(1, 5)))
    cable.write(b"".join(b"l%d,0\r" % n for n in range(active + 1, 5)) + b"C")
    data = cable.run(2.0)
    assert len(data) / (33 * active) == pytest.approx(2 * rate, abs=2)


def test_printed_quaternions_of_fifteen_stations_do_not_fit_where_binary_ones_do(plugged):
    carried = {}
    for mode, size in ((b"F", 54), (b"f", 33)):
        cable = plugged(lines=1, measurements=900.0, rate=60.0, baud=921600 if mode == b"f" else 115200)
        cable.write(mode + b"".join(b"O%d,2,11,1\r" % n for n in range(1, 16)) + b"C")
        carried[mode] = len(cable.run(1.0)) / (15 * size)
    assert carried[b"f"] == pytest.approx(60.0, rel=0.02)
    assert carried[b"F"] == pytest.approx(11520 / (15 * 54), rel=0.03)  # 14 frames/s


def test_at_another_baud_rate_there_is_garbage_both_ways_and_a_sentence(plugged):
    cable = plugged(kind="liberty", baud=115200)
    cable.listen_at(9600)
    cable.write(SETUP)
    assert cable.run(0.5) == b""  # not understood
    cable.listen_at(115200)
    cable.write(SETUP)
    assert frames(cable.run(0.5), LAYOUT)
    cable.listen_at(9600)
    garbage = cable.run(1.0)
    assert 700 < len(garbage) < 1200  # as many bytes as that rate has
    assert frames(garbage, LAYOUT) == []
    assert "at 9600 baud, this tracker at 115200" in cable.said[0]
    assert len(cable.said) == 3  # once for each change


def test_bytes_that_nobody_reads_are_lost_in_the_end_and_counted(plugged):
    cable = plugged(kind="liberty", baud=921600)
    cable.write(SETUP)
    for _ in range(300):
        cable.now += 0.03
        cable.line.serve(cable.now)
    assert cable.line.lost > 100_000
    assert "because nobody read" in cable.line.report
    assert frames(cable.read() + cable.run(1.0), LAYOUT)  # and it goes on when somebody does


def test_by_the_clock_poll_nothing_is_lost_however_late_the_reader(plugged):
    cable = plugged(kind="liberty", clock="poll", after="stop", boot=0.0)
    cable.write(SETUP)
    for _ in range(50):
        cable.line.serve(0.0)
    assert cable.line.waits
    data = b""
    while chunk := cable.read():
        data += chunk
        cable.line.serve(0.0)
    assert frames(data, LAYOUT) == list(range(90))
    assert cable.line.lost == 0


def test_unplugged_the_port_is_gone_and_plugged_in_again_its_link_leads_to_a_new_one(tmp_path):
    link = tmp_path / "tracker"
    options = SimulatorOptions(subject(), kind="liberty", names=(link,))
    line = Line(options, 0, Stage(options), print)
    line.open()
    reader = os.open(link, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    line.serve(0.0)
    options.faults.unplugged.add(1)
    line.serve(0.1)
    assert not link.is_symlink()
    assert line.fileno() == -1
    assert line.next_time(0.1) is None
    with pytest.raises(OSError, match="Input/output error"):
        os.write(reader, b"P")
    os.close(reader)
    options.faults.unplugged.clear()
    line.serve(0.2)
    os.close(os.open(link, os.O_RDWR | os.O_NOCTTY))
    line.close()
    assert not link.is_symlink()


def test_a_name_that_a_file_has_is_not_taken(tmp_path):
    (tmp_path / "tracker").write_text("mine")
    options = SimulatorOptions(subject(), kind="liberty", names=(tmp_path / "tracker",))
    with pytest.raises(CommandError, match="a file is there already"):
        Line(options, 0, Stage(options), print).open()
    assert (tmp_path / "tracker").read_text() == "mine"


def test_off_the_device_is_deaf_and_dumb_and_silent_stations_are_left_out(plugged):
    cable = plugged(kind="liberty", stations=3, baud=921600)
    cable.write(SETUP)
    cable.run(0.1)
    cable.options.faults.silent.add(2)
    cable.run(0.05)
    assert {reading.station for reading in liberty.parser(LAYOUT).feed(cable.run(0.2))} == {1, 3}
    cable.options.faults.off = True
    cable.run(0.05)
    assert cable.run(0.2) == b""
    cable.options.faults.mend()
    assert cable.run(0.2) == b"", "who was off begins as saved, and sends nothing unasked"
    cable.run(cable.options.boot)
    cable.write(SETUP)
    assert frames(cable.run(0.2), LAYOUT)


def test_a_weak_station_is_marked(plugged):
    cable = plugged(kind="liberty", stations=3, baud=921600)
    cable.options.faults.weak.add(3)
    cable.write(SETUP)
    readings = liberty.parser(LAYOUT).feed(cable.run(0.2))
    assert {(reading.station, reading.status != "") for reading in readings} == {(1, False), (2, False), (3, True)}


@pytest.mark.parametrize(("name", "share"), [("drop", 0.03), ("double", 0.02), ("flip", 0.05)])
def test_damage_hits_the_share_of_bytes_that_it_should_and_the_same_ones_again(name, share):
    data = bytes(range(256)) * 400
    one, again, other = (Damage(Faults(**{name: share}), seed)(data) for seed in (1, 1, 2))
    assert one == again != other
    piecewise = Damage(Faults(**{name: share}), 1)
    assert b"".join(piecewise(data[at : at + 77]) for at in range(0, len(data), 77)) == one
    if name == "flip":
        changed = [(a ^ b) for a, b in zip(one, data, strict=True) if a != b]
        assert all(bits.bit_count() == 1 for bits in changed)
        hit = len(changed)
    else:
        hit = abs(len(one) - len(data))
    assert hit / len(data) == pytest.approx(share, rel=0.05)


def test_without_faults_bytes_pass_as_they_are():
    assert Damage(Faults(), 1)(b"abc") == b"abc"
    assert Damage(Faults(flip=1.0), 1)(b"") == b""


def test_a_datagram_is_lost_whole_or_comes_whole():
    damage = Damage(Faults(drop=0.3, double=0.5, flip=0.01), 2)
    came = [damage.whole(bytes(500)) for _ in range(1000)]
    assert {len(datagram) for datagram in came} == {0, 500}
    assert came.count(b"") == pytest.approx(300, abs=50)
    assert sum(byte != 0 for datagram in came for byte in datagram) == pytest.approx(700 * 500 * 0.01, rel=0.1)
