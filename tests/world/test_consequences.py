"""What follows from a change of states is the server's doing: every main sees it, and it is kept and recorded."""

from __future__ import annotations

from pathlib import Path

import pytest
from ground import ROOT, ROTATIONS, eventually, join

from ahmss.errors import WorldError
from ahmss.states.behaviour import Appearance, Behaviour, Consequence, decode_behaviour
from ahmss.states.condition import parse_condition
from ahmss.states.state import State
from ahmss.world.client import WorldClient
from ahmss.world.recording import Reader
from ahmss.world.schema import NewObject
from ahmss.world.view import World

SET = Behaviour(
    {"power": State("off", ("off", "on"))}, (Appearance(("screen",), parse_condition("power == on"), lit=1.0),)
)
BUTTON = Behaviour(
    {"position": State("out", ("out", "in"))},
    consequences=(Consequence("power", "..", parse_condition("position == in"), "toggle"),),
)


def television(client: WorldClient, name: str = "tv") -> None:
    whole, part = client.put_asset(SET.encode()), client.put_asset(BUTTON.encode())
    client.add([
        NewObject(name, "tv", states={"power": "off"}, behaviour=whole),
        NewObject(f"{name}/button", "button", parent=name, states={"position": "out"}, behaviour=part),
    ])  # fmt: skip


def test_any_main_sees_what_follows_and_a_killed_server_keeps_it(start, connect, tmp_path):
    server = start(directory=tmp_path / "world")
    ken, aiko, viewer = connect(server), connect(server), connect(server)
    join(ken, "ken")
    television(ken)
    aiko.set_state("tv/button", "position", "in")
    eventually(lambda: viewer.poll().objects and viewer.world.objects["tv"].states == {"power": "on"})
    record = viewer.world.objects["tv"]
    assert decode_behaviour(viewer.get_asset(record.behaviour)) == SET
    server.kill()
    eventually(lambda: (viewer.poll(), not viewer.connected)[1])
    start(address=server.address, directory=tmp_path / "world")
    eventually(lambda: (viewer.poll(), viewer.connected)[1])
    assert viewer.refresh().objects["tv"].states == {"power": "on"}
    assert viewer.world.objects["tv/button"].states == {"position": "in"}
    viewer.set_state("tv/button", "position", "out")
    viewer.set_state("tv/button", "position", "in")
    assert viewer.refresh().objects["tv"].states == {"power": "off"}


def test_what_is_held_by_another_follows_too_and_an_asset_that_is_none_is_refused(start, connect):
    server = start()
    ken, aiko = connect(server), connect(server)
    join(ken, "ken")
    television(ken)
    ken.claim("ken", ["tv"])
    aiko.set_state("tv/button", "position", "in")
    assert aiko.refresh().objects["tv"].states == {"power": "on"}
    with pytest.raises(WorldError, match="the behaviour of a kind of object can't be read"):
        aiko.add([NewObject("x", "x", behaviour=aiko.put_asset(b"picture"))])
    assert "x" not in aiko.refresh().objects


def run(start, connect, path: Path) -> bytes:
    """A main alone in lockstep presses the button at its third frame."""
    server = start(lockstep=("ken",), recording=path)
    ken = connect(server)
    join(ken, "ken")
    television(ken)
    for frame in range(1, 8):
        if frame == 3:
            ken.set_state("tv/button", "position", "in")
        ken.publish("ken", frame, ROOT, ROTATIONS)
        ken.collect(0)
        assert ken.world.objects["tv"].states == {"power": "on" if frame >= 3 else "off"}
    ken.leave("ken")
    server.stop()
    return path.read_bytes()


def test_in_lockstep_it_happens_in_the_same_tick_of_each_run_and_is_recorded(start, connect, tmp_path):
    assert run(start, connect, tmp_path / "a.rec") == run(start, connect, tmp_path / "b.rec")
    with Reader(tmp_path / "a.rec") as reader:
        world = World()
        powers = [reader.show(tick, world).objects["tv"].states["power"] for tick in range(len(reader))]
        assert decode_behaviour(reader.asset(world.objects["tv"].behaviour)) == SET
    assert powers == ["off"] * 2 + ["on"] * 5
