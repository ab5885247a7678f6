"""Property tests: the same examples every time, however slow the machine. Files that take longest come first."""

import os
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("steady", deadline=None, derandomize=True, max_examples=25)
settings.load_profile("steady")

# The longest first, so that no worker is left alone with one in the end (`--dist loadfile`); the others as they come.
LONGEST = (
    "main/test_play.py", "demo/test_put.py", "demo/test_scenario.py", "main/test_process.py",
    "algorithms/test_swing.py", "demo/test_beside.py", "algorithms/test_turn.py", "walking/test_trip.py",
    "main/test_company.py", "main/test_coming.py", "people/test_reading_what_was_given.py",
    "algorithms/test_controls.py", "algorithms/test_typing.py", "algorithms/test_reach_rows.py",
    "algorithms/test_elsewhere.py", "algorithms/test_taking_up.py", "bench/test_compute.py",
    "algorithms/test_reach.py", "walking/test_moves.py", "algorithms/test_random_panels.py", "demo/test_chair.py",
    "database/test_layout_and_check.py", "demo/test_carton.py", "capture/test_round_trip.py",
    "capture/test_record.py", "grasping/test_grips.py", "demo/test_door.py", "algorithms/test_grasp.py",
    "demo/test_film.py", "algorithms/test_reach_scenes.py", "main/test_chain.py", "capture/test_device.py",
    "mind/test_mcp.py", "algorithms/test_rolling.py", "algorithm/test_pool.py", "demo/test_mug.py",
    "capture/test_live.py", "capture/test_simulator_process.py", "algorithms/test_before_grip.py",
    "main/test_ways.py", "demo/test_own_arm.py", "demo/test_grip.py", "grasping/test_distance.py",
    "world/test_falling.py", "main/test_waiting.py", "walking/test_captures.py", "capture/test_subject.py",
)  # fmt: skip


_MOST = 8  # workers: with more the longest file decides


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers() -> int:
    """What `-n auto` means: half as many more than processors, for a test waits for a clock a third of its time."""
    return min(-(-3 * (os.cpu_count() or 1) // 2), _MOST)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Sort by file alone, which keeps the order within each."""
    here = Path(__file__).parent
    ranks = {here / name: rank for rank, name in enumerate(LONGEST)}
    items.sort(key=lambda item: ranks.get(item.path, len(LONGEST)))
