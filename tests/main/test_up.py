import os
import signal
import time

from ahmss.errors import Unreachable
from ahmss.main.up import KeptServer
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
