"""Objects made of objects: names, places, circles, and what changed."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.quaternion import from_axis_angle
from ahmss.database import Placed, Workspace, difference
from ahmss.errors import CommandError, DataError

from .conftest import add_object

PANEL = """
[[contains]]
kind = "button"
name = "button_1"
position = [0.1, 0.0, 0.0]

[[contains]]
kind = "button"
name = "button_2"
position = [0.2, 0.0, 0.0]
facing_deg = 90
"""


def by_name(placed: tuple[Placed, ...]) -> dict[str, Placed]:
    return {p.name: p for p in placed}


def test_children_stand_relative_to_their_parents_at_any_depth(workspace: Workspace) -> None:
    add_object(workspace, "button", '[[contains]]\nkind = "lamp"\nposition = [0.0, 0.01, 0.0]\n')
    add_object(workspace, "lamp", "")
    add_object(workspace, "panel", PANEL)
    quarter = from_axis_angle(np.array([0.0, 0.0, 1.0]), np.pi / 2)
    placed = by_name(workspace.objects.place("panel", "desk", (1.0, 2.0, 0.0), tuple(quarter.tolist())))
    assert list(placed) == ["desk", "desk/button_1", "desk/button_1/lamp", "desk/button_2", "desk/button_2/lamp"]
    np.testing.assert_allclose(placed["desk/button_2"].position, [1.0, 2.2, 0.0], atol=1e-12)
    np.testing.assert_allclose(placed["desk/button_1/lamp"].position, [0.99, 2.1, 0.0], atol=1e-12)
    # Turned by the panel's quarter and its own: half a turn.
    np.testing.assert_allclose(np.abs(placed["desk/button_2"].rotation), [0, 0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(placed["desk/button_2/lamp"].position, [1.0, 2.19, 0.0], atol=1e-12)
    assert placed["desk/button_1/lamp"].parent == "desk/button_1"


def test_forty_buttons_share_one_record(workspace: Workspace) -> None:
    add_object(workspace, "button", "")
    rows = [f'[[contains]]\nkind = "button"\nname = "b{i}"\nposition = [{i / 10}, 0.0, 0.0]\n' for i in range(40)]
    add_object(workspace, "panel", "".join(rows))
    placed = workspace.objects.place("panel", "panel")
    assert len(placed) == 41
    assert len({id(workspace.objects.get(p.kind)) for p in placed[1:]}) == 1


def test_a_circle_is_told_as_a_chain(workspace: Workspace) -> None:
    add_object(workspace, "a", '[[contains]]\nkind = "b"\n')
    add_object(workspace, "b", '[[contains]]\nkind = "c"\n')
    add_object(workspace, "c", '[[contains]]\nkind = "a"\n')
    with pytest.raises(DataError, match="a circle: a contains b contains c contains a"):
        workspace.objects.place("a", "a")


def test_a_circle_is_a_fault_in_the_list_too(workspace: Workspace) -> None:
    add_object(workspace, "a", '[[contains]]\nkind = "b"\n')
    add_object(workspace, "b", '[[contains]]\nkind = "a"\n')
    add_object(workspace, "lamp", "")
    faults = {line.name: line.error for line in workspace.objects.list()}
    assert "a circle: a contains b contains a" in faults["a"]
    assert "a circle: b contains a contains b" in faults["b"]
    assert faults["lamp"] == ""


def test_a_chain_without_end_is_told_in_a_sentence(workspace: Workspace) -> None:
    for i in range(1200):
        add_object(workspace, f"k{i}", f'[[contains]]\nkind = "k{i + 1}"\n')
    add_object(workspace, "k1200", "")
    with pytest.raises(DataError, match=r"objectdb/k32/object.toml: contains: .*more than 32 deep"):
        workspace.objects.place("k0", "k0")
    assert len(workspace.objects.place("k1168", "k1168")) == 33


def test_a_multiplying_tree_is_stopped(workspace: Workspace) -> None:
    for level in range(5):
        rows = [f'[[contains]]\nkind = "k{level + 1}"\nname = "n{i}"\n' for i in range(8)]
        add_object(workspace, f"k{level}", "".join(rows))
    add_object(workspace, "k5", "")
    with pytest.raises(DataError, match="more than 20000 objects"):
        workspace.objects.place("k0", "k0")


def test_an_unknown_part_names_its_file(workspace: Workspace) -> None:
    add_object(workspace, "panel", PANEL)
    with pytest.raises(DataError, match=r'objectdb/panel/object.toml: contains\[0\].kind: no kind of object "button"'):
        workspace.objects.place("panel", "panel")
    with pytest.raises(CommandError):
        workspace.objects.place("pannel", "panel")


def test_two_of_one_name_are_refused(workspace: Workspace) -> None:
    add_object(workspace, "panel", PANEL.replace("button_2", "button_1"))
    with pytest.raises(DataError, match=r'contains\[1\].name \(line 9\): there is a "button_1" already'):
        workspace.objects.get("panel")


def test_the_difference_follows_the_file(workspace: Workspace) -> None:
    add_object(workspace, "button", "")
    add_object(workspace, "lever", '[[contains]]\nkind = "button"\n')
    file = add_object(workspace, "panel", PANEL)
    before = workspace.objects.place("panel", "p")
    text = PANEL.replace("[0.1, 0.0, 0.0]", "[0.15, 0.0, 0.0]").replace(
        'kind = "button"\nname = "button_2"', 'kind = "lever"\nname = "button_2"'
    )
    file.write_text(text + '[[contains]]\nkind = "button"\nname = "button_3"\n')
    changes = difference(before, workspace.objects.place("panel", "p"))
    assert [p.name for p in changes.moved] == ["p/button_1"]
    assert changes.moved[0].position == (0.15, 0.0, 0.0)
    assert [p.name for p in changes.added] == ["p/button_2", "p/button_2/button", "p/button_3"]
    assert changes.removed == ("p/button_2",)


def test_moving_a_parent_moves_no_child_by_itself(workspace: Workspace) -> None:
    add_object(workspace, "button", "")
    add_object(workspace, "panel", PANEL)
    changes = difference(workspace.objects.place("panel", "p"), workspace.objects.place("panel", "p", (1.0, 0.0, 0.0)))
    assert [p.name for p in changes.moved] == ["p"]
    assert not changes.added
    assert not changes.removed


def test_what_is_in_an_entry_of_another_kind_is_new_with_it(workspace: Workspace) -> None:
    add_object(workspace, "button", "")
    for kind in ("lever", "crank"):
        add_object(workspace, kind, '[[contains]]\nkind = "button"\n')
    file = add_object(workspace, "panel", '[[contains]]\nkind = "lever"\nname = "grip"\n')
    before = workspace.objects.place("panel", "p")
    file.write_text(file.read_text().replace("lever", "crank"))
    changes = difference(before, workspace.objects.place("panel", "p"))
    assert [p.name for p in changes.added] == ["p/grip", "p/grip/button"]
    assert changes.removed == ("p/grip/button", "p/grip")


def test_removed_children_go_before_their_parents(workspace: Workspace) -> None:
    add_object(workspace, "button", "")
    add_object(workspace, "lever", '[[contains]]\nkind = "button"\n')
    file = add_object(workspace, "panel", '[[contains]]\nkind = "lever"\n')
    before = workspace.objects.place("panel", "p")
    file.write_text("")
    assert difference(before, workspace.objects.place("panel", "p")).removed == ("p/lever/button", "p/lever")
