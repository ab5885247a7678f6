"""touch_type and typed: each key in its middle, by the finger that has it, no other one, at a typist's rate."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from ahmss.algorithm import HumanPose, Transform, frames
from ahmss.algorithm.keystrokes import Stroke, keys_of, strokes_of
from ahmss.algorithm.messages import Start
from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.errors import AlgorithmError
from ahmss.grasping.fingertips import pad

from .devices import SIDES, at, before, begun, device, mover, posed
from .scene import WORKSPACE, Body, program

FINGERS = ("thumb", "index", "middle", "ring", "little")
KEYS = keys_of(WORKSPACE.objects.get("keyboard").properties, "keyboard")
TOPS = np.array([0.0, 0.0, 0.02])
ALL = "THE QUICK BROWN FOX JUMPS OVER A LAZY DOG 1234567890-=[];',./"


class Desk:
    """A keyboard on a desk somewhere, and somebody who stands before it."""

    def __init__(self, seed: int, name: str = "") -> None:
        random = np.random.default_rng(seed)
        self.frame = at(1.0, 2.0, random.uniform(0.84, 0.96), random.uniform(-np.pi, np.pi))
        self.body = before(
            name or ("ken", "aiko")[seed % 2], self.frame, random.uniform(0.33, 0.4), random.uniform(-0.04, 0.04),
            random.uniform(-6.0, 6.0),
        )  # fmt: skip

    def typed(self, text: str) -> tuple[Body, Start, list[HumanPose]]:
        start = begun(self.body, device("keyboard", self.frame), "keys", {"text": text})
        return self.body, start, self.body.do("touch_type", start)

    def told(self, body: Body, start: Start, shown: list[HumanPose]) -> list[dict[str, Any]]:
        """What the keyboard says at each frame."""
        return [dict(pose.states) for pose in frames(program("typed"), mover(body, start), body.rows(shown))]

    def pads(self, body: Body, shown: list[HumanPose]) -> dict[tuple[str, str], Array]:
        """The pads (F, 3) of all fingers, from the middle of the keys' tops: to who types, to the right, up."""
        places, turned = posed(body, shown)
        back, down = self.frame.inverse(), -rotate(self.frame.rotation, np.array([0.0, 0.0, 1.0]))
        out: dict[tuple[str, str], Array] = {}
        for side in SIDES:
            for finger in FINGERS:
                link = INDEX[f"{side}_{finger}_distal"]
                tip = places[:, link] + rotate(turned[:, link], body.skeleton.tips[link])
                along = rotate(turned[:, link], np.array([1.0, 0.0, 0.0]))
                out[side, finger] = back.apply(pad(tip, along, float(body.skeleton.radii[link]), down)) - TOPS
        return out


def pressed(pads: dict[tuple[str, str], Array]) -> list[tuple[int, str, str, Array]]:
    """Each time that a pad is under the tops: the frame in which it is deepest, whose it is, where it is (3,)."""
    found: list[tuple[int, str, str, Array]] = []
    for (side, finger), pad_of in pads.items():
        on_board = (np.abs(pad_of[:, :2]) < (0.065, 0.155)).all(axis=1)
        under = np.flatnonzero((pad_of[:, 2] < -0.0005) & on_board)
        for run in np.split(under, np.flatnonzero(np.diff(under) > 1) + 1):
            if len(run):
                deepest = int(run[pad_of[run, 2].argmin()])
                found.append((deepest, side, finger, pad_of[deepest]))
    return sorted(found, key=lambda one: one[0])


def judge(seed: int, text: str) -> None:
    """Type it, and compare what fingers do with the strokes that they are to make."""
    desk = Desk(seed)
    body, start, shown = desk.typed(text)
    told = desk.told(body, start, shown)
    assert [states["text"] for states in told if "text" in states][-1] == text
    presses = pressed(desk.pads(body, shown))
    strokes: list[Stroke] = strokes_of(text, KEYS, np.random.default_rng(0), 0.0)
    assert [(side, finger) for _, side, finger, _ in presses] == [(stroke.side, stroke.finger) for stroke in strokes]
    for (_, _, _, place), stroke in zip(presses, strokes, strict=True):
        half = np.maximum(0.5 * (stroke.key.size - stroke.key.size.min()), 0.0)
        assert np.hypot(*np.maximum(np.abs(place[:2] - stroke.key.at) - half, 0.0)) < 0.002
        assert -0.0045 < place[2] < -0.003
    gaps = np.diff([frame for frame, *_ in presses]) / 60.0
    assert gaps.min() > 0.13
    assert gaps.max() < 0.3
    assert {states["key"] for states in told if "key" in states} == {"none", *(stroke.key.name for stroke in strokes)}


@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_a_word_is_typed(name: str) -> None:
    judge(("ken", "aiko").index(name), "START")


@pytest.mark.parametrize("seed", [pytest.param(seed, marks=pytest.mark.long) for seed in range(2, 32)])
def test_any_word_is_typed(seed: int) -> None:
    random = np.random.default_rng(seed)
    judge(seed, "".join(random.permutation(list(ALL.replace(" ", "")))[:16]))


@pytest.mark.parametrize("seed", [0, pytest.param(1, marks=pytest.mark.long)])
def test_all_keys_are_reached(seed: int) -> None:
    judge(seed, ALL)


def test_enter_sends_the_line_and_back_takes_a_letter_away() -> None:
    desk = Desk(0)
    told = desk.told(*desk.typed("OM<back>K<enter>"))
    assert [states["text"] for states in told if "text" in states] == ["O", "OM", "O", "OK", ""]
    assert [states["entered"] for states in told if "entered" in states] == ["OK"]


def test_small_letters_are_written_as_capitals_and_others_are_refused() -> None:
    assert [s.key.writes for s in strokes_of("ab", KEYS, np.random.default_rng(0), 0.0)] == ["A", "B"]
    with pytest.raises(AlgorithmError, match=r'no key for "ä"; it has: .*ABC.*XYZ.*, the space, <enter>'):
        Desk(0).typed("Bär")


def test_the_space_is_the_thumbs_of_the_hand_that_rests() -> None:
    strokes = strokes_of("A P ", KEYS, np.random.default_rng(0), 0.0)
    assert [(stroke.side, stroke.finger) for stroke in strokes] == [
        ("left", "little"), ("right", "thumb"), ("right", "little"), ("left", "thumb"),
    ]  # fmt: skip


def test_a_full_hand_and_one_who_walks_do_not_type() -> None:
    body = Desk(0).body
    thing = device("keyboard", Desk(0).frame)
    with pytest.raises(AlgorithmError, match="takes both hands; the left one holds something"):
        list(frames(program("touch_type"), begun(body, thing, "keys", {"text": "A"}, busy=["left"])))
    with pytest.raises(AlgorithmError, match="standing or sitting"):
        list(frames(program("touch_type"), begun(body, thing, "keys", {"text": "A"}, carried=True)))


def test_out_of_reach_is_refused() -> None:
    frame = at(0.0, 0.0, 0.88)
    body = before("aiko", frame, 1.5)
    with pytest.raises(AlgorithmError, match="too short"):
        list(frames(program("touch_type"), begun(body, device("keyboard", frame), "keys", {"text": "A"})))


def test_the_fingers_at_home_are_over_their_keys() -> None:
    """Before the first stroke, and after the last one."""
    desk = Desk(1)
    body, _, shown = desk.typed("J")
    pads = desk.pads(body, shown)
    height = pads["left", "index"][:, 2]
    low = int(np.flatnonzero(np.abs(height - 0.007) < 0.0002)[3])  # on the way up the hand only passes there
    for side, letters in (("left", "FDSA"), ("right", "JKL;")):
        for finger, letter in zip(FINGERS[1:], letters, strict=True):
            key = next(key for key in KEYS.values() if key.writes == letter)
            off = pads[side, finger][low] - (*key.at, 0.007)
            assert np.linalg.norm(off) < 0.003


def test_the_keyboard_tilted_is_typed_on_as_well() -> None:
    desk = Desk(0)
    tilt = Transform(np.zeros(3), np.array([np.cos(0.06), 0.0, np.sin(0.06), 0.0]))
    desk.frame = desk.frame.then(tilt)
    assert [states["text"] for states in desk.told(*desk.typed("HI")) if "text" in states][-1] == "HI"
