"""What a hand has let go falls and rests upright on what is under it, in every kind of ending."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import trimesh
from ground import ROOT, ROTATIONS, eventually, join, row

from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.states.behaviour import PART, Appearance, Behaviour
from ahmss.states.condition import parse_condition
from ahmss.states.state import State
from ahmss.world.assets import Assets
from ahmss.world.behaviours import Behaviours
from ahmss.world.falling import fall_of
from ahmss.world.recording import Reader
from ahmss.world.schema import NewObject, content_hash
from ahmss.world.solids import Solid, Solids
from ahmss.world.view import World

LEVEL = (1.0, 0.0, 0.0, 0.0)
UP = np.array([0.0, 0.0, 1.0])


def pose(x: float, y: float, z: float, rotation=LEVEL) -> np.ndarray:
    return np.array([x, y, z, *rotation])


@cache
def glb(*boxes: tuple[float, ...], names: tuple[str, ...] = ()) -> bytes:
    """Boxes as a shape travels, each by its lowest and its highest corner."""
    scene = trimesh.Scene()
    for i, box in enumerate(boxes):
        low, high = np.array(box[:3]), np.array(box[3:])
        mesh = trimesh.creation.box(high - low, trimesh.transformations.translation_matrix((low + high) / 2))
        scene.add_geometry(mesh, geom_name=names[i] if names else f"box {i}")
    return scene.export(file_type="glb")


CUP = glb((-0.04, -0.04, 0.0, 0.04, 0.04, 0.1))
TABLE = glb((-0.5, -0.6, 0.85, 0.5, 0.6, 0.88), (-0.05, -0.05, 0.0, 0.05, 0.05, 0.85))
HILL = glb((-1.0, -1.0, 0.0, 0.0, 1.0, 0.3), (0.0, -1.0, 0.0, 1.0, 1.0, 0.2))


def solid(data: bytes, behaviour: Behaviour | None = None) -> Solid:
    assets, name = Assets(None), content_hash(data)
    assets.put(b"", name, len(data), 0, data)
    own = b"" if behaviour is None else behaviour.encode()
    if own:
        assets.put(b"", content_hash(own), len(own), 0, own)
    found = Solids(assets, Behaviours(assets)).get(name, content_hash(own) if own else "")
    assert found is not None
    return found


def end(start: np.ndarray, *others: tuple[Solid, np.ndarray]) -> np.ndarray:
    fall = fall_of(solid(CUP), start, others)
    return start if fall is None else fall.end


def test_it_rests_on_the_table_below_it_or_beside_that_on_the_ground() -> None:
    table = (solid(TABLE), pose(2.0, 0.0, 0.0, from_axis_angle(UP, np.array(0.7))))
    assert end(pose(2.1, 0.1, 1.2), table) == pytest.approx(pose(2.1, 0.1, 0.88))
    assert end(pose(2.1, 0.1, 0.5), table)[2] == 0.0  # below the top
    assert end(pose(3.5, 0.0, 1.2), table)[2] == 0.0


def test_it_lands_on_another_thing_and_not_on_what_only_reaches_its_side() -> None:
    other = (solid(CUP), pose(0.02, 0.0, 0.3))
    assert end(pose(0.0, 0.0, 0.9), other) == pytest.approx(pose(0.0, 0.0, 0.4))
    tall = (solid(glb((-0.04, -0.04, 0.0, 0.04, 0.04, 2.0))), pose(0.2, 0.0, 0.0))
    assert end(pose(0.0, 0.0, 0.9), tall) == pytest.approx(pose(0.0, 0.0, 0.0))


def test_it_rests_where_its_middle_is_held_and_slides_off_an_edge() -> None:
    hill = (solid(HILL), pose(0.0, 0.0, 0.0))
    assert end(pose(-0.01, 0.0, 0.9), hill)[2] == pytest.approx(0.3)
    beside = end(pose(0.02, 0.0, 0.9), hill)
    assert beside[2] == pytest.approx(0.2)
    assert 0.04 <= beside[0] < 0.06  # all of its base is past the step
    assert end(pose(-0.5, 0.0, 0.31), hill)[2] == pytest.approx(0.3)


def test_what_is_let_go_a_little_too_low_is_lifted_and_what_rests_stays() -> None:
    table = (solid(TABLE), pose(0.0, 0.0, 0.0))
    fall = fall_of(solid(CUP), pose(0.1, 0.0, 0.87), [table])
    assert fall is not None
    assert fall.end[2] == pytest.approx(0.88)
    heights = [fall.pose(t)[2] for t in np.linspace(0.0, fall.seconds, 9)]
    assert heights == sorted(heights)
    assert fall_of(solid(CUP), pose(0.1, 0.0, 0.88), [table]) is None
    assert fall_of(solid(CUP), pose(0.1, 0.0, -1.0), []) is None


def test_it_falls_as_fast_as_things_do_and_rights_itself_above_the_ground() -> None:
    turned = multiply(from_axis_angle(UP, np.array(1.0)), from_axis_angle(np.array([0.0, 1.0, 0.0]), np.array(0.6)))
    fall = fall_of(solid(CUP), pose(0.0, 0.0, 1.0, turned), [])
    assert fall is not None
    assert fall.pose(0.2)[2] == pytest.approx(1.0 - 0.5 * 9.81 * 0.04)
    assert fall.seconds == pytest.approx(np.sqrt(2.0 / 9.81))
    assert fall.end == pytest.approx(pose(0.0, 0.0, 0.0, from_axis_angle(UP, np.array(1.0))))
    corners = solid(CUP).triangles.reshape(-1, 3)
    for t in np.linspace(0.0, 0.5, 30):
        now = fall.pose(t)
        assert (now[2] + rotate(now[3:], corners)[:, 2]).min() > -1e-6


def test_water_that_may_be_shut_holds_nothing_up() -> None:
    tap = glb((-0.1, -0.1, 0.0, 0.1, 0.1, 0.05), (-0.01, -0.01, 0.05, 0.01, 0.01, 0.4), names=("sink", PART + "water"))
    behaviour = Behaviour(
        {"flow": State("shut", ("shut", "running"))},
        (Appearance(("water",), parse_condition("flow == shut"), shown=False),),
    )
    assert end(pose(0.0, 0.0, 0.6), (solid(tap), pose(0.0, 0.0, 0.0)))[2] == pytest.approx(0.4)
    assert end(pose(0.0, 0.0, 0.6), (solid(tap, behaviour), pose(0.0, 0.0, 0.0)))[2] == pytest.approx(0.05)


def furnish(client, behaviour: bytes = b"") -> int:
    """A table with a cup on it; the cup's id."""
    table, cup, own = client.put_asset(TABLE), client.put_asset(CUP), client.put_asset(behaviour)
    client.add([
        NewObject("table", "table", shape=table),
        NewObject("cup", "cup", (0.1, 0.0, 0.88), shape=cup, behaviour=own),
    ])  # fmt: skip
    return client.refresh().objects["cup"].id


def lift(client, number: int, frame: int = 1, z: float = 1.3) -> None:
    """Take the cup up."""
    client.claim("ken", ["cup"], "right")
    client.publish("ken", frame, ROOT, ROTATIONS, row(number, (0.1, 0.0, z)))


def rests(client, z: float) -> bool:
    world = client.refresh()
    return bool(abs(world.pose("cup")[2] - z) < 1e-9) and world.objects["cup"].holder == ""


def test_a_cup_let_go_above_the_table_rests_on_it_and_others_see_it_fall(start, connect):
    server = start()
    ken, viewer = connect(server), connect(server)
    join(ken, "ken")
    lift(ken, furnish(ken))
    ken.refresh()
    assert ken.world.pose("cup")[2] == 1.3
    ken.release("ken", ["cup"])
    heights = []
    eventually(lambda: heights.append(float(viewer.refresh().pose("cup")[2])) or rests(viewer, 0.88))
    assert len({z for z in heights if 0.88 < z < 1.3}) > 3
    assert heights == sorted(heights, reverse=True)
    ken.claim("ken", ["cup"], "left")
    assert ken.refresh().objects["cup"].holder == "ken"


def test_who_catches_it_has_it_and_what_does_not_fall_stays(start, connect):
    server = start()
    ken = connect(server)
    join(ken, "ken")
    number = furnish(ken)
    lift(ken, number)
    ken.release("ken", ["cup"])
    lift(ken, number, 2, z=1.5)
    eventually(lambda: ken.refresh().pose("cup")[2] == 1.5)
    ken.remove("cup")
    ken.add(
        [NewObject("cup", "cup", shape=content_hash(CUP), behaviour=ken.put_asset(Behaviour(falls=False).encode()))]
    )
    lift(ken, ken.refresh().objects["cup"].id, 3)
    ken.release("ken", ["cup"])
    tick = ken.refresh().tick
    eventually(lambda: ken.refresh().tick > tick + 10)
    assert ken.world.pose("cup")[2] == 1.3


@pytest.mark.parametrize("stay", [True, False])
def test_the_cup_of_who_leaves_falls(start, connect, stay):
    server = start()
    ken, viewer = connect(server), connect(server)
    join(ken, "ken")
    lift(ken, furnish(ken))
    ken.refresh()
    ken.leave("ken", stay=stay)
    eventually(lambda: rests(viewer, 0.88))
    assert ("ken" in viewer.world.humans) == stay


HOLDER = """
import sys, time
sys.path.insert(0, {here!r})
from ground import join
from test_falling import furnish, lift
from ahmss.world.client import WorldClient
ken = WorldClient({address!r}, timeout=20.0)
join(ken, "ken")
lift(ken, furnish(ken))
ken.refresh()
print("holds", flush=True)
time.sleep(60)
"""


def test_the_cup_of_a_main_that_is_killed_falls(start, connect):
    server = start(lease_s=1.0)
    here = str(Path(__file__).parent)
    code = HOLDER.format(here=here, address=str(server.address))
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as holder:
        assert holder.stdout is not None
        assert holder.stdout.readline() == "holds\n"
        os.kill(holder.pid, signal.SIGKILL)
    viewer = connect(server)
    assert viewer.refresh().pose("cup")[2] == 1.3
    eventually(lambda: rests(viewer, 0.88))


def test_who_slept_while_it_fell_has_lost_it(start, connect):
    server = start(lease_s=1.0)
    ken, viewer = connect(server), connect(server)
    join(ken, "ken")
    lift(ken, furnish(ken))
    eventually(lambda: rests(viewer, 0.88))

    def told() -> str:
        ken.publish("ken", 2, ROOT, ROTATIONS)
        ken.poll()
        return "\n".join(ken.refusals)

    assert "no longer holds cup" in eventually(lambda: "no longer" in told() and told())
    assert rests(viewer, 0.88)


def test_what_a_killed_server_left_in_the_air_falls_when_nobody_comes_back(start, connect, tmp_path):
    server = start(directory=tmp_path / "world")
    ken = connect(server)
    join(ken, "ken")
    number = furnish(ken)
    lift(ken, number, z=60.0)  # so that it is still falling when the server is killed
    ken.release("ken", ["cup"])
    tick = ken.refresh().tick
    eventually(lambda: ken.refresh().tick > tick + 1)  # the journal has it
    ken.close()
    server.kill()
    again = start(directory=tmp_path / "world", lease_s=0.5)
    viewer = connect(again)
    assert viewer.refresh().pose("cup")[2] > 50.0
    eventually(lambda: rests(viewer, 0.88))


def run(start, connect, path: Path) -> tuple[bytes, list[float]]:
    """A main alone in lockstep lets the cup go and sees it fall."""
    server = start(lockstep=("ken",), recording=path)
    ken = connect(server)
    join(ken, "ken")
    lift(ken, furnish(ken))
    seen = []
    for frame in range(2, 40):
        if frame == 5:
            ken.release("ken", ["cup"])
        ken.publish("ken", frame, ROOT, ROTATIONS)
        seen.append(float(ken.collect(1).pose("cup")[2]))
    ken.leave("ken")
    server.stop()
    return path.read_bytes(), seen


def test_in_lockstep_a_main_alone_sees_each_frame_of_the_fall_in_every_run(start, connect, tmp_path):
    one, seen = run(start, connect, tmp_path / "a.rec")
    other, again = run(start, connect, tmp_path / "b.rec")
    assert one == other
    falling = [z for z in seen if 0.88 < z < 1.3]
    assert falling == [z for z in again if 0.88 < z < 1.3]
    assert falling == pytest.approx([1.3 - 0.5 * 9.81 * (k / 60.0) ** 2 for k in range(1, len(falling) + 1)])
    assert len(falling) == 17  # 0.42 m take 0.29 s
    with Reader(tmp_path / "a.rec") as reader:
        assert reader.show(len(reader) - 1, World()).pose("cup")[2] == pytest.approx(0.88)
