"""Humans that nobody moves any more, as their main is gone: what is added where a person is told of one."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

from ahmss.world.schema import HumanRecord

__all__ = ["with_left_behind"]

_ASK = re.compile(r"(?:, or|;) ask them to move(?:, as by `.*`)?$")


def with_left_behind(text: str, humans: Iterable[HumanRecord], *, in_vain: bool) -> str:
    """What is told, and of each human named in it whose main is gone that it is, and when they leave.

    in_vain: whether one has given up. Nobody is told to ask them to move.
    """
    gone = [
        human for human in humans if human.leaves_s and re.search(rf"(?<![\w-]){re.escape(human.name)}(?![\w-])", text)
    ]
    if not gone:
        return text
    return "; ".join([_ASK.sub("", text), *(_said(human, in_vain) for human in gone)])


def _said(human: HumanRecord, in_vain: bool) -> str:
    name = human.name
    if math.isinf(human.leaves_s):
        return f"nobody moves {name} any more: `ahmss main --human {name}` does"
    return f"the main that moved {name} is gone, and {name} leaves within {human.leaves_s:.0f} s" + (
        ": do it again then" if in_vain else ""
    )
