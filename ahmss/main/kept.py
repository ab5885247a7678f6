"""What was brought to its place and is in the hand still: told, for who reads `put: done` takes it to be let go."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ahmss.database.workspace import Workspace
from ahmss.main.command import Do, Line
from ahmss.main.order import Order
from ahmss.world.schema import ObjectRecord

__all__ = ["is_about", "still_in_hand"]


def is_about(line: Line | None, name: str) -> bool:
    """Whether a line does something with that object, whole its name or the last part of it."""
    return isinstance(line, Do) and any(f"/{name}".endswith(f"/{act.object}") for act in line.acts)


def still_in_hand(
    orders: Sequence[Order], objects: Mapping[str, ObjectRecord], human: str, workspace: Workspace
) -> list[str]:
    """A sentence for each thing that motions brought somewhere and that a hand has still.

    Args:
        orders: of the motions that are over. objects: of the world. human: whose.
        workspace: whose kinds say how one lets go.
    """
    said: dict[str, str] = {}
    for order in orders:
        record = objects.get(order.object)
        if record is None or record.holder != human or not record.hand or "goal_position" not in order.affordance.asks:
            continue
        if release := workspace.objects.get(record.kind).lets_go:
            said[record.name] = (
                f"{order.title}: {record.name} is in the {record.hand} hand still; "
                f"`do {record.name} {release}` lets go of it"
            )
    return list(said.values())
