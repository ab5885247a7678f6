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


@pytest.mark.parametrize(
    ("words", "code"),
    [
        pytest.param(["--help"], 0, marks=pytest.mark.long),
        (["--chekc"], 2),
        pytest.param(["check"], 2, marks=pytest.mark.long),
    ],
)
def test_the_script_makes_nothing_where_it_is_asked_for_help_or_is_not_understood(words: list[str], code: int) -> None:
    done = subprocess.run(
        [sys.executable, "scripts/make_motions.py", *words], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == code
    assert "--check" in done.stdout + done.stderr
    assert "frames" not in done.stdout
