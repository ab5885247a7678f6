"""Property tests: the same examples every time, however slow the machine. Files that take longest come first."""

import os
from pathlib import Path

import pytest
from hypothesis import settings

settings.register_profile("steady", deadline=None, derandomize=True, max_examples=25)
settings.load_profile("steady")

# The longest first, so that no worker is left alone with one in the end (`--dist loadfile`); the others as they come.
LONGEST = (
    "algorithms/test_turn.py", "algorithms/test_controls.py", "walking/test_trip.py", "algorithm/test_pool.py",
    "algorithms/test_typing.py", "main/test_play.py", "algorithms/test_swing.py", "algorithms/test_before_grip.py",
    "people/test_handing.py", "capture/test_live.py", "demo/test_scenario.py", "demo/test_beside.py",
    "main/test_process.py", "people/test_handing_live.py", "algorithms/test_taking_up.py", "demo/test_put.py",
    "database/test_layout_and_check.py", "algorithms/test_keeping.py", "main/test_company.py", "mind/test_mcp.py",
    "people/test_reading_what_was_given.py", "main/test_waiting.py", "demo/test_film.py", "capture/test_record.py",
    "grasping/test_grips.py", "algorithms/test_elsewhere.py", "algorithms/test_panels.py", "capture/test_device.py",
    "demo/test_mug.py", "people/test_walking_past.py", "algorithms/test_reach.py", "algorithms/test_reach_rows.py",
    "world/test_falling.py", "algorithms/test_rolling.py", "capture/test_simulator_process.py",
    "bench/test_compute.py", "people/test_hands_by_the_way.py", "walking/test_moves.py", "main/test_scenes.py",
    "demo/test_chair.py", "world/test_server.py", "walking/test_goals.py", "algorithms/test_high_flat_panels.py",
    "algorithms/test_grasp.py", "algorithms/test_random_panels.py", "algorithms/test_press.py",
    "people/test_meeting.py", "reaching/test_carried.py", "people/test_behind.py", "main/test_ways.py",
    "viewer/test_files.py", "algorithms/test_gesture.py", "demo/test_door.py", "capture/test_subject.py",
    "bench/test_judge.py", "algorithm/test_misbehaviour.py", "viewer/test_live.py", "walking/test_captures.py",
    "main/test_chain.py", "main/test_port.py", "main/test_coming.py", "algorithms/test_carrying.py",
    "main/test_late_objects.py", "demo/test_carton.py", "capture/test_round_trip.py", "main/test_control_room.py",
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
