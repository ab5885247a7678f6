"""The carton's example, played: it is lifted from the floor between both hands, and stands where it is put down."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.body.inverse import LEFT_HAND, RIGHT_HAND
from ahmss.body.quaternion import rotate
from ahmss.main.play import PlaySetup, play_script
from ahmss.motion.contact import foot_points
from ahmss.motion.quality import measure

from .conftest import ROOT
from .recorded import Recorded

SITES = {RIGHT_HAND: np.array([0.0, -0.18, 0.2]), LEFT_HAND: np.array([0.0, 0.18, 0.2])}


@pytest.fixture(scope="module", params=["ken", pytest.param("aiko", marks=pytest.mark.long)])
def played(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    directory = tmp_path_factory.mktemp("carton")
    script = (ROOT / "examples" / "carton.txt").read_text().replace("body ken", f"body {request.param}")
    Path(directory / "carton.txt").write_text(script)
    path = directory / "carton.rec"
    setup = PlaySetup(workspace=str(ROOT), fast=True, record=path)
    assert play_script(directory / "carton.txt", setup).failures == 0
    return Recorded.read(path, "ken", ("carton",))


def in_the_air(played: Recorded) -> np.ndarray:
    return np.flatnonzero(played.objects["carton"][:, 2] > 0.02)


def test_it_moves_as_smoothly_as_people_and_the_feet_stand(played: Recorded) -> None:
    quality = measure(played.rotations, played.root, played.rate, played.skeleton)
    assert 10.0 < quality.joints.acceleration_max < 60.0  # rad/s2: real standing 30, the calmest real walk 259
    assert quality.pop.degrees < 0.5
    assert np.ptp(foot_points(played.skeleton, played.rotations, played.root), axis=0).max() < 0.003


def test_a_palm_is_at_either_side_while_it_is_in_the_air(played: Recorded) -> None:
    frames = in_the_air(played)
    assert len(frames) > 120
    for hand, site in SITES.items():
        apart = played.object("carton").inverse().apply(played.grip(hand).place)[frames] - site
        assert np.abs(apart).max() < 0.03
        assert np.ptp(apart, axis=0).max() < 0.01


def test_it_is_carried_level_and_without_a_jump(played: Recorded) -> None:
    box = played.objects["carton"]
    assert 0.6 < box[:, 2].max() < 1.0
    assert rotate(box[:, 3:], np.array([0.0, 0.0, 1.0]))[:, 2].min() > 0.9999
    assert np.abs(np.diff(box[:, :3], n=2, axis=0)).max() < 0.007


def test_it_stands_where_it_was_put_down_and_is_free(played: Recorded) -> None:
    box = played.objects["carton"]
    assert box[:, 2].min() >= 0.0
    assert box[-1, 2] == pytest.approx(0.0, abs=1e-6)
    assert np.linalg.norm(box[-1, :2] - box[0, :2]) < 0.03
    assert {played.holders["carton"][frame] for frame in in_the_air(played)} == {"ken"}
    assert played.holders["carton"][-1] == ""


@pytest.mark.parametrize("body", ["ken", pytest.param("aiko", marks=pytest.mark.long)])
def test_who_walks_off_with_it_has_it_along_between_both_hands(body: str, tmp_path: Path) -> None:
    """It hung in the air where the walk began, as the arms were let down."""
    lines = ["add floor", f"human ken body {body} at 0 0", "add carton at 0.35 0", "do carton lift"]
    lines += ["do floor walk to 1.5 1.2", "do carton put_down"]
    (tmp_path / "off.txt").write_text("\n".join(lines) + "\n")
    setup = PlaySetup(workspace=str(ROOT), fast=True, record=tmp_path / "off.rec")
    assert play_script(tmp_path / "off.txt", setup).failures == 0
    played = Recorded.read(tmp_path / "off.rec", "ken", ("carton",))
    frames, box = in_the_air(played), played.objects["carton"]
    assert np.linalg.norm(box[-1, :2] - np.array([1.5, 1.2])) < 0.5
    assert box[-1, 2] == pytest.approx(0.0, abs=1e-6)
    for hand, site in SITES.items():
        apart = played.object("carton").inverse().apply(played.grip(hand).place)[frames] - site
        assert np.abs(apart).max() < 0.03
    assert np.abs(np.diff(box[:, :3], n=2, axis=0)).max() < 0.007
