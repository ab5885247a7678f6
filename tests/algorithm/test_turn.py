"""Who thinks asks for long turns on the processor, where the system has such."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

TELLS = """
from pathlib import Path
from ahmss.processes.turn import take_long_turns
before = Path("/proc/self/sched").read_text()
take_long_turns()
print(before, "then", Path("/proc/self/sched").read_text())
"""


def _newer() -> bool:
    found = re.match(r"(\d+)\.(\d+)", os.uname().release)
    return sys.platform == "linux" and found is not None and tuple(map(int, found.groups())) >= (6, 12)


@pytest.mark.skipif(not _newer() or not Path("/proc/self/sched").exists(), reason="no turns of one's own")
def test_who_thinks_takes_long_turns_and_keeps_its_priority() -> None:
    told = subprocess.run(["nice", "-n", "3", sys.executable, "-c", TELLS], capture_output=True, text=True, check=True)
    before, after = (
        {name: int(value) for name, value in re.findall(r"^(se\.slice|policy|prio)\s*:\s*(\d+)$", part, re.MULTILINE)}
        for part in told.stdout.split("then")
    )
    assert before["se.slice"] < 10_000_000 < after["se.slice"]
    assert (before["prio"], before["policy"]) == (after["prio"], after["policy"])
