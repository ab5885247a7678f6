"""The headless viewer at a real server that comes, goes and comes back."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from ahmss_viewer.aim import Aim
from ahmss_viewer.app import ViewOptions, ViewReport, view
from ahmss_viewer.live import Stop, watch
from ahmss_viewer.mirror import Mirror
from ahmss_viewer.source import Live
from ahmss_viewer.stage import Stage
from ahmss_viewer.studio import Studio
from PIL import Image

from ahmss.errors import Unreachable, WorldError
from ahmss.world.client import WorldClient
from ahmss.world.process import ServerProcess
from ahmss.world.schema import NewObject, ObjectRecord, Scene
from ahmss.world.view import World

from .scenes import RED, SKELETON, box_glb, decode, raised


@contextmanager
def actor(address: str) -> Iterator[threading.Event]:
    """A human that lifts and lowers its arm 60 times a second, and a red box; until the block ends."""
    stop = threading.Event()

    def act() -> None:
        with WorldClient(address, timeout=20.0, follow=False) as client:
            shape = client.put_asset(box_glb((0.5, 0.5, 0.5), RED))
            client.add([NewObject("box", "box", (0.7, -0.7, 0.25), shape=shape)])
            rotations, root = raised(0.0)
            client.join("ken", "ken", root, rotations, skeleton=SKELETON.to_record())
            frame = 0
            while not stop.wait(1 / 60):
                frame += 1
                rotations, root = raised(abs(frame % 60 - 30) / 30)
                client.publish("ken", frame, root, rotations)
                client.poll()

    thread = threading.Thread(target=act)
    thread.start()
    try:
        yield stop
    finally:
        stop.set()
        thread.join(20.0)


@pytest.fixture
def server(tmp_path: Path) -> Iterator[ServerProcess]:
    with ServerProcess(log=tmp_path / "server.log") as process:
        yield process


def watch_some(options: ViewOptions, pictures: int) -> ViewReport:
    """Watch until so many pictures were drawn."""
    stop = Stop()

    def count(done: int, _all: int) -> None:
        stop.asked = done >= pictures

    return watch(options, stop, count)


def later(seconds: float, act: Callable[[], None]) -> threading.Thread:
    """Do something in a moment."""
    thread = threading.Thread(target=lambda: (time.sleep(seconds), act()))
    thread.start()
    return thread


def test_a_live_film_keeps_the_time_of_the_wall(server: ServerProcess, tmp_path: Path) -> None:
    options = ViewOptions(
        address=str(server.address), record=tmp_path / "a.mp4", sheet=tmp_path / "a.png", every=15,
        snapshot=tmp_path / "s.png", size=(160, 120), rate=20.0,
    )  # fmt: skip
    begin = time.monotonic()
    with actor(str(server.address)):
        report = watch_some(options, 40)
    passed = time.monotonic() - begin
    film, rate = decode(tmp_path / "a.mp4", (160, 120))
    assert rate == 20.0
    assert report.seconds * 20.0 - 2 < len(film) < passed * 20.0 + 2
    assert report.pictures >= 40
    assert len(report.ages) > 40
    red = (film[-1][..., 0] > 80) & (film[-1][..., 0] > 2 * film[-1][..., 1])
    assert red.any()
    with Image.open(tmp_path / "s.png") as shot, Image.open(tmp_path / "a.png") as page:
        assert shot.size == (160, 120)
        assert page.size[0] >= 320
    assert set(report.files) == {str(tmp_path / name) for name in ("a.mp4", "a.png", "s.png")}
    assert not report.problems
    assert report.to_json()["age_ms"]["p50"] >= 0.0


def test_a_viewer_that_asks_and_waits_sees_the_same(server: ServerProcess, tmp_path: Path) -> None:
    options = ViewOptions(address=str(server.address), headless=True, request=True, size=(160, 120))
    with actor(str(server.address)):
        report = watch_some(options, 10)
    assert report.pictures >= 10
    assert report.faces > 6000


def test_a_snapshot_alone_ends_the_viewer(server: ServerProcess, tmp_path: Path) -> None:
    options = ViewOptions(address=str(server.address), snapshot=tmp_path / "s.png", size=(160, 120))
    with actor(str(server.address)):
        report = view(options)
    assert report.files == [str(tmp_path / "s.png")]


def test_a_snapshot_of_a_running_world_is_as_smooth_as_one_of_a_recording(
    server: ServerProcess, tmp_path: Path
) -> None:
    with WorldClient(str(server.address)) as client:
        shape = client.put_asset(box_glb((0.5, 0.5, 0.5), RED))
        client.add([NewObject("box", "box", (0.0, 0.0, 0.25), shape=shape)])
        view(ViewOptions(address=str(server.address), snapshot=tmp_path / "s.png", size=(160, 120)))
        world = client.refresh()
        with Studio(fine=True) as studio:
            studio.mirror(client.get_asset, lambda _: {}).show(world)
            best = studio.picture(Aim(ViewOptions()).begin(studio.stage, studio.painter), (160, 120), best=True)
            plain = studio.picture(Aim(ViewOptions()).begin(studio.stage, studio.painter), (160, 120)).copy()
    with Image.open(tmp_path / "s.png") as shot:
        taken = np.asarray(shot)
    assert (taken == best).all()
    assert (taken != plain).any()


def test_a_server_that_comes_late_and_is_restarted_is_found_again(tmp_path: Path) -> None:
    first = ServerProcess(log=tmp_path / "server.log")
    address = str(first.address)
    source = Live(address)
    try:
        assert source.wait(10.0)
        first.stop()
        limit = time.monotonic() + 10.0
        while not source.silent and time.monotonic() < limit:
            source.wait(0.1)
        assert source.silent, "the last world stays, and it is known to be old"
        with ServerProcess(address, log=tmp_path / "server.log"):
            assert source.wait(10.0)
            assert not source.silent
    finally:
        source.close()
        first.stop()


def test_a_viewer_without_a_server_waits_until_it_is_told_and_says_why_it_saw_nothing(tmp_path: Path) -> None:
    stop = Stop()
    options = ViewOptions(address="127.0.0.1:1", record=tmp_path / "a.mp4", size=(160, 120))

    def end() -> None:
        stop.asked = True

    ender = later(0.5, end)
    with pytest.raises(Unreachable, match=r"no virtual-space server answers at .*; start one"):
        watch(options, stop)
    ender.join()
    assert not (tmp_path / "a.mp4").exists()


@pytest.mark.parametrize("ticks", [120, pytest.param(3600, marks=[pytest.mark.long, pytest.mark.timeout(150)])])
def test_after_a_stall_the_newest_world_is_shown_and_no_older_one(server: ServerProcess, ticks: int) -> None:
    address = str(server.address)
    source = Live(address)
    try:
        with actor(address), WorldClient(address, follow=False) as beside:
            while not len(source.world.human_ids):
                assert source.wait(20.0)
            before = source.world.tick
            while beside.refresh().tick < before + ticks:
                time.sleep(0.05)
            newest, stalled = beside.world.tick, source.age()
            assert source.wait(5.0)
            assert source.world.tick > 0.5 * (before + newest)
            assert source.age() < stalled
    finally:
        source.close()


def test_a_shape_that_comes_later_is_shown_then() -> None:
    shapes: dict[str, bytes] = {}
    problems = WorldError("the server has no asset")

    def asset(name: str) -> bytes:
        if name not in shapes:
            raise problems
        return shapes[name]

    world = World()
    world.load(Scene(1, [ObjectRecord(4, "box", "box", (0, 0, 0), (1, 0, 0, 0), shape="a")], []))
    stage = Stage()
    shown = Mirror(stage, asset, lambda _: {})
    shown.show(world)
    assert not stage.things[4].pieces
    assert shown.problems == ["the server has no asset"]
    shapes["a"] = box_glb((1.0, 1.0, 1.0), RED)
    shown._again = 0.0
    shown.show(world)
    assert stage.things[4].pieces


def test_a_scene_that_grows_and_shrinks_is_followed() -> None:
    records = [ObjectRecord(n, f"box{n}", "box", (n, 0, 0), (1, 0, 0, 0), shape="a") for n in range(3)]
    world, stage = World(), Stage()
    shown = Mirror(stage, lambda _: box_glb((1.0, 1.0, 1.0), RED), lambda _: {})
    for revision, count in enumerate([0, 3, 1, 2, 0], start=1):
        world.load(Scene(revision, records[:count], []))
        shown.show(world)
        assert set(stage.things) == set(range(count))
