import os
import re
import signal
import socket
import time

import pytest

from ahmss.errors import AhmssError, CommandError, Unreachable
from ahmss.main.up import KeptServer, run_up
from ahmss.world.client import WorldClient
from ahmss.world.schema import NewObject
from ahmss.world.view import World


def _seen(client: WorldClient) -> World:
    """The world as the server has it, or as it was seen last where the server is away."""
    try:
        return client.refresh()
    except Unreachable:
        return World()


def test_a_server_that_dies_comes_back_with_what_was_placed() -> None:
    with KeptServer("127.0.0.1:0") as server, WorldClient(server.address) as client:
        client.add([NewObject("lamp", "lamp", states={"light": "on"})])
        tick = client.refresh().tick
        while client.refresh().tick < tick + 2:  # the journal is written with the next tick
            time.sleep(0.02)
        first = server.process.pid
        os.kill(first, signal.SIGKILL)
        deadline = time.monotonic() + 20.0
        while server.process.pid == first and time.monotonic() < deadline:
            time.sleep(0.05)
        assert server.process.pid != first
        while not (world := _seen(client)).objects and time.monotonic() < deadline:
            time.sleep(0.05)
        assert world.objects["lamp"].states == {"light": "on"}
        last = server.process.pid
    assert not os.path.exists(f"/proc/{last}")


def test_a_busy_port_is_answered_with_one_that_is_free() -> None:
    with KeptServer("127.0.0.1:0") as server:
        with pytest.raises(AhmssError, match=r"another program has port .* as in: --address") as caught:
            run_up("ken", "", "", server.address, None)
        port = int(re.findall(r":(\d+)", str(caught.value))[-1])
        assert port != int(server.address.rpartition(":")[2])
        for free in (port, port + 1):
            with socket.socket() as listener:
                listener.bind(("127.0.0.1", free))


def test_up_is_for_this_machine_alone_and_says_what_is_for_others() -> None:
    with pytest.raises(CommandError, match="for this machine alone, as on 127") as caught:
        run_up("ken", "", "", "0.0.0.0:7617", None)
    assert "ahmss server --address 0.0.0.0:7617 --keys" in str(caught.value)


def test_an_address_that_is_none_is_called_so() -> None:
    with pytest.raises(AhmssError, match=r'"nonsense\.invalid" is no address that is known here; write it as 127'):
        run_up("ken", "", "", "nonsense.invalid", None)
