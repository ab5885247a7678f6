from __future__ import annotations

import os
import shutil
import stat
import subprocess
import sys

import pytest
import zmq
from ground import ROOT, ROTATIONS, eventually, join

from ahmss.errors import CommandError, DependencyError, Unreachable, WorldError
from ahmss.world import keys
from ahmss.world.address import Address, parse
from ahmss.world.process import ServerProcess


def test_keys_are_made_once_and_closed_to_others(tmp_path):
    directory = tmp_path / "keys"
    made = keys.make(directory, "desk")
    assert {path.name for path in made} == {"server.key", "server.pub", "client.key", "desk"}
    assert all(stat.S_IMODE(path.stat().st_mode) == 0o600 for path in made)
    server, client = keys.read_server(directory), keys.read_client(directory)
    assert client.server == server.public
    assert server.authorised == {client.public}
    assert len({server.secret, client.secret, server.public, client.public}) == 4
    assert keys.make(directory, "desk") == []
    assert keys.read_client(directory) == client
    assert {path.relative_to(directory).as_posix() for path in keys.make(directory, "lab")} == {
        "lab/client.key", "lab/server.pub", "authorised/lab",
    }  # fmt: skip
    lab = keys.read_client(directory / "lab")
    assert lab.server == server.public
    assert keys.read_server(directory).authorised == {client.public, lab.public}


def test_wrong_keys_are_one_sentence(tmp_path, monkeypatch):
    with pytest.raises(WorldError, match="ahmss keys"):
        keys.read_server(tmp_path)
    keys.make(tmp_path)
    (tmp_path / "server.key").chmod(0o644)
    with pytest.raises(WorldError, match="chmod 600"):
        keys.read_server(tmp_path)
    (tmp_path / "client.key").write_text("hello\n")
    with pytest.raises(WorldError, match="no key file"):
        keys.read_client(tmp_path)
    with pytest.raises(WorldError, match="no name"):
        keys.authorise(tmp_path, "../evil", b"x" * 40)
    monkeypatch.setattr(zmq, "has", lambda _: False)
    with pytest.raises(DependencyError, match="CURVE"):
        keys.make(tmp_path / "other")


def test_a_server_beyond_loopback_needs_keys(start, tmp_path):
    with pytest.raises(WorldError, match="needs keys"):
        start(address="0.0.0.0:0")


def test_only_authorised_clients_come_in(start, connect, tmp_path):
    ours, theirs = tmp_path / "ours", tmp_path / "theirs"
    keys.make(ours)
    keys.make(theirs)
    shutil.copy(ours / "server.pub", theirs / "server.pub")  # the server's public key alone is not enough
    server = start(keys=ours)
    ken, viewer = (connect(server, keys=keys.read_client(ours)) for _ in range(2))
    join(ken, "ken")
    ken.publish("ken", 1, ROOT + 1, ROTATIONS)
    eventually(lambda: "ken" in viewer.poll().humans and viewer.world.human("ken")[0][0] == 1)
    stranger = connect(server, keys=keys.read_client(theirs), timeout=1)
    with pytest.raises(Unreachable, match="check the keys"):
        stranger.hello()
    bare = connect(server, timeout=1)
    with pytest.raises(Unreachable):
        bare.hello()
    ken.publish("ken", 2, ROOT + 2, ROTATIONS)
    eventually(lambda: viewer.poll().human("ken")[0][0] == 2)


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("", Address()), ("localhost", Address()), ("host", Address("host")), ("host:90", Address("host", 90)),
        ("tcp://1.2.3.4:5", Address("1.2.3.4", 5)), ("[::1]:80", Address("[::1]", 80)), ("[::1]", Address("[::1]")),
        ("ipc:///tmp/w", Address(path="/tmp/w")),
    ],
)  # fmt: skip
def test_addresses_are_read_as_people_write_them(text, address):
    assert parse(text) == address
    assert parse(str(address)) == address


@pytest.mark.parametrize("text", ["host:port", "host:70000", "host:", "ipc://" + "x" * 200])
def test_a_wrong_address_is_one_sentence(text):
    with pytest.raises(CommandError, match="server address"):
        parse(text)


@pytest.fixture
def two_machines():
    """Two network namespaces with a cable between them: 10.77.0.1 and 10.77.0.2."""
    if os.geteuid() != 0 or shutil.which("ip") is None:
        pytest.skip("making network namespaces takes root and iproute2")
    names = f"ahmss{os.getpid()}a", f"ahmss{os.getpid()}b"
    commands = [f"netns add {names[0]}", f"netns add {names[1]}"]
    commands += [f"link add {names[0]} netns {names[0]} type veth peer name {names[1]} netns {names[1]}"]
    for number, name in enumerate(names, 1):
        commands += [f"-n {name} addr add 10.77.0.{number}/24 dev {name}", f"-n {name} link set {name} up"]
        commands += [f"-n {name} link set lo up"]
    try:
        for command in commands:
            done = subprocess.run(["ip", *command.split()], capture_output=True, text=True, check=False)
            if done.returncode:
                pytest.skip(f"this machine makes no network namespaces: {done.stderr.strip()}")
        yield names
    finally:
        for name in names:
            subprocess.run(["ip", "netns", "del", name], capture_output=True, check=False)


CLIENT = """
import sys
sys.path.insert(0, sys.argv[3])
from pathlib import Path
from ground import ROOT, ROTATIONS, join, eventually
from ahmss.world.client import WorldClient
from ahmss.world.keys import read_client
with WorldClient(sys.argv[1], keys=read_client(Path(sys.argv[2])), timeout=20) as client:
    if sys.argv[4] == "main":
        join(client, "ken")
        client.put_asset(bytes(3_000_000))
        for frame in range(1, 5000):
            client.rest(0.01)
            client.publish("ken", frame, ROOT + frame, ROTATIONS)
            client.poll()
    else:
        eventually(lambda: "ken" in client.poll().humans and len(client.world.human_ids))
        first = client.world.human("ken")[0][0]
        eventually(lambda: client.poll().human("ken")[0][0] > first + 20)
        print("seen", client.skeleton(client.world.humans["ken"])["name"])
"""


def test_two_machines_share_a_world(two_machines, tmp_path):
    here, there = two_machines
    keys.make(tmp_path)
    tests = os.path.dirname(__file__)
    enter = ["ip", "netns", "exec"]
    with ServerProcess("10.77.0.1:7417", keys=tmp_path, prefix=[*enter, here]) as server:
        command = [*enter, there, sys.executable, "-c", CLIENT, server.address, str(tmp_path), tests]
        main = subprocess.Popen([*command, "main"], stdin=subprocess.DEVNULL)
        try:
            viewer = subprocess.run([*command, "view"], capture_output=True, text=True, timeout=50, check=False)
        finally:
            main.kill()
            main.wait()
    assert viewer.stdout == "seen ken\n", viewer.stderr
