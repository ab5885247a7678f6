"""[[appearances]] and [[consequences]] of object.toml, and the parts of a shape that they are about."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from ahmss.database import Workspace
from ahmss.errors import DataError
from ahmss.motion.glbfile import GlbReader
from ahmss.states.behaviour import PART

from .conftest import add_object

ROOT = Path(__file__).resolve().parents[2]
LAMP = """\
shape = "lamp.dxf"
unit = "cm"

[states.light]
values = ["off", "on"]

[states.level]
range = [0.0, 2.0]

[[appearances]]
parts = ["bulb"]
when = "light == on"
lit = 0.5
turn_deg = 90.0

[[consequences]]
when = "light == on"
of = "../fan"
state = "power"
to = "toggle"

[[consequences]]
from = "level"
state = "level"
of = ".."
"""


def test_the_entries_become_records(workspace: Workspace) -> None:
    add_object(workspace, "lamp", LAMP)
    behaviour = workspace.objects.get("lamp").behaviour
    (shine,) = behaviour.appearances
    assert (shine.parts, shine.lit, shine.color) == (("bulb",), 0.5, None)
    assert shine.turn == pytest.approx(np.pi / 2)
    fan, above = behaviour.consequences
    assert (fan.of, fan.state, fan.to, fan.source) == ("../fan", "power", "toggle", "")
    assert (above.of, above.when, above.source) == ("..", None, "level")
    assert behaviour.falls


@pytest.mark.parametrize(
    ("was", "written", "sentence"),
    [
        (
            'when = "light == on"\nlit',
            'when = "light == purple"\nlit',
            'appearances[0].when (line 12): "light" is never',
        ),
        ("lit = 0.5\nturn_deg = 90.0", "", "appearances[0] (line 10): changes nothing"),
        ("lit = 0.5", "lit = 1.5", "appearances[0].lit (line 13): 1.5; allowed"),
        ("turn_deg = 90.0", 'by = "light"', 'appearances[0].by (line 14): no state "light" that is a number'),
        ('to = "toggle"', "", "consequences[0] (line 16): says either"),
        ('when = "light == on"\nof', "of", "consequences[0] (line 16): never happens"),
        ('"../fan"', '"fan/.."', 'consequences[0].of (line 18): "fan/.." is no way to an object'),
        ('of = "../fan"', "", 'consequences[0].state (line 19): no state "power"'),
        ('from = "level"', 'from = "heat"', 'consequences[1].from (line 23): no state "heat"'),
        ("[states.light]", "[states.held]", '"held" is known of every object'),
    ],
)
def test_a_mistake_is_told_in_one_sentence(workspace: Workspace, was: str, written: str, sentence: str) -> None:
    assert was in LAMP
    add_object(workspace, "lamp", LAMP.replace(was, written))
    with pytest.raises(DataError) as caught:
        workspace.objects.get("lamp")
    assert sentence in str(caught.value)


def test_parts_that_change_are_meshes_of_their_own_and_the_rest_stays_together(workspace: Workspace) -> None:
    file = add_object(workspace, "lamp", LAMP)
    shutil.copy(ROOT / "objectdb/lamp/lamp.dxf", file.parent)
    shape = workspace.objects.shape("lamp")
    assert shape is not None
    meshes = {mesh["name"]: mesh for mesh in GlbReader(shape.glb).tree["meshes"]}
    assert set(meshes) == {"coloured", PART + "bulb"}
    reader = GlbReader(shape.glb)
    bulb = reader.array(meshes[PART + "bulb"]["primitives"][0]["attributes"]["POSITION"])
    assert np.linalg.norm(bulb[:, :2], axis=1).max() == pytest.approx(0.042, abs=1e-4)
    file.write_text(LAMP.replace('"bulb"', '"flame"'))
    with pytest.raises(DataError, match='no layer "flame" for the appearances; the shape has: '):
        workspace.objects.shape("lamp")
