"""Workers that hold old code are not used."""

from __future__ import annotations

import re
from pathlib import Path

import ahmss
from ahmss.processes import runtime

ROOT = Path(ahmss.__file__).parent


def test_the_stamp_is_of_every_package_that_algorithms_use() -> None:
    files = [*(ROOT / "algorithm").glob("*.py"), *(ROOT.parent / "algorithms").glob("*/*.py")]
    used = {name for file in files for name in re.findall(r"^from ahmss\.(\w+)", file.read_text(), re.MULTILINE)}
    packages = {name for name in used if (ROOT / name).is_dir()}
    assert {"grasping", "reaching", "walking"} < packages
    assert packages <= set(runtime._PACKAGES)
