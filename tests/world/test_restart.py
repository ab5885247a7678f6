from __future__ import annotations

import numpy as np
import pytest
from ground import ROOT, ROTATIONS, eventually, join, row

from ahmss.errors import WorldError
from ahmss.world.schema import NewObject, ObjectPose


def port_of(server):
    return server.address.rpartition(":")[2]


def test_placed_objects_and_states_survive_kill_9(start, connect, tmp_path):
    server = start(directory=tmp_path / "world")
    address = server.address
    with connect(server) as ken:
        join(ken, "ken")
        texture = ken.put_asset(b"picture")
        lamp, cup = ken.add([
            NewObject("lamp", "lamp", (1, 2, 3), texture=texture, states={"lamp": "off"}), NewObject("cup", "cup"),
        ])  # fmt: skip
        ken.add([NewObject("chair", "chair")])
        ken.remove("chair")
        ken.set_state("lamp", "lamp", "on")
        ken.claim("ken", ["cup"], "right")
        ken.publish("ken", 1, ROOT, ROTATIONS, row(cup.id, (4, 5, 6)))
        ken.release("ken", ["cup"])
        eventually(lambda: ken.poll().objects.get("cup") and not ken.world.objects["cup"].holder)
        tick = ken.world.tick
        eventually(lambda: ken.poll().tick > tick + 1)
        server.kill()
    journal = tmp_path / "world" / "journal.bin"
    journal.write_bytes(journal.read_bytes() + b"\x50\x00\x00\x00torn")
    again = start(address=address, directory=tmp_path / "world")
    with connect(again) as viewer:
        world = viewer.refresh()
        assert {name: record.id for name, record in world.objects.items()} == {"lamp": lamp.id, "cup": cup.id}
        assert world.objects["lamp"].states == {"lamp": "on"}
        assert world.pose("cup").tolist() == [4, 5, 6, 1, 0, 0, 0]
        assert world.objects["cup"].moved
        assert viewer.get_asset(texture) == b"picture"
        assert viewer.add([NewObject("chair", "chair")])[0].id > cup.id
    assert "torn" in (tmp_path / "server.log").read_text()


def test_the_scene_of_the_next_server_is_not_taken_for_that_of_the_last(start, connect, tmp_path):
    for power in ("on", "off"):
        server = start(directory=tmp_path / power)
        with connect(server) as ken:
            ken.add([NewObject("lamp", "lamp", states={"power": power})])
            eventually(lambda ken=ken: ken.poll().objects)
        server.stop()
    first = start(directory=tmp_path / "on")
    viewer = connect(first)
    assert viewer.refresh().objects["lamp"].states == {"power": "on"}
    first.kill()
    eventually(lambda: (viewer.poll(), not viewer.connected)[1])
    start(address=first.address, directory=tmp_path / "off")
    eventually(lambda: (viewer.poll(), viewer.connected)[1])
    assert viewer.refresh().objects["lamp"].states == {"power": "off"}


def test_mains_and_viewers_come_back_by_themselves_with_what_they_hold(start, connect, tmp_path):
    server = start(directory=tmp_path / "world")
    ken, viewer = connect(server), connect(server)
    join(ken, "ken")
    (cup,) = ken.add([NewObject("cup", "cup")])
    ken.refresh()
    ken.claim("ken", ["cup"], "left")
    ken.publish("ken", 1, ROOT, ROTATIONS, row(cup.id, (1, 1, 1)))
    eventually(lambda: viewer.poll().objects and viewer.world.pose("cup")[0] == 1)
    address = server.address
    server.kill()
    for frame in range(2, 20):  # the motion goes on, and nothing blocks
        ken.publish("ken", frame, ROOT, ROTATIONS, row(cup.id, (frame, 1, 1)))
        ken.poll()
        ken.rest(0.01)
    eventually(lambda: (ken.poll(), not ken.connected)[1])
    start(address=address, directory=tmp_path / "world")
    frames = iter(range(20, 10_000))

    def goes_on():
        frame = next(frames)
        ken.publish("ken", frame, ROOT + 7, ROTATIONS, row(cup.id, (frame, 1, 1)))
        ken.poll()
        world = viewer.poll()
        return (
            "ken" in world.humans
            and len(world.human_ids)
            and world.human("ken")[0][0] == 7
            and world.objects["cup"].holder == "ken"
        )

    eventually(goes_on)
    assert viewer.world.objects["cup"].hand == "left"
    assert viewer.skeleton(viewer.world.humans["ken"])["sex"] == "male"
    eventually(lambda: goes_on() and viewer.world.pose("cup")[0] >= 20)


def test_who_comes_back_late_learns_what_it_has_lost(start, connect):
    server = start(lease_s=1.0)
    ken, aiko = connect(server), connect(server)
    join(ken, "ken")
    ken.add([NewObject("cup", "cup")])
    ken.refresh()
    ken.claim("ken", ["cup"])
    eventually(lambda: not aiko.refresh().objects["cup"].holder)
    join(aiko, "aiko")
    aiko.claim("aiko", ["cup"])

    def told():
        aiko.poll()
        ken.publish("ken", 1, ROOT, ROTATIONS)
        return "\n".join(ken.poll() and ken.refusals)

    assert "no longer holds cup" in eventually(lambda: "no longer" in told() and told())
    assert aiko.refresh().objects["cup"].holder == "aiko"


def test_two_servers_do_not_share_a_directory(start, tmp_path):
    start(directory=tmp_path / "world")
    with pytest.raises(WorldError, match="another server keeps its world here"):
        start(directory=tmp_path / "world")


def test_a_file_that_is_no_journal_is_left_alone(start, tmp_path):
    (tmp_path / "journal.bin").write_bytes(b"my diary")
    with pytest.raises(WorldError, match="no journal"):
        start(directory=tmp_path)
    assert (tmp_path / "journal.bin").read_bytes() == b"my diary"


def test_a_full_disk_is_said_once_and_the_world_goes_on(start, connect, tmp_path):
    server = start(recording=None, directory=tmp_path / "world", prefix=["prlimit", "--fsize=200000"])
    ken = connect(server)
    join(ken, "ken")
    for number in range(60):
        ken.add([NewObject(f"o{number}", "cup", states={f"s{i}": "x" * 900 for i in range(6)})])
    ken.move([ObjectPose("o1", (1.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))])
    assert len(ken.refresh().objects) == 60
    eventually(lambda: "can't be written" in (tmp_path / "server.log").read_text())
    ken.publish("ken", 1, ROOT + 1, ROTATIONS)
    eventually(lambda: np.allclose(ken.refresh().human("ken")[0], ROOT + 1))
    assert (tmp_path / "server.log").read_text().count("can't be written") == 1
