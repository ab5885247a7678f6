from __future__ import annotations

import socket
import time

import numpy as np
import pytest
import zmq
from ground import ROOT, ROTATIONS, eventually, join, row

from ahmss.errors import Unreachable, WorldError
from ahmss.world import frame as frames
from ahmss.world import schema
from ahmss.world.address import Address
from ahmss.world.keys import make, read_server
from ahmss.world.schema import NewObject, ObjectPose
from ahmss.world.sockets import Sockets


def cup_and_tray(client):
    return client.add([
        NewObject("tray", "tray", (1, 0, 1)),
        NewObject("tray/cup", "cup", (0.1, 0, 0), parent="tray", states={"full": "yes"}),
    ])  # fmt: skip


def test_a_viewer_sees_humans_and_objects_of_several_mains(start, connect):
    server = start()
    ken, aiko, viewer = (connect(server) for _ in range(3))
    join(ken, "ken")
    join(aiko, "aiko")
    cup_and_tray(ken)
    aiko.claim("aiko", ["tray/cup"], "left")
    number = aiko.refresh().objects["tray/cup"].id
    viewer.refresh()
    ken.publish("ken", 1, ROOT + 1, ROTATIONS)
    aiko.publish("aiko", 5, ROOT + 2, ROTATIONS, row(number, (3, 2, 1)))
    eventually(lambda: viewer.poll().pose("tray/cup")[0] == 3)
    assert viewer.world.objects["tray/cup"].holder == "aiko"
    assert viewer.world.objects["tray/cup"].hand == "left"
    assert np.allclose(viewer.world.human("ken")[0], ROOT + 1)
    assert np.allclose(viewer.world.human("aiko")[0], ROOT + 2)
    assert viewer.skeleton(viewer.world.humans["ken"])["stature"] == 1.75
    aiko.set_state("tray/cup", "full", "no")
    eventually(lambda: viewer.poll().objects["tray/cup"].states["full"] == "no")
    aiko.leave("aiko")
    eventually(lambda: "aiko" not in viewer.poll().humans)
    assert viewer.world.objects["tray/cup"].holder == ""


def test_an_update_of_what_the_sender_does_not_hold_is_refused_whole(start, connect):
    server = start()
    ken = connect(server)
    join(ken, "ken")
    tray, cup = cup_and_tray(ken)
    ken.claim("ken", ["tray/cup"])
    both = np.concatenate([row(cup.id, (9, 9, 9)), row(tray.id, (8, 8, 8))])
    ken.publish("ken", 1, ROOT + 5, ROTATIONS, both)
    assert "does not hold tray" in eventually(lambda: (ken.poll(), ken.refusals)[1])[0]
    world = ken.refresh()
    assert world.pose("tray/cup").tolist() == [1.1, 0, 1, 1, 0, 0, 0]
    assert np.allclose(world.human("ken")[0], ROOT)  # not even the human moved


@pytest.mark.parametrize("fault", ["nan", "long", "far"])
def test_an_update_that_is_no_pose_is_refused_whole(start, connect, fault):
    server = start()
    ken = connect(server)
    join(ken, "ken")
    root, rotations = ROOT.copy() + 1, ROTATIONS.copy()
    if fault == "nan":
        rotations[20, 2] = np.nan
    elif fault == "long":
        rotations[20] *= 2
    else:
        root[1] = 1e9
    ken.publish("ken", 1, root, rotations)
    assert "frame 1 was refused whole" in eventually(lambda: (ken.poll(), ken.refusals)[1])[0]
    assert np.allclose(ken.refresh().human("ken")[0], ROOT)
    ken.publish("ken", 2, ROOT + 3, ROTATIONS)
    eventually(lambda: np.allclose(ken.refresh().human("ken")[0], ROOT + 3))


def test_another_mains_human_can_not_be_moved(start, connect):
    server = start()
    ken, thief = connect(server), connect(server)
    number = join(ken, "ken")
    join(thief, "thief")
    thief.begin(schema.Hello())
    thief._link.send(frames.pack(number, 1, ROOT + 9, ROTATIONS))
    with pytest.raises(WorldError, match="moved by another main"):
        thief.leave("ken")
    with pytest.raises(WorldError, match="is here already"):
        join(thief, "ken")
    assert np.allclose(thief.refresh().human("ken")[0], ROOT)


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        ([NewObject("tray", "tray")], "is in the world already"),
        ([NewObject("new", "cup"), NewObject("new", "cup")], "is in the world already"),
        ([NewObject("new", "cup"), NewObject("nowhere/cup", "cup", parent="nowhere")], 'no object "nowhere"'),
        ([NewObject("new", "cup"), NewObject("b", "cup", (np.nan, 0, 0))], "not finite"),
        ([NewObject("new", "cup"), NewObject("b", "cup", rotation=(2, 0, 0, 0))], "no unit quaternion"),
        ([NewObject("new", "cup"), NewObject("b c", "cup")], "is no name"),
        ([NewObject("new", "cup"), NewObject("b", "cup", shape="0" * 64)], "no asset"),
        ([NewObject("new", "cup"), NewObject("b", "cup", parent="tray")], "named tray/..."),
        ([NewObject("new", "cup"), NewObject("b", "cup", states={"s": "x" * 5000})], "too big"),
    ],
)
def test_objects_are_added_all_or_none_with_a_reason(start, connect, wrong, reason):
    ken = connect(start())
    cup_and_tray(ken)
    with pytest.raises(WorldError, match=reason):
        ken.add(wrong)
    assert set(ken.refresh().objects) == {"tray", "tray/cup"}


def test_what_is_added_with_its_parent_stands_as_if_it_came_after_it(start, connect):
    ken = connect(start())
    quarter = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))
    parents = {"a": "", "a/b": "a", "a/b/c": "a/b", "a/d": "a"}
    new = [NewObject(name, "cup", (1.0, 0.0, 0.5), quarter, parent) for name, parent in parents.items()]
    ken.add(new)
    together = {name: ken.refresh().pose(name).copy() for name in parents}
    ken.remove("a")
    for one in new:
        ken.add([one])
    assert np.allclose(together["a/b/c"], [0.0, 1.0, 1.5, -np.sqrt(0.5), 0, 0, np.sqrt(0.5)])
    for name in parents:
        assert np.allclose(ken.refresh().pose(name), together[name])


def test_more_than_a_message_holds_is_refused_before_it_is_sent(start, connect):
    ken = connect(start())
    ken.hello()  # who has been answered is connected
    with pytest.raises(WorldError, match="send it in parts"):
        ken.add([NewObject(f"o{i}", "cup", states={"s": "x" * 900}) for i in range(5000)])
    assert ken.connected
    assert not ken.refresh().objects


def test_contained_objects_go_with_their_parent_until_a_hand_takes_them(start, connect):
    ken = connect(start())
    join(ken, "ken")
    cup_and_tray(ken)
    quarter = (np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5))
    ken.move([ObjectPose("tray", (0.0, 0.0, 2.0), quarter)])
    assert np.allclose(ken.refresh().pose("tray/cup"), [0, 0.1, 2, *quarter])
    ken.claim("ken", ["tray/cup"], "right")
    ken.release("ken", ["tray/cup"])
    ken.move([ObjectPose("tray", (5.0, 0.0, 0.0), quarter)])
    assert np.allclose(ken.refresh().pose("tray/cup")[:3], [0, 0.1, 2])  # it was taken off the tray
    ken.remove("tray")
    assert set(ken.refresh().objects) == {"tray/cup"}


def test_layout_moves_only_what_nobody_has_touched(start, connect):
    ken = connect(start())
    join(ken, "ken")
    cup_and_tray(ken)
    ken.move([ObjectPose("tray/cup", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))], layout=True)
    ken.move([ObjectPose("tray/cup", (1.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))])
    with pytest.raises(WorldError, match="moved by somebody"):
        ken.move([ObjectPose("tray/cup", (2.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))], layout=True)


def test_layout_moves_what_was_used_but_not_what_was_carried(start, connect):
    ken = connect(start())
    join(ken, "ken")
    number = next(record.id for record in cup_and_tray(ken) if record.name == "tray")

    def held(*, frame: int, at: tuple[float, float, float], hand: str = "") -> bool:
        ken.claim("ken", ["tray"], hand)
        ken.publish("ken", frame, ROOT, ROTATIONS, row(number, at))
        ken.release("ken", ["tray"])
        return ken.refresh().objects["tray"].moved

    assert not held(frame=1, at=(1.0, 0.0, 1.0))  # used: it stays where it is
    ken.move([ObjectPose("tray", (2.0, 0.0, 1.0), (1.0, 0.0, 0.0, 0.0))], layout=True)
    assert np.allclose(ken.refresh().pose("tray")[:3], [2, 0, 1])
    assert held(frame=2, at=(2.0, 0.3, 1.0))
    with pytest.raises(WorldError, match="moved by somebody"):
        ken.move([ObjectPose("tray", (1.0, 0.0, 1.0), (1.0, 0.0, 0.0, 0.0))], layout=True)


def test_one_main_at_a_time_follows_the_file_of_an_object_and_another_when_it_is_gone(start, connect):
    server = start(lease_s=0.5)
    ken, aiko = connect(server), connect(server)
    join(ken, "ken")
    join(aiko, "aiko")
    ken.add([NewObject("tray", "tray"), NewObject("tray/cup", "cup", parent="tray")], keeper="ken")
    assert {name: record.keeper for name, record in aiko.refresh().objects.items()} == {"tray": "ken", "tray/cup": ""}
    moved = [ObjectPose("tray/cup", (1.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))]
    with pytest.raises(WorldError, match="tray follows its file by ken's main now, no longer by aiko's"):
        aiko.move(moved, layout=True, keeper="aiko")
    ken.leave("ken")
    assert aiko.refresh().objects["tray"].keeper == "aiko"
    aiko.move(moved, layout=True, keeper="aiko")
    for change in (
        lambda: ken.move(moved, layout=True, keeper="ken"), lambda: ken.remove("tray/cup", "ken"),
        lambda: ken.add([NewObject("tray/jug", "cup", parent="tray")], "ken"),
    ):  # fmt: skip
        with pytest.raises(WorldError, match="by aiko's main now"):
            change()
    aiko.leave("aiko")
    assert aiko.refresh().objects["tray"].keeper == "aiko"  # nobody is there
    join(ken, "mari")
    assert ken.refresh().objects["tray"].keeper == "mari"


def test_two_humans_can_not_hold_one_cup_and_one_gives_it_to_the_other(start, connect):
    server = start()
    ken, aiko, viewer = (connect(server) for _ in range(3))
    join(ken, "ken")
    join(aiko, "aiko")
    cup_and_tray(ken)
    claims = [(c, c.begin(schema.Claim(n, ["tray/cup", "tray"]))) for c, n in ((ken, "ken"), (aiko, "aiko"))]
    results, refused = [], []
    for client, claim in claims:
        try:
            results.append(client.finish(claim))
        except WorldError as error:
            refused.append(str(error))
    assert len(results) == 1
    assert "held by" in refused[0]
    holder = viewer.refresh().objects["tray/cup"].holder
    assert viewer.world.objects["tray"].holder == holder
    giver, taker = (ken, aiko) if holder == "ken" else (aiko, ken)
    other = "aiko" if holder == "ken" else "ken"
    with pytest.raises(WorldError, match="does not hold"):
        taker.release(other, ["tray/cup"])
    with pytest.raises(WorldError, match="held by"):
        taker.set_state("tray/cup", "full", "no")
    with pytest.raises(WorldError, match="held by"):
        taker.remove("tray")
    with pytest.raises(WorldError, match=f"only the main of {holder} can give"):
        taker.transfer("tray/cup", holder, other, "left")
    with pytest.raises(WorldError, match="another human"):
        giver.transfer("tray/cup", holder, holder, "left")
    with pytest.raises(WorldError, match="nobody"):
        giver.transfer("tray/cup", holder, "nobody", "left")
    assert viewer.refresh().objects["tray/cup"].holder == holder
    giver.transfer("tray/cup", holder, other, "left")
    assert viewer.refresh().objects["tray/cup"].holder == other
    taker.set_state("tray/cup", "full", "no")


def test_a_main_that_is_gone_frees_what_it_holds_and_its_human_leaves_later(start, connect, tmp_path):
    server = start(lease_s=2.0, grace_s=1.0)
    ken, aiko = connect(server), connect(server)
    join(ken, "ken")
    join(aiko, "aiko")
    cup_and_tray(ken)
    ken.claim("ken", ["tray/cup"])
    ken.close()
    with pytest.raises(WorldError, match="held by ken"):
        aiko.claim("aiko", ["tray/cup"])
    eventually(lambda: aiko.poll().objects.get("tray/cup") and not aiko.world.objects["tray/cup"].holder)
    aiko.claim("aiko", ["tray/cup"])
    eventually(lambda: "ken" not in aiko.poll().humans)
    assert "aiko" in aiko.world.humans  # its heartbeats alone keep it
    assert "ken: the main is gone" in (tmp_path / "server.log").read_text()


def test_a_main_that_was_given_up_comes_back_by_itself(start, connect):
    server = start(lease_s=1.0, grace_s=30)
    ken, viewer = connect(server), connect(server)
    join(ken, "ken")
    assert viewer.refresh().humans["ken"].leaves_s == 0.0
    cup_and_tray(ken)
    ken.refresh()
    ken.claim("ken", ["tray/cup"])
    eventually(lambda: viewer.refresh().objects["tray/cup"].holder == "")  # ken's main stands still
    assert viewer.refresh().humans["ken"].leaves_s == 30.0  # all know that nobody moves ken, and when ken leaves
    frame = iter(range(1, 10_000))

    def goes_on():
        ken.publish("ken", next(frame), ROOT + 1, ROTATIONS)
        ken.poll()
        return viewer.refresh().objects["tray/cup"].holder == "ken" and viewer.world.human("ken")[0][0] == 1

    eventually(goes_on)
    assert viewer.refresh().humans["ken"].leaves_s == 0.0


def test_whoever_is_left_standing_is_known_to_stay(start, connect):
    server = start(lease_s=1.0, grace_s=0.5)
    ken, viewer = connect(server), connect(server)
    join(ken, "ken")
    ken.leave("ken", stay=True)
    assert viewer.refresh().humans["ken"].leaves_s == np.inf
    again = connect(server)
    join(again, "ken")
    assert viewer.refresh().humans["ken"].leaves_s == 0.0


def test_random_bytes_disturb_nobody(start, connect, tmp_path):
    server = start()
    ken, viewer = connect(server), connect(server)
    join(ken, "ken")
    port = int(server.address.rpartition(":")[2])
    noise = np.random.default_rng(1)
    context = zmq.Context()
    vandal = context.socket(zmq.DEALER)
    vandal.connect(f"tcp://{server.address}")
    for _ in range(300):
        vandal.send(noise.bytes(int(noise.integers(0, 3000))))
        vandal.send(b"F" + noise.bytes(int(noise.integers(0, 3000))))
        vandal.send_multipart([noise.bytes(9), noise.bytes(1500), b""])
    vandal.send(schema.encode(schema.Hello(request=4)))
    replies = []
    while not replies or not isinstance(replies[-1], schema.Welcome):
        assert vandal.poll(20_000), "the server fell silent"
        replies.append(schema.decode_reply(vandal.recv()))
    assert all(isinstance(reply, schema.Refused) for reply in replies[:-1])
    assert 1 <= len(replies) <= 20  # it is told what is wrong, but not 900 times
    for raw_port in (port, viewer.hello().snapshots):
        for _ in range(20):
            with socket.create_connection(("127.0.0.1", raw_port)) as raw:
                raw.sendall(noise.bytes(2000))
    ken.publish("ken", 1, ROOT + 1, ROTATIONS)
    eventually(lambda: viewer.poll().humans and viewer.world.human("ken")[0][0] == 1)
    stats = viewer.stats()
    assert stats.malformed >= 900  # raw bytes may pass for messages of the oldest protocol
    assert len((tmp_path / "server.log").read_text().splitlines()) < 5
    vandal.close(0)
    context.term()


def test_a_message_that_is_too_large_only_cuts_off_its_sender(start, connect):
    server = start()
    ken = connect(server)
    join(ken, "ken")
    context = zmq.Context()
    vandal = context.socket(zmq.DEALER)
    vandal.connect(f"tcp://{server.address}")
    vandal.send(bytes(20 << 20))
    time.sleep(0.2)
    ken.publish("ken", 1, ROOT + 1, ROTATIONS)
    eventually(lambda: ken.refresh().human("ken")[0][0] == 1)
    vandal.close(0)
    context.term()


def test_a_viewer_that_stalled_sees_the_newest_world_at_once(start, connect):
    server = start()
    ken, viewer = connect(server), connect(server)
    join(ken, "ken")
    viewer.refresh()
    for k in range(1, 60):
        ken.publish("ken", k, ROOT + np.array([k, 0, 0]), ROTATIONS)
        time.sleep(0.005)
    eventually(lambda: ken.refresh().human("ken")[0][0] == 59)
    eventually(lambda: viewer.poll().human("ken")[0][0] == 59, 5)
    first = viewer.world.sequence
    eventually(lambda: ken.poll().sequence >= first + 20, 10)  # while the viewer looks at nothing
    viewer.poll()
    assert viewer.world.sequence >= first + 20  # one poll skipped them all


def test_assets_travel_by_content(start, connect):
    server = start()
    ken, viewer = connect(server), connect(server)
    data = np.random.default_rng(0).bytes(2_500_000)
    name = ken.put_asset(data)
    assert ken.put_asset(data) == name
    assert viewer.get_asset(name) == data
    with pytest.raises(WorldError, match="no asset"):
        viewer.get_asset("f" * 64)
    with pytest.raises(WorldError, match="another hash"):
        ken.finish(ken.begin(schema.PutAsset("a" * 64, 3, 0, b"abc")))
    with pytest.raises(WorldError, match="is refused"):
        ken.finish(ken.begin(schema.PutAsset("../../etc/passwd", 3, 0, b"abc")))


def test_no_server_is_one_sentence(connect):
    client = connect("127.0.0.1:1", timeout=0.3)
    with pytest.raises(Unreachable, match="ahmss server"):
        client.hello()
    assert not client.connected
    client.poll()


def test_a_port_that_is_taken_is_one_sentence(start):
    server = start()
    with pytest.raises(WorldError, match=r"can't listen .* has port \d+ .* as in: --address 127\.0\.0\.1:\d+$"):
        start(address=server.address)


@pytest.mark.parametrize("host", ["127.0.0.1", "0.0.0.0"])
def test_a_server_says_which_of_its_two_ports_another_program_has(tmp_path, host):
    """On loopback snapshots go elsewhere; other machines are let through to the port after the named one alone."""
    make(tmp_path)
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        taken = other.getsockname()[1]
        address, keys = (host, taken), None
        if host == "0.0.0.0":
            address, keys = (host, taken - 1), read_server(tmp_path)
        with pytest.raises(WorldError) as caught:
            Sockets(Address(*address), keys)
    said = str(caught.value)
    assert f"another program has port {taken} (a server has two, the one named and the one after it, for snap" in said
    assert f"; stop what is there, or name another, as in: --address {host}:" in said


def test_a_file_system_socket_serves_as_well(start, connect, tmp_path):
    address = f"ipc://{tmp_path}/world"
    server = start(address=address)
    ken = connect(server)
    join(ken, "ken")
    eventually(lambda: "ken" in ken.poll().humans)
    server.stop()
    assert not (tmp_path / "world").exists()
