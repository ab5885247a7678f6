"""Every record format: golden bytes, there and back, cut up anywhere, and what is refused."""

from __future__ import annotations

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from ahmss.body.euler import from_euler, to_euler
from ahmss.capture.commands import ALL_STATIONS, Command, CommandDecoder, encode
from ahmss.capture.formats import fastrak_ascii, fastrak_binary, liberty, ultratrak
from ahmss.capture.formats.answers import (
    StatusRecord,
    encode_stations,
    encode_status,
    find_stations,
    find_status,
)
from ahmss.capture.formats.layout import Layout
from ahmss.capture.formats.losses import Losses
from ahmss.capture.stations import Reading
from ahmss.errors import CommandError
from tests.body.strategies import rotations
from tests.capture.damage import FORMATS

TURNED = Reading(2, "", (0.254, -0.0508, 1.27), (0.5, -0.5, 0.5, 0.5), 7, 1.5)
GARBAGE = b"\x00garbage 01 L"
SERIAL = [form for form in FORMATS.values() if form.parser]


@given(rotations(shape=(20,)))
def test_euler_angles_are_intrinsic_z_y_x(q):
    angles = to_euler(q)
    assert np.all(np.abs(angles[:, 1]) <= np.pi / 2)
    theirs = Rotation.from_euler("ZYX", angles).as_quat(scalar_first=True)
    np.testing.assert_allclose(np.abs(np.einsum("ij,ij->i", theirs, q)), 1.0, atol=1e-7)
    np.testing.assert_allclose(np.abs(np.einsum("ij,ij->i", from_euler(angles), q)), 1.0, atol=1e-7)


def test_azimuth_turns_about_z_first():
    quarter = np.radians([90.0, 0.0, 0.0])
    np.testing.assert_allclose(from_euler(quarter), [np.sqrt(0.5), 0, 0, np.sqrt(0.5)], atol=1e-12)
    straight_up = from_euler(np.radians([20.0, 90.0, 0.0]))
    np.testing.assert_allclose(np.degrees(to_euler(straight_up)), [20.0, 90.0, 0.0], atol=1e-5)


def test_printed_records_of_fastrak():
    wide = b"02   10.00  -2.00  50.00 0.5000-0.5000 0.5000 0.5000\r\n"
    assert fastrak_ascii.encode(TURNED, Layout((2, 11, 1), "inch")) == wide
    weak = Reading(1, "A", (0.0123, 0.0, -1.0), (1.0, 0.0, 0.0, 0.0))
    assert fastrak_ascii.encode(weak, Layout((2, 0, 4, 1), "cm")) == (
        b"01A   1.23   0.00-100.00    0.00   0.00   0.00\r\n"
    )


@pytest.mark.parametrize("number", [b"012.34 ", b" 12.34 ", b"+12.34", b"+012.34", b"  12.34", b"+ 12.34"])
def test_signs_and_padding_that_a_fastrak_may_print(number):
    field = number.strip().rjust(7) if len(number.strip()) < 7 else number.strip()
    record = b"01 " + field + b"   0.00-  1.50" + b" 1.0000 0.0000-0.0000 0.0000\r\n"
    (reading,) = fastrak_ascii.parser(Layout((2, 11, 1), "cm")).feed(record)
    assert reading.position == pytest.approx((0.1234, 0.0, -0.015))


def test_binary_records_of_fastrak():
    golden = b"02 " + struct.pack("<7f", 10.0, -2.0, 50.0, 0.5, -0.5, 0.5, 0.5) + b"\r\n"
    assert fastrak_binary.encode(TURNED, Layout((2, 11, 1), "inch")) == golden


def test_binary_records_of_liberty_and_patriot():
    layout = Layout((2, 7, 8, 9), "cm")
    body = struct.pack("<7fII", 25.4, -5.08, 127.0, 0.5, -0.5, 0.5, 0.5, 1500, 7)
    assert liberty.encode(TURNED, layout) == b"LY\x02C \x00" + struct.pack("<H", 36) + body
    assert liberty.encode(TURNED, layout, "patriot")[:2] == b"PA"
    (reading,) = liberty.parser(layout).feed(liberty.encode(TURNED, layout, "patriot"))
    assert (reading.station, reading.count, reading.stamp) == (2, 7, 1.5)


def test_a_datagram_of_ultratrak():
    data = ultratrak.encode(123, [Reading(4, "", (0.01, 0.02, 0.03), (1.0, 0.0, 0.0, 0.0))])
    head, record = data[:56], data[56:]
    assert head.split() == [b"Frame", b"123", b"Size", b"89", b"Header", b"56", b"Record", b"33"]
    assert record == b"\x001" + b"1" + b"2\x00" + struct.pack("<7f", 1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0)
    frame = ultratrak.decode(data, "cm", Losses())
    assert frame is not None
    assert (frame.number, frame.readings[0].station) == (123, 4)


@pytest.mark.parametrize(
    "data", [b"", b"hello", b"GET / HTTP/1.1\r\n\r\n" + bytes(600), bytes(551), b"a 1 b 551 c 56 d 33"]
)
def test_foreign_datagrams_are_counted(data):
    losses = Losses()
    assert ultratrak.decode(data, "cm", losses) is None
    assert losses.foreign == 1


@pytest.mark.parametrize("form", SERIAL, ids=lambda form: form.name)
@given(q=rotations(), place=st.tuples(*[st.floats(-4.0, 4.0)] * 3), station=st.integers(1, 15), cut=st.integers(0, 300))
@settings(max_examples=25)
def test_what_is_sent_is_read_however_it_is_cut(form, q, place, station, cut):
    sent = Reading(station, "B", place, tuple(q.tolist()), 4_000_000_000, 4_000_000.5)
    record = form.encode(sent, form.layout)
    stream = GARBAGE + record + record[: cut % len(record)] + record
    parser = form.parser(form.layout)
    came = [reading for at in range(0, len(stream), 7) for reading in parser.feed(stream[at : at + 7], 3.0)]
    assert len(came) == 2
    for reading in came:
        assert (reading.station, reading.status, reading.arrival) == (station, "B", 3.0)
        np.testing.assert_allclose(reading.position, place, atol=2e-4)
        assert abs(np.dot(reading.rotation, q)) > 1.0 - 2e-7
        assert np.linalg.norm(reading.rotation) == pytest.approx(1.0, abs=1e-12)
        if 9 in form.layout.items:
            assert (reading.count, reading.stamp) == (4_000_000_000, 4_000_000.5)
    assert parser.losses.records == 2
    assert parser.losses.skipped_bytes == len(GARBAGE) + cut % len(record)


@pytest.mark.parametrize(
    "numbers",
    [(np.nan, 0, 0, 1, 0, 0, 0), (2000, 0, 0, 1, 0, 0, 0), (0, 0, 0, 1.01, 0, 0, 0), (0, 0, 0, np.inf, 0, 0, 0)],
    ids=["not a number", "too far", "not unit", "infinite"],
)
def test_values_that_cannot_be_are_damage(numbers):
    parser = fastrak_binary.parser(Layout((2, 11, 1), "cm"))
    assert parser.feed(b"01 " + struct.pack("<7f", *numbers) + b"\r\n") == []
    assert (parser.losses.damaged, parser.losses.records) == (1, 0)


def test_angles_out_of_range_are_damage():
    parser = fastrak_ascii.parser(Layout((2, 4, 1)))
    assert parser.feed(b"01    1.00   1.00   1.00  10.00  91.00   0.00\r\n") == []
    assert parser.losses.damaged == 1


def test_a_layout_that_cannot_be_is_refused():
    with pytest.raises(CommandError, match="no item 99; there are: 0 space, 1 CR LF, 2 position"):
        fastrak_ascii.parser(Layout((2, 99)))
    with pytest.raises(CommandError, match=r"needs 2 .position. and one of 4"):
        fastrak_binary.parser(Layout((2, 1)))
    with pytest.raises(CommandError, match="each once"):
        liberty.parser(Layout((2, 7, 7)))


@pytest.mark.parametrize("kind", ["fastrak", "liberty"])
def test_commands_are_decoded_as_they_were_meant(kind):
    said = [
        Command("poll"),
        Command("output", 3, (2.0, 11.0, 1.0)),
        Command("hemisphere", ALL_STATIONS if kind == "liberty" else 2, (0.0, 0.0, -1.0)),
        Command("station", 2, (0.0,)),
        Command("binary"),
        Command("centimetres"),
        Command("boresight", 1),
        Command("reinitialise"),
        Command("status"),
        Command("continuous"),
    ]
    decoder = CommandDecoder(kind)
    data = b"".join(encode(kind, command) for command in said)
    assert [command for byte in data for command in decoder.feed(bytes([byte]))] == said
    assert [command.name for command in decoder.feed(b"~O1,two\rP")] == ["unknown", "unknown", "poll"]


def test_golden_commands():
    assert encode("fastrak", Command("output", 1, (2, 4, 1))) == b"O1,2,4,1\r"
    assert encode("fastrak", Command("centimetres")) == b"u"
    assert encode("liberty", Command("output", ALL_STATIONS, (2, 7))) == b"O*,2,7\r"
    assert encode("liberty", Command("centimetres")) == b"U1\r"
    assert encode("liberty", Command("station", 1)) == b"\x150\r"
    with pytest.raises(CommandError, match="liberty: no command 'stop'"):
        encode("liberty", Command("stop"))


def test_the_status_record_of_fastrak_has_55_bytes():
    status = StatusRecord(True, "cm", True, "", "04.31", "laboratory")
    record = encode_status("fastrak", status, 1, (1, 2, 4))
    assert record == b"21S3FB    F3B  04.31 laboratory" + b" " * 22 + b"\r\n"
    assert len(record) == 55
    assert find_status("fastrak", b"01 12" + record + b"01") == status
    assert find_status("fastrak", record[:-1]) is None


def test_which_stations_there_are():
    assert encode_stations("fastrak", (1, 3)) == b"21l1010\r\n"
    assert find_stations("fastrak", b"x21l1010\r\n") == (1, 3)
    assert find_stations("liberty", encode_stations("liberty", range(1, 16), (2, 15))) == (2, 15)
    assert find_stations("liberty", b"LY\x00\x15") is None
    for printed in (True, False):
        said = encode_status("liberty", StatusRecord(not printed, text="Liberty 240/16", firmware="2.1"))
        assert find_status("liberty", said) == StatusRecord(not printed, text="Liberty 240/16 2.1")
