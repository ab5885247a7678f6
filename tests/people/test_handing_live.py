"""In real time, with a main for each: what an onlooker sees of a thing that changes hands, and of one that can't."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.quaternion import conjugate, multiply, normalize, rotate
from ahmss.main.process import MainProcess, Setup
from ahmss.world.client import WorldClient
from ahmss.world.process import ServerProcess
from tests.main.ground import steps

ROOT = Path(__file__).resolve().parents[2]
JUMP = 0.001  # metres


class Room:
    """Ken with the cup in his hand, and aiko before him."""

    def __init__(self, address: str) -> None:
        self.mains = {
            name: MainProcess(
                Setup(name, body=name, place=place, facing_deg=facing, server=address, workspace=ROOT), lambda _: None
            )
            for name, place, facing in (("ken", (0.0, 0.0), -20.0), ("aiko", (0.35, 1.0), 245.0))
        }
        self.onlooker = WorldClient(address)
        self.seen: list[tuple[str, Array, Array]] = []  # holder, cup (7,), palms (4, 7) of ken and aiko
        self.do("ken", "add floor", "add table at 0.9 -0.1 0 facing 90", "add cup at 0.42 -0.15 0.88")
        self.go_on(lambda: self.idle and "cup" in self.mains["aiko"].communication.world.objects)
        self.do("ken", "do cup reach", "do cup grasp", "do cup lift")
        self.go_on(lambda: self.idle)
        assert self.said == []

    def do(self, name: str, *lines: str) -> None:
        for step in steps(*lines):
            self.mains[name].agenda.add(step)

    @property
    def idle(self) -> bool:
        return all(main.agenda.done for main in self.mains.values())

    def go_on(self, done: Callable[[], bool], seconds: float = 25.0) -> None:
        end = time.monotonic() + seconds
        while not done():
            assert time.monotonic() < end, self.said
            for main in self.mains.values():
                main.frame()
            self.look()
            time.sleep(0.006)

    def look(self) -> None:
        """What an onlooker sees now, once for each snapshot."""
        before = self.onlooker.world.tick
        world = self.onlooker.poll()
        if world.tick == before or not self.onlooker.is_current or "cup" not in world.objects:
            return
        if not set(self.mains) <= set(world.humans):
            return
        palms = []
        for name, main in self.mains.items():
            root, rotations = world.human(name)
            palms.append(grips(main.blending.skeleton, normalize(rotations), root))
        self.seen.append((world.objects["cup"].holder, world.pose("cup").copy(), np.concatenate(palms)))

    @property
    def said(self) -> list[str]:
        return [message for main in self.mains.values() for message in main.report.messages]

    def close(self) -> None:
        for main in self.mains.values():
            main.close()
        self.onlooker.close()


@pytest.fixture
def room(tmp_path: Path) -> Iterator[Room]:
    server = ServerProcess(log=tmp_path / "server.log")
    made = Room(server.address)
    yield made
    made.close()
    server.stop()


def test_an_onlooker_sees_it_go_from_hand_to_hand_without_a_jump(room: Room) -> None:
    del room.seen[:]
    room.do("ken", "do aiko hand_over")
    room.do("aiko", "do ken receive")
    room.go_on(lambda: room.idle)
    assert room.said == []
    holders = [holder for holder, _, _ in room.seen]
    assert holders[0] == "ken"
    assert holders[-1] == "aiko"
    frame = holders.index("aiko")
    assert set(holders[:frame]) == {"ken"}
    assert set(holders[frame:]) == {"aiko"}
    assert room.mains["ken"].control.holds == {}
    assert room.mains["aiko"].control.holds == {"cup": "right"}
    inner = np.array([cup_in(palms[0 if holder == "ken" else 2], cup) for holder, cup, palms in room.seen])
    steps_ = np.linalg.norm(np.diff(inner[:, :3], axis=0), axis=1)
    steps_[frame - 1] = 0.0  # from one palm to the other
    assert steps_.max() < JUMP
    cups = np.array([cup for _, cup, _ in room.seen])
    assert np.linalg.norm(np.diff(cups[frame - 8 : frame + 3, :3], axis=0), axis=1).max() < JUMP


def cup_in(palm: Array, cup: Array) -> Array:
    back = conjugate(palm[3:])
    return np.concatenate([rotate(back, cup[:3] - palm[:3]), multiply(back, cup[3:])])


@pytest.mark.long
def test_who_leaves_in_the_midst_gets_nothing_and_it_stays_in_the_hand(room: Room) -> None:
    ken, aiko = room.mains["ken"], room.mains["aiko"]
    room.do("ken", "do aiko hand_over")
    room.go_on(lambda: ken.blending.grips[0, 1] > 0.35)
    aiko.communication.client.leave("aiko")
    del room.mains["aiko"]
    room.go_on(lambda: ken.agenda.done)
    aiko.close()
    assert ken.report.messages == ["aiko hand_over: aiko is gone"]
    assert ken.control.holds == {"cup": "right"}
    assert ken.communication.client.refresh().objects["cup"].holder == "ken"


def test_what_the_server_refuses_to_pass_on_is_in_the_hand_as_before(room: Room) -> None:
    ken = room.mains["ken"]
    begin = ken.communication.transfer
    ken.communication.transfer = lambda name, _, hand: begin(name, "nobody", hand)  # type: ignore[method-assign]
    room.do("ken", "do aiko hand_over")
    room.do("aiko", "do ken receive patience=8")
    room.go_on(lambda: ken.agenda.done)
    assert ken.report.messages == ['aiko hand_over: no human "nobody" in the world; it stays in the hand']
    room.mains["aiko"].agenda.clear()
    room.go_on(lambda: room.idle and ken.control.holds == {"cup": "right"} and not ken.control.starts)
    del room.seen[:]
    room.do("ken", "do floor stand with cup carry")
    room.go_on(lambda: room.idle and len(room.seen) > 30)
    inner = np.array([cup_in(palms[0], cup) for _, cup, palms in room.seen])
    assert {holder for holder, _, _ in room.seen} == {"ken"}
    assert np.linalg.norm(np.diff(inner[:, :3], axis=0), axis=1).max() < JUMP
    assert np.ptp(np.array([palms[0, :3] for _, _, palms in room.seen]), axis=0).max() > 0.002


@pytest.mark.long
def test_who_is_stopped_in_the_midst_keeps_it(room: Room) -> None:
    ken = room.mains["ken"]
    room.do("ken", "do aiko hand_over")
    room.go_on(lambda: ken.blending.grips[0, 1] > 0.3)
    ken.stop_motion()
    room.go_on(lambda: room.idle)
    assert ken.report.messages == []
    assert ken.control.holds == {"cup": "right"}
