"""Real motion capture beside the checkout; a test that needs it is skipped where it is missing."""

from __future__ import annotations

from pathlib import Path

import pytest

MOCAP = Path(__file__).parents[2].parent / "shared" / "mocap" / "accad_female1"


def capture_path(name: str) -> Path:
    """The file of a clip by a part of its name."""
    found = sorted(MOCAP.glob(f"*{name}*.bvh"))
    if not found:
        pytest.skip(f"no motion capture in {MOCAP}")
    return found[0]
