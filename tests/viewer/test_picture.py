"""Pictures of small scenes against what must be seen in them."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from ahmss_viewer.camera import View, look_at, project
from ahmss_viewer.figure import plain_figure
from ahmss_viewer.glb import read_glb
from ahmss_viewer.names import name_flats
from ahmss_viewer.stage import Stage

from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle

from .conftest import Draw
from .scenes import GREEN, RED, SKELETON, UNTURNED, WHITE, box_glb, floor_glb, png, raised

VIEW = look_at(np.array([3.0, -1.2, 1.7]), np.array([0.0, 0.0, 0.6]))
SIZE = (320, 240)


def pixel(picture: np.ndarray, place: np.ndarray, view: View = VIEW) -> np.ndarray:
    """The colour where a place of the world is projected, the mean of 3x3 pixels."""
    x, y, depth = project(place, view, (picture.shape[1], picture.shape[0]))
    assert depth > 0
    return picture[int(y) - 1 : int(y) + 2, int(x) - 1 : int(x) + 2].mean(axis=(0, 1))


def is_red(colour: np.ndarray) -> bool:
    return bool(colour[0] > 90 and colour[0] > 2.5 * colour[1] and colour[0] > 2.5 * colour[2])


def is_skin(colour: np.ndarray) -> bool:
    return bool(colour[0] > 120 and colour[0] > colour[1] > colour[2] and colour[0] - colour[2] > 30)


def stage_with_box() -> Stage:
    stage = Stage()
    stage.add_object(1, "floor", read_glb(floor_glb()), np.zeros(3), UNTURNED)
    stage.add_object(2, "box", read_glb(box_glb((0.5, 0.5, 0.5), RED)), np.array([0.0, 0.0, 0.25]), UNTURNED)
    return stage


def test_a_red_box_covers_the_pixels_of_its_faces_and_no_others(draw: Draw) -> None:
    picture = draw(stage_with_box(), VIEW)
    red = (picture[..., 0] > 80) & (picture[..., 0] > 2.5 * picture[..., 1])
    for place in ([0.25, 0.0, 0.25], [0.0, -0.25, 0.25], [0.0, 0.0, 0.5]):
        assert is_red(pixel(picture, np.array(place)))
    corners = np.array([[x, y, z] for x in (-0.25, 0.25) for y in (-0.25, 0.25) for z in (0.0, 0.5)])
    seen = project(corners, VIEW, SIZE)[:, :2]
    low, high = seen.min(axis=0), seen.max(axis=0)
    rows, columns = np.nonzero(red)
    assert abs(columns.min() - low[0]) < 2
    assert abs(columns.max() - high[0]) < 2
    assert abs(rows.min() - low[1]) < 2
    assert abs(rows.max() - high[1]) < 2


def test_the_sun_side_is_brighter_and_no_side_is_black(draw: Draw) -> None:
    stage = Stage()
    stage.add_object(1, "box", read_glb(box_glb((1.0, 1.0, 1.0), WHITE)), np.zeros(3), UNTURNED)
    for azimuth in np.linspace(0.0, 2.0 * np.pi, 5)[:4]:
        picture = draw(stage, View(target=np.zeros(3), distance=4.0, azimuth=azimuth, elevation=0.5))
        view = View(target=np.zeros(3), distance=4.0, azimuth=azimuth, elevation=0.5)
        side = pixel(picture, 0.5 * np.array([np.cos(azimuth), np.sin(azimuth), 0.0]), view)
        top = pixel(picture, np.array([0.0, 0.0, 0.5]), view)
        assert side.min() > 90
        assert top.mean() > side.mean() + 15


def test_a_box_casts_a_shadow_on_the_floor(draw: Draw) -> None:
    stage = stage_with_box()
    view = look_at(np.array([0.0, 0.1, 5.0]), np.zeros(3))
    with_box = draw(stage, view)
    stage.remove_object(2)
    without = draw(stage, view)
    shadow = np.array([-0.25 - 0.08, 0.0, 0.0])  # the sun stands at +x
    assert pixel(without, shadow, view).mean() > pixel(with_box, shadow, view).mean() + 25
    far = np.array([-1.0, -1.0, 0.0])
    assert pixel(without, far, view) == pytest.approx(pixel(with_box, far, view), abs=3)


def test_a_moved_box_leaves_its_place_and_looks_the_same_when_it_rests(draw: Draw) -> None:
    stage = stage_with_box()
    draw(stage, VIEW)
    stage.move_object(2, np.array([0.0, 1.0, 0.25]), UNTURNED)
    moving = draw(stage, VIEW)
    assert not is_red(pixel(moving, np.array([0.0, -0.25, 0.25])))
    assert is_red(pixel(moving, np.array([0.0, 1.0, 0.5])))
    assert len(list(stage.moving())) == 1
    for _ in range(40):
        stage.tick()
    assert not list(stage.moving())
    resting = draw(stage, VIEW)
    assert np.abs(resting - moving).mean() < 0.5
    stage.move_object(2, np.array([0.0, 1.0, 0.25]), from_axis_angle(np.array([0.0, 0.0, 1.0]), 0.0))
    assert not list(stage.moving()), "the same place is no movement"


def test_an_object_that_goes_and_one_that_comes_are_seen_to(draw: Draw) -> None:
    stage = stage_with_box()
    draw(stage, VIEW)
    stage.remove_object(2)
    stage.add_object(3, "other", read_glb(box_glb((0.3, 0.3, 0.3), GREEN)), np.array([0.0, 0.8, 0.15]), UNTURNED)
    picture = draw(stage, VIEW)
    assert not is_red(pixel(picture, np.array([0.0, 0.0, 0.5])))
    green = pixel(picture, np.array([0.0, 0.8, 0.3]))
    assert green[1] > green[0] + 40


def test_a_texture_stands_upright(draw: Draw) -> None:
    vertices = np.array([[0.0, -0.5, 0.0], [0.0, 0.5, 0.0], [0.0, 0.5, 1.0], [0.0, -0.5, 1.0]])
    mesh = trimesh.Trimesh(vertices, [[0, 1, 2], [0, 2, 3]], process=False)
    white = trimesh.visual.material.PBRMaterial(baseColorFactor=[255, 255, 255, 255])
    mesh.visual = trimesh.visual.TextureVisuals(uv=[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], material=white)
    surfaces = tuple(s.textured(png(RED, GREEN)) for s in read_glb(mesh.export(file_type="glb")))
    stage = Stage()
    stage.add_object(1, "board", surfaces, np.zeros(3), UNTURNED)
    picture = draw(stage, VIEW)
    assert is_red(pixel(picture, np.array([0.0, 0.0, 0.8])))
    low = pixel(picture, np.array([0.0, 0.0, 0.2]))
    assert low[1] > low[0] + 40


def test_a_texture_that_is_no_picture_is_left_off(draw: Draw) -> None:
    surfaces = read_glb(box_glb((0.5, 0.5, 0.5), RED))
    stage = Stage()
    stage.add_object(1, "box", tuple(s.textured(b"no picture") for s in surfaces), np.array([0.0, 0.0, 0.25]), UNTURNED)
    assert is_red(pixel(draw(stage, VIEW), np.array([0.0, 0.0, 0.5])))


def test_the_back_of_a_one_sided_wall_is_not_seen(draw: Draw) -> None:
    vertices = np.array([[0.5, -1.0, 0.0], [0.5, 1.0, 0.0], [0.5, 1.0, 1.0], [0.5, -1.0, 1.0]])
    wall = trimesh.Trimesh(vertices, [[0, 2, 1], [0, 3, 2]], process=False)  # it faces -x
    wall.visual = trimesh.visual.TextureVisuals(material=trimesh.visual.material.PBRMaterial(doubleSided=False))
    both = wall.copy()
    both.visual = trimesh.visual.TextureVisuals(material=trimesh.visual.material.PBRMaterial(doubleSided=True))
    stage = stage_with_box()
    stage.add_object(3, "wall", read_glb(wall.export(file_type="glb")), np.zeros(3), UNTURNED)
    assert is_red(pixel(draw(stage, VIEW), np.array([0.25, 0.0, 0.25])))
    stage.add_object(3, "wall", read_glb(both.export(file_type="glb")), np.zeros(3), UNTURNED)
    assert not is_red(pixel(draw(stage, VIEW), np.array([0.25, 0.0, 0.25])))


def test_a_human_has_its_head_where_its_head_is_and_moves_its_hand(draw: Draw) -> None:
    stage = Stage()
    stage.add_human(1, "ken", SKELETON.offsets, plain_figure(SKELETON))
    stage.pose_human(1, *raised(0.0))
    before = draw(stage, VIEW)
    head = stage.actors[1].places[INDEX["head"]] + np.array([0.0, 0.0, 0.2])
    hand_down = stage.actors[1].places[INDEX["right_hand"]] + np.array([0.0, 0.0, -0.05])
    stage.pose_human(1, *raised(1.0))
    after = draw(stage, VIEW)
    hand_up = stage.actors[1].places[INDEX["right_middle_proximal"]]
    assert hand_up[0] > 0.4, "the arm points forward"
    assert is_skin(pixel(before, head))
    assert is_skin(pixel(after, head))
    assert is_skin(pixel(before, hand_down))
    assert not is_skin(pixel(after, hand_down))
    assert is_skin(pixel(after, hand_up))
    assert not is_skin(pixel(before, hand_up))


def test_skinning_puts_every_vertex_where_its_link_is() -> None:
    stage = Stage()
    stage.add_human(1, "ken", SKELETON.offsets, plain_figure(SKELETON))
    rotations, root = raised(0.7)
    stage.pose_human(1, rotations, root + np.array([1.0, 2.0, 0.0]))
    actor = stage.actors[1]
    for link in (0, INDEX["right_hand"], INDEX["left_foot"]):
        T_world_bind = np.linalg.inv(actor.inverse_binds[link])
        moved = actor.batches[0].links[link].astype(float) @ np.append(T_world_bind[:3, 3], 1.0)
        assert moved == pytest.approx(actor.places[link], abs=1e-5)


def test_names_stand_over_their_things_and_do_not_cover_each_other(draw: Draw) -> None:
    from ahmss_viewer.caption import Writer

    stage = stage_with_box()
    stage.add_object(3, "room/cup", read_glb(box_glb((0.1, 0.1, 0.1), GREEN)), np.array([0.0, 0.02, 0.55]), UNTURNED)
    stage.add_human(1, "ken", SKELETON.offsets, plain_figure(SKELETON))
    stage.pose_human(1, *raised(0.0))
    flats = name_flats(stage, VIEW, SIZE, Writer())
    boxes = [(f.left, f.top, f.left + f.width, f.top + f.height) for f in flats]
    assert len(flats) >= 2
    for i, a in enumerate(boxes):
        for b in boxes[i + 1 :]:
            assert a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]
    head = project(stage.actors[1].places[INDEX["head"]] + np.array([0.0, 0.0, 0.34]), VIEW, SIZE)
    assert any(a[0] - 2 <= head[0] <= a[2] + 2 and a[1] - 14 <= head[1] <= a[3] + 14 for a in boxes)
