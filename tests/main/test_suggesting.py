"""Names as a sentence lists them."""

from __future__ import annotations

import pytest

from ahmss.main.suggesting import some


@pytest.mark.parametrize(
    ("names", "said"),
    [
        ([], "none"),
        (["room/cup", "room/tap"], "room/cup, room/tap"),
        ([f"panel/lever_{i + 1}" for i in range(10)], "panel/lever_1 to _10"),
        (["a_1", "a_2", "b_3", "b_4", "b_9", "c"], "a_1, a_2, b_3 to _9, c"),
        (["lever_1", "levers_2", "lever", "7", "_1"], "lever_1, levers_2, lever, 7, _1"),
        ([chr(97 + i) for i in range(15)], "a, b, c, d, e, f, g, h, i, j, k, l and 3 more"),
        ([f"a_{i}" for i in range(4)] + [chr(98 + i) for i in range(13)],
         "a_0 to _3, b, c, d, e, f, g, h, i, j, k, l and 2 more"),
    ],
)  # fmt: skip
def test_numbered_ones_in_a_row_stand_for_all_and_the_rest_is_counted(names: list[str], said: str) -> None:
    assert some(names) == said
