"""Who has played a script is told how to see it."""

from __future__ import annotations

from pathlib import Path

from ahmss.main.play import PlaySetup
from ahmss.main.seeing import how_to_see

SCRIPT, KEPT = Path("examples/table.txt"), Path("out/run.rec")


def test_without_a_recording_it_is_played_once_more_with_one() -> None:
    told = how_to_see(SCRIPT, PlaySetup(), window=False)
    assert told == (
        "to see it: ahmss play examples/table.txt --record table.rec, then ahmss view table.rec --sheet table.png, "
        "or a film: --record table.mp4"
    )
    assert how_to_see(SCRIPT, PlaySetup(), window=True).endswith("then ahmss view table.rec")


def test_a_recording_is_viewed_and_a_server_looked_at() -> None:
    told = how_to_see(SCRIPT, PlaySetup(record=KEPT), window=False)
    assert told == "to see it: ahmss view out/run.rec --sheet run.png, or a film: --record run.mp4"
    told = how_to_see(SCRIPT, PlaySetup(server="127.0.0.1:7417"), window=False)
    assert told == "to see the world: ahmss view --server 127.0.0.1:7417 --sheet sheet.png"
