"""What takes long: `make test-long`."""

from __future__ import annotations

import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import zmq
from ground import ROOT, ROTATIONS, eventually, join, row

from ahmss.world import frame as frames
from ahmss.world import schema
from ahmss.world.schema import NewObject

pytestmark = [pytest.mark.long, pytest.mark.timeout(300)]

REQUESTS = [
    schema.Hello(1), schema.Heartbeat(2), schema.Join("eve", "b", bytes(1400), request=3),
    schema.Leave("ken", request=4),
    schema.Add([NewObject("a", "b")], 5), schema.Remove("cup", 6), schema.Claim("ken", ["cup"], "left", 7),
    schema.Move([schema.ObjectPose("cup", (0, 0, 0), (1, 0, 0, 0))], request=8), schema.GetScene(9),
    schema.SetState([schema.StateChange("cup", "full", "no")], 10), schema.PutAsset("a" * 64, 9, 0, b"x", 11),
    schema.GetAsset("b" * 64, -5, 12), schema.Sync("ken", "l", ["ken"], 13), schema.Transfer("cup", "ken", "eve"),
]  # fmt: skip


def memory_mb(pid: int) -> float:
    with open(f"/proc/{pid}/status") as file:
        return next(int(line.split()[1]) for line in file if line.startswith("VmRSS")) / 1024


def test_half_right_messages_never_stop_the_server_or_fill_its_memory(start, connect):
    server = start()
    ken = connect(server)
    number = join(ken, "ken")
    (cup,) = ken.add([NewObject("cup", "cup", states={"full": "yes"})])
    ken.claim("ken", ["cup"])
    dice = np.random.default_rng(3)
    seeds = [schema.encode(request) for request in REQUESTS]
    seeds += [frames.pack(number, 9, ROOT, ROTATIONS, row(cup.id, (1, 2, 3))), frames.bundle([b"F", b"x" * 2000])]
    context = zmq.Context()
    vandal = context.socket(zmq.DEALER)
    vandal.setsockopt(zmq.SNDHWM, 100)
    vandal.connect(f"tcp://{server.address}")
    end, count = time.monotonic() + 60, 0
    while time.monotonic() < end:
        data = bytearray(seeds[dice.integers(len(seeds))])
        for _ in range(dice.integers(0, 4)):
            data[dice.integers(len(data))] = dice.integers(256)
        vandal.send(bytes(data[: dice.integers(1, len(data) + 1)]) if dice.random() < 0.3 else bytes(data))
        while vandal.poll(0):
            vandal.recv()
        count += 1
        if count == 5000:
            early = memory_mb(server.pid)
        if count % 1000 == 0:
            ken.publish("ken", count, ROOT, ROTATIONS, row(cup.id, (count / 1e6, 2, 3)))
            ken.poll()
    vandal.close(0)
    context.term()
    assert count > 5000
    assert memory_mb(server.pid) < early + 50
    ken.publish("ken", count + 1, ROOT + 1, ROTATIONS, row(cup.id, (7, 2, 3)))
    eventually(lambda: ken.refresh().pose("cup")[0] == 7)
    assert ken.refusals == []


VIEWER = """
import sys
from ahmss.world.client import WorldClient
with WorldClient(sys.argv[1]) as viewer:
    viewer.refresh()
    while viewer.poll().human("ken")[0][0] < 60:
        viewer.rest(0.1)
"""


def test_a_viewer_that_stalls_for_a_minute_costs_nothing_and_then_sees_the_newest(start, connect, tmp_path):
    server = start()
    ken = connect(server)
    join(ken, "ken")
    stalled = subprocess.Popen([sys.executable, "-c", VIEWER, server.address])
    time.sleep(2)
    stalled.send_signal(signal.SIGSTOP)
    before = memory_mb(server.pid)
    begin = time.monotonic()
    frame = 0
    while time.monotonic() < begin + 61:
        frame += 1
        ken.publish("ken", frame, ROOT + (time.monotonic() - begin), ROTATIONS)
        ken.poll()
        time.sleep(1 / 60)
    assert memory_mb(server.pid) < before + 30
    stalled.send_signal(signal.SIGCONT)
    assert stalled.wait(20) == 0
    assert ken.stats().frames > frame * 0.9


def test_servers_killed_again_and_again_lose_nothing(start, connect, tmp_path):
    server = start(directory=tmp_path / "world")
    address, names = server.address, set()
    for life in range(12):
        with connect(server) as ken:
            assert set(ken.refresh().objects) == names
            for number in range(20):
                name = f"o{life}_{number}"
                ken.add([NewObject(name, "cup", states={"n": float(number)})])
                names.add(name)
            gone = f"o{life}_3"
            ken.remove(gone)
            names.discard(gone)
            tick = ken.refresh().tick
            eventually(lambda ken=ken, tick=tick: ken.poll().tick > tick + 1)
        server.kill()
        server = start(address=address, directory=tmp_path / "world")
