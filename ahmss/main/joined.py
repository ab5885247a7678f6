"""Orders of one line: made together, or one after the other."""

from __future__ import annotations

from collections.abc import Sequence

from ahmss.errors import CommandError
from ahmss.main.order import Order

__all__ = ["lasting", "refuse_two_carriers", "title"]


def refuse_two_carriers(orders: Sequence[Order]) -> None:
    """Of motions made together one may take the body elsewhere: the feet would slide between two.

    Those of one chain, joined by `then`, are made one after the other.

    Raises:
        CommandError: names the two.
    """
    chains: list[list[Order]] = []
    for order in orders:
        if order.act.follows:
            chains[-1].append(order)
        else:
            chains.append([order])
    carriers = [[order.title for order in chain if order.human_algorithm.carries] for chain in chains]
    titles = [names[0] for names in carriers if names]
    if len(titles) > 1:
        raise CommandError(
            f"{titles[0]} with {titles[1]}: each takes the body its own way, and only one can at a time; "
            "join them by `then`, or do one after the other, each in a line of its own"
        )


def title(orders: Sequence[Order]) -> str:
    """How the console calls motions made together and one after the other."""
    joined = [(" then " if order.act.follows else " with ") + order.title for order in orders]
    return "".join(joined).removeprefix(" with ")


def lasting(orders: Sequence[Order], rate: float) -> str:
    """How long they take, in words; who says itself when it is over keeps to what was asked for where that will do."""
    seconds = f"{_longest(orders) / rate:.1f} s"
    if not all(order.frames for order in orders):
        return "as long as it needs"
    return f"{seconds}, or as long as it needs" if any(order.wish for order in orders) else seconds


def _longest(orders: Sequence[Order]) -> int:
    """Frames until the last of them is over."""
    ends: list[int] = []
    for order in orders:
        before = ends.pop() if order.act.follows else 0
        ends.append(before + order.after + order.frames)
    return max(ends)
