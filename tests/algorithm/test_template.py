"""`ahmss new algorithm`: what it writes works at once."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
from algorithm_rig import object_frame, play

from ahmss.algorithm.template import new_algorithm
from ahmss.database.algorithms import AlgorithmFinder, NotBuilt
from ahmss.database.workspace import Workspace
from ahmss.errors import CommandError
from ahmss.processes.answers import Answer

CHECKOUT = Path(__file__).parents[2]


@pytest.fixture
def workspace(tmp_path):
    for folder in ("objectdb", "humandb", "algorithms"):
        (tmp_path / folder).mkdir()
    ignore = shutil.ignore_patterns("nod")
    shutil.copytree(CHECKOUT / "algorithms" / "nod", tmp_path / "algorithms" / "nod", ignore=ignore)
    return Workspace(tmp_path)


def test_a_new_human_algorithm_bows(warm_launcher, make_start, workspace):
    new_algorithm(workspace, "deep-bow")
    entry = AlgorithmFinder(workspace).find("deep-bow")
    assert entry.kind == "human"
    assert entry.parameters is not None
    assert entry.parameters["depth"].default == 0.4
    process = warm_launcher.start(entry, make_start(frames=4))
    rows = [m.row for m in play(warm_launcher, process, 4) if isinstance(m, Answer)]
    head = [row[4 + 8 : 4 + 12] for row in rows]
    assert abs(head[1] - head[3]).max() > 0.1
    assert rows[0][176 + 2] == 1.0


def test_the_readme_prints_what_is_written(workspace):
    program = new_algorithm(workspace, "bow").read_text()
    assert f"```python\n{program}```" in (CHECKOUT / "README.md").read_text()


def test_a_new_object_algorithm_goes_with_the_hand(warm_launcher, make_start, workspace):
    new_algorithm(workspace, "carried", "object")
    entry = AlgorithmFinder(workspace).find("carried")
    process = warm_launcher.start(entry, make_start("object"))
    rows = [m.row for m in play(warm_launcher, process, 3, object_frame) if isinstance(m, Answer)]
    assert [round(float(row[1]), 6) for row in rows] == [0.4, 0.41, 0.42]


def test_a_new_algorithm_in_c_is_to_be_built(workspace):
    program = new_algorithm(workspace, "bob", language="c")
    assert program.name == "bob.c"
    with pytest.raises(NotBuilt, match="make -C algorithms/bob"):
        AlgorithmFinder(workspace).find("bob")


@pytest.mark.parametrize(
    ("name", "kind", "language", "reason"),
    [
        ("nod", "human", "python", "exists already"),
        ("no name", "human", "python", "is no name"),
        ("../out", "human", "python", "is no name"),
        ("fresh", "animal", "python", "it is human or object"),
        ("fresh", "human", "cobol", "there is python"),
        ("fresh", "object", "c", "there is python"),
    ],
)
def test_what_cannot_be_written_is_said(workspace, name, kind, language, reason):
    with pytest.raises(CommandError, match=reason):
        new_algorithm(workspace, name, kind, language)
    assert not (workspace.root / "algorithms" / "fresh").exists()
