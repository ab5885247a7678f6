"""Markers become a body: a known motion with markers on its skin, as a C3D file of each marker set has them."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.errors import DataError, DependencyError
from ahmss.motion.alignment import TRACKED
from ahmss.motion.c3d import read_c3d
from ahmss.motion.importing import import_clip, read_body
from ahmss.motion.markers import Markers, body_of_markers

from .makers import RATE, stepping

SUBJECT = Skeleton.of(1.7, "female")


def plug_in_gait(skeleton: Skeleton, rotations, root):
    """The places of Plug-in Gait's markers by name, metres, each where a technician would put it."""
    places, world = forward(rotations, root, skeleton.offsets)
    h = skeleton.stature

    def on(link, x, y, z):
        i = INDEX[link]
        return places[:, i] + rotate(world[:, i], h * np.array([x, y, z]))

    out = {}
    width = np.linalg.norm(skeleton.offsets[INDEX["left_upper_leg"]]) / 0.36 / h
    for s, side, sign in (("R", "right", -1.0), ("L", "left", 1.0)):
        # Link frames: trunk x up, y left, z back; legs x down, y left, z ahead; arms x down, y right, z back.
        out[f"{s}ASI"] = on("hips", 0.30 * width, sign * 0.5 * width, -0.19 * width)
        out[f"{s}PSI"] = on("hips", 0.30 * width, sign * 0.15 * width, 0.5 * width)
        out[f"{s}KNE"] = on(f"{side}_lower_leg", 0.0, sign * 0.034, 0.0)
        out[f"{s}ANK"] = on(f"{side}_foot", 0.0, sign * 0.023, 0.0)
        out[f"{s}HEE"] = on(f"{side}_foot", -0.03, 0.0, -0.02)
        out[f"{s}TOE"] = on(f"{side}_foot", 0.09, 0.0, -0.02)
        shoulder = places[:, INDEX[f"{side}_upper_arm"]]
        out[f"{s}SHO"] = shoulder + rotate(world[:, INDEX["spine"]], 0.02 * h * np.array([1.0, 0.0, 0.0]))
        elbow = places[:, INDEX[f"{side}_lower_arm"]]
        out[f"{s}ELB"] = elbow + rotate(
            world[:, INDEX[f"{side}_upper_arm"]], -sign * 0.026 * h * np.array([0.0, 1.0, 0.0])
        )
        out[f"{s}WRA"] = on(f"{side}_hand", 0.0, 0.0, -0.02)
        out[f"{s}WRB"] = on(f"{side}_hand", 0.0, 0.0, 0.02)
        out[f"{s}FIN"] = on(f"{side}_hand", 0.045, 0.0, 0.0)
        out[f"{s}FHD"] = on("head", 0.10, sign * 0.04, -0.05)
        out[f"{s}BHD"] = on("head", 0.10, sign * 0.04, 0.05)
    out["C7"], out["CLAV"] = on("head", 0.0, 0.0, 0.04), on("head", 0.0, 0.0, -0.04)
    return out


CMU = {"RASI": "RFWT", "LASI": "LFWT", "RPSI": "RBWT", "LPSI": "LBWT"}
HELEN_HAYES = {
    "ASI": "{}.ASIS", "KNE": "{}.Knee", "ANK": "{}.Ankle", "HEE": "{}.Heel", "TOE": "{}.Toe", "SHO": "{}.Shoulder",
    "ELB": "{}.Elbow",
}  # fmt: skip


def helen_hayes(markers):
    """Renamed to Helen Hayes's: one marker on the sacrum, one at each wrist, and two on the head."""
    out = {form.format(s): markers[f"{s}{name}"] for s in "RL" for name, form in HELEN_HAYES.items()}
    out |= {f"{s}.Wrist": 0.5 * (markers[f"{s}WRA"] + markers[f"{s}WRB"]) for s in "RL"}
    out["V.Sacral"] = 0.5 * (markers["RPSI"] + markers["LPSI"])
    out["Front.Head"] = 0.5 * (markers["RFHD"] + markers["LFHD"])
    out["Rear.Head"] = 0.5 * (markers["RBHD"] + markers["LBHD"])
    return out


def save_c3d(path, markers, rate=RATE, unit="mm", prefix=""):
    ezc3d = pytest.importorskip("ezc3d", reason="C3D is an extra")
    file = ezc3d.c3d()
    point = file["parameters"]["POINT"]
    point["RATE"]["value"], point["UNITS"]["value"] = [rate], [unit]
    point["LABELS"]["value"] = [prefix + name for name in markers]
    scale = {"mm": 1000.0, "m": 1.0}[unit]
    places = scale * np.stack([*markers.values()], axis=1)  # (F, N, 3)
    file["data"]["points"] = np.concatenate([places, np.ones((*places.shape[:2], 1))], axis=-1).transpose(2, 1, 0)
    file.write(str(path))
    return path


@pytest.fixture(scope="module")
def performed():
    rotations, root = stepping(SUBJECT)
    return plug_in_gait(SUBJECT, rotations, root), *forward(rotations, root, SUBJECT.offsets)


def degrees_apart(a, b):
    return np.degrees(np.linalg.norm(to_rotation_vector(multiply(conjugate(a), b)), axis=-1))


@pytest.mark.parametrize(
    ("rename", "prefix", "unit"),
    [
        (dict, "", "mm"),
        (lambda m: {CMU.get(name, name): places for name, places in m.items()}, "subject 1:", "m"),
        (helen_hayes, "", "mm"),
    ],
    ids=["Plug-in Gait", "CMU 41", "Helen Hayes"],
)
def test_joints_are_where_they_were_and_links_turned_as_they_were(tmp_path, performed, rename, prefix, unit):
    markers, places, world = performed
    body, report = read_body(save_c3d(tmp_path / "a.c3d", rename(markers), unit=unit, prefix=prefix))
    assert "C3D, 90 frames" in report[0]
    limbs = [i for i, name in enumerate(TRACKED) if name not in ("spine", "head")]
    assert np.linalg.norm(body.places - places[:, :15], axis=-1)[:, limbs].max() < 0.03
    apart = dict(zip(TRACKED, degrees_apart(body.rotations, world[:, :15]).max(axis=0), strict=True))
    assert max(angle for link, angle in apart.items() if not link.endswith(("arm", "hand"))) < 3.0, apart
    # An elbow that is nearly straight has no plane, so an upper arm's turn is known less well than its direction.
    along = [rotate(q, np.array([1.0, 0.0, 0.0])) for q in (body.rotations, world[:, :15])]
    aside = np.degrees(np.arccos(np.clip((along[0] * along[1]).sum(axis=-1), -1.0, 1.0))).max(axis=0)
    assert max(angle for link, angle in zip(TRACKED, aside, strict=True) if link.endswith("arm")) < 6.0
    assert max(apart["right_upper_arm"], apart["left_upper_arm"]) < 20.0, apart
    if rename is not helen_hayes:  # one marker at a wrist says nothing of the forearm's turn and of the hand
        assert max(apart["right_lower_arm"], apart["right_hand"], apart["left_hand"]) < 6.0, apart


def test_a_marker_hidden_for_a_while_is_filled_in_and_said(tmp_path, performed, skeleton):
    markers, _, _ = performed
    whole, _ = import_clip(save_c3d(tmp_path / "whole.c3d", markers), skeleton)
    holed = markers | {"RKNE": markers["RKNE"].copy()}
    holed["RKNE"][40:48] = np.nan
    clip, report = import_clip(save_c3d(tmp_path / "holed.c3d", holed), skeleton)
    assert any("hidden markers filled in, one for 8 of 90 frames" in sentence for sentence in report)
    assert degrees_apart(clip.rotations, whole.rotations).max() < 6.0


def test_missing_markers_are_one_sentence(tmp_path, performed):
    markers, _, _ = performed
    left = {name: places for name, places in markers.items() if name not in ("RKNE", "C7", "CLAV", "LTOE")}
    left["RHEE"] = np.full_like(left["RHEE"], np.nan)  # named, but never seen
    with pytest.raises(DataError) as error:
        read_body(save_c3d(tmp_path / "a.c3d", left))
    said = str(error.value)
    assert "markers: missing: R knee (RKNE or RKNEE), R heel (RHEE or RHEEL), L toe (LTOE or LTOES)" in said
    assert "neck" not in said  # the shoulders serve
    assert "\n" not in said


def test_a_room_whose_y_points_up_is_turned(performed):
    markers, _, _ = performed
    upright = Markers("a.c3d", tuple(markers), np.stack([*markers.values()], axis=1), RATE)  # pyright: ignore
    turned = Markers("a.c3d", tuple(markers), upright.places[..., [1, 2, 0]], RATE)  # pyright: ignore
    one, other = body_of_markers(upright)[0], body_of_markers(turned)[0]
    np.testing.assert_allclose(one.places[..., 2], other.places[..., 2], atol=1e-9)


def test_damaged_and_foreign_files_are_one_sentence(tmp_path, performed):
    markers, _, _ = performed
    path = save_c3d(tmp_path / "a.c3d", markers)
    whole = path.read_bytes()
    rng = np.random.default_rng(3)
    for content in (b"", b"hello", whole[:100], whole[:700], bytes(rng.integers(0, 256, 2000, dtype=np.uint8))):
        path.write_bytes(content)
        with pytest.raises(DataError) as error:
            read_c3d(path)
        assert str(path) in str(error.value)
        assert "\n" not in str(error.value)
    with pytest.raises(DataError, match="no such file"):
        read_c3d(tmp_path / "none.c3d")


def test_without_ezc3d_the_way_to_get_it_is_said(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "ezc3d", None)
    with pytest.raises(DependencyError, match=r"pip install 'ahmss\[c3d\]'"):
        read_c3d(tmp_path / "a.c3d")
