"""Fields of distances that are there before a hand asks for them."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from ahmss.algorithm.shape import TargetShape
from ahmss.database import Workspace
from ahmss.grasping import distance
from ahmss.processes import foresight

ROOT = Path(__file__).resolve().parents[2]
WALL = np.array([0.0, 0.0, 0.052])  # the cup's


@pytest.fixture(autouse=True)
def fields(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where fields are kept, in a store of its own; and this process keeps its priority."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(os, "nice", lambda _: 0)
    return tmp_path / "ahmss" / "fields"


def test_the_place_where_a_kind_is_taken_is_ready_then(fields: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    foresight.make_fields(ROOT, ["no such kind", "floor", "cup"])
    made = sorted(file.name for file in fields.iterdir())
    assert len(made) == 1  # all that is done to a cup is done at its wall; a floor is not taken
    monkeypatch.setattr(distance, "build", None)  # it is made already
    path, digest = Workspace(ROOT).objects.kept_shape("cup") or (Path(), "")
    field = TargetShape(str(path), digest).field(WALL)
    assert field.clearance(np.array([[0.046, 0.0, 0.05]]))[0] == pytest.approx(0.01, abs=1.5e-3)
    foresight.make_fields(ROOT, ["cup"])
    assert sorted(file.name for file in fields.iterdir()) == made
