"""The hand at the cup, by the skin that viewers show: vertices of the shape, blended as they blend them."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.inverse import RIGHT_HAND
from ahmss.body.links import INDEX, LINKS, fingers
from ahmss.body.quaternion import conjugate, rotate
from ahmss.database import Workspace
from ahmss.main.play import PlaySetup, play_script

from .conftest import CUP, ROOT
from .recorded import Recorded
from .skin import Skin

pytestmark = pytest.mark.timeout(180)

RADIUS, HEIGHT = 0.036, 0.095  # of the cup
LIMIT = 0.004
NEAR = 0.2  # metres between palm and cup beyond which nothing touches
SCRIPT = """
add room
human aiko body aiko at 0 0 facing -20
do cup reach frames 42
do cup grasp
do cup lift
do cup put to 0.42 -0.15 0.88
do cup release
wait 0.2
"""
# Of a face: its corners, the middles of its edges, its middle.
WITHIN = np.array([[2, 0, 0], [0, 2, 0], [0, 0, 2], [1, 1, 0], [0, 1, 1], [1, 0, 1], [2 / 3, 2 / 3, 2 / 3]]) / 2.0


@dataclass(frozen=True)
class Grip:
    """Distances (F, T, 7) of the hand's faces from the cup at the frames near it, negative inside; links (T,)."""

    distance: Array
    link: Array
    held: Array  # (F,) whether the cup moves

    @classmethod
    def of(cls, played: Recorded, name: str) -> Grip:
        skin = Skin.read(Workspace(ROOT).humans.shape(name).glb, played.skeleton)
        hand = np.isin(skin.link, [INDEX["right_hand"], *fingers("right")])
        chosen = np.flatnonzero(hand)
        faces = np.searchsorted(chosen, skin.faces[hand[skin.faces].all(axis=1)])
        cup = played.object(CUP)
        near = np.linalg.norm(played.grip(RIGHT_HAND).place - cup.place, axis=1) < NEAR
        frames = np.flatnonzero(near)[::3]
        moved = np.linalg.norm(np.diff(cup.place, axis=0, append=cup.place[-1:]), axis=1) > 1e-6
        distance: list[Array] = []
        for frame in frames:
            points = skin.posed(played.rotations[frame], played.root[frame], chosen)
            seen = rotate(conjugate(cup.rotation[frame]), points - cup.place[frame])
            distance.append(outside(WITHIN @ seen[faces]))
        return cls(np.array(distance), skin.link[chosen][faces[:, 0]], moved[frames])


def outside(points: Array) -> Array:
    """The distance (...) of points (..., 3) from the cup taken as solid, negative inside."""
    level = np.hypot(points[..., 0], points[..., 1]) - RADIUS
    above = np.maximum(points[..., 2] - HEIGHT, -points[..., 2])
    inside = np.maximum(level, above)
    return np.where(inside < 0.0, inside, np.hypot(np.maximum(level, 0.0), np.maximum(above, 0.0)))


@pytest.fixture(scope="module", params=["ken", pytest.param("aiko", marks=pytest.mark.long)])
def grip(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Grip:
    if request.param == "ken":
        return Grip.of(request.getfixturevalue("demo"), "ken")
    folder: Path = tmp_path_factory.mktemp("grip")
    (folder / "grip.txt").write_text(SCRIPT)
    setup = PlaySetup(workspace=str(ROOT), fast=True, record=folder / "grip.rec")
    assert play_script(folder / "grip.txt", setup).failures == 0
    return Grip.of(Recorded.read(folder / "grip.rec", "aiko", (CUP,)), "aiko")


def test_no_part_of_the_skin_sinks_into_the_cup(grip: Grip) -> None:
    assert grip.held.sum() > 20
    deepest = grip.distance.min(axis=(0, 2))
    assert deepest.min() > -LIMIT, LINKS[grip.link[deepest.argmin()]]


@pytest.mark.parametrize(
    "part", ["hand", *(f"{name}_distal" for name in ("thumb", "index", "middle", "ring", "little"))]
)
def test_palm_and_fingertips_are_on_the_cup_while_it_moves(grip: Grip, part: str) -> None:
    touching = grip.distance[:, grip.link == INDEX[f"right_{part}"]].min(axis=(1, 2))
    assert touching[grip.held].max() < LIMIT
    assert touching.max() > 2 * LIMIT  # it was away before
