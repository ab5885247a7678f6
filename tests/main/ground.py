"""What the tests of main share."""

from __future__ import annotations

from collections import deque

from ahmss.main.command import parse
from ahmss.main.script import Step


def steps(*lines: str) -> deque[Step]:
    """Lines of a script as steps."""
    out: deque[Step] = deque()
    for number, text in enumerate(lines, 1):
        line = parse(text)
        assert line is not None
        out.append(Step(line, number, f"line {number}"))
    return out
