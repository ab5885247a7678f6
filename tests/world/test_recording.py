from __future__ import annotations

import numpy as np
import pytest
from ground import KEN, ROOT, ROTATIONS, eventually, join, row

from ahmss.errors import DataError
from ahmss.world.recording import Reader
from ahmss.world.replay import replay
from ahmss.world.schema import NewObject
from ahmss.world.view import World


def record(start, connect, path, frames=40):
    """A cup is taken at frame 10, emptied at 20 and gone at 30; ken walks."""
    server = start(recording=path, lockstep=("ken",))
    with connect(server, follow=False) as ken:
        join(ken, "ken")
        shape = ken.put_asset(b"shape of a cup")
        (cup,) = ken.add([NewObject("cup", "cup", (1, 0, 1), shape=shape, states={"full": "yes"})])
        ken.refresh()
        for k in range(1, frames + 1):
            moved = row(cup.id, (k, 0, 0)) if 10 < k < 30 else None
            if k == 10:
                ken.claim("ken", ["cup"], "right")
            elif k == 20:
                ken.set_state("cup", "full", "no")
            elif k == 30:
                ken.remove("cup")
            ken.publish("ken", k, ROOT + [k, 0, 0], ROTATIONS, moved)  # noqa: RUF005 - a sum
            ken.collect()
        ken.leave("ken")
    server.stop()


def test_a_recording_says_every_tick_in_any_order(start, connect, tmp_path):
    path = tmp_path / "run.ahmss"
    record(start, connect, path)
    with Reader(path) as reader:
        assert reader.is_whole
        assert len(reader) == 40
        assert reader.rate == 60
        world = World()
        for tick in (39, 0, 25, 12, 19):
            reader.show(tick, world)
            k = tick + 1
            assert np.allclose(world.human("ken")[0], ROOT + np.array([k, 0, 0]), atol=1e-5)
            assert ("cup" in world.objects) == (k < 30)
            if k < 30:
                assert world.pose("cup")[0] == (k if k > 10 else 1)
                assert world.objects["cup"].holder == ("ken" if k >= 10 else "")
                assert world.objects["cup"].states["full"] == ("no" if k >= 20 else "yes")
        assert reader.asset(reader.scene(0).objects[0].shape) == b"shape of a cup"
        assert reader.skeleton(reader.scene(0).humans[0]) == KEN.to_record()


@pytest.mark.parametrize("lost", [1, 700, 9000])
def test_a_recording_that_was_cut_off_is_read_up_to_its_last_whole_tick(start, connect, tmp_path, lost):
    path = tmp_path / "run.ahmss"
    record(start, connect, path)
    whole = path.read_bytes()
    path.write_bytes(whole[:-lost])
    with Reader(path) as reader:
        assert not reader.is_whole
        assert 20 < len(reader) < 40
        assert reader.show(len(reader) - 1, World()).human_frames.tolist() == [len(reader)]


def test_what_is_no_recording_is_one_sentence(tmp_path):
    for content in (b"", b"AHMSS", b"something else entirely"):
        path = tmp_path / "no"
        path.write_bytes(content)
        with pytest.raises(DataError, match="no recording"):
            Reader(path)
    with pytest.raises(DataError, match="can't be read"):
        Reader(tmp_path / "nowhere")


def test_a_recording_is_played_into_a_server_and_seen(start, connect, tmp_path):
    path = tmp_path / "run.ahmss"
    record(start, connect, path)
    server = start(recording=tmp_path / "again.ahmss")
    replay(path, server.address, speed=2.0)
    server.stop()
    with Reader(tmp_path / "again.ahmss") as again:
        worlds = [again.show(tick, World()) for tick in range(len(again))]
        places = [round(world.human("ken")[0][0]) for world in worlds if "ken" in world.humans]
        taken = [world for world in worlds if "cup" in world.objects and world.objects["cup"].holder == "ken"]
        assert places == sorted(places)
        assert places[-1] == 40
        assert any(world.objects["cup"].states["full"] == "no" for world in taken)
        assert any(world.pose("cup")[0] > 20 for world in taken)
        assert again.asset(taken[0].objects["cup"].shape) == b"shape of a cup"


def test_a_real_time_recording_has_a_tick_every_sixtieth(start, connect, tmp_path):
    path = tmp_path / "run.ahmss"
    server = start(recording=path)
    with connect(server) as ken:
        join(ken, "ken")
        ken.publish("ken", 1, ROOT + 1, ROTATIONS)
        tick = ken.refresh().tick
        eventually(lambda: ken.poll().tick > tick + 10)
    server.stop()
    with Reader(path) as reader:
        ticks = [reader.snapshot(i).tick for i in range(len(reader))]
        assert ticks == sorted(set(ticks))
        assert [reader.snapshot(i).time for i in range(len(reader))] == [tick / 60 for tick in ticks]


def test_a_full_disk_ends_the_recording_and_not_the_world(start, connect, tmp_path):
    path = tmp_path / "run.ahmss"
    server = start(recording=path, lockstep=("ken",), prefix=["prlimit", "--fsize=300000"])
    with connect(server, follow=False) as ken:
        join(ken, "ken")
        for k in range(1, 1001):
            ken.publish("ken", k, ROOT, ROTATIONS)
            ken.collect(behind=8)
        ken.collect()
        ken.leave("ken")
    server.stop()
    log = (tmp_path / "server.log").read_text()
    assert log.count("the recording stops here") == 1
    with Reader(path) as reader:
        assert 100 < len(reader) < 1000
