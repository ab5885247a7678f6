"""What was typed beside an action: whether it is enough, known and allowed, and what it comes to."""

from __future__ import annotations

import math
from typing import Any

from ahmss.database.records import Affordance, AlgorithmEntry
from ahmss.errors import CommandError
from ahmss.main.command import Act, Value

__all__ = ["PATIENCE", "frames_of", "patience_of", "refuse_incomplete", "refuse_unknown"]

PATIENCE = "patience"
"""What may be said of every action: seconds that one waits for what another has."""

_PATIENCE, _MOST_PATIENCE = 10.0, 3600.0  # seconds: where nobody says, and at the most


def refuse_unknown(
    title: str,
    typed: tuple[tuple[str, Value], ...],
    affordance: Affordance,
    human: AlgorithmEntry,
    mover: AlgorithmEntry | None,
) -> None:
    """Refuse a typed parameter that neither algorithm declares and the affordance does not name."""
    declared = [entry.parameters for entry in (human, mover) if entry is not None]
    if any(parameters is None for parameters in declared):
        return
    known = {*affordance.parameters, *(name for parameters in declared for name in parameters or {})}
    for name, _ in typed:
        if name not in {PATIENCE, *known}:
            every = "" if PATIENCE in known else f"; every action: {PATIENCE}"
            raise CommandError(f'{title}: no parameter "{name}"; it takes: {", ".join(sorted(known)) or "none"}{every}')


def refuse_incomplete(title: str, act: Act, affordance: Affordance) -> None:
    """Refuse an act that leaves out what its action can't do without: a facing and a hand are found, a goal is not."""
    if "goal_position" in affordance.asks and not (act.goal_place or act.goal_object):
        raise CommandError(f"{title}: asks for a place; add `to X Y Z`, or `to` and an object")
    if "goal_posture" in affordance.asks and not act.posture:
        raise CommandError(f"{title}: asks for a posture; add `pose` and a motion clip")


def frames_of(act: Act, affordance: Affordance, human: AlgorithmEntry) -> int:
    """How many frames: as many as was said, but no fewer than the motion takes; else the action's own number."""
    if not act.frames:
        return affordance.frames
    return max(act.frames, math.ceil(human.fewest * affordance.frames))


def patience_of(title: str, act: Act, parameters: dict[str, Any]) -> float:
    """Seconds that one waits for what another has."""
    value = dict(act.parameters).get(PATIENCE, _PATIENCE) if PATIENCE not in parameters else _PATIENCE
    if not isinstance(value, int | float) or not 0.0 <= value <= _MOST_PATIENCE:
        raise CommandError(f'{title}: patience "{value}" is no number of seconds; allowed: 0 to {_MOST_PATIENCE:g}')
    return float(value)
