"""Objects look as their states say: pictures of a signal whose parts change."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from ahmss_viewer.camera import look_at
from ahmss_viewer.glb import read_glb
from ahmss_viewer.mirror import Mirror
from ahmss_viewer.source import Replay
from ahmss_viewer.stage import Stage

from ahmss.body.quaternion import from_axis_angle
from ahmss.states.behaviour import PART, Appearance, Behaviour
from ahmss.states.condition import parse_condition
from ahmss.states.state import State
from ahmss.world.recording import Writer
from ahmss.world.schema import ObjectChange, ObjectRecord, Scene, Snapshot, content_hash

from .conftest import Draw
from .scenes import GREEN, RED
from .test_picture import is_red, pixel

VIEW = look_at(np.array([3.0, -1.2, 1.7]), np.array([0.0, 0.0, 0.6]))
UPRIGHT = (1.0, 0.0, 0.0, 0.0)
LAMP, ARM = np.array([0.25, 0.0, 1.0]), np.array([0.25, 0.0, 0.35])
SIGNAL = Behaviour(
    {"light": State("off", ("off", "on", "gone")), "angle": State(0.0, (), 0.0, 1.0)},
    (
        Appearance(("lamp",), parse_condition("light == on"), color=(250, 220, 40), lit=1.0),
        Appearance(("lamp",), parse_condition("light == gone"), shown=False),
        Appearance(("arm",), by="angle", turn=np.pi / 2, axis=(1.0, 0.0, 0.0), pivot=(0.0, 0.0, 0.25)),
    ),
)


def signal_glb() -> bytes:
    """A dark green lamp above a red arm that lies along y."""
    scene = trimesh.Scene()
    for name, size, place, colour in (
        ("lamp", (0.5, 0.5, 0.5), (0, 0, 1.0), (20, 60, 30)),
        ("arm", (0.5, 1.0, 0.2), (0, 0, 0.35), RED),
    ):
        mesh = trimesh.creation.box(size, trimesh.transformations.translation_matrix(place))
        mesh.visual.vertex_colors = np.tile([*colour, 255], (len(mesh.vertices), 1))
        scene.add_geometry(mesh, geom_name=PART + name)
    return scene.export(file_type="glb")


@pytest.fixture
def film(tmp_path: Path) -> Replay:
    """Two signals: the first goes through its states, the second stays as it was."""
    assets: dict[str, bytes] = {}

    def put(data: bytes) -> str:
        assets[content_hash(data)] = data
        return content_hash(data)

    shape, behaviour = put(signal_glb()), put(SIGNAL.encode())
    first = {"light": "off", "angle": 0.0}
    objects = [
        ObjectRecord(number, name, "signal", place, UPRIGHT, shape=shape, states=first, behaviour=behaviour)
        for number, name, place in ((1, "a", (0.0, 0.0, 0.0)), (2, "b", (0.0, 1.1, 0.0)))
    ]  # fmt: skip
    scene = Scene(1, objects, [])
    writer = Writer(tmp_path / "signal.rec", assets.get)
    for k, (light, angle) in enumerate([("off", 0.0), ("on", 0.0), ("gone", 0.0), ("off", 1.0), ("off", 0.0)]):
        changes = [ObjectChange(1, {"light": light, "angle": angle})] if k else []
        writer.write(Snapshot(k, k / 60.0, 1, changes=changes), lambda: scene)
    writer.close()
    return Replay(tmp_path / "signal.rec")


def test_parts_are_lit_hidden_turned_and_as_before(film: Replay, draw: Draw) -> None:
    stage = Stage()
    mirror = Mirror(stage, film.asset, film.skeleton)
    pictures = []
    for tick in range(len(film)):
        mirror.show(film.show(tick))
        pictures.append(draw(stage, VIEW))
        assert mirror.problems == []
    off, on, gone, turned, again = pictures
    assert pixel(on, LAMP) == pytest.approx([250, 220, 40], abs=3)  # its own light, whatever falls on it
    assert pixel(off, LAMP).max() < 80
    assert pixel(gone, LAMP)[2] > 150  # the sky
    end = ARM + np.array([0.0, -0.4, 0.0])
    assert is_red(pixel(off, end))
    assert not is_red(pixel(turned, end))
    assert is_red(pixel(turned, np.array([0.25, -0.1, 0.65])))
    assert np.abs(again - off).mean() < 0.05  # a pixel or two at edges, for it is drawn by itself now
    beside = (np.array([0.25, 1.1, 1.0]), np.array([0.25, 1.1, 0.35]))
    for picture in pictures:
        for place in beside:
            assert pixel(picture, place) == pytest.approx(pixel(off, place), abs=1)
    film.close()


def test_objects_that_look_the_same_share_their_surfaces_and_a_change_rests_again(film: Replay, draw: Draw) -> None:
    stage = Stage()
    mirror = Mirror(stage, film.asset, film.skeleton)
    mirror.show(film.show(0))
    draw(stage, VIEW)
    assert [p.surface for p in stage.things[1].pieces] == [p.surface for p in stage.things[2].pieces]
    assert not list(stage.moving())
    mirror.show(film.show(1))
    assert not list(stage.moving())  # another colour alone stays merged
    mirror.show(film.show(3))
    assert len(list(stage.moving())) == 2
    for _ in range(40):
        stage.tick()
    assert not list(stage.moving())
    before = draw(stage, VIEW)
    stage.move_object(1, np.array([0.0, 0.0, 0.001]), from_axis_angle(np.array([0.0, 0.0, 1.0]), np.array(0.0)))
    assert np.abs(draw(stage, VIEW).astype(int) - before).mean() < 1.0  # drawn by itself it is turned as well
    film.close()


def test_a_shape_without_parts_is_one_piece() -> None:
    mesh = trimesh.creation.box((1.0, 1.0, 1.0))
    mesh.visual.vertex_colors = np.tile([*GREEN, 255], (len(mesh.vertices), 1))
    assert [surface.part for surface in read_glb(mesh.export(file_type="glb"))] == [""]
    assert sorted(surface.part for surface in read_glb(signal_glb())) == ["arm", "lamp"]
