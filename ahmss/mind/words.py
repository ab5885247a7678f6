"""What a main answers, in words that a language model can act on."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ahmss.client import Affordances, Person, Result, Self, Thing
from ahmss.port.schema import Action

__all__ = ["affordances", "behind", "objects", "outcome", "person", "self_told"]

_ASKS = {
    "goal_position": "needs `to`: x y z in metres, or an object's name",
    "facing": "takes `facing_deg`",
    "goal_posture": "needs `pose`: a motion clip",
    "hand": "takes `hand`: left or right",
}
_BEHIND = 90.0  # degrees aside: what is farther round nobody sees over their shoulder
_OVER = ("done", "failed", "cancelled")


def self_told(me: Self) -> str:
    """Who and where the human is."""
    x, y, _ = me.place
    holds = ", ".join(f"{name} in the {hand} hand" if hand else f"{name} (no hand)" for name, hand in me.holds.items())
    doing = ", ".join(str(number) for number in me.doing)
    return (
        f"You are {me.human}, {me.stature:.2f} m tall. You stand at x {x:.2f} y {y:.2f} (metres) and face "
        f"{me.facing_deg:.0f} degrees (0 is +x, 90 is +y). You hold {holds or 'nothing'}. "
        + (f"Being done or waiting: line {doing}." if doing else "You are doing nothing.")
    )


def person(other: Person) -> str:
    """Another human."""
    return f"{other.name} (another human): {_where(other.distance, other.direction_deg)}"


def objects(things: list[Thing]) -> str:
    """A line for each object, the near ones first."""
    return "\n".join(_thing(thing) for thing in sorted(things, key=lambda thing: thing.distance))


def _thing(thing: Thing) -> str:
    states = ", ".join(f"{name} is {value}" for name, value in thing.states.items())
    x, y, z = thing.place
    parts = [_where(thing.distance, thing.direction_deg), f"at {x:.2f} {y:.2f} {z:.2f}"]
    parts += [states] if states else []
    parts += [f"held by {thing.holder}" + (f" in the {thing.hand} hand" if thing.hand else "")] if thing.holder else []
    parts += [] if thing.seen else ["not in sight"]
    return f"{thing.name}: {thing.sentence or thing.kind} [{'; '.join(parts)}]"


def _where(distance: float, direction: float) -> str:
    if abs(direction) < 10.0:
        side = "ahead"
    elif abs(direction) > 170.0:
        side = "behind"
    else:
        side = f"{abs(direction):.0f} degrees to the {'left' if direction > 0.0 else 'right'}"
    return f"{distance:.1f} m {side}"


def behind(me: Self, what: str, place: Sequence[float]) -> str:
    """What is to be said of a picture of a place (metres) behind the human: how to turn there; "" where it is ahead."""
    x, y = place[0] - me.place[0], place[1] - me.place[1]
    bearing = math.degrees(math.atan2(y, x))
    aside = (bearing - me.facing_deg + 180.0) % 360.0 - 180.0
    if abs(aside) <= _BEHIND:
        return ""
    side = "left" if aside > 0.0 else "right"
    return (
        f"{what} is behind you, {abs(aside):.0f} degrees to the {side}: the picture shows what you see once you have "
        f'turned. To turn: act(object="floor", action="walk", to="{me.place[0]:.2f} {me.place[1]:.2f}", '
        f"facing_deg={bearing:.0f})."
    )


def affordances(told: Affordances, *, parameters: bool = True) -> str:
    """What an object affords now, and what not and why."""
    lines = [f"{told.object} affords you now:" if told.now else f"{told.object} affords you nothing now."]
    lines += [_action(action, parameters=parameters) for action in told.now]
    if told.later:
        lines.append("Not now:")
        lines += [
            f"- {action.name}: {action.reason.removeprefix(f'{told.object} {action.name}: ')}" for action in told.later
        ]
    return "\n".join(lines)


def _action(action: Action, *, parameters: bool) -> str:
    asks = "; ".join(_ASKS.get(ask, ask) for ask in action.asks)
    frames = f"{action.frames} frames" if action.frames else "as long as it needs"
    line = f"- {action.name}: {action.sentence} ({'; '.join(filter(None, (asks, frames)))})"
    if parameters and action.parameters:
        line += "".join(f"\n    parameter {name}: {told}" for name, told in action.parameters.items())
    return line


def outcome(result: Result, rate: float) -> str:
    """What has become of a line."""
    seconds = f"{result.frames / rate:.1f} s"
    notes = "".join(f"\nNote: {note}" for note in result.notes)
    if result.status == "waiting":
        return f"Line {result.number} waits for those before it: {result.line}"
    if result.status not in _OVER:
        parts = ", ".join(f"{p.title} at frame {p.frame}" + (f" of {p.of}" if p.of else "") for p in result.parts)
        return (
            f"Line {result.number} goes on since {seconds} ({parts or result.line}); call wait with number="
            f"{result.number} for its end, or stop.{notes}"
        )
    why = f": {result.reason}" if result.reason else ""
    return f"Line {result.number} {result.status} after {seconds}{why}. It was: {result.line}{notes}"
