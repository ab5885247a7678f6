"""Property tests: the same examples every time, however slow the machine. Files that take longest come first."""

from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("steady", deadline=None, derandomize=True, max_examples=25)
settings.load_profile("steady")

# The longest first, so that no worker is left alone with one in the end (`--dist loadfile`); the others as they come.
LONGEST = (
    "main/test_play.py", "main/test_process.py", "demo/test_put.py", "demo/test_scenario.py", "walking/test_trip.py",
    "grasping/test_grips.py", "demo/test_chair.py", "algorithms/test_typing.py", "database/test_layout_and_check.py",
    "algorithms/test_controls.py", "capture/test_device.py", "capture/test_record.py", "walking/test_moves.py",
    "algorithms/test_taking_up.py", "mind/test_mcp.py", "capture/test_live.py", "algorithm/test_pool.py",
    "main/test_motion_commands.py", "capture/test_subject.py", "world/test_falling.py", "walking/test_captures.py",
)  # fmt: skip


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Sort by file alone, which keeps the order within each."""
    here = Path(__file__).parent
    ranks = {here / name: rank for rank, name in enumerate(LONGEST)}
    items.sort(key=lambda item: ranks.get(item.path, len(LONGEST)))
