"""What changed since the last tick, for those who must be told: the journal, the scene, mains in lockstep."""

from __future__ import annotations

from dataclasses import dataclass, field

__all__ = ["Changes"]


@dataclass
class Changes:
    """Collected during a tick, taken whole at its end.

    Attributes:
        put: names of objects that are new, or whose states, holder or resting place changed; in order, once each.
        gone: ids of objects that were removed.
        moved: ids of objects that were moved, and the client that moved each last.
        humans_put, humans_gone: names of humans that came, ids of humans that went.
        ways_gone: ids of humans that stay and whose ways are not known any more, but by a frame without one.
        is_structural: what exists changed, so the scene needs a new revision.
    """

    put: dict[str, None] = field(default_factory=dict[str, None])
    gone: list[int] = field(default_factory=list[int])
    moved: dict[int, bytes] = field(default_factory=dict[int, bytes])
    humans_put: dict[str, None] = field(default_factory=dict[str, None])
    humans_gone: list[int] = field(default_factory=list[int])
    ways_gone: dict[int, None] = field(default_factory=dict[int, None])
    is_structural: bool = False

    @property
    def is_quiet(self) -> bool:
        """Whether nothing changed but poses."""
        return not (self.put or self.gone or self.humans_put or self.humans_gone or self.ways_gone)
