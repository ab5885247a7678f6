"""A manual that was handed over is opened and read by who has it now, at whichever margin they hold it."""

from __future__ import annotations

from pathlib import Path

import pytest

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


@pytest.mark.parametrize("hand", [" hand left", pytest.param("", marks=pytest.mark.long)])
def test_a_manual_is_opened_where_the_other_hand_comes_to_its_pages(hand: str, tmp_path: Path) -> None:
    recording, mains = play(tmp_path, SCRIPT.format(hand=hand))
    assert [main["messages"] for main in mains] == [[], []]
    states = states_of(recording, ("manual",))["manual"]
    pages = [state["page"] for state in states]
    assert sorted(set(pages)) == [0.0, 1.0, 2.0]
    assert states[-1]["cover"] == "open"
