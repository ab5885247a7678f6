"""Files become clips: real capture on both humans, the report, and what is refused."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest

from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.database import Workspace
from ahmss.errors import CommandError, DataError
from ahmss.motion.alignment import TRACKED, BodyMotion
from ahmss.motion.bvh import read_bvh
from ahmss.motion.bvh_out import write_bvh
from ahmss.motion.clip import load, save
from ahmss.motion.importing import import_clip, read_body, read_source
from ahmss.motion.quality import measure
from ahmss.motion.sourcequality import measure_source

from .makers import RATE, remounted, save_amc, save_bvh, stepping
from .mocap import capture_path

HUMANS = ("ken", "aiko")
WALKS = ("B01", "B02", "B03", "B09", "B10", "B12", "B13")
CLIPS = ("A01", "A05", *WALKS)
HANDS = [INDEX["right_hand"], INDEX["left_hand"]]
SHOULDERS = [INDEX["right_upper_arm"], INDEX["left_upper_arm"]]
SPINE, NECK = INDEX["spine"], INDEX["head"]


@lru_cache
def human(name: str) -> Skeleton:
    return Workspace.find().humans.get(name).skeleton


@lru_cache
def imported(name: str, on: str):
    return import_clip(capture_path(name), human(on))


@pytest.mark.parametrize("on", HUMANS)
@pytest.mark.parametrize("name", CLIPS)
def test_imported_feet_slide_no_more_than_their_source(name, on):
    clip, _ = imported(name, on)
    found = measure(clip.rotations, clip.root, clip.rate, human(on), clip.contacts).support
    source = measure_source(read_source(capture_path(name))).support
    assert len(found.slides) >= 0.5 * len(source.slides)
    assert found.slide_mean <= source.slide_mean
    assert found.speed_mean <= source.speed_mean


@pytest.mark.parametrize("on", HUMANS)
@pytest.mark.parametrize("name", CLIPS)
def test_imported_hands_are_where_they_were_relative_to_the_body(name, on):
    """Seen from the trunk, in arm lengths; inwards of the shoulder, in shoulder widths. 2 cm."""
    clip, _ = imported(name, on)
    skeleton = human(on)
    body = read_body(capture_path(name))[0].at_rate(clip.rate)
    expected = hands_in_trunk(body) * scales(body, skeleton)
    places, world = forward(clip.rotations, clip.root, skeleton.offsets)
    trunk = conjugate(world[:, None, SPINE])
    found = rotate(trunk, places[:, HANDS] - places[:, SHOULDERS])
    # Where on a shoulder that moves one measures from is one choice for a clip.
    apart = found - expected
    apart -= 0.5 * (apart.max(axis=0) + apart.min(axis=0))
    assert np.linalg.norm(apart, axis=-1).max() < 0.02


def hands_in_trunk(body: BodyMotion):
    """The wrists (F, 2, 3) from the middle place of their shoulder, in the trunk's axes."""
    trunk = conjugate(body.rotations[:, None, SPINE])
    shoulders = rotate(trunk, body.places[:, SHOULDERS] - body.places[:, None, NECK])
    return rotate(trunk, body.places[:, HANDS] - body.places[:, None, NECK]) - np.median(shoulders, axis=0)


def scales(body: BodyMotion, skeleton: Skeleton):
    """What each component of the wrists' places (F, 2, 3) is to be scaled by."""

    def bones(places, *links):
        return np.linalg.norm(np.diff(places[..., list(links), :], axis=-2), axis=-1).sum(axis=-1)

    upright, _ = forward(*skeleton.upright(), skeleton.offsets)
    arm = [INDEX[f"right_{part}"] for part in ("upper_arm", "lower_arm", "hand")]
    own, theirs = bones(upright, *arm), np.median(bones(body.places, *arm))
    width, their_width = bones(upright, *SHOULDERS), np.median(bones(body.places, *SHOULDERS))
    hands = hands_in_trunk(body)
    out = np.full(hands.shape, own / theirs)
    inwards = hands[..., 1] * np.array([-1.0, 1.0]) < 0.0
    out[..., 1] = np.where(inwards, width / their_width, own / theirs)
    return out


def test_an_imported_walk_goes_ahead_over_the_floor_in_strides_that_fit_the_legs():
    tall, small = imported("B03", "ken")[0], imported("B03", "aiko")[0]
    legs = [np.linalg.norm(human(on).offsets[[7, 8]], axis=-1).sum() for on in HUMANS]
    assert tall.root[-1, 0] / legs[0] == pytest.approx(small.root[-1, 0] / legs[1], rel=0.03)
    assert tall.root[-1, 0] > 6.0
    assert np.allclose(tall.root[0, :2], 0.0, atol=0.01)
    assert 0.5 < tall.contacts.mean() < 0.8


def test_the_report_says_what_was_found_and_done():
    _, report = imported("B03", "ken")
    said = "; ".join(report)
    for words in (
        "BVH, 230 frames, names as in ACCAD files",
        "cm",
        "1.63 m",
        "zero pose",
        "30 frames a second became 60",
    ):
        assert words in said
    assert "legs of 80 cm became 86 cm" in said


@pytest.fixture
def file(tmp_path, skeleton):
    write_bvh(tmp_path / "stepping.bvh", skeleton, *stepping(skeleton), RATE)
    return tmp_path / "stepping.bvh"


def test_amc_brings_in_what_bvh_does(tmp_path, file):
    from_bvh, _ = read_body(file)
    from_amc, report = read_body(save_amc(read_source(file), tmp_path / "07_01.amc", unit=0.0254 / 0.45))
    said = "; ".join(report)
    assert "AMC, 90 frames" in said
    assert "unit taken to be cmu" in said
    assert "120 frames a second taken" in said
    np.testing.assert_allclose(from_amc.places, from_bvh.places, atol=1e-6)
    apart = to_rotation_vector(multiply(conjugate(from_amc.rotations), from_bvh.rotations))
    limbs = [i for i, name in enumerate(TRACKED) if not name.endswith(("foot", "hand"))]  # they have no tips here
    assert np.degrees(np.linalg.norm(apart[:, limbs], axis=-1)).max() < 0.01


def test_a_clip_that_is_imported_is_one_that_loads(tmp_path, file, skeleton):
    clip, _ = import_clip(file, skeleton)
    save(clip, tmp_path / "clip.npz")
    back = load(tmp_path / "clip.npz")
    assert back.header.origin == "stepping.bvh"
    assert back.frames == 90


@pytest.mark.parametrize(("rate", "frames"), [(None, 90), (60.0, 90), (30.0, 45), (120.0, 179)])
def test_the_rate_is_the_one_asked_for(file, skeleton, rate, frames):
    clip, _ = import_clip(file, skeleton, rate=rate)
    assert clip.frames == frames
    assert clip.rate == (rate or RATE)


def test_a_unit_may_be_given_and_is_else_guessed(file):
    guessed, report = read_body(file)
    assert any("unit taken to be m:" in sentence for sentence in report)
    given, _ = read_body(file, "cm")
    np.testing.assert_allclose(given.places, 0.01 * guessed.places)
    with pytest.raises(CommandError, match='no unit "yard"; known are m, cm, mm'):
        read_body(file, "yard")


@pytest.mark.parametrize(
    ("scale", "unit"), [(100.0, "cm"), (1000.0, "mm"), (1.0 / 0.0254, "inch"), (0.45 / 0.0254, "cmu"), (1e-5, "")]
)
def test_units_are_told_from_the_stature(file, scale, unit):
    lines = file.read_text().splitlines()
    for i, line in enumerate(lines):
        if line.strip().startswith("OFFSET"):
            lines[i] = "OFFSET " + " ".join(f"{float(word) * scale:.9f}" for word in line.split()[1:])
        elif lines[i][:1] in "-0123456789":
            words = line.split()
            lines[i] = " ".join([f"{float(word) * scale:.9f}" for word in words[:3]] + words[3:])
    same, _ = read_body(file)
    file.write_text("\n".join(lines))
    body, report = read_body(file)
    assert any((f"unit taken to be {unit}:" if unit else "no known unit fits") in sentence for sentence in report)
    np.testing.assert_allclose(body.places, same.places, atol=0.002)


def test_a_first_frame_apart_from_the_motion_is_left_out(file, skeleton):
    lines = file.read_text().splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("Frame Time")) + 1
    zero = lines[first].split()[:3] + ["0"] * (len(lines[first].split()) - 3)
    lines.insert(first, " ".join(zero))
    file.write_text("\n".join(lines).replace("Frames: 90", "Frames: 91"))
    clip, report = import_clip(file, skeleton)
    assert clip.frames == 90
    assert any("frame 0 is a pose by itself" in sentence for sentence in report)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("walk.fbx", r"motion files end in \.bvh, \.amc or \.c3d"),
        ("walk.asf", r"name the \.amc file"),
        ("a.bvh", "can't be read"),
    ],
)
def test_what_is_no_motion_is_refused(tmp_path, skeleton, name, message):
    with pytest.raises(DataError, match=message):
        import_clip(tmp_path / name, skeleton)


def test_a_motion_in_which_nobody_stands_is_refused(tmp_path, skeleton):
    """Sitting from first to last, and the zero pose is no help: what upright is can't be known."""
    rotations, root = stepping(skeleton)
    rotations[:, INDEX["right_upper_leg"]] = (np.sqrt(0.5), 0.0, -np.sqrt(0.5), 0.0)
    write_bvh(tmp_path / "sits.bvh", skeleton, rotations, root, RATE)
    rotations[:, INDEX["right_upper_leg"]] = rotations[:, INDEX["left_upper_leg"]]
    path = save_bvh(remounted(read_bvh(tmp_path / "sits.bvh")), tmp_path / "heap.bvh")
    with pytest.raises(DataError, match="nobody stands, neither in the zero pose nor in any frame"):
        import_clip(path, skeleton)
