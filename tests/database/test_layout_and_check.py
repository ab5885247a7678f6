"""`ahmss init`, `ahmss new object` and `ahmss check`."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from ahmss.database import Workspace
from ahmss.database.check import check
from ahmss.database.layout import init, new_object
from ahmss.errors import CommandError
from ahmss.motion import archive
from ahmss.walking.catalogue import STRAIGHT
from ahmss.walking.library import BODY, Library, WalkClip, save

from .conftest import add_algorithm, add_object

CHECKOUT = Path(__file__).resolve().parents[2]


def test_a_new_object_works_at_once(workspace: Workspace) -> None:
    file = new_object(workspace, "vase")
    assert file == workspace.root / "objectdb/vase/object.toml"
    shape = workspace.objects.shape("vase")
    assert shape is not None
    assert shape.faces == 12
    assert shape.bounds == ((-0.05, -0.05, 0.0), (0.05, 0.05, pytest.approx(0.1)))
    assert check(workspace).problems == ()


def test_a_new_object_can_be_looked_at_as_the_television_is(workspace: Workspace) -> None:
    (workspace.root / "objectdb/television").mkdir()
    (workspace.root / "objectdb/television/look.npz").write_bytes(b"")
    look = '[affordances.look]\nhuman_algorithm = "gaze"\nmotion = "look.npz"\nsite = "s"\nframes = 45\n'
    add_object(workspace, "television", "[sites.s]\n" + look)
    new_object(workspace, "vase")
    own = workspace.objects.get("vase").affordances["look"]
    assert (own.human_algorithm, own.site, own.frames) == ("gaze", "middle", 45)
    assert own.motion == workspace.root / "objectdb/television/look.npz"


@pytest.mark.parametrize(
    ("name", "sentence"), [("cup", "exists already"), ("../x", "is no name"), ("7up", "is no name")]
)
def test_a_new_object_needs_a_free_name(workspace: Workspace, name: str, sentence: str) -> None:
    add_object(workspace, "cup", "")
    with pytest.raises(CommandError, match=sentence):
        new_object(workspace, name)


def test_init_copies_a_workspace_that_is_whole(workspace: Workspace, tmp_path_factory: pytest.TempPathFactory) -> None:
    add_object(workspace, "cup", 'sentence = "A cup."')
    add_algorithm(workspace, "nod", 'kind = "human"\nargv = ["python", "nod.py"]\n')
    (workspace.root / "algorithms/nod/__pycache__").mkdir()
    target = tmp_path_factory.mktemp("own") / "deep" / "space"
    own = init(target, workspace)
    assert own.objects.get("cup").sentence == "A cup."
    assert own.algorithms.find("nod").directory == target.resolve() / "algorithms/nod"
    assert sorted(p.name for p in target.iterdir()) == ["algorithms", "examples", "humandb", "objectdb"]
    assert not (target / "algorithms/nod/__pycache__").exists()
    with pytest.raises(CommandError, match="objectdb, humandb, algorithms, examples exists already"):
        init(target, workspace)


def test_init_says_what_cannot_be_written(workspace: Workspace) -> None:
    (workspace.root / "a_file").write_text("")
    with pytest.raises(CommandError, match="can't be written"):
        init(workspace.root / "a_file/below", workspace)
    with pytest.raises(CommandError, match="lies in the objectdb/"):
        init(workspace.root / "objectdb/own", workspace)


def test_check_tells_every_fault_once(workspace: Workspace) -> None:
    add_object(
        workspace,
        "cup",
        'shape = "gone.dxf"\n[affordances.nod]\nhuman_algorithm = "nod"\nmotion = "gone.npz"\n'
        "parameters = { dept = 1.0 }\n"
        '[affordances.fall]\nhuman_algorithm = "fall"\nobject_algorithm = "missing"\n',
    )
    add_object(workspace, "ring", '[[contains]]\nkind = "ring"\n')
    add_object(workspace, "broken", "?")
    add_algorithm(workspace, "nod", 'kind = "human"\nargv = ["python", "nod.py"]\n[parameters.depth]\ntype = "float"\n')
    add_algorithm(workspace, "fall", 'kind = "object"\nargv = ["python", "fall.py"]\n')
    add_algorithm(workspace, "spoilt", "?")
    report = check(workspace)
    assert (report.objects, report.humans, report.algorithms, report.motions) == (3, 0, 3, 1)
    expected = (
        "objectdb/broken/object.toml: not TOML",
        "objectdb/cup/object.toml: shape (line 1): no file objectdb/cup/gone.dxf",
        "objectdb/cup/object.toml: affordances.nod.parameters.depth: missing; it is float without a default",
        'objectdb/cup/object.toml: affordances.nod.parameters: no parameter "dept", did you mean "depth"?',
        "objectdb/cup/object.toml: affordances.nod.motion (line 4): no file objectdb/cup/gone.npz",
        'affordances.fall.human_algorithm: "fall" moves objects; name one that moves humans',
        'affordances.fall.object_algorithm: no algorithm "missing"',
        "objectdb/ring/object.toml: contains[0].kind: a circle: ring contains ring",
        "algorithms/spoilt/algorithm.toml: not TOML",
    )
    assert len(report.problems) == len(expected)
    for sentence, problem in zip(expected, report.problems, strict=True):
        assert sentence in problem


def test_a_motion_may_be_a_walk_library_and_a_broken_one_is_told(workspace: Workspace) -> None:
    add_object(workspace, "floor", '[affordances.walk]\nhuman_algorithm = "walk"\nmotion = "walk.npz"\nframes = 0\n')
    add_algorithm(workspace, "walk", 'kind = "human"\nargv = ["python", "walk.py"]\n')
    path = workspace.root / "objectdb" / "floor" / "walk.npz"
    rotations, root = np.tile([1.0, 0.0, 0.0, 0.0], (5, BODY, 1)), np.zeros((5, 3))
    step = WalkClip(STRAIGHT, rotations, root, np.ones((5, 2, 3), bool))
    save(Library("ken", 0.9, {STRAIGHT: step}), path)
    assert check(workspace).problems == ()
    archive.write(path, archive.read(path, "walk library") | {"root": np.zeros((4, 3), np.int32)})
    (problem,) = check(workspace).problems
    assert "walk.npz: root: shape (4, 3) of int32; it must be (5, 3)" in problem


def test_what_is_not_built_yet_is_a_note_until_an_object_wants_it(workspace: Workspace) -> None:
    folder = add_algorithm(workspace, "nod", 'kind = "human"\nargv = ["./nod"]\n')
    (folder / "Makefile").write_text("")
    told = 'algorithms/nod/algorithm.toml: argv: "./nod" is not built yet; type: make -C algorithms/nod'
    assert (check(workspace).problems, check(workspace).notes) == ((), (told,))
    add_object(workspace, "cup", '[affordances.nod]\nhuman_algorithm = "nod"\n')
    assert told in check(workspace).problems[0]


def test_what_is_shipped_is_whole() -> None:
    report = check(Workspace(CHECKOUT))
    assert report.problems == ()
