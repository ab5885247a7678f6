"""An act as a Python program says it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from ahmss.port.schema import Act

__all__ = ["act"]


def act(
    object: str | Sequence[float], action: str, *, to: str | Sequence[float] = (), facing_deg: float | None = None,  # noqa: A002
    hand: str = "", pose: str = "", frames: int | None = None, parameters: Mapping[str, str | float] | None = None,
    after: int = 0, follows: bool = False,
) -> Act:  # fmt: skip
    """One motion of a line, for `Client.together`; arguments as `Client.do` has them, and as `Act` says."""
    return Act(
        object if isinstance(object, str) else "",
        action,
        () if isinstance(object, str) else tuple(object),
        () if isinstance(to, str) else tuple(to),
        to if isinstance(to, str) else "",
        facing_deg,
        hand,
        pose,
        dict(parameters or {}),
        frames,
        after,
        follows,
    )
