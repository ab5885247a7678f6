"""What everything with a shape affords is said once, and a kind's own action of that name goes before it."""

from __future__ import annotations

from pathlib import Path

import pytest

from ahmss.database import Workspace
from ahmss.errors import DataError

from .conftest import add_object

SHIPPED = Workspace(Path(__file__).resolve().parents[2])
COMMON = '[affordances.point]\nsentence = "Point."\nhuman_algorithm = "point"\nneeds = { free_hands = 1 }\n'


def test_kinds_with_a_shape_have_it_after_their_own_as_the_file_now_is(workspace: Workspace) -> None:
    add_object(workspace, "gauge", 'shape = "gauge.dxf"\n[affordances.check]\nhuman_algorithm = "check"\n')
    add_object(workspace, "room", 'sentence = "Has no shape."\n')
    own = '[sites.a]\n[affordances.point]\nhuman_algorithm = "aim"\nsite = "a"\n'
    add_object(workspace, "lamp", f'shape = "lamp.dxf"\n{own}')
    assert list(workspace.objects.get("gauge").affordances) == ["check"]
    file = workspace.root / "objectdb" / "everything.toml"
    file.write_text(COMMON)
    kinds = {name: workspace.objects.get(name).affordances for name in ("gauge", "room", "lamp")}
    assert {name: list(found) for name, found in kinds.items()} == {
        "gauge": ["check", "point"], "room": [], "lamp": ["point"],
    }  # fmt: skip
    assert kinds["gauge"]["point"].needs == {"free_hands": 1.0}
    assert kinds["lamp"]["point"].human_algorithm == "aim"
    assert workspace.objects.names() == ["gauge", "lamp", "room"]
    file.unlink()
    assert list(workspace.objects.get("gauge").affordances) == ["check"]


def test_what_is_wrong_with_it_names_the_file(workspace: Workspace) -> None:
    add_object(workspace, "gauge", 'shape = "gauge.dxf"\n')
    (workspace.root / "objectdb" / "everything.toml").write_text(COMMON.replace("needs", "wants"))
    with pytest.raises(DataError, match=r"objectdb/everything\.toml.*wants"):
        workspace.objects.get("gauge")


def test_all_that_is_seen_in_a_control_room_can_be_pointed_at() -> None:
    for name in SHIPPED.objects.names():
        kind = SHIPPED.objects.get(name)
        assert ("point" in kind.affordances) == (kind.shape is not None), name
