"""A tracker drives a human of the world."""

from __future__ import annotations

import json
import re
import subprocess
import time

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.capture.config import LineConfig, TrackerConfig
from ahmss.capture.live import Latency, Performer, Puppet, drive
from ahmss.capture.stations import Status, TrackerFrame
from ahmss.database.workspace import Workspace
from ahmss.errors import DependencyError
from ahmss.world.client import WorldClient
from ahmss.world.process import ServerProcess
from tests.capture.faked import Fake
from tests.capture.stage import AHMSS, ROOT, simulated
from tests.capture.taken import SUBJECT, degrees_between, performed, take_of


@pytest.fixture(scope="module")
def ken():
    return Workspace.find(ROOT).humans.get("ken")


def frames_of(take) -> list[TrackerFrame]:
    rows = zip(take.times, take.rotations, take.positions, take.status, strict=True)
    return [TrackerFrame(k, float(t), q, p, s, float(t)) for k, (t, q, p, s) in enumerate(rows)]


def test_it_waits_for_the_upright_pose_and_then_does_what_the_subject_does(ken):
    performance = performed("lift")
    take, _ = take_of(performance)
    performer = Performer(SUBJECT, TrackerConfig(), Puppet("ken", ken, (2.0, 1.0), np.radians(90.0)))
    poses = [performer.step(frame) for frame in frames_of(take)]
    first = next(k for k, pose in enumerate(poses) if pose is not None)
    assert first == 59  # a second of standing still
    rotations, root = poses[first]
    np.testing.assert_allclose(root[:2], [2.0, 1.0], atol=0.01)
    np.testing.assert_allclose(rotate(rotations[0], np.array([0.0, 0.0, -1.0])), [0.0, 1.0, 0.0], atol=1e-6)
    spine = INDEX["spine"]
    found = np.array([pose[0][spine] for pose in poses[first:]])
    assert degrees_between(found, performance.rotations[first:, spine]).max() < 0.01
    drop = [root[2] - pose[1][2] for pose in poses[first:]]
    meant = performance.root[first, 2] - performance.root[first:, 2]
    np.testing.assert_allclose(drop, meant, atol=0.03)
    feet = [forward(*pose, SUBJECT.offsets)[0][[INDEX["right_foot"], INDEX["left_foot"]]] for pose in poses[first:]]
    assert np.ptp(feet, axis=0).max() < 0.05  # lifting, one stays where one is


def test_who_moves_or_is_not_seen_whole_does_not_calibrate_it(ken):
    take, _ = take_of(performed("lift"))
    performer = Performer(SUBJECT, TrackerConfig(), Puppet("ken", ken))
    moving = frames_of(take)[150:]
    assert all(performer.step(frame) is None for frame in moving[:120])
    take.status[:, 3] = Status.MISSING
    assert all(performer.step(frame) is None for frame in frames_of(take)[:100])


def test_latency_in_milliseconds():
    assert Latency.of([]) == Latency(0, 0.0, 0.0)
    assert "not known" in Latency.of([]).sentence
    found = Latency.of([0.001] * 98 + [0.1] * 2)
    assert (found.frames, found.p50) == (100, 1.0)
    assert found.p99 > 50.0


@pytest.fixture
def driven(ken, tmp_path):
    """Drives ken by a tracker for so many seconds: what it raised, and what was said."""
    server = ServerProcess(log=tmp_path / "server.log")

    def drive_by(config: TrackerConfig, seconds: float) -> tuple[str, list[str]]:
        said: list[str] = []
        with WorldClient(str(server.address)) as client, pytest.raises(DependencyError) as raised:
            drive(config, Puppet("ken", ken), Workspace.find(ROOT).humans.shape("ken"), client, said.append, seconds)
        return str(raised.value), said

    yield drive_by
    server.stop()


def test_who_got_nothing_live_is_told_why(driven):
    why, said = driven(TrackerConfig(line=(LineConfig("/dev/ttyNOT_THERE"),)), 0.3)
    assert "/dev/ttyNOT_THERE: no such port" in why
    assert not any("p50" in line for line in said)
    with Fake("liberty", 2) as fake:
        why, _ = driven(fake.config(), 2.0)
    assert re.search(r"did not stand upright and still for a second in \d+ frames", why)


def test_the_tracker_drives_a_human_of_the_world(tmp_path):
    server = ServerProcess(log=tmp_path / "server.log")
    words = ["--human", "aiko", "--at", "1.0", "0.5", "--seconds", "5", "--json", "--workspace", str(ROOT)]
    try:
        with simulated(tmp_path, "lift", "--upright", "1.2") as config, WorldClient(str(server.address)) as client:
            live = subprocess.Popen(
                [*AHMSS, "capture", "live", str(config), *words, "--server", str(server.address)],
                stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            )  # fmt: skip
            heights: list[float] = []
            fingers: list[Array] = []
            while live.poll() is None:
                seen = client.refresh().human_poses
                heights += seen[:, 2].tolist()
                fingers += list(seen[:, 3:].reshape(-1, 43, 4)[:, 15:])
                time.sleep(0.05)
            out, said = live.communicate()
            left = client.refresh().human_poses
    finally:
        server.stop()
    assert live.returncode == 0, said
    assert "calibrated: move" in said
    assert json.loads(out)["byte_to_server_ms"]["frames"] > 100
    assert max(heights) - min(heights) > 0.2  # it bent to lift
    assert degrees_between(np.array(fingers), fingers[0]).max() < 0.1  # relaxed from the start
    assert len(left) == 0
