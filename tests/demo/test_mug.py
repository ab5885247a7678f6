"""Mugs taken by their handles in a play: each stands still until the hand has closed, the thumb on the bar."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import conjugate, rotate
from ahmss.database import Workspace
from ahmss.main.play import PlaySetup, play_script
from tests.grasping.shapes import MUGS, THICK, mug, outside

from .conftest import ROOT
from .made import workspace_with
from .recorded import Recorded
from .skin import Skin

pytestmark = pytest.mark.timeout(180)

SITE = 'position = [{x}, 0.0, 0.06]\norientation = [0.0, 0.0, 0.0, 1.0]\ngrip = "power"'
SCRIPT = """
add floor
add table at 0.77 0.2
add {name} as mug at 0.42 0 0.88 facing {facing}
human {who} body {who} at -0.05 0
wait 0.2
do mug grasp hand {side}
wait 0.3
do mug put to 0.45 {y}
"""
DEEPEST, MOVED, ON_IT = 0.002, 0.001, 0.003  # metres


def taken(folder: Path, who: str, name: str, facing: int, side: str) -> tuple[Recorded, Array]:
    """The recording of a mug that is taken and put elsewhere, and the mug's triangles."""
    deep, tall = MUGS[name]
    triangles = mug(deep, tall)
    workspace_with(folder, name, triangles, SITE.format(x=0.04 + deep + THICK + 0.0025))
    y = 0.1 if side == "left" else -0.1
    script = folder / "mug.txt"
    script.write_text(SCRIPT.format(name=name, facing=facing, who=who, side=side, y=y))
    setup = PlaySetup(workspace=folder, fast=True, record=folder / "mug.rec")
    assert play_script(script, setup).failures == 0
    return Recorded.read(folder / "mug.rec", who, ("mug",)), triangles


@pytest.mark.parametrize(
    ("who", "name", "facing", "side"),
    [
        ("aiko", "mug36", 60, "left"),
        pytest.param("ken", "mug36", -90, "right", marks=pytest.mark.long),
        pytest.param("ken", "mug46", 60, "left", marks=pytest.mark.long),
        pytest.param("aiko", "mug46", -90, "right", marks=pytest.mark.long),
    ],
)
def test_a_mug_stands_until_the_hand_has_closed_around_its_bar(
    who: str, name: str, facing: int, side: str, tmp_path: Path
) -> None:
    played, triangles = taken(tmp_path, who, name, facing, side)
    skin = Skin.read(Workspace(ROOT).humans.shape(who).glb, played.skeleton)
    chosen = np.flatnonzero(np.isin(skin.link, [INDEX[f"{side}_hand"], *fingers(side)]))
    links = skin.link[chosen]
    thumb, others = [np.isin(links, fingers(side)[part]) for part in (slice(2), slice(2, None))]
    stands = played.object("mug").place
    moved = np.linalg.norm(stands - stands[0], axis=1)
    lifted = int(np.argmax(moved > MOVED))
    assert lifted > 0
    held = range(lifted, min(lifted + 40, len(moved)), 10)

    def apart(frame: int) -> Array:
        points = skin.posed(played.rotations[frame], played.root[frame], chosen)
        here = played.object("mug")
        return outside(rotate(conjugate(here.rotation[frame]), points - here.place[frame]), triangles)

    before = apart(lifted - 1)
    assert before[thumb].min() < ON_IT, "the thumb is on it before it moves"
    assert before[others].min() < ON_IT
    for frame in held:
        distance = apart(frame)
        assert distance.min() > -DEEPEST, frame
        assert distance[thumb].min() < ON_IT, frame
