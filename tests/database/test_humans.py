"""humandb/: skeletons out of human.toml, and the skin's check."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from ahmss.body.links import LINKS
from ahmss.body.skeleton import Skeleton
from ahmss.database import Workspace
from ahmss.errors import CommandError, DataError


def human_toml(skeleton: Skeleton) -> str:
    lines = [f"stature = {skeleton.stature}", f'sex = "{skeleton.sex}"', 'shape = "body.glb"']
    lines += [f"eye = {skeleton.eye.tolist()}"]
    for i, link in enumerate(LINKS):
        lines += [f"[links.{link}]", f"offset = {skeleton.offsets[i].tolist()}", f"tip = {skeleton.tips[i].tolist()}"]
        lines += [f"mass = {skeleton.mass[i]}", f"limits_deg = {np.degrees(skeleton.limits[i]).tolist()}"]
    return "\n".join(lines)


def skin(names: tuple[str, ...]) -> bytes:
    """The least GLB that is skinned to joints of these names."""
    header = {
        "asset": {"version": "2.0"},
        "nodes": [{"name": n} for n in names],
        "skins": [{"joints": list(range(len(names)))}],
        "meshes": [{"primitives": [{"attributes": {}, "indices": 0}]}],
        "accessors": [{"count": 36}],
    }
    text = json.dumps(header).encode()
    text += b" " * (-len(text) % 4)
    version, whole, length = (n.to_bytes(4, "little") for n in (2, 20 + len(text), len(text)))
    return b"glTF" + version + whole + length + b"JSON" + text


def add_human(workspace: Workspace, text: str, glb: bytes) -> Path:
    folder = workspace.root / "humandb/mia"
    folder.mkdir(exist_ok=True)
    (folder / "human.toml").write_text(text)
    (folder / "body.glb").write_bytes(glb)
    return folder


def test_the_skeleton_comes_back_as_it_was_written(workspace: Workspace) -> None:
    wanted = Skeleton.of(1.62, "female", "mia")
    add_human(workspace, human_toml(wanted), skin(LINKS))
    mia = workspace.humans.get("mia")
    for key in ("offsets", "tips", "mass", "limits", "grips", "soles", "eye", "radii"):
        np.testing.assert_allclose(getattr(mia.skeleton, key), getattr(wanted, key), atol=1e-12)
    assert (mia.name, mia.skeleton.name, mia.skeleton.sex, mia.skeleton.stature) == ("mia", "mia", "female", 1.62)
    assert workspace.humans.shape("mia").faces == 12
    assert workspace.humans.shape("mia").glb == skin(LINKS)


@pytest.mark.parametrize(
    ("was", "written", "sentence"),
    [
        ("[links.left_foot]", "[links.left_feet]", 'links.left_feet (line 75): no link "left_feet", did you mean'),
        ("stature = 1.62", "stature = 162.0", "stature (line 1): 162 m; allowed: 0.5 to 2.5"),
        ('sex = "female"', 'sex = "none"', "allowed: female, male"),
        ('shape = "body.glb"', 'shape = "../../../body.glb"', "leads out of the workspace"),
        ("mass = ", "mass = -", "a mass is more than 0"),
        ("offset", "offsets", 'no key "offsets"'),
    ],
)
def test_mistakes_in_human_toml(workspace: Workspace, was: str, written: str, sentence: str) -> None:
    text = human_toml(Skeleton.of(1.62, "female", "mia"))
    assert was in text
    add_human(workspace, text.replace(was, written, 1), skin(LINKS))
    with pytest.raises(DataError) as caught:
        workspace.humans.get("mia")
    assert sentence in str(caught.value)


@pytest.mark.parametrize(
    ("glb", "sentence"),
    [
        (b"no glb", "no GLB file"),
        (skin(LINKS[::-1]), "must have the 43 links in their order"),
        (skin(LINKS[:15]), "its skin has 15 joints"),
        (b"glTF" + b"\0" * 40, "no skinned, indexed mesh"),
    ],
)
def test_a_shape_that_is_not_skinned_to_the_links(workspace: Workspace, glb: bytes, sentence: str) -> None:
    add_human(workspace, human_toml(Skeleton.of(1.62, "female", "mia")), glb)
    with pytest.raises(DataError, match=sentence):
        workspace.humans.shape("mia")


def test_unknown_and_broken_humans(workspace: Workspace) -> None:
    add_human(workspace, "stature = 'tall'", skin(LINKS))
    with pytest.raises(CommandError, match='no human "mio" in humandb/, did you mean "mia"'):
        workspace.humans.get("mio")
    (listing,) = workspace.humans.list()
    assert "humandb/mia/human.toml: stature (line 1)" in listing.error
