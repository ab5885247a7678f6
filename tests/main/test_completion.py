from collections.abc import Sequence
from typing import cast

import pytest

from ahmss.errors import CommandError
from ahmss.main.catalogue import WorldCatalogue
from ahmss.main.completion import candidates
from ahmss.main.dialogue import Listing


class Shelf:
    """A catalogue with two lamps, whose last part means neither."""

    def objects(self) -> Listing:
        return Listing("objects", tuple((name, "") for name in ("room", "room/cup", "room/lamp", "hall/lamp")))

    def actions(self, name: str) -> Listing:
        if name not in ("cup", "room/cup"):
            raise CommandError("no such object")
        return Listing("actions", (("grasp", ""), ("put", "")))

    def states(self, name: str) -> Sequence[str]:
        del name
        return ("power",)


@pytest.mark.parametrize(
    ("text", "offered", "not_offered"),
    [
        ("cu", {"cup", "room/cup", "do"}, {"lamp"}),
        ("do cu", {"cup", "room/cup"}, {"lamp"}),
        ("do cup gr", {"grasp", "put"}, {"cup"}),
        ("do chair ", set[str](), {"grasp"}),
        ("set room/lamp ", {"power"}, {"cup"}),
    ],
)
def test_what_is_offered(text: str, offered: set[str], not_offered: set[str]) -> None:
    catalogue = cast(WorldCatalogue, Shelf())
    found = set(candidates(text, catalogue, catalogue.objects().names))
    assert offered <= found
    assert not (not_offered & found)
