"""The table scenario of examples/, played as fast as it can, once for all tests."""

from __future__ import annotations

from pathlib import Path

import pytest

from ahmss.main.play import PlaySetup, play_script

from .recorded import Recorded

ROOT = Path(__file__).resolve().parents[2]
CUP, DOOR = "room/cup", "room/doorway/door"


@pytest.fixture(scope="session")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("demo") / "table.rec"
    report = play_script(ROOT / "examples" / "table.txt", PlaySetup(workspace=str(ROOT), fast=True, record=path))
    assert report.failures == 0
    return path


@pytest.fixture(scope="session")
def demo(recording: Path) -> Recorded:
    return Recorded.read(recording, "ken", (CUP, DOOR))
