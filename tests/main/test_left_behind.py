"""Who is told of somebody whose main is gone is told that, too."""

from __future__ import annotations

import math

import pytest

from ahmss.main.left_behind import with_left_behind
from ahmss.world.schema import HumanRecord

KEN, AIKO = HumanRecord(1, "ken", "ken", leaves_s=10.0), HumanRecord(2, "aiko", "aiko")
STOOD = HumanRecord(3, "bo-2", "ken", leaves_s=math.inf)
TOLD = "; the main that moved ken is gone, and ken leaves within 10 s: do it again then"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("ken stands in the way, where one is to stand (1 2), and does not go; ask them to move",
         f"ken stands in the way, where one is to stand (1 2), and does not go{TOLD}"),
        ("ken stands in the way and does not go; take another way, or ask them to move",
         f"ken stands in the way and does not go; take another way{TOLD}"),
        ("ken stands in the way and does not go; take another way, or ask them to move, as by `ken: do x`",
         f"ken stands in the way and does not go; take another way{TOLD}"),
        ("floor walk: waits for ken, who is in the way", f"floor walk: waits for ken, who is in the way{TOLD}"),
        ("bo-2 is in the way", "bo-2 is in the way; nobody moves bo-2 any more: `ahmss main --human bo-2` does"),
    ],
)  # fmt: skip
def test_of_who_is_left_behind_it_is_told_when_they_leave(text: str, said: str) -> None:
    assert with_left_behind(text, [KEN, AIKO, STOOD], in_vain=True) == said
    waits = said.removesuffix(": do it again then")
    assert with_left_behind(text, [KEN, AIKO, STOOD], in_vain=False) == waits


@pytest.mark.parametrize("text", ["aiko does not go; ask them to move", "bo is in the way", "the token is taken", ""])
def test_of_others_nothing_is_added(text: str) -> None:
    assert with_left_behind(text, [KEN, AIKO, STOOD], in_vain=True) == text
