"""touch_type and typed: each key in its middle, by the finger that has it, no other one, at a typist's rate."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import msgspec
import numpy as np
import pytest

from ahmss.algorithm import HumanPose, HumanTask, Transform, frames
from ahmss.algorithm.messages import Start
from ahmss.body.array import Array
from ahmss.body.fingertip import pad
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.errors import AlgorithmError
from ahmss.skills.keystrokes import Stroke, keys_of, strokes_of

from .devices import SIDES, at, before, begun, device, mover, posed
from .scene import WORKSPACE, Body, program, record

FINGERS = ("thumb", "index", "middle", "ring", "little")
KEYS = keys_of(WORKSPACE.objects.get("keyboard").properties, "keyboard")
TOPS = np.array([0.0, 0.0, 0.02])
ALL = "THE QUICK BROWN FOX JUMPS OVER A LAZY DOG 1234567890-=[];',./"


class Desk:
    """A keyboard on a desk somewhere, and somebody who stands before it."""

    def __init__(self, seed: int, name: str = "", *, height: float | None = None, away: float | None = None) -> None:
        random = np.random.default_rng(seed)
        high, turn = random.uniform(0.84, 0.96), random.uniform(-np.pi, np.pi)
        self.frame = at(1.0, 2.0, high if height is None else height, turn)
        far, aside, turned = random.uniform(0.33, 0.4), random.uniform(-0.04, 0.04), random.uniform(-6.0, 6.0)
        name = name or ("ken", "aiko")[seed % 2]
        self.body = before(name, self.frame, far if away is None else away, aside, turned)
        self.notes: list[str] = []

    def typed(self, text: str, **given: Any) -> tuple[Body, Start, list[HumanPose]]:
        start = begun(self.body, device("keyboard", self.frame), "keys", {"text": text}, **given)

        def noted(task: HumanTask) -> Iterator[Any]:
            yield from program("touch_type")(task)
            self.notes.extend(task.notes)

        return self.body, start, self.body.do(noted, start)

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


def judge(seed: int, text: str, name: str = "", **given: float) -> None:
    """Type it, and compare what fingers do with the strokes that they are to make."""
    desk = Desk(seed, name, **given)
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


@pytest.mark.parametrize("name", ["aiko", pytest.param("ken", marks=pytest.mark.long)])
def test_all_keys_of_a_text_are_reached_on_a_low_desk(name: str) -> None:
    judge(4, "QUICK BROWN FOX 1234567890", name, height=0.72, away=0.4)


@pytest.mark.long
@pytest.mark.parametrize("away", [0.3, 0.5, 0.6])
@pytest.mark.parametrize("height", [0.62, 0.72, 0.8, 1.0])
@pytest.mark.parametrize("name", ["ken", "aiko"])
def test_all_keys_are_reached_from_where_one_stands(name: str, height: float, away: float) -> None:
    judge(5, ALL, name, height=height, away=away)


def test_where_keys_would_stay_up_it_is_refused_with_which_and_by_how_much() -> None:
    """A text without some of its letters was typed, and a note told which were left out."""
    desk = Desk(1, "aiko", height=0.88, away=0.9)
    told = r"^it can't be typed from here, as digit_\d,.* would stay up, up to [1-5]?\d mm out of reach of .* nearer"
    with pytest.raises(AlgorithmError, match=told):
        desk.typed("FOX 1234567890")
    body, start, shown = desk.typed("FOX")  # these are in reach
    assert [states["text"] for states in desk.told(body, start, shown) if "text" in states][-1] == "FOX"


def test_where_keys_would_stay_up_one_steps_to_where_none_does() -> None:
    desk = Desk(1, "aiko", height=0.88)
    desk.body = before("aiko", desk.frame, 0.36 + 0.098, 0.0, 14.0)
    motion = str(WORKSPACE.objects.get("latching_button").affordances["press"].motion)
    body, start, shown = desk.typed("1234567890", motion=motion)
    assert [states["text"] for states in desk.told(body, start, shown) if "text" in states][-1] == "1234567890"


def test_where_no_key_is_reached_one_does_not_type_in_the_air() -> None:
    with pytest.raises(AlgorithmError, match=r"digit_1 would stay up, up to \d+ mm out of reach|too short"):
        Desk(1, "aiko", height=0.88, away=1.0).typed("1")


def test_who_stands_elsewhere_steps_before_the_keys() -> None:
    desk = Desk(6, "ken", away=1.3)
    body, start, shown = desk.typed(
        "HELLO 7", motion=str(WORKSPACE.objects.get("latching_button").affordances["press"].motion)
    )
    assert [states["text"] for states in desk.told(body, start, shown) if "text" in states][-1] == "HELLO 7"
    stood = desk.frame.inverse().apply(body.root)
    assert 0.25 < stood[0] < 0.55
    assert abs(stood[1]) < 0.08


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


@pytest.mark.parametrize("aside", [0.36, -0.36])
def test_from_far_aside_nobody_types_other_keys_than_those_of_the_text(aside: float) -> None:
    desk = Desk(0, "ken", height=0.77)
    desk.body = before("ken", desk.frame, 0.36, aside, 0.0)
    with pytest.raises(AlgorithmError, match=r"can't be typed from here, as fingers would press (\w+, )+.* nearer"):
        desk.typed("PUMP 3 ON")


def test_fingers_that_would_jump_are_refused() -> None:
    desk = Desk(0, "ken", height=0.77)
    desk.body = before("ken", desk.frame, 0.36, 0.3, 0.0)
    with pytest.raises(AlgorithmError, match=r"can't be typed from here, as fingers would jump by \d\d degrees; "):
        desk.typed("PUMP 3 ON")


def test_a_thing_where_one_would_stand_is_named_before_a_step_is_taken() -> None:
    desk = Desk(6, "ken", away=1.3)
    corners = 0.45 * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
    place = desk.frame.apply(np.array([0.76, 0.0, 0.0]))
    trunk = record("room/sink", Transform(np.append(place[:2], 0.0), np.array([1.0, 0.0, 0.0, 0.0])))
    trunk = msgspec.structs.replace(trunk, id=12, name="trunk", footprint=[[tuple(at) for at in corners.tolist()]])
    motion = str(WORKSPACE.objects.get("latching_button").affordances["press"].motion)
    with pytest.raises(AlgorithmError, match=r"^one would stand 0\.\d\d m aside of .*; trunk stands before it: move"):
        desk.typed("HELLO", motion=motion, world=[trunk])
    assert (desk.body.root[:2] == Desk(6, "ken", away=1.3).body.root[:2]).all()
