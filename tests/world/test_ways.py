"""Where humans mean to be: told with a frame, seen by all, forgotten with who told it; in files old and new."""

from __future__ import annotations

import itertools
import struct
from concurrent.futures import ThreadPoolExecutor

import msgspec
import numpy as np
import pytest
from ground import ROOT, ROTATIONS, eventually, join

from ahmss.world import frame as frames
from ahmss.world import recording, schema
from ahmss.world.recording import Reader, Writer
from ahmss.world.replay import replay
from ahmss.world.view import World

WAY = np.arange(12.0).reshape(6, 2) / 4.0 + 1.0  # float32 holds it


def told(world: World, name: str) -> bool:
    """Whether the human's way is as it was told; false where it is not known. Any other is a failure."""
    way = world.way(name)
    assert way is None or (way == WAY).all()
    return way is not None


def test_a_way_is_seen_by_viewers_and_mains_until_a_frame_comes_without(start, connect):
    server = start()
    ken, aiko, viewer = connect(server), connect(server), connect(server)
    for client, name in ((ken, "ken"), (aiko, "aiko")):
        join(client, name)
    viewer.hello()
    ken.publish("ken", 1, ROOT, ROTATIONS, way=WAY)
    for client in (viewer, aiko):
        eventually(lambda client=client: "ken" in client.poll().humans and told(client.world, "ken"))
        ways = client.world.human_ways
        assert ways.shape == (2, 6, 2)
        assert np.isnan(ways).all(axis=(1, 2)).sum() == 1
        assert client.world.way("aiko") is client.world.way("nobody") is None
    assert told(aiko.refresh(), "ken")
    ken.publish("ken", 2, ROOT, ROTATIONS)
    eventually(lambda: not told(viewer.poll(), "ken"))
    assert viewer.world.human_ways.shape == (2, 6, 2)
    ken.publish("ken", 3, ROOT, ROTATIONS, way=WAY)
    eventually(lambda: told(viewer.poll(), "ken"))
    ken.publish("ken", 4, ROOT, ROTATIONS, way=np.full((6, 2), np.nan))
    eventually(lambda: not told(viewer.poll(), "ken"))


def test_the_way_of_who_stays_behind_or_is_lost_or_comes_again_is_forgotten(start, connect):
    server = start(grace_s=30.0)
    mains = {name: connect(server) for name in ("stays", "is_lost", "comes_again")}
    viewer = connect(server)
    for name, client in mains.items():
        join(client, name)
        client.publish(name, 1, ROOT, ROTATIONS, way=WAY)
    eventually(lambda: all(told(viewer.refresh(), name) for name in mains))
    join(mains["comes_again"], "comes_again")
    assert [told(viewer.refresh(), name) for name in mains] == [True, True, False]
    mains["stays"].leave("stays", stay=True)
    assert [told(viewer.refresh(), name) for name in mains] == [False, True, False]
    mains["is_lost"].close()
    eventually(lambda: not any(told(viewer.refresh(), name) for name in mains))
    assert viewer.world.humans.keys() == mains.keys()


@pytest.mark.parametrize("together", [False, True])
@pytest.mark.parametrize("fault", [np.nan, np.inf, 1e9])
def test_a_way_that_is_none_is_refused_with_its_frame(start, connect, fault, together):
    server = start()
    ken = connect(server)
    join(ken, "ken")
    wrong = WAY.copy()
    wrong[2, 1] = fault
    ken.hello()
    if together:  # frames that come at once are checked at once
        number = ken._own["ken"].id
        ken._link.send(frames.pack(number, 1, ROOT, ROTATIONS, way=WAY))
        ken._link.send(frames.pack(number, 2, ROOT + 1, ROTATIONS, way=wrong))
    else:
        ken.publish("ken", 2, ROOT + 1, ROTATIONS, way=wrong)
    (reason,) = eventually(lambda: (ken.poll(), ken.refusals)[1])
    assert reason == "frame 2 was refused whole: its way is not finite or too far; NaN in all of it is not known"
    assert np.allclose(ken.refresh().human("ken")[0], ROOT)  # not even the human moved
    ken.publish("ken", 3, ROOT + 3, ROTATIONS, way=WAY)
    eventually(lambda: told(ken.refresh(), "ken"))
    assert np.allclose(ken.world.human("ken")[0], ROOT + 3)


def test_a_frame_is_these_bytes_with_a_way_and_as_before_there_were_any(start, connect):
    head = struct.Struct("<BBHIQ")
    pose, way = [*ROOT, *ROTATIONS.ravel()], WAY.ravel()
    plain = head.pack(0x46, 1, 0, 1, 7) + struct.pack("<175d", *pose)
    with_way = head.pack(0x46, 2, 1, 1, 8) + struct.pack("<175d", *pose) + struct.pack("<12d", *way)
    row = np.array([[9.0, 1.0, 2.0, 3.0, 1.0, 0.0, 0.0, 0.0]])
    assert frames.pack(1, 7, ROOT, ROTATIONS) == plain
    assert frames.pack(1, 8, ROOT, ROTATIONS, row, WAY) == with_way + row.tobytes()

    server = start()
    ken = connect(server)
    number = join(ken, "ken")
    ken.hello()
    of_ken = [bytes(data[:4]) + struct.pack("<I", number) + bytes(data[8:]) for data in (plain, with_way)]
    ken._link.send(of_ken[0])
    eventually(lambda: ken.refresh().human_frames.tolist() == [7])
    ken._link.send(of_ken[1][:2] + b"\0\0" + of_ken[1][4:])
    eventually(lambda: ken.refresh().human_frames.tolist() == [8])
    assert told(ken.world, "ken")
    for version, data in ((2, of_ken[1][:-8]), (3, of_ken[1])):
        wrong = data[:1] + bytes([version]) + b"\0\0" + data[4:]
        reason = f"a frame of version {version} with 0 objects is not {len(data)} bytes"
        # Once a second one is told of a message that is none.
        eventually(lambda wrong=wrong, reason=reason: ken._link.send(wrong) and reason in (ken.poll(), ken.refusals)[1])


def test_in_lockstep_a_way_comes_with_its_tick_and_is_forgotten_with_one(start, connect):
    names = ("aiko", "ken", "mari")
    server = start(lockstep=names, lease_s=1.0)
    clients = {name: connect(server, follow=False) for name in names}
    with ThreadPoolExecutor() as together:
        list(together.map(lambda name: (join(clients[name], name), clients[name].refresh()), names))

    def tick(k: int, **ways: np.ndarray) -> World:
        """A frame of all who are there; the world as ken sees it."""
        for name, client in clients.items():
            client.publish(name, k, ROOT, ROTATIONS, way=ways.get(name))
        for client in clients.values():
            client.collect()
        return clients["ken"].world

    assert not told(tick(1), "aiko")
    world = tick(2, aiko=WAY, ken=WAY)
    assert [told(world, name) for name in names] == [True, False, False]  # of oneself one is told nothing
    assert told(clients["mari"].world, "ken")
    world = tick(3, mari=WAY)
    assert [told(world, name) for name in names] == [False, False, True]
    tick(4, aiko=WAY, mari=WAY)
    clients.pop("aiko").begin(schema.Leave("aiko", stay=True))  # it is answered when the others have spoken
    world = tick(5, mari=WAY)
    assert [told(world, name) for name in names] == [False, False, True]
    clients.pop("mari").close()
    world = tick(6)  # when she is waited for no more
    assert not told(world, "mari")
    assert world.humans.keys() == set(names)


def record(start, connect, path) -> None:
    """Ten frames of ken: with a way from the third to the seventh."""
    server = start(recording=path, lockstep=("ken",))
    with connect(server, follow=False) as ken:
        join(ken, "ken")
        for k in range(1, 11):
            ken.publish("ken", k, ROOT, ROTATIONS, way=WAY if 3 <= k <= 7 else None)
            ken.collect()
        ken.leave("ken")
    server.stop()


def test_a_recording_holds_ways_and_is_played_with_them(start, connect, tmp_path):
    path, again = tmp_path / "run.rec", tmp_path / "again.rec"
    record(start, connect, path)
    with Reader(path) as reader:
        world = World()
        assert [told(reader.show(tick, world), "ken") for tick in range(10)] == [3 <= k <= 7 for k in range(1, 11)]
        assert [bool(reader.snapshot(tick).ways) for tick in (0, 2)] == [False, True]
    for _ in range(5):  # by the clock a server that gets no processor for long sees the newest frame alone
        server = start(recording=again)
        replay(path, server.address, speed=0.2)
        server.stop()
        with Reader(again) as reader:
            seen = [told(world, "ken") for tick in range(len(reader)) if "ken" in reader.show(tick, world).humans]
        if [change for change, _ in itertools.groupby(seen)] == [False, True, False]:
            return
    pytest.fail(f"of the ways of a recording that is played came {seen}")


def test_a_recording_from_before_there_were_ways_is_read(start, connect, tmp_path, monkeypatch):
    new, old = tmp_path / "new.rec", tmp_path / "old.rec"
    record(start, connect, new)

    def as_it_was(record: object) -> bytes:
        fields = msgspec.to_builtins(record, builtin_types=(bytes,))
        fields.pop("ways", None)
        return msgspec.msgpack.encode(fields)

    with Reader(new) as reader:
        monkeypatch.setattr(recording, "_encode", as_it_was)
        writer = Writer(old, reader.asset)
        for tick in range(len(reader)):
            writer.write(reader.snapshot(tick), lambda tick=tick: reader.scene(tick))
        writer.close()
    assert b"ways" not in old.read_bytes()
    assert b"ways" in new.read_bytes()
    with Reader(old) as reader:
        world = reader.show(4, World())
        assert len(reader) == 10
        assert not told(world, "ken")
        assert world.human_ways.shape == (1, 6, 2)
        np.testing.assert_allclose(world.human("ken")[0], ROOT, atol=1e-6)


def test_a_client_that_knows_no_ways_reads_what_tells_them() -> None:
    class Snapshot(msgspec.Struct, tag="snapshot"):
        """What a reader of before knows of it."""

        tick: int
        poses: bytes = b""

    data = schema.encode(schema.Snapshot(3, 0.0, 1, poses=b"12", ways=WAY.astype("<f4").tobytes()))
    assert msgspec.msgpack.decode(data, type=Snapshot) == Snapshot(3, b"12")
