"""The humans that are shipped: file and skin agree, and the body stands, grips and holds together."""

from __future__ import annotations

import hashlib
import json
import struct

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS, fingers
from ahmss.body.quaternion import conjugate, from_rotation_vector, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.database.workspace import Workspace
from humandb.conftest import ROOT, Shipped

SITTING = {
    "right_upper_leg": (0, -90, 0), "right_lower_leg": (0, 90, 0),
    "left_upper_leg": (0, -90, 0), "left_lower_leg": (0, 90, 0),
}  # fmt: skip
DRINKING = {"right_upper_arm": (0, 60, 0), "right_lower_arm": (0, 120, 0), "spine": (0, 10, 0)}
LOOKING_ASIDE = {"head": (60, 0, 0)}
FIST = {
    f"right_{finger}_{segment}": (0, 0, -80)
    for finger in ("index", "middle", "ring", "little")
    for segment in ("proximal", "intermediate")
}


def _welded(points: Array) -> Array:
    """The number of the place of each vertex: those at one place share it."""
    return np.unique(np.round(points, 5), axis=0, return_inverse=True)[1].reshape(-1)


def test_two_humans_of_different_stature_and_sex_are_found() -> None:
    humans = Workspace(ROOT).humans
    found = [humans.get(name).skeleton for name in humans.names()]
    assert {s.sex for s in found} == {"male", "female"}
    assert len({s.stature for s in found}) == len(found) >= 2


def test_the_file_says_what_usual_proportions_say(human: Shipped) -> None:
    # The skin was modelled around this skeleton: were it changed alone, skin and links would part.
    usual = Skeleton.of(human.skeleton.stature, human.skeleton.sex, human.name)
    for field in ("offsets", "tips", "mass", "radii", "limits", "grips", "soles", "eye"):
        np.testing.assert_allclose(getattr(human.skeleton, field), getattr(usual, field), atol=2e-5, err_msg=field)


def test_the_skin_names_the_43_links_in_order_and_fits_them(human: Shipped) -> None:
    data = (ROOT / "humandb" / human.name / "shape.glb").read_bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    tree = json.loads(data[20 : 20 + length])
    assert tuple(tree["nodes"][i]["name"] for i in tree["skins"][0]["joints"]) == LINKS
    assert len(data) < 1_000_000
    frames = np.linalg.inv(human.skin.inverse_binds)
    parents = {child: i for i, node in enumerate(tree["nodes"]) for child in node.get("children", ())}
    for link, parent in parents.items():
        offset = (np.linalg.inv(frames[parent]) @ frames[link])[:3, 3]
        np.testing.assert_allclose(offset, human.skeleton.offsets[link], atol=1e-5, err_msg=LINKS[link])


def test_weights_sum_to_one_and_every_link_moves_some_skin(human: Shipped) -> None:
    assert (human.skin.weights.astype(int).sum(axis=1) == 255).all()
    moved = np.unique(human.skin.joints[human.skin.weights > 0])
    assert len(moved) == len(LINKS)
    assert human.skin.joints.max() < len(LINKS)


def test_faces_are_as_many_as_a_viewer_bears(human: Shipped) -> None:
    assert 4_000 < len(human.surface.faces) < 14_500


def test_upright_stands_on_the_floor_at_its_stature(human: Shipped) -> None:
    skin = human.posed(*human.skeleton.upright())
    assert abs(skin[:, 2].max() - human.skeleton.stature) < 0.01
    for side in (-1.0, 1.0):
        foot = skin[(skin[:, 1] * side > 0.03) & (skin[:, 2] < 0.1)]
        assert abs(foot[:, 2].min()) < 0.002
    assert abs(skin[:, 1].max() + skin[:, 1].min()) < 0.005  # as wide to the left as to the right


def test_the_body_is_one_piece(human: Shipped) -> None:
    point = _welded(human.surface.positions)
    faces = point[human.surface.faces]
    edges = np.concatenate([faces[:, :2], faces[:, 1:]])
    count = int(point.max()) + 1
    pieces, label = connected_components(csr_matrix((np.ones(len(edges)), edges.T), shape=(count, count)))
    assert np.bincount(label).max() > 0.99 * count
    assert pieces <= 4  # slivers of a cut at the most


def test_vertices_at_one_place_move_as_one(human: Shipped) -> None:
    # Vertices are split where colours meet; with different weights the seam would open.
    point = _welded(human.surface.positions)
    skin = human.posed(*_pose(human, SITTING | DRINKING | LOOKING_ASIDE))
    low, high = np.full((point.max() + 1, 3), np.inf), np.full((point.max() + 1, 3), -np.inf)
    np.minimum.at(low, point, skin)
    np.maximum.at(high, point, skin)
    assert (high - low).max() < 0.001


@pytest.mark.parametrize(
    "turns", [SITTING, DRINKING, LOOKING_ASIDE, FIST], ids=["sitting", "drinking", "aside", "fist"]
)
def test_no_edge_tears_in_a_pose(human: Shipped, turns: dict[str, tuple[float, float, float]]) -> None:
    faces = human.surface.faces
    edges = np.concatenate([faces[:, :2], faces[:, 1:], faces[:, [2, 0]]])
    before = human.surface.positions.astype(float)
    after = human.posed(*_pose(human, turns))
    grown = _lengths(after, edges) - _lengths(before, edges)
    assert grown.max() < 0.09  # the seat of the trousers is what stretches most


@pytest.mark.parametrize("row", [0, 1], ids=["right", "left"])
def test_the_grip_lies_on_the_palms_skin(human: Shipped, row: int) -> None:
    rotations, root = human.skeleton.upright()
    places, world = forward(rotations, root, human.skeleton.offsets)
    hand = INDEX[("right_hand", "left_hand")[row]]
    grip = places[hand] + rotate(world[hand], human.skeleton.grips[row, :3])
    out = rotate(multiply(world[hand], human.skeleton.grips[row, 3:]), np.array([1.0, 0.0, 0.0]))
    heights = _hits(grip + 0.05 * out, -out, human.posed(rotations, root), human.surface.faces)
    assert np.abs(0.05 - heights).min() < 0.002


@pytest.mark.parametrize("side", ["right", "left"])
def test_finger_radii_are_those_of_the_skin(human: Shipped, side: str) -> None:
    rotations, root = human.skeleton.upright()
    places, world = forward(rotations, root, human.skeleton.offsets)
    skin = human.posed(rotations, root)
    off: dict[str, float] = {}
    for link in fingers(side):
        share = np.where(human.skin.joints == link, human.skin.weights, 0).sum(axis=1)
        local = rotate(conjugate(world[link]), skin[share > 128] - places[link])
        along = local[:, 0] / human.skeleton.tips[link, 0]
        middle = np.hypot(local[:, 1], local[:, 2])[(along > 0.15) & (along < 0.85)]
        if len(middle) >= 4:
            off[LINKS[link]] = float(middle.mean() - human.skeleton.radii[link])
    assert len(off) >= 10
    assert max(abs(error) for error in off.values()) < 0.0015, off


def test_eyes_look_out_of_the_face(human: Shipped) -> None:
    rotations, root = human.skeleton.upright()
    places, world = forward(rotations, root, human.skeleton.offsets)
    eye = places[INDEX["head"]] + rotate(world[INDEX["head"]], human.skeleton.eye)
    skin = human.posed(rotations, root)
    white = (human.surface.colours[:, :3] > 240).all(axis=1) & (np.abs(skin[:, 2] - eye[2]) < 0.03)
    assert white.any()
    for side in (-1.0, 1.0):
        seen = skin[white & (skin[:, 1] * side > 0.0)]
        assert abs(seen[:, 0].max() - eye[0]) < 0.01
        assert np.linalg.norm(seen.mean(axis=0)[1:] - (side * 0.032, eye[2])) < 0.01


def test_the_two_have_skins_of_their_own() -> None:
    shapes = {hashlib.sha256((ROOT / "humandb" / n / "shape.glb").read_bytes()).hexdigest() for n in ("aiko", "ken")}
    assert len(shapes) == 2


def _pose(human: Shipped, turns: dict[str, tuple[float, float, float]]) -> tuple[Array, Array]:
    """Upright with some links turned further, in degrees."""
    rotations, root = human.skeleton.upright()
    for name, turn in turns.items():
        rotations[INDEX[name]] = multiply(rotations[INDEX[name]], from_rotation_vector(np.radians(turn)))
    return rotations, root


def _lengths(points: Array, edges: Array) -> Array:
    return np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)


def _hits(start: Array, direction: Array, points: Array, faces: Array) -> Array:
    """How far along a ray its crossings with the faces lie (Moller & Trumbore 1997)."""
    a, b, c = (points[faces[:, i]] for i in range(3))
    h = np.cross(direction, c - a)
    scale = np.einsum("ij,ij->i", b - a, h)
    safe = np.where(np.abs(scale) > 1e-14, scale, np.inf)
    u = np.einsum("ij,ij->i", start - a, h) / safe
    q = np.cross(start - a, b - a)
    v, t = (q @ direction) / safe, np.einsum("ij,ij->i", c - a, q) / safe
    return t[(u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (t > 0.0)]
