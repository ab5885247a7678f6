"""The objects that one human has: asked for at the server, moved by an algorithm of theirs once granted, let go."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from ahmss.database.records import Affordance
from ahmss.database.statefile import HELD
from ahmss.errors import AhmssError, Unreachable, WorldError
from ahmss.main.afforded import Actor
from ahmss.main.communication import Communication
from ahmss.main.motion import Mover
from ahmss.main.order import Order
from ahmss.main.passing import GIVE, RECEIVE
from ahmss.world.link import Pending

__all__ = ["Claims", "refusal", "wants_free"]


class Claims:
    """What one human moves, object by object; nothing here knows of the motions that need it.

    Args:
        actor: gives the human as it is now.
    """

    def __init__(self, communication: Communication, actor: Callable[[], Actor]) -> None:
        self._communication, self._actor = communication, actor
        self._movers: dict[str, Mover] = {}
        self._passing: list[tuple[Mover, Pending]] = []  # what was on its way when its motion was given up

    def __contains__(self, name: str) -> bool:
        """Whether an object is moved or asked for."""
        return name in self._movers

    @property
    def movers(self) -> list[Mover]:
        """All that is moved or asked for, in the order in which it was asked for."""
        return list(self._movers.values())

    @property
    def asking(self) -> bool:
        """Whether the server has still to answer for one of them."""
        return any(mover.claim is not None for mover in self._movers.values())

    @property
    def holds(self) -> dict[str, str]:
        """The objects that were taken, each with the hand that holds it ("": none, it is sat on)."""
        return {name: mover.order.hand for name, mover in self._movers.items() if mover.takes and not mover.awaits}

    @property
    def between(self) -> frozenset[str]:
        """Those of them that are held between both hands, as it took two free ones to take them."""
        needs = {name: self._movers[name].order.affordance.needs for name in self.holds}
        return frozenset(name for name, least in needs.items() if least.get("free_hands", 0.0) > 1.0)

    def holder(self, name: str) -> str:
        """Another human that has an object, as far as is known here; "" where there is none."""
        record = self._communication.world.objects.get(name)
        return record.holder if record is not None and record.holder != self._communication.human else ""

    def taken_away(self) -> list[Mover]:
        """What was granted, and another has now."""
        return [mover for mover in self._movers.values() if mover.granted and self.holder(mover.name)]

    def lost(self) -> list[Mover]:
        """What was granted, and the server says this human has no longer, as after a restart that lost the claim."""
        granted = [mover for mover in self._movers.values() if mover.granted]
        held = self._communication.held() if granted else None
        return [mover for mover in granted if held is not None and mover.name not in held]

    # Asking, and being granted

    def claim(self, order: Order) -> Mover | None:
        """The mover of an order's object: a new one that asks for the object, or the one that has it.

        Raises:
            AhmssError: something else of this human's moves it.
        """
        mover = self._movers.get(order.object)
        hold = order.affordance.hold
        if mover is not None and hold == "release":
            if order.object_algorithm is not None:  # it goes on until the motion ends, as what is put down wants
                return mover
            if mover.order.hand:  # the hand opens, and what was in it falls while it does
                self.release(mover)
                return None
            _silence(mover)  # a chair is the sitter's until they have stood up
            return mover
        if order.object_algorithm is None or hold in ("keep", GIVE):
            return mover if hold == GIVE else None
        if mover is not None:
            raise AhmssError(f"{order.title}: {mover.order.title} moves it until it is released")
        number = self._communication.world.objects[order.object].id
        hand = order.hand if hold == "take" else ""
        claim = self._communication.claim(order.object, hand) if hold != RECEIVE else None
        mover = Mover(order, number, self._communication.pose(order.object), claim, self._actor())
        self._movers[order.object] = mover
        return mover

    def granting(self, begin: Callable[[Mover], None]) -> Iterator[tuple[Mover, str]]:
        """Have what the server has granted begun to be moved; one after another what it refused, and why."""
        for mover in self.movers:
            claim = mover.claim
            if claim is None or not claim.done:
                continue
            mover.claim = None
            try:
                claim.result()
                begin(mover)
            except Unreachable:  # the connection broke before the answer: ask again
                mover.claim = self._communication.claim(mover.name, mover.order.hand if mover.takes else "")
            except AhmssError as error:
                yield mover, str(error)

    # Letting go

    def release(self, mover: Mover) -> None:
        """Let the object go where it is."""
        self.forget(mover)
        if mover.granted or mover.claim is not None:
            self._communication.release(mover.name)

    def forget(self, mover: Mover) -> None:
        """It is moved no more, and is nothing of this human's; the server is not told."""
        _silence(mover)
        if self._movers.get(mover.name) is mover:
            del self._movers[mover.name]

    # From hand to hand

    def give(self, mover: Mover, whom: str, state: str) -> Pending:
        """Hand the object to another human: the server's answer."""
        self.forget(mover)
        return self._communication.transfer(mover.name, whom, state)

    def receive(self, mover: Mover) -> None:
        """Ask for what the giver has let go of: the hand has closed on it."""
        mover.given, mover.pose = True, self._communication.pose(mover.name)
        mover.claim = self._communication.claim(mover.name, mover.order.hand)

    def leave_on_its_way(self, mover: Mover, passes: Pending) -> None:
        """Its motion was given up on the way into another hand: it comes there, or is taken back."""
        self._passing.append((mover, passes))

    def settle_what_was_on_its_way(self) -> None:
        """Take back what was refused of that."""
        for mover, passes in [(mover, passes) for mover, passes in self._passing if passes.done]:
            self._passing.remove((mover, passes))
            if refusal(passes):
                self.take_back(mover)

    def take_back(self, mover: Mover) -> None:
        """What could not be given is in the hand as before."""
        mover.order = replace(mover.order, frames=0)  # the hand is closed on it already
        mover.granted, mover.over, mover.given = False, False, True
        mover.claim = self._communication.claim(mover.name, mover.order.hand)
        self._movers[mover.name] = mover


def _silence(mover: Mover) -> None:
    """Its algorithm moves it no more."""
    if mover.process is not None:
        mover.process.stop()
        mover.process = None
    mover.frames.clear()
    mover.over = True


def wants_free(affordance: Affordance, *, moves: bool) -> bool:
    """Whether an action is one of what nobody else has: it `moves` the object, or asks who holds it."""
    if affordance.hold in ("keep", "release"):
        return False
    asks = affordance.when is not None and any(clause.state == HELD for clause in affordance.when.clauses())
    return asks or moves


def refusal(pending: Pending) -> str:
    """Why a request that is done was refused; "" where it was granted."""
    try:
        pending.result()
    except WorldError as error:
        return str(error)
    return ""
