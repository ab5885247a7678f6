"""The simulated unit obeys: bytes in, bytes out, on a clock of the test's own."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.capture.formats import fastrak_ascii, fastrak_binary, liberty
from ahmss.capture.formats.answers import find_stations, find_status
from ahmss.capture.formats.layout import Layout
from ahmss.capture.simulator.machine import Machine
from ahmss.capture.simulator.options import SimulatorOptions
from ahmss.capture.simulator.stage import Stage
from ahmss.capture.stations import Reading
from ahmss.errors import CommandError
from tests.capture.simulated import angles_between, as_rotation, subject

FACTORY = Layout((2, 4, 1), stations=4)
QUATERNIONS = Layout((2, 11, 1), stations=4)


class Bench:
    """One unit on the table: what is said to it, and all that it says, at one time."""

    def __init__(self, kind="fastrak", unit=0, **options):
        self.options = SimulatorOptions(subject(), kind=kind, **options)
        self.stage = Stage(self.options)
        self.machine = Machine(self.options, unit, self.stage)

    def tell(self, data: bytes, now=0.0) -> bytes:
        self.machine.hear(data, now)
        return self.answers(now)

    def answers(self, now=0.0) -> bytes:
        words = []
        while word := self.machine.speak(now):
            words.append(word)
        return b"".join(words)


def test_switched_on_it_is_quiet_prints_inches_and_euler_angles_and_answers_a_poll():
    bench = Bench()
    assert bench.answers(5.0) == b""
    readings = fastrak_ascii.parser(FACTORY).feed(bench.tell(b"P", 5.0))
    assert [reading.station for reading in readings] == [1, 2, 3, 4]
    for reading in readings:
        sensed = bench.stage.sense(reading.station, 0.0, 0)
        assert reading.position == pytest.approx(sensed.position, abs=0.0002)
        assert angles_between(reading.rotation, sensed.rotation)[0] < 0.02


def test_told_so_it_sends_binary_quaternions_in_centimetres():
    bench = Bench()
    answer = bench.tell(b"O1,2,11,1\rO2,2,11,1\rO3,2,11,1\rO4,2,11,1\ruf" + b"P")
    readings = fastrak_binary.parser(Layout((2, 11, 1), "cm", 4)).feed(answer)
    assert len(readings) == 4
    for reading in readings:
        sensed = bench.stage.sense(reading.station, (reading.station - 1) / 120.0, 0)
        assert reading.position == pytest.approx(sensed.position, abs=1e-6)
        assert angles_between(reading.rotation, sensed.rotation)[0] < 1e-4


def test_commands_may_come_a_byte_at_a_time_with_either_end_of_line():
    bench = Bench()
    for byte in b"O1,2,11,1\nl2,0\r\nl3,0\nl4,0\n":
        assert bench.tell(bytes([byte])) == b""
    assert len(fastrak_ascii.parser(QUATERNIONS).feed(bench.tell(b"P"))) == 1


def test_stations_that_are_off_send_nothing_and_leave_the_others_more_of_the_measurements():
    bench = Bench(rate=120.0, stations=4)
    assert bench.machine.frames_a_second == 30.0
    bench.tell(b"l2,0\rl4,0\r")
    assert bench.machine.frames_a_second == 60.0
    assert [reading.station for reading in fastrak_ascii.parser(FACTORY).feed(bench.tell(b"P"))] == [1, 3]
    assert find_stations("fastrak", bench.tell(b"l1\r")) == (1, 3)
    bench.tell(b"l2,1\r")
    assert find_stations("fastrak", bench.tell(b"l1\r")) == (1, 2, 3)


def test_stations_switched_while_it_sends_change_the_rate_from_then_on_and_nothing_else():
    bench = Bench("liberty", stations=4, measurements=120.0, rate=240.0)
    bench.tell(b"F1\rO*,2,7,9\rC\r", 0.0)
    parser = liberty.parser(Layout((2, 7, 9)))

    def next_frames(now: float, count: int) -> list[float]:
        """When the next frames are ready; each station's reading must be the subject's at that time."""
        times = []
        for _ in range(count):
            now = bench.machine.next_time(now)
            times.append(now)
            reading = parser.feed(bench.answers(now))[0]
            assert reading.position == pytest.approx(bench.stage.sense(1, now, 0).position, abs=1e-5)
        return times

    steps = np.diff(next_frames(0.0, 5))
    assert steps == pytest.approx(1 / 30.0)
    bench.tell(b"\x154,0\r\x153,0\r", 0.2)
    steps = np.diff(next_frames(0.2, 8))
    assert steps == pytest.approx(1 / 60.0)
    bench.tell(b"\x154,1\r\x153,1\r", 0.5)
    steps = np.diff(next_frames(0.5, 4))
    assert steps == pytest.approx(1 / 30.0)


def test_continuous_output_begins_the_performance_and_its_end_the_silence():
    bench = Bench()
    bench.tell(b"F", 10.0)
    assert bench.tell(b"C", 100.0) == bench.tell(b"", 100.0) + _frame(bench, 0)
    assert bench.answers(100.02) == b""
    assert bench.answers(100.0334) == _frame(bench, 1)
    assert bench.machine.next_time(100.04) == pytest.approx(100.0 + 2 / 30.0)
    bench.tell(b"c", 100.05)
    assert bench.answers(101.0) == b""
    assert bench.machine.next_time(101.0) is None
    assert bench.tell(b"C", 200.0) == _frame(bench, 0)  # nobody was watching: the subject begins anew


def _frame(bench: Bench, number: int) -> bytes:
    """The frame's records, by way of the stage: FASTRAK measures one station after the other."""
    settings = bench.machine.settings
    records = b""
    for station in range(1, 5):
        sensed = bench.stage.sense(station, number / 30.0 + (station - 1) / 120.0, number)
        rotation, position = settings.stations[station - 1].applied(sensed.rotation, sensed.position)
        records += fastrak_ascii.encode(Reading(station, "", tuple(position), tuple(rotation)), FACTORY)
    return records


def test_all_units_watch_one_performance():
    options = SimulatorOptions(subject())
    stage = Stage(options)
    first, second = Machine(options, 0, stage), Machine(options, 1, stage)
    first.hear(b"C", 100.0)
    second.hear(b"C", 100.25)
    assert stage.epoch == 100.0
    second.hear(b"c", 101.0)
    second.hear(b"C", 102.0)
    assert stage.epoch == 100.0


def test_boresight_makes_the_present_rotation_none_and_unboresight_undoes_it():
    bench = Bench()
    bench.tell(b"O1,2,11,1\rl2,0\rl3,0\rl4,0\rP", 0.0)
    raw = [bench.stage.sense(1, seconds, 0).rotation for seconds in (0.2, 1.4)]
    bench.tell(b"B1\r", 0.2)
    [still] = fastrak_ascii.parser(QUATERNIONS).feed(bench.tell(b"P", 0.2))
    assert angles_between(still.rotation, [1.0, 0.0, 0.0, 0.0])[0] < 0.01
    [turned] = fastrak_ascii.parser(QUATERNIONS).feed(bench.tell(b"P", 1.4))
    expected = as_rotation(raw[1]) * as_rotation(raw[0]).inv()  # relative to the transmitter's axes, not the sensor's
    assert angles_between(turned.rotation, np.roll(expected.as_quat(), 1, axis=-1))[0] < 0.02
    bench.tell(b"b1\r", 1.4)
    [back] = fastrak_ascii.parser(QUATERNIONS).feed(bench.tell(b"P", 1.4))
    assert angles_between(back.rotation, raw[1])[0] < 0.02


def test_alignment_moves_and_turns_the_frame_and_adds_to_the_one_before():
    bench = Bench()
    bench.tell(b"uO1,2,11,1\rl2,0\rl3,0\rl4,0\r")
    bench.tell(b"A1,10,20,30,10,21,30,9,20,30\r")  # x where y was, y where -x was: a quarter turn about z
    [reading] = fastrak_ascii.parser(Layout((2, 11, 1), "cm", 4)).feed(bench.tell(b"P"))
    sensed = bench.stage.sense(1, 0.0, 0)
    quarter = as_rotation([np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)])
    moved = quarter.inv().apply(sensed.position - [0.1, 0.2, 0.3])[0]
    assert reading.position == pytest.approx(moved, abs=1e-4)
    turned = quarter.inv() * as_rotation(sensed.rotation)
    assert angles_between(reading.rotation, np.roll(turned.as_quat(), 1, axis=-1))[0] < 0.02
    bench.tell(b"A1,0,0,0,0,1,0,-1,0,0\r")
    [again] = fastrak_ascii.parser(Layout((2, 11, 1), "cm", 4)).feed(bench.tell(b"P"))
    assert again.position == pytest.approx(quarter.inv().apply(moved)[0], abs=1e-4)
    bench.tell(b"R1\r")
    [reset] = fastrak_ascii.parser(Layout((2, 11, 1), "cm", 4)).feed(bench.tell(b"P"))
    assert reset.position == pytest.approx(sensed.position, abs=1e-4)


def test_three_points_in_a_line_are_no_alignment():
    bench = Bench()
    assert b"*ERROR*" in bench.tell(b"A1,0,0,0,1,0,0,2,0,0\r")


def test_outside_its_hemisphere_a_sensor_is_measured_at_the_opposite_place():
    bench = Bench()
    bench.tell(b"uO1,2,11,1\rl2,0\rl3,0\rl4,0\rH1,-1,0,0\r")
    [reading] = fastrak_ascii.parser(Layout((2, 11, 1), "cm", 4)).feed(bench.tell(b"P"))
    sensed = bench.stage.sense(1, 0.0, 0)
    assert sensed.position[0] > 0.5
    assert reading.position == pytest.approx(-sensed.position, abs=1e-4)
    assert angles_between(reading.rotation, sensed.rotation)[0] < 0.02


def test_the_status_record_has_55_bytes_and_tells_the_settings():
    bench = Bench()
    answer = bench.tell(b"S")
    assert len(answer) == 55
    assert answer[:6] == b"21S3F0"
    bench.tell(b"fuC")
    bench.answers()
    told = find_status("fastrak", bench.tell(b"S"))
    assert told is not None
    assert (told.binary, told.units, told.continuous) == (True, "cm", True)


def test_a_reinitialisation_takes_its_time_and_forgets_what_was_not_saved():
    bench = Bench(boot=10.0)
    bench.tell(b"f\x0bu\x19C", 0.0)  # binary is saved, centimetres are not; it is deaf to C already
    assert bench.tell(b"S", 9.9) == b""
    told = find_status("fastrak", bench.tell(b"S", 10.1))
    assert told is not None
    assert (told.binary, told.units, told.continuous) == (True, "inch", False)
    bench.tell(b"W", 10.2)
    told = find_status("fastrak", bench.tell(b"S", 10.2))
    assert told is not None
    assert not told.binary


@pytest.mark.parametrize("command", [b"q", b"O1,2,99\r", b"O9,2,4\r", b"lx,0\r", b"H1,1\r", b"B7\r"])
def test_what_a_fastrak_does_not_understand_it_says_and_goes_on(command):
    bench = Bench()
    before = bench.machine.settings
    assert bench.tell(command).startswith(b"2 E*ERROR*")
    assert bench.machine.settings.stations[0].items == before.stations[0].items
    assert len(fastrak_ascii.parser(FACTORY).feed(bench.tell(b"P"))) == 4


def test_a_liberty_counts_frames_and_milliseconds_and_stops_at_a_poll():
    bench = Bench("liberty", rate=60.0, stations=3)
    bench.tell(b"F1\rU1\rO*,2,7,8,9,1\r", 50.0)
    parser = liberty.parser(Layout((2, 7, 8, 9, 1), "cm", 16))
    bench.tell(b"Q0\r", 51.0)
    first = parser.feed(bench.tell(b"C\r", 52.0))
    assert [(reading.station, reading.count, reading.stamp) for reading in first] == [(n, 60, 1.0) for n in (1, 2, 3)]
    later = parser.feed(bench.answers(53.001))
    assert {reading.count for reading in later} == {120}  # the newest; those between were never sent
    parser.feed(bench.tell(b"P", 53.001))
    assert bench.answers(54.0) == b""
    assert find_stations("liberty", bench.tell(b"\x150\r", 54.0)) == (1, 2, 3)


def test_a_patriot_says_that_it_is_one():
    bench = Bench("patriot", unit=1, lines=2, stations=4)
    assert bench.tell(b"F1\rO*,2,7\rP").startswith(b"PA\x01")


def test_by_the_clock_poll_each_frame_that_is_asked_for_is_the_next():
    bench = Bench(clock="poll")
    bench.tell(b"O1,2,11,1\rl2,0\rl3,0\rl4,0\rf")
    parser = fastrak_binary.parser(QUATERNIONS)
    for number in range(5):
        [reading] = parser.feed(bench.tell(b"P", 1000.0 * number))
        sensed = bench.stage.sense(1, number / bench.machine.frames_a_second, number)
        assert reading.position == pytest.approx(sensed.position, abs=1e-6)


def test_by_the_clock_poll_continuous_output_begins_with_frame_0_whatever_was_polled():
    bench = Bench("liberty", clock="poll", stations=1)
    bench.tell(b"F1\rO*,2,7,9\rPPP")
    bench.machine.hear(b"C\r", 0.0)
    counts = [
        reading.count for _ in range(4) for reading in liberty.parser(Layout((2, 7, 9))).feed(bench.machine.speak(0.0))
    ]
    assert counts == [0, 1, 2, 3]


def test_what_does_not_fit_together_is_said():
    for options, words in (
        ({"kind": "fastrak", "lines": 1}, "at most 4; use 4 to 15"),
        ({"stations": 16}, "1 to 15"),
        ({"kind": "patriot", "lines": 16}, "use 8 to 15"),
    ):
        with pytest.raises(CommandError, match=words):
            SimulatorOptions(subject(), **options).units()


def test_units_share_the_stations_evenly_in_their_order():
    assert SimulatorOptions(subject()).units() == ((1, 2, 3, 4), (5, 6, 7, 8), (9, 10, 11, 12), (13, 14, 15))
    assert SimulatorOptions(subject(), kind="liberty", lines=2).units() == (tuple(range(1, 9)), tuple(range(9, 16)))
    assert len(SimulatorOptions(subject(), kind="patriot").units()) == 8
    assert len(SimulatorOptions(subject(), lines=1, measurements=900.0).units()) == 1


@pytest.mark.parametrize(("synchronised", "last"), [(True, 30.0), (False, 40.0)])
def test_a_unit_of_fewer_stations_runs_ahead_unless_the_units_are_synchronised(synchronised, last):
    bench = Bench(unit=3, synchronised=synchronised)
    assert len(bench.options.units()[3]) == 3
    assert bench.machine.frames_a_second == last
    assert bench.options.frames_a_second == 30.0
