"""BVH read and written: channels of any order, joints of any kind, and damage named with its line."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from ahmss.body.kinematics import forward
from ahmss.body.links import LINKS
from ahmss.body.quaternion import multiply, to_matrix
from ahmss.errors import DataError
from ahmss.motion.bvh import read_bvh
from ahmss.motion.bvh_out import t_pose, write_bvh

from .makers import stepping

SMALL = """HIERARCHY
ROOT Hips
{
  OFFSET 1 2 3
  CHANNELS 6 Zposition Xposition Yposition Yrotation Zrotation Xrotation
  JOINT Left Leg {
    OFFSET 0 -4 0
    CHANNELS 5 Xrotation Yrotation Zrotation Yposition Xposition
    End Site
    {
      OFFSET 0 -5 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.0083333
30 10 20 90 0 0 0 0 0 -4 0
33 11 22 40 50 60 10 20 30 -4.5 0.5
"""


def written(tmp_path, text):
    path = tmp_path / "small.bvh"
    path.write_text(text)
    return path


def test_positions_and_angles_go_by_the_order_of_their_channels(tmp_path):
    source = read_bvh(written(tmp_path, SMALL))
    assert source.names == ("Hips", "Left Leg", "Left Leg_end")
    assert source.parents == (-1, 0, 1)
    assert source.rate == 120.0
    np.testing.assert_allclose(source.translations[:, 0], [[10, 20, 30], [11, 22, 33]])
    np.testing.assert_allclose(source.translations[1, 1], [0.5, -4.5, 0.0])  # positions stand for the offset
    np.testing.assert_allclose(source.offsets[:, 1], [2, -4, -5])
    hips, leg = (to_matrix(source.rotations[1, joint]) for joint in (0, 1))
    np.testing.assert_allclose(hips, Rotation.from_euler("YZX", [40, 50, 60], degrees=True).as_matrix(), atol=1e-12)
    np.testing.assert_allclose(leg, Rotation.from_euler("XYZ", [10, 20, 30], degrees=True).as_matrix(), atol=1e-12)


def test_a_chain_is_carried_by_its_parents(tmp_path):
    places, _ = read_bvh(written(tmp_path, SMALL.replace("0 0 0 0 0 -4 0", "0 90 0 0 0 -4 0", 1))).world()
    # R = Ry Rx of two quarters: about x the leg's -y goes to -z, about y that goes to -x.
    np.testing.assert_allclose(places[0, 1] - places[0, 0], [-4.0, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(places[0, 2] - places[0, 1], [-5.0, 0.0, 0.0], atol=1e-12)


DAMAGE = {
    "not BVH": ("HIERARCHY", "VERSION", "line 1: a BVH file starts with HIERARCHY"),
    "no number": ("OFFSET 0 -4 0", "OFFSET 0 four 0", 'line 7: "four" is not a number'),
    "offset of two": ("OFFSET 0 -4 0", "OFFSET 0 -4", "line 7: OFFSET of Left Leg has 2 numbers; it must have 3"),
    "no offset": ("    OFFSET 0 -4 0\n", "", "Left Leg of line 6 has no OFFSET"),
    "unknown channel": ("Yposition Xposition\n", "Yscale Xposition\n", "line 8: CHANNELS of Left Leg has yscale"),
    "channel twice": ("Yposition Xposition\n", "Yposition Yposition\n", "line 8: CHANNELS of Left Leg has one twice"),
    "channels miscounted": (
        "CHANNELS 5",
        "CHANNELS 6",
        "line 8: CHANNELS of Left Leg must be a number and",
    ),
    "same name": ("JOINT Left Leg", "JOINT Hips", 'line 6: there are two joints named "Hips"'),
    "two roots": ("JOINT Left Leg", "ROOT Left Leg", "line 6: a ROOT stands outside all braces"),
    "brace lost": ("    }\n  }\n}", "    }\n  }", "line 14: MOTION comes before the hierarchy is closed"),
    "odd word": ("    End Site", "    Begin Site", 'line 9: "Begin" is no part of a hierarchy'),
    "no frames": ("Frames: 2", "Frames: 0", "line 16: here must stand"),
    "frames no number": ("Frames: 2", "Frames: two", "line 16: here must stand"),
    "too many frames": ("Frames: 2", "Frames: 9999999999", "line 16: 9999999999 frames; at most"),
    "frame time nought": ("Time: 0.0083333", "Time: 0", "line 17: a frame time of 0 s"),
    "too few rows": (
        "Frames: 2",
        "Frames: 3",
        "line 19: the file ends where frame 2 of 3 should stand",
    ),
    "too many rows": ("Frames: 2", "Frames: 1", "line 18: more follows the last of 1 frames"),
    "row too short": ("30 10 20 90 ", "30 10 20 ", "line 18: frame 0 has 10 numbers; the joints have 11 channels"),
    "not a number in a row": ("33 11", "nan 11", "line 19: frame 1 has a number that is not finite"),
    "a word in a row": ("33 11", "33.1.1 11", 'line 19: "33.1.1" is not a number'),
    "cut in the hierarchy": (SMALL[120:], "", "the file ends where MOTION should stand; is it cut short?"),
}


@pytest.mark.parametrize(("old", "new", "message"), DAMAGE.values(), ids=DAMAGE)
def test_damage_is_one_sentence_with_file_and_line(tmp_path, old, new, message):
    assert old in SMALL
    path = written(tmp_path, SMALL.replace(old, new, 1))
    with pytest.raises(DataError) as error:
        read_bvh(path)
    assert message in str(error.value)
    assert str(error.value).startswith(str(path))
    assert "\n" not in str(error.value)


def test_no_cut_or_garbled_file_is_more_than_a_sentence(tmp_path):
    rng = np.random.default_rng(1)
    refused = 0
    for _ in range(150):
        text = bytearray(SMALL.encode())
        text[rng.integers(len(text))] = rng.integers(32, 127)
        path = tmp_path / "damaged.bvh"
        path.write_bytes(bytes(text[: rng.integers(1, len(text) + 1)] if rng.random() < 0.5 else text))
        try:
            read_bvh(path)
        except DataError:
            refused += 1
    assert refused > 70


def test_a_missing_file_is_said(tmp_path):
    with pytest.raises(DataError, match="can't be read"):
        read_bvh(tmp_path / "none.bvh")


def test_what_is_written_is_read_back(tmp_path, skeleton):
    rotations, root = stepping(skeleton)
    rotations[30:, 0] *= -1.0  # signs must not matter
    path = tmp_path / "new" / "out.bvh"
    write_bvh(path, skeleton, rotations, root, 60.0)
    source = read_bvh(path)
    places, _ = source.world()
    expected, _ = forward(rotations, root, skeleton.offsets)
    links = [source.names.index(link) for link in LINKS]
    # y up, z ahead, x to the left: ours is x ahead, y to the left, z up.
    np.testing.assert_allclose(places[:, links][..., [2, 0, 1]], expected, atol=5e-6)
    assert source.rate == 60.0
    ends = [i for i, name in enumerate(source.names) if name.endswith("_end")]
    assert len(ends) == 13  # head, two feet, ten fingers


def test_what_is_written_stands_in_a_t_pose_upright_and_in_metres(tmp_path, skeleton):
    rotations, root = t_pose(skeleton)
    write_bvh(tmp_path / "t.bvh", skeleton, rotations[None], root[None], 60.0)
    source = read_bvh(tmp_path / "t.bvh")
    np.testing.assert_allclose(source.rotations[0, 1:, 0], 1.0, atol=1e-9)
    places, names = source.world()[0][0], source.names
    head, foot, hand = (places[names.index(n)] for n in ("head_end", "right_foot_end", "left_hand"))
    assert head[1] == pytest.approx(skeleton.stature, abs=0.02)
    assert foot[2] > 0.1  # toes ahead, along z
    assert hand[0] > 0.5  # the left hand along x, at the shoulder's height
    assert hand[1] == pytest.approx(places[names.index("left_upper_arm")][1], abs=1e-6)


def test_angles_written_have_no_jumps(tmp_path, skeleton):
    pose, place = skeleton.upright()
    t = np.linspace(0.0, 4.0 * np.pi, 200)
    spin = np.stack([np.cos(0.5 * t), 0.0 * t, 0.0 * t, np.sin(0.5 * t)], axis=-1)
    rotations = np.repeat(pose[None], 200, axis=0)
    rotations[:, 0] = multiply(spin, rotations[:, 0])
    write_bvh(tmp_path / "spin.bvh", skeleton, rotations, np.repeat(place[None], 200, axis=0), 60.0)
    table = np.loadtxt((tmp_path / "spin.bvh").read_text().split("Frame Time:")[1].splitlines()[1:])
    assert np.abs(np.diff(table, axis=0)).max() < 5.0
    assert table[-1, 5] - table[0, 5] == pytest.approx(720.0, abs=1e-3)
