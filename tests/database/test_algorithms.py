"""Finding algorithms in folders, and their typed parameters."""

from __future__ import annotations

from pathlib import Path

import pytest

from ahmss.database import Workspace
from ahmss.database.parameter import Parameter, fill
from ahmss.errors import CommandError, DataError
from ahmss.states.state import State

from .conftest import add_algorithm

NOD = 'kind = "human"\nargv = ["python", "nod.py"]\nsentence = "Nods."\n'


def test_the_objects_own_comes_first_then_objectdb_then_algorithms(workspace: Workspace) -> None:
    own = workspace.root / "objectdb/cup"
    add_algorithm(workspace, "nod", NOD)
    assert workspace.algorithms.find("nod", own).directory == workspace.root / "algorithms/nod"
    add_algorithm(workspace, "nod", NOD, "objectdb")
    assert workspace.algorithms.find("nod", own).directory == workspace.root / "objectdb/nod"
    add_algorithm(workspace, "nod", NOD, "objectdb/cup")
    assert workspace.algorithms.find("nod", own).directory == own / "nod"
    assert workspace.algorithms.find("nod").directory == workspace.root / "objectdb/nod"
    entry = workspace.algorithms.find("nod", own)
    assert (entry.kind, entry.argv, entry.sentence, entry.world) == ("human", ("python", "nod.py"), "Nods.", "near")


def test_footprints_are_told_to_who_asks(workspace: Workspace) -> None:
    add_algorithm(workspace, "nod", NOD)
    add_algorithm(workspace, "walk", f"{NOD}footprints = true\n".replace("nod", "walk"))
    assert [workspace.algorithms.find(name).footprints for name in ("nod", "walk")] == [False, True]


def test_the_shape_is_told_to_who_asks(workspace: Workspace) -> None:
    add_algorithm(workspace, "nod", NOD)
    add_algorithm(workspace, "grasp", f"{NOD}shape = true\n".replace("nod", "grasp"))
    found = [workspace.algorithms.find(name) for name in ("nod", "grasp")]
    assert [(entry.shape, entry.carries, entry.humans) for entry in found] == [
        (False, False, False),
        (True, False, False),
    ]


def test_shapes_are_told_to_who_asks_for_footprints_and_them(
    workspace: Workspace,
) -> None:
    add_algorithm(workspace, "nod", NOD)
    add_algorithm(workspace, "sit", f"{NOD}footprints = true\nshapes = true\n".replace("nod", "sit"))
    assert [workspace.algorithms.find(name).shapes for name in ("nod", "sit")] == [False, True]
    add_algorithm(workspace, "lie", f"{NOD}shapes = true\n".replace("nod", "lie"))
    with pytest.raises(DataError, match="asks for the shapes of what occupies the floor; add `footprints = true`"):
        workspace.algorithms.find("lie")


def test_ways_are_told_to_who_asks_for_humans_and_them(workspace: Workspace) -> None:
    add_algorithm(workspace, "nod", NOD)
    add_algorithm(workspace, "walk", f"{NOD}humans = true\nways = true\n".replace("nod", "walk"))
    assert [workspace.algorithms.find(name).ways for name in ("nod", "walk")] == [False, True]
    add_algorithm(workspace, "run", f"{NOD}ways = true\n".replace("nod", "run"))
    with pytest.raises(
        DataError, match=r"ways \(line 4\): asks where the other humans mean to be; add `humans = true`"
    ):
        workspace.algorithms.find("run")


def test_arms_are_told_to_who_asks_for_humans_and_them(workspace: Workspace) -> None:
    add_algorithm(workspace, "nod", NOD)
    add_algorithm(workspace, "walk", f"{NOD}humans = true\narms = true\n".replace("nod", "walk"))
    assert [workspace.algorithms.find(name).arms for name in ("nod", "walk")] == [False, True]
    add_algorithm(workspace, "run", f"{NOD}arms = true\n".replace("nod", "run"))
    with pytest.raises(DataError, match=r"arms \(line 4\): asks where the other humans' arms are; add `humans = true`"):
        workspace.algorithms.find("run")


def executable(path: Path) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("#!/bin/sh\n")
    path.chmod(0o755)
    return path


@pytest.mark.parametrize("place", ["wave", "wave/wave"])
def test_a_bare_executable_will_do(workspace: Workspace, place: str) -> None:
    program = executable(workspace.root / "algorithms" / place)
    entry = workspace.algorithms.find("wave")
    assert (entry.kind, entry.argv, entry.parameters) == ("", (str(program),), None)
    assert entry.directory == program.parent
    assert workspace.algorithms.names() == ["wave"]


def test_a_program_of_the_folder_is_started_by_its_path_and_another_by_its_name(workspace: Workspace) -> None:
    folder = add_algorithm(workspace, "nod", 'kind = "human"\nargv = ["./nod", "-v"]\n')
    executable(folder / "nod")
    assert workspace.algorithms.find("nod").argv == (str(folder / "nod"), "-v")
    add_algorithm(workspace, "perl", 'kind = "object"\nargv = ["perl", "x.pl"]\n')
    assert workspace.algorithms.find("perl").argv == ("perl", "x.pl")


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ('kind = "human"\nargv = ["python", "gone.py"]\n', 'argv (line 2): no file "gone.py" in algorithms/nod'),
        ('kind = "human"\nargv = ["python"]\n', "names no script"),
        ('kind = "human"\nargv = []\n', "names the program"),
        ('kind = "human"\nargv = ["./nod.py"]\n', "may not be executed; chmod +x it"),
        ('kind = "human"\nargv = ["python", "../../../x.py"]\n', "leads out of the workspace"),
        ('kind = "human"\nargv = ["/bin/sh"]\n', "is an absolute path"),
        ('kind = "humans"\nargv = ["python", "nod.py"]\n', "kind (line 1): 'humans' is not possible"),
        (NOD + 'world = "far"\n', "allowed: all, near, none"),
        (NOD + '[parameters.n]\ntype = "float"\ndefault = "x"\n', "parameters.n.default (line 6): 'x' is no finite"),
        (NOD + '[parameters.n]\ntype = "float"\ndefault = 3.0\nmaximum = 2.0\n', "3 is out of range"),
    ],
)
def test_what_algorithm_toml_may_not_say(workspace: Workspace, text: str, sentence: str) -> None:
    add_algorithm(workspace, "nod", text)
    with pytest.raises(DataError) as caught:
        workspace.algorithms.find("nod")
    assert sentence in str(caught.value)
    assert str(caught.value).startswith("algorithms/nod/algorithm.toml: ")


def test_a_broken_own_one_does_not_fall_back_in_silence(workspace: Workspace) -> None:
    add_algorithm(workspace, "nod", NOD)
    add_algorithm(workspace, "nod", "kind = 3", "objectdb/cup")
    with pytest.raises(DataError, match="objectdb/cup/nod/algorithm"):
        workspace.algorithms.find("nod", workspace.root / "objectdb/cup")


def test_an_unknown_one_is_told_with_the_nearest_and_where(workspace: Workspace) -> None:
    add_algorithm(workspace, "nod", NOD)
    sentence = 'no algorithm "nodd" in objectdb/cup, objectdb, algorithms, did you mean "nod"'
    with pytest.raises(CommandError, match=sentence):
        workspace.algorithms.find("nodd", workspace.root / "objectdb/cup")
    with pytest.raises(CommandError):
        workspace.algorithms.find("../algorithms/nod")


def test_the_list_holds_objects_own_ones_and_broken_ones(workspace: Workspace) -> None:
    add_algorithm(workspace, "nod", NOD)
    add_algorithm(workspace, "broken", "?")
    add_algorithm(workspace, "pour", NOD.replace("nod.py", "pour.py"), "objectdb/cup")
    listed = workspace.algorithms.list()
    assert [entry.name for entry in listed if not isinstance(entry, DataError)] == ["nod", "pour"]
    assert [str(entry)[:32] for entry in listed if isinstance(entry, DataError)] == ["algorithms/broken/algorithm.toml"]


def test_a_new_algorithm_and_a_changed_one_are_seen(workspace: Workspace) -> None:
    with pytest.raises(CommandError):
        workspace.algorithms.find("nod")
    add_algorithm(workspace, "nod", NOD)
    assert workspace.algorithms.find("nod").sentence == "Nods."
    add_algorithm(workspace, "nod", NOD.replace("Nods.", "Nods slowly."))
    assert workspace.algorithms.find("nod").sentence == "Nods slowly."


def test_a_parameter_may_be_bounded_by_the_state_that_another_names() -> None:
    level = Parameter("float", default=-1.0, minimum=-1.0, maximum=1.0, bounds="state")
    declared = {"level": level, "state": Parameter("str", default="height")}
    states = {"height": State(0.0, low=0.0, high=0.4), "lid": State("shut", values=("shut", "open"))}
    for value in (0.0, 0.4):
        assert fill(declared, {"level": value}, states)["level"] == value
    assert fill(declared, {}, states)["level"] == -1.0  # the default has a meaning of its own, and is not typed
    for value in (-0.5, 0.5, -1.0):
        with pytest.raises(ValueError, match=f"level: {value:g} is out of range; allowed: 0 to 0\\.4"):
            fill(declared, {"level": value}, states)
    assert fill(declared, {"level": 0.5, "state": "lid"}, states)["level"] == 0.5  # no number bounds it
    assert fill(declared, {"level": 0.5})["level"] == 0.5


def test_a_word_of_digits_is_a_word() -> None:
    """`position=3` was "3.0 is no str", and the positions that there are were not told."""
    word = Parameter("str")
    assert [word.convert(value) for value in ("a", 3.0, 12, 0.5)] == ["a", "3", "12", "0.5"]
    with pytest.raises(ValueError, match="True is no str"):
        word.convert(True)


def test_parameters_are_filled_converted_and_ranged() -> None:
    declared = {
        "speed": Parameter("float", default=1.0, minimum=0.0),
        "times": Parameter("int"),
        "soft": Parameter("bool", default=False),
        "path": Parameter("floats", default=[0.0]),
    }
    assert fill(declared, {"times": "3", "soft": "true", "path": "1,2.5", "other": 1}) == {
        "speed": 1.0,
        "times": 3,
        "soft": True,
        "path": [1.0, 2.5],
    }
    for given, sentence in (
        ({}, "times: missing; it is int without a default"),
        ({"times": 2.5}, "times: 2.5 is no int"),
        ({"times": 1, "speed": -1}, "speed: -1 is out of range; allowed: 0 to any"),
        ({"times": True}, "times: True is no finite number"),
        ({"times": 1, "speed": "60%"}, "speed: '60%' is no finite number; allowed: 0 to any"),
        ({"times": 1, "soft": "perhaps"}, "soft: 'perhaps' is no bool"),
    ):
        with pytest.raises(ValueError, match=sentence.replace(".", r"\.")):
            fill(declared, given)
    assert fill(None, {"anything": 1}) == {"anything": 1}
