"""Readings become sweeps, sweeps frames: lost, doubled, late and miscounted ones, several lines."""

from __future__ import annotations

from itertools import groupby, pairwise

import numpy as np
import pytest

from ahmss.capture.assembly import Assembler, Sweep
from ahmss.capture.formats.losses import Losses
from ahmss.capture.merge import Merger
from ahmss.capture.stations import Reading
from ahmss.capture.udp import Numbers

RATE = 60.0


def reading(station: int, count: int | None = None, arrival: float = 0.0) -> Reading:
    return Reading(station, "", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), count, None, arrival)


def assembler(numbering, stations=4, losses=None):
    return Assembler(range(1, stations + 1), RATE, losses or Losses(), numbering=numbering)


def shape(sweeps):
    return [(sweep.number, sorted(sweep.readings)) for sweep in sweeps]


def test_sweeps_by_count():
    four = assembler("count")
    sweeps = four.feed([reading(station, count) for count in (100, 101, 104) for station in (1, 2, 3, 4)])
    assert shape(sweeps) == [(100, [1, 2, 3, 4]), (101, [1, 2, 3, 4]), (104, [1, 2, 3, 4])]
    assert [sweep.fresh for sweep in sweeps] == [True, False, False]


def test_one_record_with_a_wrong_count_ends_nothing():
    losses = Losses()
    four = assembler("count", losses=losses)
    four.feed([reading(station, 7) for station in (1, 2, 3, 4)])
    wrong = [reading(1, 8), reading(2, 10), reading(3, 8), reading(4, 1_000_000)]
    rest = [reading(station, count) for count in (9, 10) for station in (1, 2, 3, 4)]
    assert shape(four.feed(wrong + rest)) == [(8, [1, 3]), (9, [1, 2, 3, 4]), (10, [1, 2, 3, 4])]
    assert losses.miscounted == 1


def test_a_restarted_device_counts_anew():
    two = assembler("count", 2)
    two.feed([reading(station, 900) for station in (1, 2)])
    again = two.feed([reading(station, count) for count in (1, 2, 3) for station in (1, 2)])
    assert shape(again)[-1] == (3, [1, 2])
    assert [sweep.fresh for sweep in again] == [True, False]


def test_the_count_of_a_device_wraps():
    two = assembler("count", 2)
    last = 2**32 - 1
    counts = [sweep.number for count in (last, 0, 1) for sweep in two.feed([reading(1, count), reading(2, count)])]
    assert counts == [last, last + 1, last + 2]


def test_sweeps_by_the_order_of_stations():
    four = assembler("clock")
    came = [1, 2, 3, 4, 1, 2, 4, 1, 2, 3, 4, 3, 4, 1, 2, 3, 4]  # lost: 3; then 1 and 2
    sweeps = four.feed([reading(station) for station in came])
    assert shape(sweeps) == [(0, [1, 2, 3, 4]), (1, [1, 2, 4]), (2, [1, 2, 3, 4]), (3, [3, 4]), (4, [1, 2, 3, 4])]


def test_a_damaged_station_character_does_not_cut_a_sweep_in_two():
    fifteen = assembler("clock", 15)
    came = [*range(1, 16), 1, 2, 5, 4, *range(5, 16), *range(1, 16)]
    assert [len(sweep.readings) for sweep in fifteen.feed([reading(station) for station in came])] == [15, 14, 15]


def test_half_a_sweep_is_given_when_its_rest_does_not_come():
    four = assembler("clock")
    assert four.feed([reading(1), reading(2)]) == []
    assert four.flush(0.2) == []
    assert shape(four.flush(0.3)) == [(0, [1, 2])]


def test_numbers_leave_a_gap_where_time_went_by_and_none_for_a_burst():
    two = assembler("clock", 2)
    pair = lambda time: [reading(1, None, time), reading(2, None, time)]  # noqa: E731
    numbers = [sweep.number for at in range(10) for sweep in two.feed(pair(at / RATE))]
    numbers += [sweep.number for sweep in two.feed(pair(14 / RATE))]  # 10 to 13 were lost
    numbers += [sweep.number for sweep in two.feed([r for _ in range(6) for r in pair(20 / RATE)])]  # read late
    assert numbers == [*range(10), 14, *range(15, 21)]


def heard_of(rate: float, *, busy: bool, lossy: bool, seconds: float = 60.0) -> tuple[list[float], list[float]]:
    """When a line sent its sweeps, and when they were read: by a busy machine late, and several at once."""
    rng = np.random.default_rng(3)
    sent = np.arange(0.0, seconds, 1.0 / rate)
    if lossy:
        for gap in (10.0, 25.0, 40.0):
            sent = sent[(sent < gap) | (sent > gap + 0.7)]
    reads = np.cumsum(np.where(rng.random(40_000) < 0.05 * busy, rng.uniform(0.02, 0.2, 40_000), 0.003))
    late = np.where(rng.random(len(sent)) < 0.05 * busy, rng.uniform(0.0, 0.08, len(sent)), 0.0)
    came = np.maximum.accumulate(sent + rng.exponential(0.001, len(sent)) + late)
    return sent.tolist(), reads[np.searchsorted(reads, came)].tolist()


@pytest.mark.parametrize("lossy", [False, True])
@pytest.mark.parametrize("busy", [False, True])
@pytest.mark.parametrize("rate", [5.0, 7.8, 17.3, 23.3, 26.5, 30.0, 44.6, 52.0, 58.0, 60.0])
def test_the_time_of_a_line_without_a_count_is_right_at_any_rate(rate, busy, lossy):
    sent, read = heard_of(rate, busy=busy, lossy=lossy)
    one = assembler("clock", 1)
    numbers: list[int] = []
    for arrival, together in groupby(read):
        numbers += [sweep.number for sweep in one.feed([reading(1, None, arrival) for _ in together])]
    assert (numbers[-1] - numbers[0]) / RATE == pytest.approx(sent[-1] - sent[0], rel=0.005)
    off = np.array(numbers) / RATE - np.array(sent)
    assert np.abs(off - np.median(off)).max() < (0.3 if busy else 0.06)


def test_sweeps_of_a_slow_line_are_numbered_evenly():
    one = assembler("clock", 1)
    numbers = [sweep.number for at in range(60) for sweep in one.feed([reading(1, None, at / 30)])]
    assert {after - before for before, after in pairwise(numbers[12:])} == {2}


def test_a_device_that_is_too_fast_is_held_back_beside_others():
    one = assembler("time", 1)
    numbers = [sweep.number for at in range(120) for sweep in one.feed([reading(1, None, at / 80)])]
    assert numbers[-1] == pytest.approx(119 * RATE / 80, abs=2)
    assert all(after - before in (0, 1) for before, after in pairwise(numbers))


def sweep(number: int, *stations: int, arrival: float = 0.0, fresh: bool = False) -> Sweep:
    return Sweep(number, {station: reading(station) for station in stations}, arrival, fresh)


def test_lines_that_count_differently_are_merged():
    losses = Losses()
    merger = Merger(2, RATE, losses)
    for at in range(3):
        merger.add(0, sweep(500 + at, 1, 2, arrival=at / RATE, fresh=at == 0))
        merger.add(1, sweep(90 + at, 3, 4, arrival=(at + 0.2) / RATE, fresh=at == 0))
    frames = merger.take(3 / RATE)
    assert [(frame.number, sorted(frame.readings)) for frame in frames] == [(at, [1, 2, 3, 4]) for at in range(3)]
    merger.add(0, sweep(505, 1, 2, arrival=5 / RATE))
    assert merger.take(5 / RATE) == []  # the other line may still send its own
    merger.add(1, sweep(96, 3, 4, arrival=6 / RATE))
    assert [(frame.number, sorted(frame.readings)) for frame in merger.take(6 / RATE)] == [(5, [1, 2])]
    assert losses.lost == 2


def test_a_silent_line_holds_the_others_up_for_a_moment_only():
    merger = Merger(2, RATE, Losses())
    merger.add(0, sweep(0, 1, fresh=True))
    assert merger.take(0.01) == []
    assert [sorted(frame.readings) for frame in merger.take(0.2)] == [[1]]


def test_datagrams_that_overtake_each_other_are_put_in_order():
    losses = Losses()
    merger = Merger(1, RATE, losses, ordered=False)
    merger.add(0, sweep(10, 1, fresh=True))
    numbers = [frame.number for frame in merger.take(0.0)]
    for number, now in ((12, 0.016), (11, 0.018), (12, 0.02), (11, 0.021), (14, 0.03), (15, 0.05)):
        merger.add(0, sweep(number, 1, arrival=now))
        numbers += [frame.number for frame in merger.take(now)]
    assert numbers == [0, 1, 2]
    assert [frame.number for frame in merger.take(0.2)] == [4, 5]  # 3 never came
    assert (losses.repeated, losses.lost) == (2, 1)


def test_numbers_of_datagrams():
    numbers = Numbers(RATE)
    judged = [numbers.judge(number, at / RATE) for at, number in enumerate((100, 101, 103, 102, 7102, 104, 5, 6, 7))]
    assert judged == [True, False, False, False, None, False, None, True, False]
