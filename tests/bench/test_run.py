"""`ahmss bench` and what its help says of it."""

from __future__ import annotations

from typing import get_args, get_type_hints

from ahmss.bench.run import MEASURES
from ahmss.cli import bench


def test_the_help_names_all_that_can_be_measured() -> None:
    argument = get_args(get_type_hints(bench, include_extras=True)["what"])[1]
    assert argument.help == f"{', '.join(MEASURES)}; left out: all."
