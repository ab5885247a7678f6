"""The bench measures real processes: every case runs, and what goes wrong is no number."""

from __future__ import annotations

import pytest

from ahmss.bench.compute import CASES, rig
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError


def test_every_case_makes_frames_through_real_processes() -> None:
    with rig(Workspace.find()) as one:
        for line in CASES.values():
            assert one.rate(line, frames=5, rounds=2, warm=5) > 0.0


def test_a_line_that_fails_gives_no_number() -> None:
    with rig(Workspace.find()) as one, pytest.raises(AhmssError, match="juggle"):
        one.rate("do thing juggle frames {n}", frames=5, rounds=2, warm=5)
