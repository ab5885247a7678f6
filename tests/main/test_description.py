"""What START tells of a room with many objects of one kind."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import numpy as np
import pytest

from ahmss.database.objects import ObjectDatabase
from ahmss.database.workspace import Workspace
from ahmss.main.description import Description

from .test_afforded import Room

SHIPPED = Workspace(Path(__file__).resolve().parents[2])


def test_the_file_of_a_kind_is_looked_at_once_however_many_there_are(monkeypatch: pytest.MonkeyPatch) -> None:
    room, asked = Room(kind="panel"), Counter[str]()
    kinds = Counter(record.kind for record in room.objects.values())
    assert max(kinds.values()) > 5
    get = ObjectDatabase.get

    def counted(self: ObjectDatabase, name: str) -> object:
        asked[name] += 1
        return get(self, name)

    walk = SHIPPED.algorithms.find("walk", SHIPPED.root / "objectdb" / "floor")
    told = Description(SHIPPED, room, walk, {})  # type: ignore[arg-type]
    monkeypatch.setattr(ObjectDatabase, "get", counted)
    world = told.world("", np.zeros(3))
    placed = {(record.kind, room.pose(name)[2:].tobytes()) for name, record in room.objects.items()}
    footprints = Counter(kind for kind, _ in placed)  # each differs by height and tilt
    assert asked == {kind: 1 + footprints[kind] for kind in kinds}
    assert [record.name for record in world] == list(room.objects)
    for record in world:
        assert record.kind == room.objects[record.name].kind
        assert set(record.sites) == set(get(SHIPPED.objects, record.kind).sites)
