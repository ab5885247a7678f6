"""The driver on real pseudo-terminals and sockets: every mode, damage, silence and its reason, several lines."""

from __future__ import annotations

import itertools
import socket
import threading
import time
from contextlib import ExitStack

import msgspec
import numpy as np
import pytest

from ahmss.capture import port
from ahmss.capture.config import LineConfig, TrackerConfig, UdpConfig
from ahmss.capture.device import Tracker
from ahmss.capture.formats import ultratrak
from ahmss.capture.port import open_port
from ahmss.capture.stations import Status
from tests.capture.faked import Fake, truth


@pytest.fixture
def soon_set_up(monkeypatch):
    """A device that is silent is set up again after three quarters of a second."""
    monkeypatch.setattr(port, "_SILENT", 0.75)


def frames_of(tracker, count, seconds=20.0):
    """The next frames; fails where they don't come."""
    frames, end = [], time.monotonic() + seconds
    while len(frames) < count and time.monotonic() < end:
        frames += tracker.poll()
        time.sleep(0.003)
    assert len(frames) >= count, tracker.silence
    return frames


def silence_of(tracker, word, seconds=20.0):
    """What the tracker says of its silence, once that has the word in it."""
    end = time.monotonic() + seconds
    while word not in tracker.silence and time.monotonic() < end:
        tracker.poll()
        time.sleep(0.01)
    return tracker.silence


def is_true(frame, stations, count):
    """Whether a frame shows these stations as they were at a count of the device."""
    return all(
        np.allclose(frame.positions[station - 1], truth(station, count).position, atol=1e-4)
        and abs(np.dot(frame.rotations[station - 1], truth(station, count).rotation)) > 1.0 - 1e-6
        for station in stations
    )


@pytest.mark.parametrize("mode", ["continuous", "poll"])
@pytest.mark.parametrize(("kind", "form", "stations"), [("liberty", "binary", 15), ("fastrak", "ascii", 4)])
def test_frames_in_every_mode(kind, form, stations, mode):
    expected = {"liberty": "poll", "fastrak": "stop"}[kind]
    with Fake(kind, stations, form=form) as fake:
        with Tracker(fake.config(mode)) as tracker:
            frames = frames_of(tracker, 30)
        end = time.monotonic() + 10.0
        while fake.heard[-1] != expected and time.monotonic() < end:
            time.sleep(0.01)
    whole = next(frame for frame in frames if not frame.status[:stations].any())
    first = next(count for count in range(400) if is_true(whole, range(1, stations + 1), count)) - whole.number
    for frame in frames:
        seen = frame.status != Status.MISSING
        assert seen[:stations].any()
        assert not seen[stations:].any()
        if seen[:stations].all() and kind == "liberty" and mode == "continuous":
            assert is_true(frame, range(1, stations + 1), first + frame.number)
    assert frames[0].number == 0
    times = [frame.time for frame in frames]
    assert all(after > before for before, after in itertools.pairwise(times))
    assert "poll" in fake.heard if mode == "poll" else "continuous" in fake.heard
    assert fake.heard[-1] == expected  # it was told to be quiet at the end


def test_four_lines_are_one_frame():
    with ExitStack() as stack:
        fakes = [stack.enter_context(Fake("fastrak", count, rate=30.0)) for count in (4, 4, 4, 3)]
        lines = [
            LineConfig(fake.path, 115_200, tuple(range(1 + 4 * at, 1 + 4 * at + fake.stations)))
            for at, fake in enumerate(fakes)
        ]
        config = TrackerConfig(kind="fastrak", rate=30.0, line=tuple(lines))
        tracker = stack.enter_context(Tracker(config))
        frames = frames_of(tracker, 20)
    whole = [frame for frame in frames if not frame.status.any()]
    assert len(whole) > len(frames) // 2
    for frame in whole:  # a line's station 1 is the first of its stations in the file
        assert frame.positions[[0, 4, 8, 12], 0] == pytest.approx(frame.positions[0, 0], abs=0.05)
        assert frame.positions[14, 0] == pytest.approx(frame.positions[2, 0], abs=0.05)


def test_garbage_in_the_stream_is_counted_and_skipped():
    with Fake("liberty", 15, noise=b"\x00\xffLY\x03garbage") as fake, Tracker(fake.config()) as tracker:
        frames = frames_of(tracker, 20)
        losses = tracker.losses
    assert losses.skipped_bytes >= 12 * 19
    assert losses.resyncs >= 19
    good = np.mean([frame.status == Status.GOOD for frame in frames])
    assert good > 0.9  # the garbage stands in the middle of one record of fifteen


def test_a_weak_station_is_marked():
    with Fake("fastrak", 4, weak=3) as fake, Tracker(fake.config()) as tracker:
        frames = frames_of(tracker, 5)
    assert {int(frame.status[2]) for frame in frames} <= {Status.WEAK, Status.MISSING}
    assert tracker.losses.weak > 0


def test_a_port_that_is_not_there(monkeypatch):
    config, asked, begun = TrackerConfig(line=(LineConfig("/dev/ttyNOT_THERE"),)), threading.Event(), []

    def opened_late(line, *given):
        begun.append(asked.wait(20.0))
        return open_port(line, *given)

    monkeypatch.setattr(port, "open_port", opened_late)
    with Tracker(config) as tracker:
        assert tracker.poll() == []  # nothing waits for the device
        asked.set()
        assert "/dev/ttyNOT_THERE: no such port; plug the tracker in" in silence_of(tracker, "no such port")
    assert begun[0]


def test_a_file_that_is_no_port(tmp_path):
    (tmp_path / "file").write_text("")
    with Tracker(TrackerConfig(line=(LineConfig(str(tmp_path / "file")),))) as tracker:
        assert "this is no serial port" in silence_of(tracker, "no serial port")


def test_a_port_that_another_program_has_open():
    with Fake("liberty", 2) as fake, Tracker(fake.config()) as first:
        frames_of(first, 1)
        with Tracker(fake.config()) as second:
            assert "another program has it open" in silence_of(second, "another program")


def test_a_device_that_is_off():
    with Fake("liberty", 2, mute=True) as fake, Tracker(fake.config()) as tracker:
        assert "not a byte comes; is the LIBERTY switched on" in silence_of(tracker, "not a byte")


def test_a_device_that_sends_what_nobody_can_read():
    with Fake("fastrak", 2, form="ascii") as fake:
        config = msgspec.structs.replace(fake.config(), kind="liberty", format="binary")
        with Tracker(config) as tracker:
            stop = threading.Event()

            def babble():
                while not stop.wait(0.05):
                    fake._write(b"\x80\xf8\x00\x78" * 20)

            talker = threading.Thread(target=babble)
            talker.start()
            said = silence_of(tracker, "bytes come")
            stop.set()
            talker.join()
    assert "bytes come, but nothing that LIBERTY sends; the baud rate is hardly 115200" in said


def test_a_device_that_falls_silent_and_goes_on():
    with Fake("liberty", 3) as fake, Tracker(fake.config()) as tracker:
        before = frames_of(tracker, 5)[-1]
        fake.mute = True
        assert "LIBERTY fell silent" in silence_of(tracker, "fell silent")
        fake.mute = False
        frames = frames_of(tracker, 20)
        assert tracker.silence == ""
    assert frames[-1].number - before.number >= 60  # the frames of the silence are counted
    assert tracker.losses.lost >= 40


@pytest.mark.usefixtures("soon_set_up")
@pytest.mark.parametrize(("kind", "mode"), [("liberty", "continuous"), ("fastrak", "poll")])
def test_a_device_that_was_switched_off_and_on_is_set_up_again(kind, mode):
    with Fake(kind, 3) as fake, Tracker(fake.config(mode)) as tracker:
        frames_of(tracker, 5)
        fake.off = True
        assert "fell silent" in silence_of(tracker, "fell silent")
        fake.heard.clear()
        fake.off = False
        frames = frames_of(tracker, 10)
        assert tracker.silence == ""
    assert {"status", "centimetres", "output", "hemisphere"} <= set(fake.heard)
    assert all(after.number > before.number for before, after in itertools.pairwise(frames))
    assert frames[-1].status[:3].tolist() == [0, 0, 0]


@pytest.mark.usefixtures("soon_set_up")
def test_a_device_that_is_switched_on_late_is_set_up_then():
    with Fake("liberty", 2, off=True) as fake, Tracker(fake.config()) as tracker:
        assert "not a byte comes; is the LIBERTY switched on" in silence_of(tracker, "not a byte")
        fake.off = False
        assert frames_of(tracker, 5)[-1].status[:2].tolist() == [0, 0]
        assert "centimetres" in fake.heard


def test_a_cable_that_is_pulled_out():
    with Fake("liberty", 3) as fake, Tracker(fake.config()) as tracker:
        frames_of(tracker, 5)
        fake.unplug()
        said = silence_of(tracker, fake.path)
        assert "unplugged" in said or "no such port" in said
        tracker.poll()
    assert tracker.losses.reopened >= 1


@pytest.fixture
def free_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def datagram(number):
    return ultratrak.encode(1000 + number, [truth(station, number) for station in range(1, 16)])


def test_who_walks_out_of_reach_is_told_so_and_not_to_look_at_the_power():
    with Fake("liberty", 2) as fake, Tracker(fake.config()) as tracker:
        frames_of(tracker, 10)
        fake.away = 9.5
        said = silence_of(tracker, "values that can't be")
        assert "LIBERTY sends records with values that can't be; come nearer to the transmitter" in said
        fake.mute = True
        assert "fell silent" in silence_of(tracker, "fell silent")
        fake.away, fake.mute = 0.0, False
        frames_of(tracker, 10)
        assert tracker.silence == ""


def test_datagrams_of_who_is_out_of_reach(free_port):
    far = [msgspec.structs.replace(truth(station, 0), position=(9.5, 0.0, 0.0)) for station in range(1, 16)]
    sender, said = socket.socket(socket.AF_INET, socket.SOCK_DGRAM), ""
    with sender, Tracker(TrackerConfig(kind="ultratrak", udp=UdpConfig(free_port))) as tracker:
        end = time.monotonic() + 15.0
        while "values that can't be" not in said and time.monotonic() < end:
            sender.sendto(ultratrak.encode(round(60.0 * time.monotonic()), far), ("127.0.0.1", free_port))
            tracker.poll()
            said = tracker.silence
            time.sleep(0.02)
    assert "ULTRATRAK sends records with values that can't be; come nearer" in said


def test_datagrams_lost_doubled_late_and_foreign(free_port):
    config = TrackerConfig(kind="ultratrak", udp=UdpConfig(free_port))
    order = [0, 1, 2, 4, 3, 5, 5, 6, 8, 9, 7, 10, 13, 14]  # 11 and 12 never come
    sender = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    with sender, Tracker(config) as tracker:
        frames, end = [], time.monotonic() + 15.0
        while not tracker.ready and time.monotonic() < end:  # until the socket is there
            sender.sendto(datagram(0), ("127.0.0.1", free_port))
            frames += tracker.poll()
            time.sleep(0.02)
        for number in order:
            sender.sendto(b"foreign", ("127.0.0.1", free_port))
            sender.sendto(datagram(number), ("127.0.0.1", free_port))
        while (not frames or frames[-1].number < 14) and time.monotonic() < end:
            frames += tracker.poll()
            time.sleep(0.003)
    assert [frame.number for frame in frames] == [*range(11), 13, 14]
    assert all(is_true(frame, range(1, 16), frame.number) for frame in frames)
    losses = tracker.losses
    assert (losses.foreign, losses.lost) == (len(order), 2)
    assert losses.repeated >= 1


def test_why_no_datagram_comes(free_port):
    config = TrackerConfig(kind="ultratrak", udp=UdpConfig(free_port))
    with Tracker(config) as tracker, Tracker(config) as second:
        said = "".join(silence_of(one, "UDP") for one in (tracker, second))
    assert "nothing comes; does the tracker's PC send to this machine and port" in said
    assert "another program listens there" in said


def test_stopping_a_tracker_that_was_never_started():
    Tracker(TrackerConfig(line=(LineConfig("/dev/ttyNOT_THERE"),))).stop()
