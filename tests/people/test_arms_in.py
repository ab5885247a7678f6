"""Who passes somebody closely keeps the arms in, so that no hand swings where another's is."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, rotate, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.main.play import PlaySetup, play_script
from ahmss.motion.edit import floor_frame
from ahmss.motion.way import ways_of
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import skin_of
from ahmss.skills.arms_in import ArmsIn
from ahmss.walking.library import RATE
from ahmss.walking.walkers import Walker
from tests.demo.recorded import Recorded
from tests.walking import measures as m

UP = np.array([0.0, 0.0, 1.0])
SIDES = ("right", "left")
ARMS = [INDEX[f"{side}_{link}"] for side in SIDES for link in ("upper_arm", "lower_arm", "hand")]
PIECE, SHOWN = 30, 17  # frames that are handed out at once, and that are shown of every second piece
SCRIPT = """
add floor
human ken body ken at -0.45 1.48 facing 131
human aiko body aiko at -1.20 -0.98 facing -147
ken: do floor walk to 0.62 -1.42
ken: do floor walk to -0.45 1.48
aiko: do floor walk to 1.11 1.07
aiko: do floor walk to -1.20 -0.98
"""


@cache
def walked(name: str) -> tuple[Array, Array]:
    """Four metres straight ahead: rotations (F, 43, 4) and root (F, 3)."""
    walk, _ = m.walked(m.Goal(name, 0.0, 4.0, 0.0, 0.0))
    return walk.rotations, walk.root


def rows_of(name: str, degrees: float, at: tuple[float, float], when: int) -> Array:
    """POSE rows (F, 272) of that walk turned so, its hips at a place in a frame."""
    rotations, root = (rows.copy() for rows in walked(name))
    turn = from_axis_angle(UP, np.radians(degrees))
    rotations[:, 0] = multiply(turn, rotations[:, 0])
    root = rotate(turn, root)
    root[:, :2] += np.array(at) - root[when, :2]
    rows = np.zeros((len(root), 272))
    rows[:, 1:4], rows[:, 4:176] = root, rotations.reshape(-1, 172)
    rows[:, 260:] = ways_of(root[:, :2], 0, len(root), RATE).reshape(-1, 12)
    return rows


def past(name: str, rows: Array, other: Array) -> Array:
    """The rows with arms kept in past another's, in pieces, of some of which only the first frames are shown."""
    arms, made, begun = ArmsIn(m.subject(name).skeleton, RATE, SIDES), list[Array](), 0
    while begun < len(rows):
        seen = other[min(max(begun - 1, 0), len(other) - 1)]
        piece = arms.over(rows[begun : begun + PIECE], [Walker(seen[1:3], np.zeros(2), way=seen[260:].reshape(6, 2))])
        if len(made) % 2 and len(piece) > SHOWN:
            piece = piece[:SHOWN]
            arms.keep(SHOWN)
        made.append(piece)
        begun += len(piece)
    return np.concatenate(made)


def poses(rows: Array) -> tuple[Array, Array]:
    return rows[:, 4:176].reshape(-1, 43, 4), rows[:, 1:4]


def gap(one: tuple[str, Array], other: tuple[str, Array]) -> float:
    """How near the skin of one's forearms and hands comes to the other's, metres."""
    shown = [[skin_of(Reacher.of(m.subject(name).skeleton, side), *poses(rows)) for side in SIDES]
             for name, rows in (one, other)]  # fmt: skip
    least = np.inf
    for own, own_radii in shown[0]:
        for theirs, radii in shown[1]:
            for k in range(min(len(own), len(theirs))):
                away = np.linalg.norm(own[k][:, None] - theirs[k], axis=-1) - own_radii[:, None] - radii
                least = min(least, float(away.min()))
    return least


def fastest(rows: Array) -> float:
    """How fast a link of an arm turns at the most, radians a frame."""
    turns = poses(rows)[0][:, ARMS]
    return float(np.linalg.norm(to_rotation_vector(multiply(conjugate(turns[:-1]), turns[1:])), axis=-1).max())


@pytest.mark.parametrize(
    ("names", "degrees", "when", "at"),
    [
        (("ken", "ken"), 0.0, 130, (0.54, 0.43)),  # side by side, half a stride apart
        (("ken", "aiko"), 19.0, 112, (0.02, 0.63)),
        (("ken", "aiko"), -15.0, 112, (0.13, -0.51)),
        (("ken", "ken"), -14.0, 122, (0.3, -0.85)),
    ],
)
def test_no_hand_swings_where_another_is(
    names: tuple[str, str], degrees: float, when: int, at: tuple[float, float]
) -> None:
    one, other = rows_of(names[0], 0.0, (0.0, 0.0), 130), rows_of(names[1], degrees, at, when)
    assert gap((names[0], one), (names[1], other)) < 0.015  # hips as far apart as walkers keep them
    kept = past(names[0], one, other), past(names[1], other, one)
    assert gap((names[0], kept[0]), (names[1], kept[1])) > 0.3
    assert gap((names[0], kept[0]), (names[1], other)) > 0.15  # even where the other does not
    for before, after in zip((one, other), kept, strict=True):
        assert fastest(after) < fastest(before) + 1e-3


def swing(name: str, rows: Array, side: int) -> float:
    """How far a hand swings along the way past the hips, metres."""
    place, turn = floor_frame(*poses(rows))
    palm = grips(m.subject(name).skeleton, *poses(rows))[:, side, :3]
    return float(np.ptp(rotate(conjugate(turn), palm - place)[:, 0]))


def test_the_arm_beside_somebody_is_kept_in_and_the_other_swings() -> None:
    one, other = rows_of("ken", 0.0, (0.0, 0.0), 130), rows_of("aiko", 0.0, (0.0, 0.75), 130)
    kept, whole = past("ken", one, other), slice(60, 220)
    assert swing("ken", one[whole], 0) > 0.4
    assert swing("ken", kept[whole], 0) > 0.4
    assert swing("ken", one[whole], 1) > 0.4
    assert swing("ken", kept[whole], 1) < 0.15


def test_arms_swing_as_ever_where_nobody_is_near() -> None:
    one, other = rows_of("ken", 0.0, (0.0, 0.0), 130), rows_of("aiko", 180.0, (0.0, 1.5), 130)
    np.testing.assert_array_equal(past("ken", one, other), one)
    np.testing.assert_array_equal(ArmsIn(Skeleton.of(1.7), RATE, SIDES).over(one, []), one)


@pytest.mark.long
def test_two_who_cross_on_a_bare_floor_keep_their_hands_apart(tmp_path: Path) -> None:
    (tmp_path / "script.txt").write_text(SCRIPT)
    recording = tmp_path / "run.rec"
    report = play_script(tmp_path / "script.txt", PlaySetup(workspace=m.ROOT, fast=True, record=recording))
    assert report.failures == 0
    shown = []
    for name in m.HUMANS:
        one = Recorded.read(recording, name, ())
        rows = np.zeros((len(one.root), 272))
        rows[:, 1:4], rows[:, 4:176] = one.root, one.rotations.reshape(-1, 172)
        shown.append((name, rows))
    assert gap(*shown) > 0.1
