"""Faces out of DXF, written by ezdxf and read back as metres and colours."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import ezdxf
import ezdxf.filemanagement
import numpy as np
import pytest
from ezdxf.render import forms

from ahmss.database.dxf import read_dxf
from ahmss.database.soup import Soup
from ahmss.errors import DataError

SQUARE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]


def read(path: Path, document: Any, most: int = 100_000) -> Soup:
    document.saveas(path / "x.dxf")
    return read_dxf(path / "x.dxf", "x.dxf", most)[0]


def volume(soup: Soup) -> float:
    """Of a closed surface; positive where its faces look outwards."""
    a, b, c = (soup.triangles[:, i] for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6.0)


def test_three_d_faces(tmp_path: Path) -> None:
    document = ezdxf.filemanagement.new()
    document.modelspace().add_3dface(SQUARE)
    document.modelspace().add_3dface(SQUARE[:3])  # a triangle
    soup = read(tmp_path, document)
    assert len(soup.triangles) == 3
    a, b, c = (soup.triangles[:, i] for i in range(3))
    assert (np.cross(b - a, c - a)[:, 2] > 0).all()


@pytest.mark.parametrize("kind", ["polyface", "mesh", "3dfaces"])
def test_a_cube_of_each_entity_keeps_its_volume(tmp_path: Path, kind: str) -> None:
    document = ezdxf.filemanagement.new()
    cube = forms.cube().scale_uniform(2.0)
    render = {"polyface": cube.render_polyface, "mesh": cube.render_mesh, "3dfaces": cube.render_3dfaces}[kind]
    render(document.modelspace())
    soup = read(tmp_path, document)
    assert len(soup.triangles) == 12
    assert volume(soup) == pytest.approx(8.0)


@pytest.mark.parametrize(("closed", "squares"), [((False, False), 6), ((True, False), 9)])
def test_polygon_meshes(tmp_path: Path, closed: tuple[bool, bool], squares: int) -> None:
    document = ezdxf.filemanagement.new()
    mesh = document.modelspace().add_polymesh(size=(3, 4))
    for i in range(3):
        for j in range(4):
            mesh.set_mesh_vertex((i, j), (np.cos(2 * i), np.sin(2 * i), j))
    if closed[0]:
        mesh.m_close(status=True)
    assert len(read(tmp_path, document).triangles) == 2 * squares


def test_insert_scales_turns_repeats_and_nests(tmp_path: Path) -> None:
    document = ezdxf.filemanagement.new()
    inner = document.blocks.new("inner")
    forms.cube().render_mesh(inner)  # side 1 about the origin
    outer = document.blocks.new("outer")
    outer.add_blockref("inner", (10, 0, 0), dxfattribs={"xscale": 2, "yscale": 3, "zscale": 4})
    document.modelspace().add_blockref(
        "outer", (0, 0, 5), dxfattribs={"rotation": 90, "column_count": 2, "column_spacing": 50}
    )
    soup = read(tmp_path, document)
    assert len(soup.triangles) == 24
    assert volume(soup) == pytest.approx(48.0)
    corners = soup.triangles.reshape(-1, 3)
    np.testing.assert_allclose(corners.min(axis=0), [-1.5, 9.0, 3.0], atol=1e-9)
    np.testing.assert_allclose(corners.max(axis=0), [1.5, 61.0, 7.0], atol=1e-9)


def test_a_mirrored_insert_keeps_its_outside_outside(tmp_path: Path) -> None:
    document = ezdxf.filemanagement.new()
    forms.cube().render_mesh(document.blocks.new("cube"))
    document.modelspace().add_blockref("cube", (3, 0, 0), dxfattribs={"xscale": -1})
    soup = read(tmp_path, document)
    assert volume(soup) == pytest.approx(1.0)
    assert soup.triangles[..., 0].min() == pytest.approx(2.5)


def test_colours_and_layers_as_cad_shows_them(tmp_path: Path) -> None:
    document = ezdxf.filemanagement.new()
    document.layers.add("red", color=1)
    document.layers.add("teal", true_color=ezdxf.colors.rgb2int((10, 120, 130)))
    block = document.blocks.new("part")
    block.add_3dface(SQUARE, dxfattribs={"layer": "0"})  # takes the INSERT's layer
    block.add_3dface(SQUARE, dxfattribs={"layer": "red"})  # keeps its own
    block.add_3dface(SQUARE, dxfattribs={"layer": "0", "color": 0})  # BYBLOCK: the INSERT's colour
    document.modelspace().add_blockref("part", (0, 0, 0), dxfattribs={"layer": "teal", "color": 5})
    document.modelspace().add_3dface(SQUARE, dxfattribs={"layer": "red", "true_color": 0x010203})
    soup = read(tmp_path, document)
    seen = [(soup.layers[soup.layer[i]], tuple(soup.colors[i].tolist())) for i in range(0, 8, 2)]
    assert seen == [("teal", (10, 120, 130)), ("red", (255, 0, 0)), ("teal", (0, 0, 255)), ("red", (1, 2, 3))]


def test_what_has_no_faces_says_what_it_has(tmp_path: Path) -> None:
    document = ezdxf.filemanagement.new()
    document.modelspace().add_line((0, 0), (1, 1))
    document.modelspace().add_circle((0, 0), 1)
    document.modelspace().add_circle((2, 0), 1)
    with pytest.raises(DataError, match="no faces: it has 2 CIRCLE, 1 LINE; AHMSS takes 3DFACE"):
        read(tmp_path, document)


def test_blocks_in_a_circle_are_refused(tmp_path: Path) -> None:
    document = ezdxf.filemanagement.new()
    one, two = document.blocks.new("one"), document.blocks.new("two")
    one.add_blockref("two", (0, 0))
    two.add_blockref("one", (0, 0))
    document.modelspace().add_blockref("one", (0, 0))
    with pytest.raises(DataError, match="in a circle"):
        read(tmp_path, document)


def test_inserts_that_multiply_are_stopped(tmp_path: Path) -> None:
    document = ezdxf.filemanagement.new()
    document.blocks.new("b0").add_3dface(SQUARE)
    for level in range(1, 12):
        block = document.blocks.new(f"b{level}")
        for _ in range(10):
            block.add_blockref(f"b{level - 1}", (0, 0))
    document.modelspace().add_blockref("b11", (0, 0))
    with pytest.raises(DataError, match="more than 2,000 faces"):
        read(tmp_path, document, 2_000)


def test_inserts_of_nothing_that_multiply_are_stopped(tmp_path: Path) -> None:
    document = ezdxf.filemanagement.new()
    document.blocks.new("b0").add_line((0, 0), (1, 1))
    for level in range(1, 12):
        block = document.blocks.new(f"b{level}")
        for _ in range(10):
            block.add_blockref(f"b{level - 1}", (0, 0))
    document.modelspace().add_blockref("b11", (0, 0))
    with pytest.raises(DataError, match="no faces: it has 1 INSERT"):
        read(tmp_path, document, 2_000)


@pytest.mark.parametrize(("unit", "metres"), [(4, 0.001), (5, 0.01), (6, 1.0), (0, None)])
def test_the_header_says_the_unit(tmp_path: Path, unit: int, metres: float | None) -> None:
    document = ezdxf.filemanagement.new()
    document.header["$INSUNITS"] = unit
    document.modelspace().add_3dface(SQUARE)
    document.saveas(tmp_path / "x.dxf")
    assert read_dxf(tmp_path / "x.dxf", "x.dxf", 10)[1] == metres


@pytest.mark.parametrize("data", [b"hello", b"\0\1\2" * 400, b"0\nSECTION\n2\nENTITIES\n0\n3DFACE\n10\n"])
def test_what_is_no_dxf_is_refused(tmp_path: Path, data: bytes) -> None:
    (tmp_path / "x.dxf").write_bytes(data)
    with pytest.raises(DataError, match=r"x\.dxf: no"):
        read_dxf(tmp_path / "x.dxf", "x.dxf", 10)
