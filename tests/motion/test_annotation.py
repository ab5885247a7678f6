"""The hand-written table beside a captured clip: what it adds, and how it says what is wrong in it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.body.inverse import GAZE, LEFT_HAND, RIGHT_HAND, grips
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import from_axis_angle, multiply, rotate, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.errors import DataError
from ahmss.motion.annotation import annotate, load_table
from ahmss.motion.clip import Clip, load, save

SKELETON = Skeleton.of(1.76, "male", "ken")
RATE, SECONDS = 60.0, 4.0
COUNT = int(SECONDS * RATE) + 1
UP = np.array([0.0, 0.0, 1.0])


def captured() -> Clip:
    """Somebody who stands and raises the right arm, with importance 0.5 everywhere."""
    rotations, root = SKELETON.relaxed()
    many = np.repeat(rotations[None], COUNT, axis=0)
    raised = from_axis_angle(np.array([0.0, 1.0, 0.0]), np.linspace(0.0, 1.2, COUNT))
    arm = INDEX["right_upper_arm"]
    many[:, arm] = multiply(many[:, arm], raised)
    return Clip(many, np.repeat(root[None], COUNT, axis=0), np.full((COUNT, 44), 0.5), np.ones((COUNT, 2)), RATE)


def annotated(tmp_path: Path, text: str) -> Clip:
    file = tmp_path / "raise.annotation.toml"
    file.write_text(text)
    return annotate(captured(), load_table(file), SKELETON)


def at(seconds: float) -> int:
    return round(seconds * RATE)


def test_an_empty_table_changes_nothing(tmp_path: Path) -> None:
    clip, before = annotated(tmp_path, ""), captured()
    np.testing.assert_array_equal(clip.rotations, before.rotations)
    np.testing.assert_array_equal(clip.importance, before.importance)
    assert clip.targets is None


def test_a_part_is_kept_and_begins_at_the_humans_floor_frame(tmp_path: Path) -> None:
    clip = annotated(tmp_path, "[keep]\nfrom = 1.0\nto = 2.5")
    assert clip.frames == 91
    np.testing.assert_allclose(clip.root[0, :2], 0.0, atol=1e-12)
    np.testing.assert_allclose(clip.rotations[0, 3], captured().rotations[60, 3])
    with pytest.raises(ValueError, match="frames 60 to 600"):
        annotated(tmp_path, "[keep]\nfrom = 1.0\nto = 10.0")


def test_importance_comes_and_goes_and_later_rows_win(tmp_path: Path) -> None:
    clip = annotated(
        tmp_path,
        """
        [[importance]]
        joints = { all = 1.0, left_arm = 0.25 }
        [[importance]]
        from = 1.0
        to = 2.0
        ease = 0.5
        joints = { left_hand = 3.0, root = 2.0 }
        """,
    )
    left_hand, left_elbow, index = INDEX["left_hand"], INDEX["left_lower_arm"], INDEX["left_index_distal"]
    assert (clip.importance[:, left_elbow] == 0.25).all()
    assert (clip.importance[:, index] == 0.25).all()  # an arm has its fingers with it
    assert (clip.importance[:, INDEX["head"]] == 1.0).all()
    np.testing.assert_allclose(clip.importance[[at(0.4), at(2.6)], left_hand], 0.25)
    np.testing.assert_allclose(clip.importance[at(1.0) : at(2.0) + 1, left_hand], 3.0)
    np.testing.assert_allclose(clip.importance[at(1.0) : at(2.0) + 1, 43], 2.0)
    assert clip.importance[at(0.75), left_hand] == pytest.approx(0.25 + 0.5 * 2.75)
    assert np.abs(np.diff(clip.importance[:, left_hand], n=2)).max() < 0.02


def test_fingers_go_from_shape_to_shape(tmp_path: Path) -> None:
    clip = annotated(
        tmp_path,
        """
        [[fingers]]
        hand = "left"
        shape = "open"
        from = 0.5
        to = 1.0
        [[fingers]]
        hand = "left"
        shape = "around"
        diameter = 0.03
        from = 1.5
        to = 2.0
        [[fingers]]
        hand = "left"
        shape = "relaxed"
        from = 3.0
        to = 3.5
        """,
    )
    knuckle, middle = INDEX["left_index_proximal"], INDEX["left_index_intermediate"]
    turned = to_rotation_vector(clip.rotations[:, [knuckle, middle]])
    bent = np.degrees(turned[..., 2].sum(axis=-1))  # fingers of the left hand bend about +z
    assert bent[at(1.2)] < 40.0 < 44.0 < bent[0] < 60.0 < 100.0 < bent[at(2.5)]
    np.testing.assert_allclose(bent[at(2.0) : at(3.0)], bent[at(2.5)])
    np.testing.assert_allclose(
        clip.rotations[-1, list(fingers("left"))], captured().rotations[0, list(fingers("left"))]
    )
    np.testing.assert_array_equal(
        clip.rotations[:, list(fingers("right"))], captured().rotations[:, list(fingers("right"))]
    )


def test_a_fist_is_more_closed_than_a_hand_around_something(tmp_path: Path) -> None:
    def closure(shape: str) -> float:
        clip = annotated(tmp_path, f'[[fingers]]\nhand = "right"\n{shape}\nto = 1.0')
        links = [INDEX[f"right_{finger}_{joint}"] for finger in ("index", "ring") for joint in ("proximal", "distal")]
        return float(np.linalg.norm(to_rotation_vector(clip.rotations[-1, links]), axis=-1).sum())

    assert closure('shape = "fist"') > closure('shape = "around"\ndiameter = 0.05') > closure('shape = "open"') + 0.5


def test_a_hand_meets_the_site_and_goes_on_as_it_was_captured(tmp_path: Path) -> None:
    """The site's x points to the left of the human: a path ahead in the capture is one to its -y there."""
    clip = annotated(
        tmp_path,
        """
        [site]
        facing_deg = 90
        [[hand]]
        hand = "right"
        at = [0.01, 0.02, 0.03]
        from = 1.0
        to = 3.0
        ease = 0.5
        """,
    )
    assert clip.targets is not None
    target = clip.targets[:, RIGHT_HAND]
    palm = grips(SKELETON, clip.rotations, clip.root)[:, RIGHT_HAND]
    np.testing.assert_allclose(target[at(1.0), :3], [0.01, 0.02, 0.03], atol=1e-12)
    way = palm[at(2.0), :3] - palm[at(1.0), :3]
    assert way[0] > 0.1
    np.testing.assert_allclose(target[at(2.0), :3] - target[at(1.0), :3], [way[1], -way[0], way[2]], atol=1e-12)
    back = from_axis_angle(UP, np.radians(90.0))
    thumb = rotate(multiply(back, target[at(2.0), 3:7]), UP)
    np.testing.assert_allclose(thumb, rotate(palm[at(2.0), 3:], UP), atol=1e-12)
    np.testing.assert_allclose(target[at(1.0) : at(3.0) + 1, 7], 1.0)
    np.testing.assert_allclose(target[[at(0.5), at(3.5)], 7], 0.0, atol=1e-12)
    assert not clip.targets[:, LEFT_HAND].any()


def test_the_gaze_is_on_a_place_or_on_what_a_hand_is_on(tmp_path: Path) -> None:
    clip = annotated(
        tmp_path,
        """
        [[hand]]
        hand = "right"
        from = 2.0
        to = 3.0
        [[gaze]]
        at = [0.0, 0.0, 0.5]
        from = 0.5
        to = 1.0
        weight = 0.6
        [[gaze]]
        on = "right"
        from = 2.0
        to = 3.0
        """,
    )
    assert clip.targets is not None
    gaze = clip.targets[:, GAZE]
    np.testing.assert_allclose(gaze[at(0.7)], [0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 0.6])
    np.testing.assert_allclose(gaze[at(2.5), :3], clip.targets[at(2.5), RIGHT_HAND, :3])
    assert gaze[at(1.5), 7] == 0.0


def test_a_foot_is_said_to_bear_or_not(tmp_path: Path) -> None:
    clip = annotated(tmp_path, '[[contact]]\nfoot = "left"\nbears = false\nfrom = 1.0\nto = 2.0')
    assert (clip.contacts[:, 0] == 1.0).all()
    assert not clip.contacts[at(1.0) : at(2.0) + 1, 1].any()
    assert clip.contacts[at(0.9), 1] == clip.contacts[at(2.1), 1] == 1.0


def test_the_clip_is_put_where_the_object_was(tmp_path: Path) -> None:
    """The object looked the human in the face: in its frame the human faces its -x, the hips where the table says."""
    clip = annotated(tmp_path, "[object]\nfacing_deg = 180\nhips = [0.4, 0.1]\nat = 2.0")
    assert clip.header.frame == "object"
    np.testing.assert_allclose(clip.root[at(2.0), :2], [0.4, 0.1], atol=1e-12)
    np.testing.assert_allclose(clip.root[:, 2], captured().root[:, 2])
    np.testing.assert_allclose(rotate(clip.rotations[0, 0], np.array([0.0, 0.0, -1.0])), [-1.0, 0.0, 0.0], atol=1e-12)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "[[importance]]\njoints = { tail = 1.0 }",
            r"importance\[0\].joints: no 'tail'; all, root, trunk, right_fingers",
        ),
        ("[[importance]]\njoints = { head = -1.0 }", r"importance\[0\].joints.head: -1.0; it must not be negative"),
        ('[[fingers]]\nhand = "right"\nshape = "around"', r'fingers\[0\]: a diameter > 0 goes with shape "around"'),
        ('[[fingers]]\nhand = "right"\nshape = "fist"\ndiameter = 0.1', r"fingers\[0\]: a diameter > 0 goes with"),
        ('[[hand]]\nhand = "middle"', r"'middle'.*\$\.hand\[0\]\.hand"),
        ("[[gaze]]\nwhere = [0, 0, 0]", r"unknown field `where`.*\$\.gaze\[0\]"),
        ("[keep", "raise.annotation.toml: "),
    ],
)
def test_what_is_wrong_is_said_with_its_place(tmp_path: Path, text: str, message: str) -> None:
    with pytest.raises(DataError, match=message):
        annotated(tmp_path, text)


def test_a_table_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(DataError, match=r"none\.toml: can't be read: No such file"):
        load_table(tmp_path / "none.toml")


def test_an_annotated_clip_can_be_saved(tmp_path: Path) -> None:
    clip = annotated(tmp_path, '[[hand]]\nhand = "left"\nfrom = 1.0\nto = 2.0\n[[gaze]]\non = "left"')
    save(clip, tmp_path / "raise.npz")
    assert load(tmp_path / "raise.npz").targets is not None
