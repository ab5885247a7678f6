"""A small workspace of its own for each test."""

from __future__ import annotations

from pathlib import Path

import pytest

from ahmss.database import Workspace


@pytest.fixture(autouse=True)
def _store(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """Converted shapes are kept away from the user's own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("store")))


@pytest.fixture
def workspace(tmp_path: Path) -> Workspace:
    for folder in ("objectdb", "humandb", "algorithms"):
        (tmp_path / folder).mkdir()
    return Workspace(tmp_path)


def add_object(workspace: Workspace, name: str, text: str) -> Path:
    """objectdb/NAME/object.toml with this text."""
    file = workspace.root / "objectdb" / name / "object.toml"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")
    return file


def add_algorithm(workspace: Workspace, name: str, text: str, base: str = "algorithms") -> Path:
    """BASE/NAME/algorithm.toml with this text and an empty NAME.py."""
    folder = workspace.root / base / name
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"{name}.py").write_text("")
    (folder / "algorithm.toml").write_text(text, encoding="utf-8")
    return folder
