"""A cup goes from hand to hand: it is held at every frame, never jumps, and is refused where it can't be taken."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from ahmss.algorithm import Transform
from ahmss.body.array import Array
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, rotate
from ahmss.grasping.coming_off import coming_off
from ahmss.grasping.field import STEP, Field
from ahmss.grasping.hand import Hand
from ahmss.grasping.power import power_at
from ahmss.main.play import PlaySetup, play_script
from ahmss.motion.edit import floor_frame
from ahmss.motion.fingers import opened
from ahmss.motion.steps import finished
from ahmss.reaching.comfort import around_axis
from ahmss.reaching.goal import Goal
from ahmss.skills.beside_hand import in_their_hand
from tests.algorithms.scene import Body, module
from tests.demo.recorded import Recorded

ROOT = Path(__file__).resolve().parents[2]
SCENE = """
add floor
add table at 0.9 -0.1 0 facing 90
add cup at 0.42 -0.15 0.88
human ken body ken at 0 0 facing -20
human aiko body aiko at {aiko}
ken: do cup reach
ken: do cup grasp
ken: do cup lift
sync
"""
GIVEN = """
ken: do aiko hand_over
aiko: do ken receive{hand}
sync
aiko: do cup carry frames 30
"""
FINGERS = [f"{finger}_distal" for finger in ("thumb", "index", "middle", "ring", "little")]
JUMP = 0.001  # metres in a frame beyond what the hands move


def play(folder: Path, text: str, *, seed: int = 1) -> tuple[Path, list[dict[str, object]]]:
    (folder / "script.txt").write_text(text)
    recording = folder / "run.rec"
    report = play_script(folder / "script.txt", PlaySetup(workspace=str(ROOT), fast=True, seed=seed, record=recording))
    return recording, list(report.mains)


PLACES = [("-0.75 0.75 facing 250", " hand left"), pytest.param(("0.35 1.0 facing 240", ""), marks=pytest.mark.long)]
RADIUS, HIGH = 0.036, 0.095  # metres, of the cup


@pytest.fixture(scope="module", params=PLACES)
def given(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> tuple[Recorded, Recorded, str]:
    aiko, hand = request.param
    recording, mains = play(tmp_path_factory.mktemp("given"), SCENE.format(aiko=aiko) + GIVEN.format(hand=hand))
    assert [main["messages"] for main in mains] == [[], []]
    ken, aiko_ = (Recorded.read(recording, name, ("cup",)) for name in ("ken", "aiko"))
    return ken, aiko_, hand.split()[-1] if hand else "right"


def changed(ken: Recorded) -> int:
    """The first frame in which it is aiko's."""
    return ken.holders["cup"].index("aiko")


def test_it_changes_hands_in_one_frame_and_belongs_to_somebody_in_each(given: tuple[Recorded, Recorded, str]) -> None:
    holders = given[0].holders["cup"]
    first = holders.index("ken")
    last = len(holders) - holders[::-1].index("aiko")
    assert set(holders[first:last]) == {"ken", "aiko"}
    assert sum(a != b for a, b in zip(holders[first:last], holders[first + 1 : last], strict=False)) == 1


def test_it_never_jumps_more_than_the_hand_that_has_it_moves(given: tuple[Recorded, Recorded, str]) -> None:
    ken, aiko, side = given
    n, frame = min(len(ken.root), len(aiko.root)), changed(ken)
    cup = ken.object("cup").place[:n]
    # The right hand of ken took it; each palm carries what is in it, its turns included.
    for human, rows, hand in ((ken, slice(160, frame), 0), (aiko, slice(frame, n - 5), int(side == "left"))):
        grip = human.grip(hand)
        inner = rotate(conjugate(grip.rotation[:n]), cup - grip.place[:n])
        assert np.linalg.norm(np.diff(inner[rows], axis=0), axis=1).max() < JUMP
    assert np.linalg.norm(np.diff(cup[frame - 12 : frame + 6], axis=0), axis=1).max() < JUMP


def test_both_hands_are_at_it_when_it_changes_hands(given: tuple[Recorded, Recorded, str]) -> None:
    ken, aiko, side = given
    frame = changed(ken)
    wall = ken.object("cup").apply(np.array([0.0, 0.0, 0.052]))[frame]
    palms = [ken.grip(0).place[frame], aiko.grip(int(side == "left")).place[frame]]
    assert max(np.linalg.norm(palm - wall) for palm in palms) < 0.08
    out = [one.grip(hand).rotation[frame] for one, hand in ((ken, 0), (aiko, int(side == "left")))]
    ahead = np.array([1.0, 0.0, 0.0])
    # Palms that would be in each other look the same way; a left one comes from beside the right one that gives.
    assert rotate(out[0], ahead) @ rotate(out[1], ahead) < (0.3 if side == "right" else 0.75)


@pytest.mark.parametrize("who", ["ken", "aiko"])
def test_no_finger_is_ever_in_it(given: tuple[Recorded, Recorded, str], who: str) -> None:
    """The taker's came through its wall where the wrist could not turn as asked; the giver's as it was drawn away."""
    human = given[who == "aiko"]
    places, turned = human.links
    links = [INDEX[f"{side}_{finger}"] for side in ("right", "left") for finger in FINGERS]
    tips = places[:, links] + rotate(turned[:, links], human.skeleton.tips[links])
    cup = human.object("cup")
    seen = rotate(conjugate(cup.rotation)[:, None], tips - cup.place[:, None])
    within = (seen[..., 2] > 0.0) & (seen[..., 2] < HIGH)
    assert np.linalg.norm(seen[..., :2], axis=-1)[within].min() > RADIUS


def hand_of(human: Recorded, side: str, frame: int) -> tuple[Array, Array]:
    """The middles (m, 3) of the balls that fingers and palm are of, in the world, and their radii (m), metres."""
    hand, palm = Hand.of(human.skeleton, side), human.grip(int(side == "left"))
    middles, radii = hand.balls(human.rotations[frame, list(fingers(side))])
    at = Transform(palm.place[frame], palm.rotation[frame]).then(Transform.of(hand.grip).inverse())
    radii = np.concatenate([radii.ravel(), np.full(len(hand.palm), hand.palm_radius)])
    return at.apply(np.concatenate([middles.reshape(-1, 3), hand.palm])), radii


def test_no_hand_is_ever_in_the_other(given: tuple[Recorded, Recorded, str]) -> None:
    """Fingers were 10 to 15 mm in the other's palm, and swept through it as the giver's opened."""
    ken, aiko, side = given
    frame, deepest = changed(ken), -np.inf
    for k in range(frame - 90, frame + 90, 2):
        (own, wide), (other, thick) = hand_of(ken, "right", k), hand_of(aiko, side, k)
        apart = np.linalg.norm(own[:, None] - other, axis=2)
        deepest = max(deepest, float((wide[:, None] + thick - apart).max()))
    assert deepest < 0.002


def test_what_can_be_taken_from_the_giver_s_own_side_only_is_taken_from_there() -> None:
    """No palm is opposite theirs: then the one that is so least badly, rather than none."""
    body, place = Body("aiko"), np.array([0.4, 0.0, 1.0])
    turns = from_axis_angle(np.array([0.0, 0.0, 1.0]), np.array([0.0, 0.3]))
    palms = np.concatenate([np.tile(place, (2, 1)), turns], axis=1)
    goal = Goal(place, around=np.array([*place, 1.0, 0.0, 0.0, 0.0]), palms={"right": palms})
    start = SimpleNamespace(rotations=body.rotations, root=body.root)
    task = SimpleNamespace(human=body.skeleton, start=start, object=SimpleNamespace(place=place, properties={}))
    whom = SimpleNamespace(site=lambda *_: Transform(place, np.array([1.0, 0.0, 0.0, 0.0])))
    goals = finished(module("receive")._about(task, whom, "right", goal, None))
    assert all(len(one.palms["right"]) for one in goals)
    assert len(goals) == 3


def cup() -> Field:
    """Distances from a full cylinder about z, as large as the cup."""
    first, spacing = np.array([-0.07, -0.07, -0.03]), 0.002
    at = first + spacing * np.stack(np.indices((71, 71, 79)), axis=-1)
    out = np.stack([np.hypot(at[..., 0], at[..., 1]) - RADIUS, np.abs(at[..., 2] - 0.5 * HIGH) - 0.5 * HIGH])
    distance = np.minimum(out.max(axis=0), 0.0) + np.hypot(*np.maximum(out, 0.0))
    return Field(first, spacing, np.round(distance / STEP).astype(np.int16))


@pytest.mark.parametrize("giver", ["right", "left"])
def test_a_hand_closes_past_the_one_that_has_it_and_stays_out_of_its_way_back(giver: str) -> None:
    body, axis = Body("aiko"), Transform(np.array([0.0, 0.0, 0.052]), np.array([1.0, 0.0, 0.0, 0.0]))
    hand, palms = Hand.of(body.skeleton, "left"), around_axis(axis.row(), 1.0)
    palms = np.concatenate([np.tile(axis.place, (len(palms), 1)), palms], axis=1)
    # Behind the cup, a right hand that looks a little to the left, and a left one that looks to the right.
    turn = from_axis_angle(np.array([0.0, 0.0, 1.0]), np.array(np.pi + (0.5 if giver == "right" else -0.3)))
    theirs = Transform(axis.place - (RADIUS + 0.001) * rotate(turn, np.array([1.0, 0.0, 0.0])), turn)
    start = SimpleNamespace(rotations=body.rotations, root=body.root)
    world = Transform(np.zeros(3), np.array([1.0, 0.0, 0.0, 0.0]))
    task = SimpleNamespace(human=body.skeleton, start=start, object=SimpleNamespace(frame=world), site=axis)
    whom = SimpleNamespace(sites={}, site=lambda *_: theirs)
    held = finished(in_their_hand(task, whom, giver, cup()))  # type: ignore[arg-type]
    grips = finished(held.holdings(hand, palms, axis.row(), opened("left"), 0.03))
    assert grips
    other = Hand.of(body.skeleton, giver)
    shape = finished(power_at(other, held.thing, theirs.row(), axis.row())).shape
    for k, (back, shape_then) in enumerate([(0.0, shape), *((b, coming_off(other, shape)) for b in (0.0, 0.04, 0.08))]):
        away = theirs.apply(np.array([-back, 0.0, 0.0]))
        on = Transform(away, theirs.rotation).then(Transform.of(other.grip).inverse())
        middles, radii = other.balls(shape_then)
        skin = on.apply(middles.reshape(-1, 3)), radii.ravel()
        for grip in grips:
            at = Transform.of(grip.palm).then(Transform.of(hand.grip).inverse())
            own, wide = hand.balls(grip.shape)
            apart = np.linalg.norm(at.apply(own.reshape(-1, 3))[:, None] - skin[0], axis=2)
            assert (wide.ravel()[:, None] + skin[1] - apart).max() < 0.003, k


def test_they_stand_face_to_face_about_an_arm_apart(given: tuple[Recorded, Recorded, str]) -> None:
    ken, aiko, _ = given
    frame = changed(ken)
    (a, qa), (b, qb) = (floor_frame(one.rotations[frame], one.root[frame]) for one in (ken, aiko))
    assert 0.8 < np.linalg.norm(b - a) < 1.25
    assert aside(a, qa, b) < np.radians(35.0)
    assert aside(b, qb, a) < np.radians(35.0)


def aside(here: Array, turn: Array, there: Array) -> float:
    """How far aside of where one faces a place is, radians."""
    x, y, _ = rotate(conjugate(turn), there - here)
    return abs(float(np.arctan2(y, x)))


def test_the_giver_lets_go_only_afterwards_and_the_arm_goes_down(given: tuple[Recorded, Recorded, str]) -> None:
    ken, aiko, _ = given
    frame = changed(ken)
    fingers = slice(17, 29)  # index to little of the right hand
    still = multiply(conjugate(ken.rotations[frame - 5, fingers]), ken.rotations[frame, fingers])
    assert np.abs(still[:, 0]).min() > np.cos(np.radians(0.5))
    opened = multiply(conjugate(ken.rotations[frame, fingers]), ken.rotations[frame + 40, fingers])
    assert np.abs(opened[:, 0]).min() < np.cos(np.radians(15.0))
    assert ken.grip(0).place[min(len(ken.root), len(aiko.root)) - 1, 2] < 0.95


def test_what_can_not_be_is_refused_in_a_sentence_and_nothing_falls(tmp_path: Path) -> None:
    lines = (
        "ken: do aiko hand_over patience=1", "ken: do aiko receive", "ken: do aiko hand_over hand left", "sync",
        "aiko: do ken hand_over", "aiko: do ken receive patience=1", "sync", "ken: do cup carry frames 10",
    )  # fmt: skip
    recording, mains = play(tmp_path, SCENE.format(aiko="0.35 1.0 facing 240") + "\n".join(lines) + "\n")
    said = [[str(message).rpartition("txt:")[2] for message in main["messages"]] for main in mains]  # type: ignore[attr-defined]
    assert [len(messages) for messages in said] == [3, 2]
    assert said[0][0].endswith("aiko did not take cup within 1 s; it stays in the hand")
    assert said[0][1:] == [
        "12: aiko receive: aiko holds nothing",
        "13: aiko hand_over: ken holds nothing in the left hand",
    ]
    assert said[1][0] == "15: ken hand_over: aiko holds nothing"
    assert said[1][1].endswith("ken has not held out cup within 1 s")
    assert Recorded.read(recording, "ken", ("cup",)).holders["cup"][-80] == "ken"
    told = [[str(note).partition(": ")[2] for note in main["notes"]] for main in mains]  # type: ignore[attr-defined]
    assert told == [["waits for aiko to take cup"], ["waits for ken to hold cup out"]]


@pytest.mark.long
@pytest.mark.parametrize("seed", range(8))
def test_any_two_meet_from_anywhere(tmp_path: Path, seed: int) -> None:
    random = np.random.default_rng(seed)
    giver, taker = random.permutation(["ken", "aiko"])
    way, far = np.radians(random.uniform(90.0, 270.0)), random.uniform(0.95, 2.6)  # away from the table
    place = f"{far * np.cos(way):.2f} {far * np.sin(way):.2f} facing {random.uniform(0.0, 360.0):.0f}"
    hand = random.choice(["", " hand left", " hand right"])
    text = SCENE.format(aiko=place) + GIVEN.format(hand=hand)
    swapped = text.replace("ken", "X").replace("aiko", taker).replace("X", giver)
    recording, mains = play(tmp_path, swapped.replace("at 0.42 -0.15", "at 0.40 -0.13"), seed=seed)
    assert [main["messages"] for main in mains] == [[], []]
    gives, takes = (Recorded.read(recording, name, ("cup",)) for name in (giver, taker))
    frame, n = gives.holders["cup"].index(taker), min(len(gives.root), len(takes.root))
    cup = gives.object("cup").place[:n]
    for human, rows in ((gives, slice(160, frame)), (takes, slice(frame, n - 40))):
        moved: list[float] = []
        for palm in (human.grip(0), human.grip(1)):
            inner = rotate(conjugate(palm.rotation[:n]), cup - palm.place[:n])
            moved.append(float(np.linalg.norm(np.diff(inner[rows], axis=0), axis=1).max()))
        assert min(moved) < JUMP
