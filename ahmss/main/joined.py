"""Orders of one line: made together, or one after the other."""

from __future__ import annotations

from collections.abc import Sequence

from ahmss.errors import CommandError
from ahmss.main.database import Order

__all__ = ["longest", "refuse_two_carriers", "title"]


def refuse_two_carriers(orders: Sequence[Order]) -> None:
    """Of motions made together one may take the body elsewhere: the feet would slide between two.

    Raises:
        CommandError: names the two.
    """
    titles = [order.title for order in orders if order.human_algorithm.carries]
    if len(titles) > 1:
        raise CommandError(
            f"{titles[0]} with {titles[1]}: each takes the body its own way, and only one can at a time; "
            "do one after the other, each in a line of its own"
        )


def title(orders: Sequence[Order]) -> str:
    """How the console calls motions made together and one after the other."""
    joined = [(" then " if order.act.follows else " with ") + order.title for order in orders]
    return "".join(joined).removeprefix(" with ")


def longest(orders: Sequence[Order]) -> int:
    """Frames until the last of them is over."""
    ends: list[int] = []
    for order in orders:
        before = ends.pop() if order.act.follows else 0
        ends.append(before + order.after + order.frames)
    return max(ends)
