"""What object.toml may say, and the sentence for each thing that it may not."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.quaternion import rotate
from ahmss.database import Workspace
from ahmss.errors import CommandError, DataError

from .conftest import add_object

CUP = """
name = "cup"
sentence = "A cup."
properties = "properties.toml"

[sites.handle]
position = [0.045, 0.0, 0.05]
facing_deg = 90

[sites.rim]
free_axis = "z"

[states.lamp]
values = ["off", "on"]

[states.level]
range = [0.0, 1.0]
initial = 0.25

[affordances.grasp]
human_algorithm = "grasp"
object_algorithm = "follow_hand"
site = "handle"
asks = ["goal_position"]
parameters = { diameter = 0.07 }
when = "lamp == on and level > 0.2 or level == 1"
needs = { reach = 1.9 }
hold = "take"
"""


def test_a_whole_file_becomes_a_record(workspace: Workspace) -> None:
    add_object(workspace, "cup", CUP)
    (workspace.root / "objectdb/cup/properties.toml").write_text("mass = 0.3\n")
    cup = workspace.objects.get("cup")
    grasp = cup.affordances["grasp"]
    assert cup.properties == {"mass": 0.3}
    assert grasp.frames == 60
    assert (grasp.site, grasp.asks, grasp.hold) == ("handle", ("goal_position",), "take")
    assert grasp.needs == {"reach": 1.9}
    assert cup.initial_states == {"lamp": "off", "level": 0.25}
    assert cup.sites["rim"].free_axis == "z"
    turned = rotate(np.array(cup.sites["handle"].rotation), np.array([1.0, 0.0, 0.0]))
    np.testing.assert_allclose(turned, [0.0, 1.0, 0.0], atol=1e-12)


def test_orientation_in_degrees_turns_about_x_then_y_then_z(workspace: Workspace) -> None:
    add_object(workspace, "panel", "[sites.face]\norientation_deg = [90, 0, 90]\n")
    q = np.array(workspace.objects.get("panel").sites["face"].rotation)
    np.testing.assert_allclose(rotate(q, np.array([0.0, 1.0, 0.0])), [0.0, 0.0, 1.0], atol=1e-12)
    np.testing.assert_allclose(rotate(q, np.array([1.0, 0.0, 0.0])), [0.0, 1.0, 0.0], atol=1e-12)


@pytest.mark.parametrize(
    ("states", "afforded"),
    [
        ({"lamp": "on", "level": 0.5}, True),
        ({"lamp": "on", "level": 0.1}, False),
        ({"lamp": "off", "level": 1.0}, True),
        ({"lamp": "off", "level": 0.5}, False),
        ({}, False),
    ],
)
def test_an_action_is_afforded_while_its_condition_holds(
    workspace: Workspace, states: dict[str, str | float], afforded: bool
) -> None:
    add_object(workspace, "cup", CUP)
    (workspace.root / "objectdb/cup/properties.toml").write_text("")
    assert ("grasp" in workspace.objects.get("cup").afforded(states)) is afforded


@pytest.mark.parametrize(
    ("was", "written", "sentence"),
    [
        (
            'site = "handle"',
            'site = "hadle"',
            'objectdb/cup/object.toml: affordances.grasp.site (line 23): no site "hadle"; this object has: handle, rim',
        ),
        ("[sites.rim]", "[sites.rim]\npositon = [0, 0, 1]", 'no key "positon" here, did you mean "position"'),
        ("sentence =", "sentense =", 'objectdb/cup/object.toml: sentense (line 3): no key "sentense" here'),
        ('"A cup."', "3", "sentence (line 3): expected text in quotes, got a whole number"),
        ("[0.045, 0.0, 0.05]", "[0.045, 0.0]", "sites.handle.position (line 7)"),
        ("[0.045, 0.0, 0.05]", "[0.045, 0.0, nan]", "sites.handle.position[2] (line 7): nan"),
        ('name = "cup"', 'name = "mug"', 'is not the name of its folder, "cup"'),
        ("[sites.rim]", "[sites.rim", "objectdb/cup/object.toml: not TOML:"),
        ('free_axis = "z"', 'free_axis = "y"', "sites.rim.free_axis (line 11): 'y' is not possible"),
        ('free_axis = "z"', 'grip = "firm"', "sites.rim.grip (line 11): 'firm' is not possible"),
        ('free_axis = "z"', "orientation = [1, 1, 0, 0]", "has length 1.414; a rotation is [w, x, y, z] of length 1"),
        ('values = ["off", "on"]', "", "states.lamp (line 13): a state has values"),
        ('values = ["off", "on"]', "text = 0", "states.lamp.text (line 14): 0; allowed: 1 to 1000 characters"),
        ("initial = 0.25", "initial = 2", "states.level.initial (line 18): 2.0 is not among: 0 to 1"),
        ("range = [0.0, 1.0]", "range = [2.0, 1.0]", "2 is more than 1"),
        ('"grasp"', "7", "affordances.grasp.human_algorithm"),
        ('human_algorithm = "grasp"', "", 'affordances.grasp (line 20): the key "human_algorithm" is missing'),
        ('["goal_position"]', '["goal_positon"]', "affordances.grasp.asks"),
        ("lamp == on and", "light == on and", 'no state "light"; this object has: lamp, level'),
        ("lamp == on and", "lamp == bright and", '"lamp" is never "bright"; allowed: off, on'),
        ("level > 0.2", "level > high", '"level" is a number, never "high"'),
        ("lamp == on and", "lamp is on and", "is no condition; write STATE == VALUE"),
        ("needs = { reach", "needs = { height", 'no need "height"'),
        ('hold = "take"', 'hold = "grab"', "affordances.grasp.hold"),
        ('object_algorithm = "follow_hand"', "", '"take" wants an object_algorithm'),
        (
            'site = "handle"',
            'site = "handle"\nframes = -1',
            "-1 frames; allowed: 1 to 100000, or 0 for as many as it needs",
        ),
        ('"properties.toml"', '"weights.toml"', 'no file "weights.toml"'),
    ],
)
def test_a_mistake_is_told_in_one_sentence(workspace: Workspace, was: str, written: str, sentence: str) -> None:
    assert was in CUP
    add_object(workspace, "cup", CUP.replace(was, written, 1))
    (workspace.root / "objectdb/cup/properties.toml").write_text("")
    with pytest.raises(DataError) as caught:
        workspace.objects.get("cup")
    assert sentence in str(caught.value)
    assert str(caught.value).startswith("objectdb/cup/object.toml: ")
    assert "\n" not in str(caught.value)


def test_an_unknown_kind_is_told_with_the_nearest(workspace: Workspace) -> None:
    add_object(workspace, "table", "")
    with pytest.raises(CommandError, match=r'no kind of object "tabel", did you mean "table"\?'):
        workspace.objects.get("tabel")
    with pytest.raises(CommandError):
        workspace.objects.get("../table")


def test_one_broken_file_hides_no_other(workspace: Workspace) -> None:
    add_object(workspace, "a_good", 'sentence = "Good."')
    add_object(workspace, "broken", "= = =")
    add_object(workspace, "misses", 'shape = "gone.dxf"')
    (workspace.root / "objectdb/binary").mkdir()
    (workspace.root / "objectdb/binary/object.toml").write_bytes(b"\xff\xfe\x00")
    (workspace.root / "objectdb/pictures").mkdir()
    listed = {line.name: line for line in workspace.objects.list()}
    assert list(listed) == ["a_good", "binary", "broken", "misses"]
    assert (listed["a_good"].sentence, listed["a_good"].error) == ("Good.", "")
    assert "not TOML" in listed["broken"].error
    assert "not UTF-8" in listed["binary"].error
    assert "shape (line 1): no file objectdb/misses/gone.dxf" in listed["misses"].error
