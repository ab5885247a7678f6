"""From hand to hand: what is to be given, how it is taken, and how it changes its main.

The giver's algorithm says when the other hand has closed, the receiver's when its own has; both by the state `held` of
the thing. Then neither is asked for frames until the world has made the change, so both bodies stand still for as long
as that takes. The giver's main moves the thing no more from the moment that it asks; the receiver's moves it from the
moment that it has it. In between it stays where it is, and belongs to one or the other.
"""

from __future__ import annotations

from collections.abc import Mapping

from ahmss.database.records import Affordance, ObjectKind
from ahmss.database.workspace import Workspace
from ahmss.errors import CommandError
from ahmss.main.afforded import Actor
from ahmss.main.company import KIND
from ahmss.main.description import Scene
from ahmss.world.schema import ObjectRecord

__all__ = ["GIVE", "PASSING", "RECEIVE", "passed", "refuse_full", "taking"]

GIVE, RECEIVE = "give", "receive"
PASSING = (GIVE, RECEIVE)
_HANDS = 2


def passed(scene: Scene, actor: Actor, whom: str, affordance: Affordance, hand: str, named: str) -> str:
    """The thing that changes hands: the one named, the one in that hand, or the only one.

    Args:
        scene: the world. actor: who acts. whom: the other human.
        affordance: which says whether it is given or received. hand: of the giver, or "". named: its full name, or "".

    Raises:
        CommandError: there is none, or more than one; says what to do.
    """
    giving = affordance.hold == GIVE
    held = _in_hands(actor.holds) if giving else in_hands_of(scene, whom)
    who = actor.name if giving else whom
    if giving and hand:
        held = {name: side for name, side in held.items() if side == hand}
    title = f"{whom} {affordance.name}"
    if named:
        if named not in held:
            raise CommandError(f"{title}: {who} does not hold {named}; {_has(who, held)}")
        return named
    if not held:
        raise CommandError(f"{title}: {who} holds nothing{f' in the {hand} hand' if hand and giving else ''}")
    if len(held) > 1:
        raise CommandError(f"{title}: which? {_has(who, held)}; say which by `to` and its name")
    return next(iter(held))


def taking(workspace: Workspace, record: ObjectRecord) -> tuple[ObjectKind, Affordance]:
    """How a thing is taken in a hand, which is how it is received as well.

    Raises:
        CommandError: it is taken in no hand, or between both. DataError: its file is wrong.
    """
    kind = workspace.objects.get(record.kind)
    for affordance in kind.affordances.values():
        free = affordance.needs.get("free_hands", 1.0)
        if affordance.hold != "take" or free <= 0.0 or affordance.of:
            continue
        if free > 1.0:
            down = next((one.name for one in kind.affordances.values() if one.hold == "release"), "put it down")
            raise CommandError(
                f"{record.name} can't be handed over: it is carried between both hands; `do {record.name} {down}`, and "
                f"who is to have it does `do {record.name} {affordance.name}`"
            )
        return kind, affordance
    raise CommandError(f"{record.name} can't be handed over: nothing in its file says how a hand takes it")


def refuse_full(scene: Scene, title: str, whom: str) -> None:
    """Refuse to give something to who has no hand free.

    Raises:
        CommandError: says what they hold.
    """
    held = in_hands_of(scene, whom)
    if len(set(held.values())) >= _HANDS:
        raise CommandError(f"{title}: {whom} has no hand free; {_has(whom, held)}")


def in_hands_of(scene: Scene, human: str) -> dict[str, str]:
    """What another human holds, and in which hand, as the world has it."""
    return {
        name: record.hand
        for name, record in scene.objects.items()
        if record.kind != KIND and record.holder == human and record.hand
    }


def _in_hands(holds: Mapping[str, str]) -> dict[str, str]:
    return {name: hand for name, hand in holds.items() if hand}


def _has(who: str, held: Mapping[str, str]) -> str:
    return f"{who} holds {', '.join(held) or 'nothing'}"
