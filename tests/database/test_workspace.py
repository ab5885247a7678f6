"""Where the workspace is, the border around it, and changes that are seen without a restart."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from ahmss.database import Workspace
from ahmss.errors import DataError, WorkspaceError

from .conftest import add_object


def test_found_from_a_folder_within(workspace: Workspace) -> None:
    deep = workspace.root / "objectdb/cup/parts"
    deep.mkdir(parents=True)
    assert Workspace.find(start=deep).root == workspace.root


def test_the_checkout_serves_where_there_is_none(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    assert (Workspace.find(start=tmp_path / "empty").root / "ahmss").is_dir()


def test_a_named_folder_without_objectdb_is_refused(tmp_path: Path) -> None:
    with pytest.raises(WorkspaceError, match="ahmss init"):
        Workspace.find(tmp_path)


@pytest.mark.parametrize(
    ("path", "sentence"),
    [
        ("/etc/passwd", "is an absolute path"),
        ("../../../secret.dxf", "leads out of the workspace"),
        ("link.dxf", "leads out of the workspace"),
        ("folder/secret.dxf", "leads out of the workspace"),
        ("C:/secret.dxf", "is an absolute path"),
        ("", "is no file name"),
    ],
)
def test_no_path_leaves_the_workspace(tmp_path: Path, path: str, sentence: str) -> None:
    root = tmp_path / "workspace"
    (root / "objectdb").mkdir(parents=True)
    (tmp_path / "secret.dxf").write_text("0\nEOF\n")
    space = Workspace(root)
    file = add_object(space, "cup", f'shape = "{path}"')
    (file.parent / "link.dxf").symlink_to(tmp_path / "secret.dxf")
    (file.parent / "folder").symlink_to(tmp_path)
    with pytest.raises(DataError, match=sentence) as caught:
        space.objects.get("cup")
    assert str(caught.value).startswith("objectdb/cup/object.toml: shape (line 1): ")


def test_a_kind_that_is_a_link_out_is_listed_as_broken(tmp_path: Path) -> None:
    (tmp_path / "space/objectdb").mkdir(parents=True)
    (tmp_path / "foreign").mkdir()
    (tmp_path / "foreign/object.toml").write_text("")
    (tmp_path / "space/objectdb/foreign").symlink_to(tmp_path / "foreign")
    (listing,) = Workspace(tmp_path / "space").objects.list()
    assert "leads out of the workspace" in listing.error


def test_pictures_of_a_neighbour_folder_may_be_shared(workspace: Workspace) -> None:
    add_object(workspace, "cup", 'texture = "../textures/oak.png"')
    assert workspace.objects.get("cup").texture == workspace.root / "objectdb/textures/oak.png"


def test_a_changed_file_is_seen_and_an_unchanged_one_is_shared(workspace: Workspace) -> None:
    file = add_object(workspace, "cup", 'sentence = "One."')
    first = workspace.objects.get("cup")
    assert workspace.objects.get("cup") is first
    file.write_text('sentence = "Another."')
    assert workspace.objects.get("cup").sentence == "Another."


def test_a_change_of_equal_size_is_seen_by_its_time(workspace: Workspace) -> None:
    file = add_object(workspace, "cup", 'sentence = "One."')
    workspace.objects.get("cup")
    before = file.stat().st_mtime_ns
    file.write_text('sentence = "Two."')
    os.utime(file, ns=(before + 1, before + 1))
    assert workspace.objects.get("cup").sentence == "Two."


def test_a_shared_file_counts_as_a_change_of_the_kind(workspace: Workspace) -> None:
    add_object(workspace, "cup", 'properties = "../sizes.toml"')
    sizes = workspace.root / "objectdb/sizes.toml"
    sizes.write_text("mass = 1.0")
    assert workspace.objects.get("cup").properties == {"mass": 1.0}
    sizes.write_text("mass = 2.25")
    assert workspace.objects.get("cup").properties == {"mass": 2.25}


def test_a_mended_file_and_a_new_one_and_a_removed_one(workspace: Workspace) -> None:
    file = add_object(workspace, "cup", "broken")
    for _ in range(2):  # the failure is remembered, and raised again
        with pytest.raises(DataError):
            workspace.objects.get("cup")
    file.write_text('sentence = "Mended."')
    assert workspace.objects.get("cup").sentence == "Mended."
    add_object(workspace, "jug", "")
    assert workspace.objects.names() == ["cup", "jug"]
    file.unlink()
    assert workspace.objects.names() == ["jug"]
