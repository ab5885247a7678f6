"""docs/writing-an-object.md says every key, and its example is right."""

from __future__ import annotations

import re
from pathlib import Path

import msgspec
import pytest

from ahmss.database import Workspace
from ahmss.database.objectfile import AffordanceEntry, ContainedEntry, ForwardEntry, ObjectFile, SiteEntry
from ahmss.database.statefile import AppearanceEntry, ConsequenceEntry, StateEntry
from ahmss.errors import DataError

from .conftest import add_object

PAGE = (Path(__file__).resolve().parents[2] / "docs/writing-an-object.md").read_text(encoding="utf-8")


ENTRIES = [
    ObjectFile, SiteEntry, StateEntry, AppearanceEntry, ConsequenceEntry, AffordanceEntry, ForwardEntry, ContainedEntry,
]  # fmt: skip


@pytest.mark.parametrize("struct", ENTRIES)
def test_every_key_is_told(struct: type[msgspec.Struct]) -> None:
    for field in struct.__struct_encode_fields__:
        assert f"`{field}`" in PAGE or f"`[{field}." in PAGE or f"`[[{field}]]`" in PAGE, field


def test_the_example_is_read_and_its_mistake_is_told_as_printed(workspace: Workspace) -> None:
    blocks = re.findall(r"^```\w*\n(.*?)^```", PAGE, re.DOTALL | re.MULTILINE)
    example = next(b for b in blocks if b.startswith('name = "vase"'))
    told = next(b for b in blocks if b.startswith("objectdb/vase"))
    add_object(workspace, "vase", example)
    assert workspace.objects.get("vase").affordances["grasp"].hold == "take"
    add_object(workspace, "vase", example.replace('site = "neck"', 'site = "nek"'))
    with pytest.raises(DataError) as caught:
        workspace.objects.get("vase")
    assert str(caught.value) == told.strip()
