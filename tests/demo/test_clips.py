"""The shipped motion clips are those that their script makes."""

from __future__ import annotations

import subprocess
import sys

import pytest

from .conftest import ROOT


@pytest.mark.long
@pytest.mark.timeout(180)
def test_the_script_makes_the_clips_that_are_here() -> None:
    done = subprocess.run(
        [sys.executable, "scripts/make_motions.py", "--check"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
