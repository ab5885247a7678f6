"""`ahmss capture doctor`: for each thing that is wrong, the sentence that says so and what mends it."""

from __future__ import annotations

import errno
import grp
import json
import os
import pwd

import msgspec
import pytest

from ahmss.capture import doctor
from ahmss.capture.config import LineConfig, TrackerConfig, UdpConfig
from ahmss.capture.doctor import bits_a_second, examine, examine_tracker
from ahmss.capture.trouble import of_error
from tests.capture.faked import Fake


def told(findings):
    return {finding.what: f"{finding.found}; {finding.cure}" for finding in findings if not finding.ok}


@pytest.fixture(autouse=True)
def hasty(monkeypatch):
    monkeypatch.setattr(doctor, "_LISTEN", 0.5)


def test_a_tracker_that_is_well(capsys):
    with Fake("liberty", 15) as fake:
        stations = {link: number for link, number in TrackerConfig().stations.items() if number <= 15}
        config = msgspec.structs.replace(
            fake.config(),
            stations=stations,
            line=(LineConfig(fake.path, 921_600, tuple(range(1, 16))),),
        )
        assert told(examine(config)).keys() <= {"frames"}  # a busy machine may not keep up
        examine_tracker(config, as_json=True)
    said = json.loads(capsys.readouterr().out)
    assert [finding["what"] for finding in said["findings"]][:3] == ["line", "stations", "speed"]


def test_a_port_that_is_missing(capsys):
    config = TrackerConfig(line=(LineConfig("/dev/ttyNOT_THERE"),))
    assert examine_tracker(config) == 1
    assert "ILL  port: /dev/ttyNOT_THERE: no such port\n     to mend it: plug the tracker in" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("number", "said"),
    [
        (errno.EACCES, "this user may not open it; nor may they look at its rights"),
        (errno.EBUSY, "another program has it open"),
        (errno.EIO, "unplugged"),
        (errno.ENOTTY, "no serial port"),
    ],
)
def test_what_the_system_says_of_a_port(number, said):
    assert said in of_error("/dev/ttyUSB0", OSError(number, "words"))


@pytest.mark.parametrize(
    ("mode", "group", "said"),
    [
        (0o660, "tty", "type: sudo usermod -aG tty eve   (and log in again)"),
        (0o664, "daemon", "type: sudo usermod -aG daemon eve"),
        (0o620, "tty", "its mode lets no group in; type: sudo chown eve /dev/ttyUSB0"),
        (0o660, "root", "its mode lets no group in"),
        (0o600, "tty", "its mode lets no group in"),
    ],
)
def test_who_may_not_open_a_port_is_told_the_group_that_may(monkeypatch, mode, group, said):
    gid, asked = grp.getgrnam(group).gr_gid, os.stat
    real = os.stat_result((0o020000 | mode, 1, 1, 1, 0, gid, 0, 0, 0, 0))
    monkeypatch.setenv("USER", "eve")
    monkeypatch.setattr(os, "getgroups", lambda: [0])
    monkeypatch.setattr(os, "stat", lambda path, **more: real if path == "/dev/ttyUSB0" else asked(path, **more))
    assert f"may not open it; {said}" in of_error("/dev/ttyUSB0", OSError(errno.EACCES, "words"))
    monkeypatch.setattr(os, "getgroups", lambda: [gid])
    mine = of_error("/dev/ttyUSB0", OSError(errno.EACCES, "words"))
    assert ("is theirs" in mine) == ("usermod" in said)


def test_a_group_without_a_name_is_nobodys_to_join(monkeypatch):
    real, asked = os.stat_result((0o020660, 1, 1, 1, 0, 54_321, 0, 0, 0, 0)), os.stat
    monkeypatch.setenv("USER", "eve")
    monkeypatch.setattr(os, "stat", lambda path, **more: real if path == "/dev/ttyUSB0" else asked(path, **more))
    said = of_error("/dev/ttyUSB0", OSError(errno.EACCES, "words"))
    assert "usermod" not in said
    assert "54321, has no name here" in said
    assert "sudo chown eve /dev/ttyUSB0" in said


def test_a_folder_that_is_closed_is_named_and_who_may_open_it(monkeypatch, tmp_path):
    (tmp_path / "dev" / "serial").mkdir(parents=True)
    port, closed, asked = str(tmp_path / "dev" / "serial" / "ttyS9"), tmp_path / "dev", os.stat

    def refused(path, **more):
        if path == port:
            raise PermissionError(errno.EACCES, "Permission denied")
        return asked(path, **more)

    monkeypatch.setattr(os, "stat", refused)
    monkeypatch.setattr(os, "access", lambda path, _mode: closed not in (path, *path.parents))
    said = of_error(port, OSError(errno.EACCES, "words"))
    owner = pwd.getpwuid(closed.stat().st_uid).pw_name
    assert f"the folder {closed} is closed to them; {owner}, whose it is, or root may open it" in said
    assert f"sudo chmod o+x {closed}" in said


def test_a_device_that_is_off(monkeypatch):
    monkeypatch.setattr(doctor, "BAUDS", (115_200, 9_600))
    with Fake("liberty", 2, mute=True) as fake:
        findings = told(examine(fake.config()))
    assert "not a byte comes; is the LIBERTY switched on, is the cable plugged in" in findings["cable or power"]


def test_the_wrong_device(monkeypatch):
    monkeypatch.setattr(doctor, "BAUDS", (115_200,))
    with Fake("fastrak", 2) as fake:  # which takes a Liberty's stop for a poll
        findings = told(examine(msgspec.structs.replace(fake.config(), kind="liberty")))
    assert "no answer of a LIBERTY at any baud rate; is kind = 'liberty' right?" in findings["device"]


def test_a_sensor_that_is_missing_and_a_line_that_is_too_slow():
    with Fake("liberty", 12) as fake:
        line = LineConfig(fake.path, 115_200, tuple(range(1, 16)))
        findings = told(examine(msgspec.structs.replace(fake.config(), line=(line,))))
    assert "no sensor at its station 13 (left_upper_leg), 14 (left_lower_leg), 15 (left_foot)" in findings["stations"]
    assert "at most 17 frames a second get through" in findings["speed"]


def test_a_weak_sensor():
    with Fake("fastrak", 4, rate=30.0, weak=2) as fake:
        stations = {link: number for link, number in TrackerConfig().stations.items() if number <= 4}
        findings = told(examine(msgspec.structs.replace(fake.config(), stations=stations)))
    assert "weak: spine; come nearer to the transmitter" in findings["signal"]


def test_loads_of_lines():
    line = LineConfig("x")
    for form, orientation, kbaud in (("ascii", "quaternion", 486), ("ascii", "euler", 423), ("binary", "euler", 261)):
        config = TrackerConfig(kind="fastrak", format=form, orientation=orientation, line=(line,))
        assert bits_a_second(config, line) == kbaud * 1000


def test_no_datagram(monkeypatch):
    config = TrackerConfig(kind="ultratrak", udp=UdpConfig(1))
    monkeypatch.setattr(doctor, "_PATIENCE", 1.5)
    findings = told(examine(config))
    assert "UDP 127.0.0.1:1" in findings["frames"]
