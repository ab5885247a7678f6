"""The chair's example, played: a human sits down and stands up; it seats one at a time."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.database import Workspace
from ahmss.main.play import PlaySetup, play_script
from ahmss.motion.clip import load
from ahmss.motion.contact import foot_points
from ahmss.motion.quality import measure

from .conftest import ROOT
from .recorded import Recorded

CHAIR = "room/chair"
SEAT = 0.43
STANDING_REAL = 30.0  # rad/s2: the largest acceleration of a joint in real standing, 259 in the calmest real walk


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    path = tmp_path_factory.mktemp("chair") / "chair.rec"
    report = play_script(ROOT / "examples" / "chair.txt", PlaySetup(workspace=str(ROOT), fast=True, record=path))
    assert report.failures == 0
    return Recorded.read(path, "ken", (CHAIR,))


def seen_from_chair(played: Recorded) -> np.ndarray:
    return played.object(CHAIR).inverse().apply(played.root)


def sitting(played: Recorded) -> np.ndarray:
    """The frames in which the hips are down."""
    return np.flatnonzero(played.root[:, 2] < played.root[:, 2].min() + 0.01)


def test_it_moves_as_smoothly_as_people(played: Recorded) -> None:
    quality = measure(played.rotations, played.root, played.rate, played.skeleton)
    assert 10.0 < quality.joints.acceleration_max < 2.0 * STANDING_REAL
    assert quality.pop.degrees < 0.5


def test_the_feet_stay_where_they_stand(played: Recorded) -> None:
    points = foot_points(played.skeleton, played.rotations, played.root)
    assert np.ptp(points, axis=0).max() < 0.003
    assert points[..., 2].min() > -0.003


def test_the_hips_are_on_the_seat_for_a_while_and_do_not_sink_into_it(played: Recorded) -> None:
    down = sitting(played)
    assert len(down) > 50
    ahead, aside, height = seen_from_chair(played)[down].T
    assert np.abs(ahead + 0.055).max() < 0.06
    assert np.abs(aside).max() < 0.01
    assert height.min() - SEAT > 0.064 * played.skeleton.stature  # what one sits on is so far below the hips' joint
    assert height.min() - SEAT < 0.071 * played.skeleton.stature


def test_nobody_slides_along_the_seat(played: Recorded) -> None:
    on_seat = seen_from_chair(played)[played.root[:, 2] < played.root[:, 2].min() + 0.002]
    assert np.ptp(on_seat[:, 0]) < 0.04


def test_who_has_sat_stands_again_where_they_stood(played: Recorded) -> None:
    np.testing.assert_allclose(played.root[-1], played.root[0], atol=0.01)


def test_the_hands_rest_on_the_thighs(played: Recorded) -> None:
    middle = int(np.median(sitting(played)))
    places, _ = played.links
    for side, name in enumerate(("right", "left")):
        palm = played.grip(side).place[middle]
        thigh = 0.4 * places[middle, INDEX[f"{name}_upper_leg"]] + 0.6 * places[middle, INDEX[f"{name}_lower_leg"]]
        assert np.linalg.norm((palm - thigh)[:2]) < 0.05
        assert 0.04 < palm[2] - thigh[2] < 0.10
        assert rotate(played.grip(side).rotation[middle], np.array([1.0, 0.0, 0.0]))[2] < -0.85


def test_the_chair_is_the_sitters_until_they_stand_up(played: Recorded) -> None:
    assert {played.holders[CHAIR][frame] for frame in sitting(played)} == {"ken"}
    assert played.holders[CHAIR][0] == played.holders[CHAIR][-1] == ""
    assert np.ptp(played.objects[CHAIR], axis=0).max() == 0.0


def failing(tmp_path: Path, *lines: str) -> int:
    script = tmp_path / "script.txt"
    script.write_text("\n".join(["add room", *lines]) + "\n")
    return play_script(script, PlaySetup(workspace=str(ROOT), fast=True)).failures


def test_two_do_not_sit_on_one_chair(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    there = "at 1.80 0.2 facing 180"
    failures = failing(
        tmp_path, f"human ken body ken {there}", f"human aiko body aiko {there}", "ken: do chair sit", "sync",
        "aiko: do chair sit patience=0", "sync", "ken: do chair stand_up", "sync", "aiko: do chair sit",
    )  # fmt: skip
    assert failures == 1
    said = capfd.readouterr()
    assert "room/chair is held by ken" in said.out + said.err


def test_who_stands_elsewhere_walks_there_and_has_to_sit_to_stand_up(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    lines = ("human ken body ken at 0 0 facing -20", "do chair stand_up", "do chair sit", "do chair stand_up")
    assert failing(tmp_path, *lines) == 1
    said = capfd.readouterr()
    assert "room/chair stand_up: ken does not sit on it" in said.out + said.err


@pytest.mark.parametrize("motion", ["chair/play_sit", "chair/play_stand_up", "door/play_open", "door/play_close"])
def test_the_captured_clips_are_what_their_objects_name(motion: str) -> None:
    kind, name = motion.split("/")
    path = Workspace(ROOT).objects.get(kind).affordances[name].motion
    assert path is not None
    clip = load(path)
    assert clip.header.origin.startswith("captured by scripts/make_motions.py")
    assert clip.contacts.min() == 1.0  # both feet on the floor throughout
    assert (clip.importance[:, INDEX["head"]] < clip.importance[:, INDEX["hips"]]).all()  # the head may look elsewhere
