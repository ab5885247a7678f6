"""What may be started some time, of all that a workspace affords."""

from __future__ import annotations

from pathlib import Path

from ahmss.database.workspace import Workspace
from ahmss.main.expected import programs

ROOT = Path(__file__).resolve().parents[2]


def test_each_program_comes_once_with_each_motion_that_it_gets():
    found = programs(Workspace.find(ROOT))
    told = {(entry.name, motion and motion.name, frames) for entry, motion, frames in found}
    assert {("walk", "walk.npz", 0), ("grasp", None, 30), ("follow_hand", None, 0)} <= told
    assert sum(entry.name == "follow_hand" for entry, _, _ in found) == 1
    drinks = [motion for entry, motion, _ in found if entry.name == "slerp" and motion is not None]
    assert any(motion == ROOT / "objectdb" / "cup" / "drink.npz" for motion in drinks)


def test_a_broken_kind_hides_its_own_alone(tmp_path):
    for name, text in (("good", 'human_algorithm = "nod"'), ("bad", 'human_algorithm = "nobody"')):
        (tmp_path / "objectdb" / name).mkdir(parents=True)
        (tmp_path / "objectdb" / name / "object.toml").write_text(f'name = "{name}"\n[affordances.it]\n{text}\n')
    for folder in ("humandb", "algorithms/nod"):
        (tmp_path / folder).mkdir(parents=True)
    (tmp_path / "algorithms" / "nod" / "algorithm.toml").write_text('kind = "human"\nargv = ["python", "nod.py"]\n')
    (tmp_path / "algorithms" / "nod" / "nod.py").touch()
    assert [entry.name for entry, _, _ in programs(Workspace(tmp_path))] == ["nod"]
