from __future__ import annotations

import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from ground import ROOT, ROTATIONS, eventually, join, row

from ahmss.world import schema
from ahmss.world.recording import Reader
from ahmss.world.view import World

FRAMES = 60
MAIN = Path(__file__).with_name("lockstep_main.py")


def play(start, connect, path: Path, names: tuple[str, ...], seed: int) -> bytes:
    server = start(lockstep=names, recording=path)
    with connect(server, follow=False) as room:
        room.add([schema.NewObject("cup", "cup", (1, 0, 1), states={"by": ""})])
    command = [sys.executable, MAIN, server.address]
    mains = [subprocess.Popen([*command, name, str(FRAMES), str(seed)]) for name in reversed(names)]
    assert [main.wait(50) for main in mains] == [0] * len(names)
    server.stop()
    return path.read_bytes()


def test_two_runs_with_one_seed_give_the_same_bytes(start, connect, tmp_path):
    names = ("aiko", "ken")
    first = play(start, connect, tmp_path / "1", names, 7)
    assert first == play(start, connect, tmp_path / "2", names, 7)
    with Reader(tmp_path / "1") as reader:
        assert len(reader) == FRAMES
        holders = {change.holder for tick in range(FRAMES) for change in reader.snapshot(tick).changes}
    assert holders >= {"aiko", "ken"}  # both had it: the race for it was run, and always won by the same


def test_another_seed_gives_other_bytes(start, connect, tmp_path):
    assert play(start, connect, tmp_path / "1", ("ken",), 1) != play(start, connect, tmp_path / "2", ("ken",), 2)


def test_the_tick_waits_for_every_main(start, connect):
    server = start(lockstep=("aiko", "ken"))
    aiko, ken = connect(server, follow=False), connect(server, follow=False)
    first = aiko.begin(schema.Join("aiko", "ken", np.concatenate([ROOT, ROTATIONS.ravel()]).tobytes()))
    aiko.rest(0.3)
    aiko.poll()
    assert not first.done  # ken has said nothing yet
    ken_join = ken.begin(schema.Join("ken", "ken", np.concatenate([ROOT, ROTATIONS.ravel()]).tobytes()))
    assert ken.finish(ken_join)
    assert aiko.finish(first)


def test_a_main_sees_what_others_did_in_the_tick(start, connect):
    server = start(lockstep=("aiko", "ken"))
    aiko, ken = connect(server, follow=False), connect(server, follow=False)
    with connect(server, follow=False) as room:
        room.add([schema.NewObject("cup", "cup", (1, 0, 1))])
    with ThreadPoolExecutor() as together:
        list(together.map(join, (aiko, ken), ("aiko", "ken")))
    scenes = [client.begin(schema.GetScene()) for client in (aiko, ken)]
    for client, scene in zip((aiko, ken), scenes, strict=True):
        client.finish(scene)
    claims = [c.begin(schema.Claim(n, ["cup"])) for c, n in ((aiko, "aiko"), (ken, "ken"))]
    aiko.finish(claims[0])
    with pytest.raises(Exception, match="held by aiko"):
        ken.finish(claims[1])
    cup = aiko.world.objects["cup"].id
    aiko.publish("aiko", 1, ROOT + 1, ROTATIONS, row(cup, (5, 6, 7)))
    ken.publish("ken", 1, ROOT + 2, ROTATIONS)
    aiko.collect()
    ken.collect()
    assert ken.world.pose("cup")[:3].tolist() == [5, 6, 7]
    assert aiko.world.pose("cup")[:3].tolist() == [5, 6, 7]
    assert ken.world.objects["cup"].holder == "aiko"
    assert np.allclose(aiko.world.human("ken")[0], ROOT + 2)
    assert np.allclose(ken.world.human("aiko")[0], ROOT + 1)


def test_a_killed_main_does_not_hold_up_the_others(start, connect, tmp_path):
    server = start(lockstep=("aiko", "ken"), lease_s=0.5)
    command = [sys.executable, MAIN, server.address, "aiko", "100000", "1"]
    with connect(server, follow=False) as room:
        room.add([schema.NewObject("cup", "cup", (1, 0, 1), states={"by": ""})])
    aiko = subprocess.Popen(command)
    ken = connect(server, follow=False, timeout=40)
    join(ken, "ken")
    ken.refresh()
    ken.publish("ken", 1, ROOT, ROTATIONS)
    ken.collect()
    aiko.kill()
    aiko.wait()
    for k in range(2, 20):
        ken.publish("ken", k, ROOT, ROTATIONS)
        ken.collect(timeout=20)
    ken.claim("ken", ["cup"])
    assert "gone" in (tmp_path / "server.log").read_text()


def test_humans_meet_at_a_line_and_a_human_that_left_is_not_waited_for(start, connect):
    server = start()
    aiko, ken, eve = (connect(server) for _ in range(3))
    for client, name in ((aiko, "aiko"), (ken, "ken"), (eve, "eve")):
        join(client, name, group="run")
    names = ["aiko", "ken", "eve"]
    first, second = aiko.sync("aiko", "line 3", names), ken.sync("ken", "line 3", names)
    ken.hello()
    aiko.poll()
    ken.poll()
    assert not first.done
    assert not second.done
    eve.leave("eve")
    eventually(lambda: (aiko.poll(), ken.poll(), first.done and second.done)[-1])


def test_a_main_alone_runs_ahead_and_its_requests_keep_their_place(start, connect, tmp_path):
    server = start(lockstep=("ken",), recording=tmp_path / "run")
    with connect(server, follow=False) as ken:
        join(ken, "ken")
        (cup,) = ken.add([schema.NewObject("cup", "cup")])
        ken.refresh()
        for k in range(1, 101):
            if k == 51:
                ken.claim("ken", ["cup"])
            ken.publish("ken", k, ROOT, ROTATIONS, row(cup.id, (k, 0, 0)) if k > 50 else None)
            ken.collect(behind=1)
        assert ken.collect().tick == 100
        ken.leave("ken")
    server.stop()
    with Reader(tmp_path / "run") as reader:
        held = [reader.show(tick, World()).objects["cup"].holder == "ken" for tick in range(100)]
        assert held == [False] * 50 + [True] * 50
        assert [reader.snapshot(tick).tick for tick in range(100)] == list(range(1, 101))
