"""One motion to be made: what was typed, with all that the database knows of it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ahmss.algorithm import messages
from ahmss.database.records import Affordance, AlgorithmEntry
from ahmss.main.command import Act

__all__ = ["Order"]


@dataclass(frozen=True, slots=True)
class Order:
    """An act, resolved."""

    act: Act
    object: str
    affordance: Affordance
    human_algorithm: AlgorithmEntry
    object_algorithm: AlgorithmEntry | None
    frames: int
    after: int
    hand: str
    goal: messages.Goal
    parameters: dict[str, Any]
    object_parameters: dict[str, Any]
    whom: str = ""  # the other human, of what changes hands
    patience: float = 0.0  # seconds that one waits for what another has

    @property
    def wish(self) -> bool:
        """Whether its frames are a wish: its algorithm says itself when it is over."""
        return self.affordance.frames == 0 or (self.human_algorithm.stretches and not self.act.frames)

    @property
    def title(self) -> str:
        """How the console calls it: `cup grasp`."""
        return f"{self.whom or self.object} {self.affordance.name}"
