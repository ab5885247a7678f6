"""A manual that was handed over is opened and read by who has it now, at whichever margin they hold it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, rotate
from tests.demo.recorded import Recorded
from tests.demo.scenario import states_of

from .test_handing import play

SCRIPT = """
add floor
add desk at 0.75 0 0 facing 180
add manual at 0.46 0 0.72 facing 180
human ken body ken at 0 0 facing 0
human aiko body aiko at -0.6 0.9 facing 300
ken: do manual take hand left
sync
ken: do aiko hand_over
aiko: do ken receive{hand}
sync
aiko: do manual open
aiko: do manual turn
"""


@pytest.mark.long
@pytest.mark.parametrize("hand", [" hand left", ""])
def test_a_manual_is_opened_where_the_other_hand_comes_to_its_pages(hand: str, tmp_path: Path) -> None:
    recording, mains = play(tmp_path, SCRIPT.format(hand=hand))
    assert [main["messages"] for main in mains] == [[], []]
    states = states_of(recording, ("manual",))["manual"]
    pages = [state["page"] for state in states]
    assert sorted(set(pages)) == [0.0, 1.0, 2.0]
    assert states[-1]["cover"] == "open"
    aiko = Recorded.read(recording, "aiko", ("manual",))
    palms = np.stack([aiko.grip(side).rotation for side in (0, 1)])
    cos = np.abs((palms[:, 1:] * palms[:, :-1]).sum(axis=-1))
    assert np.degrees(2.0 * np.arccos(np.clip(cos, 0.0, 1.0))).max() < 8.5


BACK = """
add floor
add table at 1.0 0 0 facing 180
add manual at 0.55 0.0 0.88 facing 180
human aiko body aiko at 0.2 0 facing 0
human ken body ken at -1.67 -0.24 facing -12
aiko: do manual take hand right
sync
aiko: do ken hand_over
ken: do aiko receive
sync
ken: do aiko hand_over
aiko: do ken receive
sync
aiko: wait 1
"""


def test_what_was_received_goes_with_the_hand_and_is_given_straight_back(tmp_path: Path) -> None:
    recording, mains = play(tmp_path, BACK)
    assert [main["messages"] for main in mains] == [[], []]
    ken = Recorded.read(recording, "ken", ("manual",))
    has = np.flatnonzero(np.array(ken.holders["manual"]) == "ken")
    assert ken.holders["manual"][-1] == "aiko"
    at, palm = ken.object("manual").place[has[3:]], ken.grip(0)
    inner = rotate(conjugate(palm.rotation[has[3:]]), at - palm.place[has[3:]])
    assert np.ptp(at, axis=0).max() > 0.1  # it was drawn near
    assert np.linalg.norm(np.diff(inner, axis=0), axis=1).max() < 0.001
    assert np.ptp(inner, axis=0).max() < 0.01


AGAIN = """
add floor
add table at 1.0 0 0 facing 180
add manual at 0.55 0.0 0.88 facing 180
human ken body ken at 0.2 0 facing 0
human aiko body aiko at -1.6 0.3 facing 0
ken: do manual take hand left
sync
ken: do aiko hand_over
aiko: do ken receive
sync
aiko: do manual open
sync
aiko: do ken hand_over
ken: do aiko receive
sync
ken: do manual turn
"""


@pytest.mark.long
def test_a_leaf_of_what_was_given_back_goes_with_thumb_and_finger(tmp_path: Path) -> None:
    recording, mains = play(tmp_path, AGAIN)
    assert [main["messages"] for main in mains] == [[], []]
    ken = Recorded.read(recording, "ken", ("manual",))
    turn = np.array([state.get("turn", 0.0) for state in states_of(recording, ("manual",))["manual"]], float)
    has = np.array(ken.holders["manual"]) == "ken"
    led = np.flatnonzero((turn > 0.001) & (turn < 0.3) & has)
    assert len(led) > 25
    hinge, corner, angle = (
        np.array([0.0, -0.09, 0.0075]),
        np.array([0.055, 0.084, 0.007]),
        np.radians(358.0) * turn[led],
    )
    off = corner - hinge
    swung = np.stack([
        np.full(len(led), off[0]), np.cos(angle) * off[1] - np.sin(angle) * off[2],
        np.sin(angle) * off[1] + np.cos(angle) * off[2],
    ], axis=-1)  # fmt: skip
    book = ken.object("manual")
    at = book.place[led] + rotate(book.rotation[led], hinge + swung)
    places, turned = ken.links
    tips = [INDEX[f"left_{finger}_distal"] for finger in ("thumb", "index")]
    pinch = np.mean([places[led, i] + rotate(turned[led, i], ken.skeleton.tips[i]) for i in tips], axis=0)
    assert np.linalg.norm(pinch - at, axis=1).max() < 0.012
