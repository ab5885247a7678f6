"""From shape files to GLB: formats, units, pictures, and what is refused at the border."""

from __future__ import annotations

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from PIL import Image

from ahmss.database import Shape, Workspace, convert
from ahmss.database.convert import convert_shape
from ahmss.database.records import ObjectKind
from ahmss.database.texture import box_projection
from ahmss.errors import DataError

from .conftest import add_object


def shape_of(workspace: Workspace, text: str) -> Shape:
    add_object(workspace, "thing", text)
    shape = workspace.objects.shape("thing")
    assert shape is not None
    return shape


def put(workspace: Workspace, name: str, data: bytes | str) -> Path:
    path = workspace.root / "objectdb/thing" / name
    path.parent.mkdir(exist_ok=True)
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return path


def faces_dxf(
    faces: list[list[tuple[float, float, float]]], layers: dict[str, list[tuple[float, float, float]]] | None = None
) -> str:
    lines: list[object] = [0, "SECTION", 2, "ENTITIES"]
    for layer, corners in [*(("0", f) for f in faces), *(layers or {}).items()]:
        lines += [0, "3DFACE", 8, layer]
        for i, corner in enumerate([*corners, corners[-1]][:4]):
            for axis, value in enumerate(corner):
                lines += [10 * (axis + 1) + i, value]
    return "\n".join(str(line) for line in [*lines, 0, "ENDSEC", 0, "EOF", ""])


ONE = [[(0.0, 0.0, 0.0), (10.0, 0.0, 0.0), (0.0, 20.0, 0.0)]]


def header(glb: bytes) -> dict[str, Any]:
    return json.loads(glb[20 : 20 + int.from_bytes(glb[12:16], "little")])


def test_the_unit_scales_what_does_not_say_its_own(workspace: Workspace) -> None:
    put(workspace, "t.dxf", faces_dxf(ONE))
    shape = shape_of(workspace, 'shape = "t.dxf"\nunit = "cm"')
    np.testing.assert_allclose(shape.bounds, [[0, 0, 0], [0.1, 0.2, 0.0]], atol=1e-9)
    assert shape.faces == 1
    assert shape.glb[:4] == b"glTF"


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "glb"])
def test_other_formats(workspace: Workspace, suffix: str) -> None:
    box = trimesh.creation.box((2.0, 4.0, 6.0))
    put(workspace, f"t.{suffix}", box.export(file_type=suffix))
    shape = shape_of(workspace, f'shape = "t.{suffix}"\n')
    size = np.ptp(np.array(shape.bounds), axis=0)
    # glTF has y up, the others z.
    np.testing.assert_allclose(size, [2.0, 6.0, 4.0] if suffix == "glb" else [2.0, 4.0, 6.0], atol=1e-6)
    assert shape.faces == 12
    assert header(shape.glb)["materials"][0]["doubleSided"] is False


def test_the_same_shape_is_the_same_bytes_in_the_store_and_out_of_it(
    workspace: Workspace, monkeypatch: pytest.MonkeyPatch
) -> None:
    put(workspace, "t.stl", trimesh.creation.icosphere(2).export(file_type="stl"))
    first = shape_of(workspace, 'shape = "t.stl"')
    kept = Workspace(workspace.root).objects.shape("thing")
    monkeypatch.setenv("XDG_CACHE_HOME", str(workspace.root / "another"))
    assert kept == first == Workspace(workspace.root).objects.shape("thing")


def test_an_obj_is_read_once_unless_another_file_says_its_colours(
    workspace: Workspace, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
    put(workspace, "t.mtl", "newmtl paint\nKd 1 0 0\n")
    read = list[Path | None]()

    def converted(workspace: Workspace, kind: ObjectKind) -> Shape:
        read.append(kind.shape)
        return convert_shape(workspace, kind)

    monkeypatch.setattr(convert, "convert_shape", converted)
    for times, obj in ((1, text), (2, f"mtllib t.mtl\n{text}")):
        read.clear()
        put(workspace, "t.obj", obj)
        first = shape_of(workspace, 'shape = "t.obj"')
        assert Workspace(workspace.root).objects.shape("thing") == first
        assert len(read) == times


def test_a_spoilt_store_is_not_believed(workspace: Workspace, monkeypatch: pytest.MonkeyPatch) -> None:
    store = workspace.root / "store"
    monkeypatch.setenv("XDG_CACHE_HOME", str(store))
    put(workspace, "t.dxf", faces_dxf(ONE))
    first = shape_of(workspace, 'shape = "t.dxf"\nunit = "cm"')
    (kept,) = (p for p in store.rglob("*") if p.is_file())
    for spoilt in (b"", b"\x81", kept.read_bytes()[:-40], kept.read_bytes().replace(b"glTF", b"gltf")):
        kept.write_bytes(spoilt)
        assert Workspace(workspace.root).objects.shape("thing") == first


def test_a_store_that_cannot_be_written_costs_nothing_else(
    workspace: Workspace, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(put(workspace, "a_file", "")))
    put(workspace, "t.dxf", faces_dxf(ONE))
    assert shape_of(workspace, 'shape = "t.dxf"\nunit = "cm"').faces == 1


def test_a_changed_shape_file_is_seen(workspace: Workspace) -> None:
    put(workspace, "t.dxf", faces_dxf(ONE))
    first = shape_of(workspace, 'shape = "t.dxf"\nunit = "cm"')
    assert workspace.objects.shape("thing") is first
    put(workspace, "t.dxf", faces_dxf(ONE * 2))
    again = workspace.objects.shape("thing")
    assert again is not None
    assert again.faces == 2


def test_round_things_are_smooth_and_edges_sharp(workspace: Workspace) -> None:
    put(workspace, "t.stl", trimesh.creation.cylinder(1.0, 2.0, sections=24).export(file_type="stl"))
    shape = shape_of(workspace, 'shape = "t.stl"')
    (mesh,) = trimesh.load_scene(io.BytesIO(shape.glb), file_type="glb", process=False).geometry.values()
    normals, places = np.asarray(mesh.vertex_normals), np.asarray(mesh.vertices)
    side = np.abs(normals[:, 2]) < 0.5
    radial = places[side, :2] / np.linalg.norm(places[side, :2], axis=1, keepdims=True)
    assert (np.einsum("ij,ij->i", normals[side, :2], radial) > 0.999).all()  # smooth around
    np.testing.assert_allclose(np.abs(normals[~side, 2]), 1.0, atol=1e-6)  # flat at the ends


def picture(color: tuple[int, int, int] = (200, 30, 30), kind: str = "PNG") -> bytes:
    out = io.BytesIO()
    Image.new("RGB", (8, 4), color).save(out, kind)
    return out.getvalue()


def test_a_texture_lies_on_its_layers_and_travels_as_it_is(workspace: Workspace) -> None:
    data = picture()
    put(workspace, "p.png", data)
    upright = [(5.0, 0.0, 0.0), (5.0, 8.0, 0.0), (5.0, 8.0, 6.0), (5.0, 0.0, 6.0)]
    put(workspace, "t.dxf", faces_dxf(ONE, {"screen": upright}))
    shape = shape_of(workspace, 'shape = "t.dxf"\nunit = "cm"\ntexture = "p.png"\ntexture_layers = ["screen"]')
    assert shape.texture is not None
    assert shape.texture.data == data
    assert shape.texture.media == "image/png"
    meshes = header(shape.glb)["meshes"]
    assert [m["name"] for m in meshes] == ["coloured", "textured"]
    assert "COLOR_0" in meshes[0]["primitives"][0]["attributes"]
    assert "TEXCOORD_0" in meshes[1]["primitives"][0]["attributes"]
    scene = trimesh.load_scene(io.BytesIO(shape.glb), file_type="glb", process=False)
    screen = scene.geometry["textured"]
    corners = zip(np.round(screen.vertices, 6), np.round(screen.visual.uv, 6), strict=True)
    corner = {tuple(place): tuple(uv) for place, uv in corners}
    assert corner[(0.05, 0.0, 0.0)] == (0.0, 0.0)  # seen from +x: y to the right, z up
    assert corner[(0.05, 0.08, 0.06)] == (1.0, 1.0)


def test_box_projection_is_upright_and_not_mirrored_from_outside() -> None:
    box = trimesh.creation.box((2.0, 2.0, 2.0))
    uv = box_projection(np.asarray(box.triangles), 0.0)
    assert uv.min() == 0.0
    assert uv.max() == 1.0
    for triangle, corners, normal in zip(box.triangles, uv, box.face_normals, strict=True):
        # Counter-clockwise from outside must be counter-clockwise in the picture.
        (ax, ay), (bx, by) = corners[1] - corners[0], corners[2] - corners[0]
        assert ax * by - ay * bx > 0.0
        if abs(normal[2]) < 0.5:
            np.testing.assert_allclose(corners[:, 1], (triangle[:, 2] + 1.0) / 2.0)


@pytest.mark.parametrize(
    ("name", "data", "sentence"),
    [
        ("t.dxf", b"", "the shape file is empty"),
        ("t.step", b"x", 'no shape file ".step"; allowed: dxf, glb'),
        ("t.stl", b"solid nothing\nendsolid\n", "t.stl: no"),
        ("t.obj", b"v 0 0 0\nv 1 0 0\n", "no faces"),
        ("t.glb", b"glTF\x02\0\0\0" + b"\xff" * 30, "no GLB file that can be read"),
        ("t.ply", b"ply\nformat ascii 1.0\nelement face 900000000\nend_header\n", "900,000,000 faces; at most 500,000"),
        ("t.stl", b"\0" * 80 + (40_000).to_bytes(4, "little") + b"\0" * 50, "t.stl: no"),
        ("t.dxf", faces_dxf([[(0, 0, 0), (float("nan"), 0, 0), (0, 1, 0)]]).encode(), "t.dxf: "),
        ("t.dxf", faces_dxf([[(0, 0, 0), (1e9, 0, 0), (0, 1, 0)]]).encode(), 'is "unit" right?'),
        ("t.dxf", faces_dxf([[(0, 0, 0), (1e-9, 0, 0), (0, 1e-9, 0)]]).encode(), 'is "unit" right?'),
        ("t.dxf", faces_dxf([[(0, 0, 0), (1, 0, 0), (2, 0, 0)]]).encode(), "no faces with an area"),
        ("t.obj", b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "t.obj: no OBJ file that can be read"),
    ],
)
def test_what_is_refused_at_the_border(workspace: Workspace, name: str, data: bytes, sentence: str) -> None:
    put(workspace, name, data)
    with pytest.raises(DataError) as caught:
        shape_of(workspace, f'shape = "{name}"')
    assert sentence in str(caught.value)
    assert str(caught.value).startswith("objectdb/thing/t.")
    assert "\n" not in str(caught.value)


def test_a_missing_shape(workspace: Workspace) -> None:
    with pytest.raises(
        DataError, match=r"objectdb/thing/object\.toml: shape \(line \d+\): no file objectdb/thing/gone\.dxf"
    ):
        shape_of(workspace, 'shape = "gone.dxf"')


def test_a_million_faces_are_counted_and_refused(workspace: Workspace) -> None:
    face = "0\n3DFACE\n8\n0\n" + "".join(f"{c}\n0\n" for c in (10, 20, 30, 11, 21, 31, 12, 22, 32, 13, 23, 33))
    path = put(workspace, "t.dxf", "0\nSECTION\n2\nENTITIES\n")
    with path.open("a") as file:
        for _ in range(100):
            file.write(face * 10_000)
        file.write("0\nENDSEC\n0\nEOF\n")
    with pytest.raises(DataError, match="1,000,000 faces; at most 500,000"):
        shape_of(workspace, 'shape = "t.dxf"')


def test_a_gltf_may_not_fetch_from_outside(workspace: Workspace) -> None:
    (workspace.root.parent / "secret.bin").write_bytes(b"\0" * 36)
    gltf = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "buffers": [{"byteLength": 36, "uri": "../../../secret.bin"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    }
    put(workspace, "t.gltf", json.dumps(gltf))
    with pytest.raises(DataError, match="leads out of the workspace"):
        shape_of(workspace, 'shape = "t.gltf"')


@pytest.mark.parametrize(
    ("data", "sentence"),
    [
        (b"GIF89a", "no PNG or JPEG picture"),
        (b"\x89PNG\r\n\x1a\n broken", "no PNG or JPEG picture"),
        (picture(kind="BMP"), "no PNG or JPEG picture"),
    ],
)
def test_bad_pictures(workspace: Workspace, data: bytes, sentence: str) -> None:
    put(workspace, "t.dxf", faces_dxf(ONE))
    put(workspace, "p.png", data)
    with pytest.raises(DataError, match=sentence):
        shape_of(workspace, 'shape = "t.dxf"\nunit = "cm"\ntexture = "p.png"')


def test_a_picture_of_hostile_size(workspace: Workspace) -> None:
    put(workspace, "t.dxf", faces_dxf(ONE))
    out = io.BytesIO()
    Image.new("1", (6000, 6000)).save(out, "PNG")
    put(workspace, "p.png", out.getvalue())
    with pytest.raises(DataError, match="6000 x 6000 pixels"):
        shape_of(workspace, 'shape = "t.dxf"\nunit = "cm"\ntexture = "p.png"')


def test_an_unknown_layer_for_the_texture(workspace: Workspace) -> None:
    put(workspace, "t.dxf", faces_dxf(ONE))
    put(workspace, "p.png", picture())
    with pytest.raises(DataError, match='no layer "screen" for the texture; the shape has: 0'):
        shape_of(workspace, 'shape = "t.dxf"\nunit = "cm"\ntexture = "p.png"\ntexture_layers = ["screen"]')


def test_the_picture_within_a_glb_is_kept(workspace: Workspace) -> None:
    box = trimesh.creation.box((1.0, 1.0, 1.0))
    uv = np.random.default_rng(1).random((len(box.vertices), 2))
    material = trimesh.visual.material.PBRMaterial(baseColorTexture=Image.new("RGB", (4, 4), (9, 8, 7)))
    box.visual = trimesh.visual.TextureVisuals(uv=uv, material=material)
    put(workspace, "t.glb", box.export(file_type="glb"))
    shape = shape_of(workspace, 'shape = "t.glb"')
    assert shape.texture is not None
    assert Image.open(io.BytesIO(shape.texture.data)).getpixel((0, 0)) == (9, 8, 7)
    assert header(shape.glb)["meshes"][0]["name"] == "textured"
