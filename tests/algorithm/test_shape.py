"""The target's shape as an algorithm reads it: from where shapes are kept, and nothing else."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
import pytest

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.shape import TargetShape
from ahmss.database import Workspace
from ahmss.errors import DataError

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> TargetShape:
    """The cup's, as START would name it, in a store of its own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    found = Workspace(ROOT).objects.kept_shape("cup")
    assert found is not None
    return TargetShape(str(found[0]), found[1])


def test_its_corners_are_the_objects(kept: TargetShape) -> None:
    corners = kept.vertices[kept.faces]
    assert corners.shape == (216, 3, 3)
    assert np.hypot(*corners[..., :2].T).max() == pytest.approx(0.036, abs=1e-6)
    assert (corners[..., 2].min(), corners[..., 2].max()) == pytest.approx((0.0, 0.095), abs=1e-6)


def test_its_distances_are_made_once(kept: TargetShape, monkeypatch: pytest.MonkeyPatch) -> None:
    place = np.array([0.0, 0.0, 0.052])
    field = kept.field(place)
    points = np.array([[0.046, 0.0, 0.05], [0.0, 0.034, 0.05], [0.0, 0.0, 0.05]])
    np.testing.assert_allclose(field.clearance(points), [0.01, -0.0015, 0.032], atol=1.5e-3)  # of 18 flat sides
    assert kept.field(place + 0.001) is field
    Path(kept.path).unlink()  # not looked at again
    again = TargetShape(kept.path, kept.digest).field(place)
    np.testing.assert_array_equal(again.nodes, field.nodes)


def test_a_kept_field_that_is_broken_is_made_anew(kept: TargetShape, tmp_path: Path) -> None:
    place = np.zeros(3)
    nodes = kept.field(place).nodes
    (file,) = (tmp_path / "ahmss" / "fields").iterdir()
    file.write_bytes(file.read_bytes()[:-9])
    np.testing.assert_array_equal(TargetShape(kept.path, kept.digest).field(place).nodes, nodes)


def test_a_path_that_leads_elsewhere_is_refused(kept: TargetShape, tmp_path: Path) -> None:
    data = Path(kept.path).read_bytes()
    (tmp_path / "cup.glb").write_bytes(data)
    link = Path(kept.path).with_name("link.glb")
    link.symlink_to(tmp_path / "cup.glb")
    for path in (tmp_path / "cup.glb", link, Path(kept.path).parent / "../../../cup.glb"):
        with pytest.raises(DataError, match="is no shape that is kept"):
            _ = TargetShape(str(path), kept.digest).vertices


def test_other_bytes_than_those_named_are_refused(kept: TargetShape) -> None:
    Path(kept.path).write_bytes(b"glTF")
    with pytest.raises(DataError, match="is not the shape that was named"):
        _ = kept.vertices
    other = hashlib.sha256(b"glTF").hexdigest()
    named = TargetShape(str(Path(kept.path).with_name(f"{other}.glb")), other)
    Path(named.path).write_bytes(b"glTF")
    with pytest.raises(DataError, match="has no triangles that can be read"):
        _ = named.vertices
    Path(kept.path).unlink()
    with pytest.raises(DataError, match="is gone"):
        _ = kept.vertices


def test_an_object_that_is_not_asked_for_has_none(kept: TargetShape) -> None:
    from ahmss.algorithm.messages import ObjectRecord

    assert WorldObject.of(ObjectRecord(1, "a", "cup", (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))).shape is None


def test_what_of_it_stays_is_told_without_what_states_move(kept: TargetShape) -> None:
    assert kept.rest is None  # a cup has no parts
    path, digest = Workspace(ROOT).objects.kept_shape("tap") or (Path(), "")
    tap = TargetShape(str(path), digest)
    assert tap.rest is not None
    lever, spout = np.array([0.075, 0.0, 0.243]), np.array([0.1, 0.0, 0.18])
    assert tap.field(lever).clearance(lever) < 0.0
    assert tap.rest.field(lever).clearance(lever) > 0.03
    np.testing.assert_allclose(tap.rest.field(lever).clearance(spout), tap.field(lever).clearance(spout), atol=1e-3)
