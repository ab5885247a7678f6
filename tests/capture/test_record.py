"""`ahmss capture record` as a user runs it: what is saved, however it ends."""

from __future__ import annotations

import json
import signal
import subprocess
import time

import numpy as np
import pytest

from ahmss import cli
from ahmss.capture import record
from ahmss.capture.config import template
from ahmss.capture.record import Progress, rate_of
from ahmss.capture.session import Wishes, calibrate_take, facing_of, record_clip
from ahmss.capture.stations import TrackerFrame
from ahmss.capture.take import load
from ahmss.errors import CommandError
from ahmss.motion import clip as clips
from tests.capture.stage import AHMSS, ROOT, simulated


def test_ctrl_c_ends_it_and_what_came_is_saved(tmp_path):
    with simulated(tmp_path, "lift") as config:
        command = [*AHMSS, "capture", "record", str(tmp_path / "lift.npz"), "--tracker", str(config), "--json"]
        child = subprocess.Popen(
            [*command, "--workspace", str(ROOT)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        assert child.stderr is not None
        for line in child.stderr:
            if "frames" in line:  # it has begun
                break
        time.sleep(1.5)
        child.send_signal(signal.SIGINT)
        out, said = child.communicate(timeout=40)
    assert child.returncode == 0, said
    told = json.loads(out)
    take, clip = load(tmp_path / "lift.take.npz"), clips.load(tmp_path / "lift.npz")
    assert take.frames == clip.frames == told["frames"] > 60
    assert clip.header.human == "ken"
    assert told["jumps"] == []  # gaps there may be: a busy machine reads late

    wishes = Wishes("aiko", (0.1, 1.0), "0", mend=False, smooth=0.0, workspace=ROOT)
    calibrate_take(tmp_path / "lift.take.npz", tmp_path / "again.npz", wishes, force=False, as_json=False)
    assert clips.load(tmp_path / "again.npz").header.human == "aiko"
    with pytest.raises(CommandError, match=r"again\.npz: it is there already"):
        calibrate_take(tmp_path / "lift.take.npz", tmp_path / "again.npz", wishes, force=False, as_json=False)
    with pytest.raises(CommandError, match=r"lift\.take\.npz: it is there already"):
        record_clip(tmp_path / "lift.npz", config, wishes, seconds=1.0, wait=0.0, origin="", force=False, as_json=False)


def test_a_tracker_that_is_not_there_is_said_in_a_sentence(tmp_path):
    config = tmp_path / "tracker.toml"
    config.write_text(template("liberty").replace("/dev/ttyUSB0", str(tmp_path / "none")))
    child = subprocess.Popen(
        [*AHMSS, "capture", "record", str(tmp_path / "x.npz"), "--tracker", str(config), "--workspace", str(ROOT)],
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    assert child.stderr is not None
    line = next(line for line in child.stderr if "none" in line)
    assert "no such port" in line
    child.send_signal(signal.SIGTERM)
    _, said = child.communicate(timeout=20)
    assert child.returncode == 1
    assert said.startswith("ahmss: ")
    assert not (tmp_path / "x.take.npz").exists()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("simulate", "dance"), "no performance"),
        (("simulate", "lift", "--noise", "much"), "--noise"),
        (("simulate", "lift", "--kind", "kinect"), "--kind"),
        (("calibrate", "nowhere.take.npz"), "no such take"),
        (("config", "--kind", "kinect"), "fastrak, liberty"),
        (("record", "x.npz", "--tracker", "nowhere.toml"), "nowhere.toml"),
    ],
)
def test_what_is_typed_wrong_is_told_in_one_sentence(words, said, monkeypatch, capsys):
    monkeypatch.setattr("sys.argv", ["ahmss", "capture", *words])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 1
    told = capsys.readouterr().err
    assert said in told
    assert told.count("\n") == 1


def test_facing_is_degrees_or_sensors():
    assert facing_of("90") == pytest.approx(np.pi / 2)
    assert facing_of("sensors") is None
    for wrong in ("north", "nan", "inf"):
        with pytest.raises(CommandError, match="sensors"):
            facing_of(wrong)


@pytest.mark.parametrize("upright", [(np.nan, 2.0), (0.0, np.inf)])
def test_the_upright_stretch_is_seconds(upright, tmp_path, monkeypatch):
    wishes = Wishes("ken", upright, "0", False, 0.0, ROOT)
    with pytest.raises(CommandError, match="give the seconds"):
        wishes.choices(60.0)
    (tmp_path / "tracker.toml").write_text(template("liberty"))
    monkeypatch.setattr(record, "Tracker", lambda _: pytest.fail("somebody is to perform"))
    with pytest.raises(CommandError, match="--upright"):
        record_clip(
            tmp_path / "x.npz", tmp_path / "tracker.toml", wishes, seconds=1.0, wait=60.0, origin="", force=False,
            as_json=False,
        )  # fmt: skip


def frames(count: int, rate: float) -> list[TrackerFrame]:
    rotations, nothing = np.tile([1.0, 0.0, 0.0, 0.0], (15, 1)), np.zeros(15, np.uint8)
    return [TrackerFrame(k, k / rate, rotations, np.zeros((15, 3)), nothing, 0.0) for k in range(count)]


def test_a_take_has_the_rate_at_which_frames_really_came():
    assert rate_of(frames(100, 60.2), 60.0) == 60.0
    assert rate_of(frames(100, 30.0), 60.0) == pytest.approx(30.0)
    assert rate_of(frames(10, 30.0), 60.0) == 60.0  # too few to tell


def test_how_far_it_is():
    assert Progress(0, 0.0, "", ()).line == "waiting for the first frame"
    assert Progress(90, 1.5, "no power", ("head",)).line == "1.5 s, 90 frames; weak or missing: head; no power"
