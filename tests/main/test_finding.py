"""Names are found by an index, however many objects there are."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import SimpleNamespace
from typing import Any

import pytest

from ahmss.errors import CommandError
from ahmss.main.company import Everything, Humans
from ahmss.main.naming import find_object
from ahmss.world.schema import ObjectRecord, Scene, Ticked
from ahmss.world.view import World

UPRIGHT = (1.0, 0.0, 0.0, 0.0)


def record(number: int, name: str) -> ObjectRecord:
    return ObjectRecord(number, name, "box", (0.0, 0.0, 0.0), UPRIGHT)


class Unlisted(Mapping[str, ObjectRecord]):
    """Objects that are only to be asked for by name."""

    def __init__(self, world: World) -> None:
        self._world = world

    def __getitem__(self, name: str) -> ObjectRecord:
        return self._world.objects[name]

    def __contains__(self, name: object) -> bool:
        return name in self._world.objects

    def __iter__(self) -> Iterator[str]:
        raise AssertionError("all names were gone through")

    def __len__(self) -> int:
        return len(self._world.objects)


def scene(world: World) -> Any:
    return SimpleNamespace(objects=Everything(Unlisted(world), Humans(world), world.called))


@pytest.fixture
def world() -> World:
    seen = World()
    names = ["cup", "room", "room/table", "room/panel", "room/panel/lever_1", "other/panel/lever_1", "room/tablet"]
    seen.load(Scene(1, [record(number, name) for number, name in enumerate(names, 1)], []))
    return seen


def test_the_last_parts_of_a_name_are_enough_and_nothing_else_is_looked_at(world: World) -> None:
    seen = scene(world)
    assert find_object(seen, "table") == "room/table"
    assert find_object(seen, "room/table") == "room/table"
    assert find_object(seen, "cup") == "cup"
    with pytest.raises(CommandError, match=r'which "lever_1"\? there are: room/panel/lever_1, other/panel/lever_1'):
        find_object(seen, "lever_1")
    with pytest.raises(CommandError, match='which "panel/lever_1"'):
        find_object(seen, "panel/lever_1")
    assert find_object(seen, "other/panel/lever_1") == "other/panel/lever_1"


def test_what_comes_is_found_and_what_goes_is_not(world: World) -> None:
    seen = scene(world)
    assert find_object(seen, "tablet") == "room/tablet"
    world.apply(Ticked(1, 2, put=[record(9, "room/mug"), record(10, "hall/tablet")]))
    assert find_object(seen, "mug") == "room/mug"
    with pytest.raises(CommandError, match="which"):
        find_object(seen, "tablet")
    world.apply(Ticked(2, 3, gone=[7]))
    assert find_object(seen, "tablet") == "hall/tablet"
    world.load(Scene(4, [record(3, "room/table")], []))
    assert world.called("tablet") == []
    assert find_object(seen, "table") == "room/table"
