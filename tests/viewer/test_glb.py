"""Shapes as they travel, whole and broken."""

from __future__ import annotations

import json
import struct

import numpy as np
import pytest
import trimesh
from ahmss_viewer.glb import read_glb
from ahmss_viewer.surface import corner_normals

from ahmss.errors import ProtocolError

from .scenes import RED, box_glb


def glb(tree: dict[str, object], binary: bytes) -> bytes:
    text = json.dumps(tree).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def skinned() -> bytes:
    """Three vertices held by joints 0, 1 and both."""
    parts = [
        np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], "<f4"),
        np.array([[0, 0, 0, 0], [1, 0, 0, 0], [0, 1, 0, 0]], "u1"),
        np.array([[1, 0, 0, 0], [1, 0, 0, 0], [0.3, 0.7, 0, 0]], "<f4"),
        np.stack([np.eye(4), np.diag([2.0, 2.0, 2.0, 1.0])]).astype("<f4"),
        np.array([0, 1, 2], "<u2"),
    ]
    parts[3][1, 3, :3] = (5.0, 6.0, 7.0)  # column-major: the translation is the last row
    kinds = [(5126, "VEC3"), (5121, "VEC4"), (5126, "VEC4"), (5126, "MAT4"), (5123, "SCALAR")]
    views, accessors, at = [], [], 0
    for part, (component, kind) in zip(parts, kinds, strict=True):
        views.append({"buffer": 0, "byteOffset": at, "byteLength": part.nbytes})
        accessors.append({
            "bufferView": len(views) - 1, "componentType": component, "type": kind,
            "count": part.size if kind == "SCALAR" else len(part),
        })  # fmt: skip
        at += part.nbytes + -part.nbytes % 4
    binary = b"".join(part.tobytes() + b"\0" * (-part.nbytes % 4) for part in parts)
    attributes = {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2}
    tree = {
        "asset": {"version": "2.0"}, "buffers": [{"byteLength": len(binary)}], "bufferViews": views,
        "accessors": accessors, "meshes": [{"primitives": [{"attributes": attributes, "indices": 4}]}],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": 3}],
        "nodes": [{"mesh": 0, "skin": 0, "translation": [9, 9, 9]}, {}, {}],
        "scenes": [{"nodes": [0, 1, 2]}], "scene": 0,
    }  # fmt: skip
    return glb(tree, binary)


def test_a_box_comes_back_with_its_faces_and_colours_and_outward_normals() -> None:
    (surface,) = read_glb(box_glb((1.0, 2.0, 3.0), RED))
    assert len(surface.faces) == 12
    assert surface.bounds() == pytest.approx(np.array([[-0.5, -1.0, -1.5], [0.5, 1.0, 1.5]]))
    assert (surface.colours == [*RED, 255]).all()
    corners = surface.positions[surface.faces]
    out = np.einsum("ijk,ik->ij", surface.normals[surface.faces], corners.mean(axis=1))
    assert (out > 0.3).all()
    assert np.abs(surface.normals).max(axis=1) == pytest.approx(1.0), "a box has flat sides"


def test_round_shapes_are_smooth_and_edges_stay_sharp() -> None:
    ball = trimesh.creation.icosphere(subdivisions=3)
    normals = corner_normals(ball.vertices, ball.faces)
    outward = ball.vertices[ball.faces]
    assert np.einsum("ijk,ijk->ij", normals, outward).min() > 0.99
    can = trimesh.creation.cylinder(1.0, 2.0, sections=48)
    normals = corner_normals(can.vertices, can.faces)
    assert (np.abs(normals[..., 2]) > 0.99).any()
    assert (np.abs(normals[..., 2]) < 0.01).any()
    assert ((np.abs(normals[..., 2]) > 0.99) | (np.abs(normals[..., 2]) < 0.01)).all()


def test_a_shape_wound_inside_out_is_turned() -> None:
    mesh = trimesh.creation.box((1.0, 1.0, 1.0))
    mesh.faces = mesh.faces[:, ::-1]
    (surface,) = read_glb(mesh.export(file_type="glb", include_normals=False))
    corners = surface.positions[surface.faces]
    out = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert (np.einsum("ij,ij->i", out, corners.mean(axis=1)) > 0).all()


def test_a_skin_keeps_joints_weights_and_binds_and_ignores_its_node() -> None:
    (surface,) = read_glb(skinned())
    assert surface.skin is not None
    assert surface.skin.joints[2].tolist() == [0, 1, 0, 0]
    assert surface.skin.weights.sum(axis=1).tolist() == [255, 255, 255]
    assert surface.skin.weights[2, 1] == pytest.approx(0.7 * 255, abs=1.5)
    assert surface.skin.inverse_binds[1, :3, 3] == pytest.approx([5.0, 6.0, 7.0])
    assert surface.positions[1] == pytest.approx([1.0, 0.0, 0.0])


@pytest.mark.parametrize("cut", [0, 3, 11, 40, 200, -30])
def test_a_file_that_was_cut_off_is_named(cut: int) -> None:
    with pytest.raises(ProtocolError, match="cup"):
        read_glb(skinned()[:cut], "cup")


def test_bytes_that_lead_out_of_the_file_are_refused() -> None:
    whole = skinned()
    for old, new in ((b'"count": 3', b'"count": 9'), (b'"indices": 4', b'"indices": 7')):
        assert old in whole
        with pytest.raises(ProtocolError, match="tap: not a readable GLB"):
            read_glb(whole.replace(old, new), "tap")


def test_random_bytes_never_raise_anything_else() -> None:
    whole, chance = bytearray(skinned()), np.random.default_rng(4)
    for _ in range(300):
        data = bytearray(whole)
        for at in chance.integers(0, len(data), 4):
            data[at] = int(chance.integers(0, 256))
        try:
            read_glb(bytes(data), "fuzz")
        except ProtocolError:
            continue
