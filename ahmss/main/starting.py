"""The start of a motion and of what it moves: checked, claimed, and handed to processes of their algorithms."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import msgspec

from ahmss.algorithm.haste import too_few
from ahmss.errors import CommandError
from ahmss.main.afforded import Actor
from ahmss.main.claims import Claims, wants_free
from ahmss.main.communication import Communication
from ahmss.main.company import beside, met, numbers
from ahmss.main.database import Database
from ahmss.main.motion import Motion, Mover
from ahmss.main.order import Order
from ahmss.main.showing import Showing
from ahmss.main.surroundings import NOTHING, known
from ahmss.processes.launcher import Launcher

__all__ = ["Starting"]

_SAYS_SO = 30  # frames after which who waits says so again


class Starting:
    """Starts what one human does.

    Args:
        note: is told in one line what the person may want to know.
        actor: gives the human as it is now.
        rate: frames a second.
        seed: of the run; each process gets one of its own from it.
    """

    def __init__(
        self, database: Database, communication: Communication, launcher: Launcher, claims: Claims, showing: Showing,
        note: Callable[[str], None], actor: Callable[[], Actor], rate: float, seed: int,
    ) -> None:  # fmt: skip
        self._database, self._communication, self._launcher = database, communication, launcher
        self._claims, self._showing, self._note, self._actor = claims, showing, note, actor
        self._rate, self._seed = rate, seed

    def start(self, motion: Motion, motions: Sequence[Motion]) -> None:
        """Check, claim and start one motion of these, where it need not wait.

        Raises:
            AhmssError: it can't be; says why.
        """
        order, seen, actor = motion.order, self._communication, self._actor()
        if order.act.follows:  # what hand is meant may have been decided by what came before
            motion.order = order = self._database.order(order.act, seen, actor)
        if self._waits(motion):
            return
        self._database.check(order, seen, actor)
        motion.met = self._as_it_is(order)
        motion.mover = None if self.comes_first(motion) else self._claims.claim(order)
        _carry(motion, motions)
        others = [other.order for other in motions if other is not motion]
        start = self._database.start(
            order, "human", seen, actor, self._next_seed(), self._rate, carried=motion.carried, others=others
        )
        motion.process = self._launcher.start(order.human_algorithm, start)
        if order.act.frames and order.frames > order.act.frames:
            self._note(f"{order.title}: {too_few(order.act.frames, order.frames)}")
        target = () if order.human_algorithm.world == "none" else (seen.objects[order.object].id,)
        motion.knows = known({*target, *numbers(start), *(record.id for record in start.world)})
        motion.company, motion.beside = met(start), beside(start)
        motion.k = 1
        motion.process.ask(self._showing.frame(1, NOTHING, order.human_algorithm))

    def first(self, motion: Motion) -> Order | None:
        """What is made before a motion that follows another, where it asks for that and its hand is not there by then.

        Raises:
            AhmssError: it can't be; says why.
        """
        before, act = motion.follows, motion.order.act
        if before is None:
            return None
        order = self._database.order(replace(act, after=0), self._communication, self._actor())
        if (before.order.object, before.order.affordance.name) == (order.object, order.affordance.first):
            return None
        return self._database.first(order, self._communication, self._actor())

    def comes_first(self, motion: Motion) -> bool:
        """Whether it claims what it moves only when it has come there, so that nobody who stands before it waits."""
        order = motion.order
        claims = order.object_algorithm is not None and order.affordance.hold in ("", "take")
        return claims and motion.comes and order.object not in self._claims

    def check(self, motion: Motion) -> None:
        """Whether it may still act, where it has come to.

        Raises:
            AhmssError: it may not; says why.
        """
        self._database.check(motion.order, self._communication, self._actor())

    def claim(self, motion: Motion) -> None:
        """It has come to where it acts: what it moves is claimed, or planned for anew where it is otherwise by now."""
        if self._as_it_is(motion.order) == motion.met:
            motion.mover = self._claims.claim(motion.order)
        else:
            motion.begin_anew()

    def begin_to_move(self, mover: Mover) -> None:
        """Start the algorithm of an object whose claim is granted."""
        entry = mover.order.object_algorithm
        assert entry is not None
        actor = mover.actor if mover.frames else self._actor()
        start = self._database.start(mover.order, "object", self._communication, actor, self._next_seed(), self._rate)
        mover.granted = True
        if mover.given:  # the hand has closed on it already: its algorithm sees no fingers close
            start = msgspec.structs.replace(start, hold="keep")
            mover.told = True
        mover.process = self._launcher.start(entry, start)
        mover.knows = known(record.id for record in start.world)

    def _waits(self, motion: Motion) -> bool:
        """Whether what it is about is another's now, and it waits until it is let go.

        Raises:
            CommandError: it has waited long enough.
        """
        order, holder = motion.order, ""
        if order.patience and self.comes_first(motion):
            return False
        record = self._communication.world.objects.get(order.object)
        if record is not None and not order.whom and order.object not in self._claims:
            holder = record.holder if record.holder != self._communication.human else ""
        if not holder or not wants_free(order.affordance, moves=order.object_algorithm is not None):
            return False
        if motion.waited >= order.patience * self._rate:
            after = f"; waited {order.patience:g} s" if motion.waited else ""
            raise CommandError(f"{order.title}: {order.object} is held by {holder}{after}")
        if not motion.waited:
            self._note(f"{order.title}: waits for {holder}, who has {order.object}")
        if motion.waited % _SAYS_SO == 0 and order.object_algorithm is not None:
            self._communication.wait_for(order.object)
        motion.waited += 1
        return True

    def _as_it_is(self, order: Order) -> tuple[object, ...]:
        """What a motion is planned from: where its object is, and in which states."""
        record = self._communication.world.objects.get(order.object)
        if record is None:
            return ()
        return (*self._communication.pose(order.object).tolist(), *sorted(record.states.items()))

    def _next_seed(self) -> int:
        """A seed for one process: the same in every run of the same script."""
        self._seed = (self._seed * 6364136223846793005 + 1442695040888963407) % 2**63
        return self._seed >> 16


def _carry(motion: Motion, motions: Sequence[Motion]) -> None:
    """Of motions made together the one that takes the body elsewhere has its legs; once carried, always carried."""
    others = [other for other in motions if other is not motion]
    if motion.carries:
        for other in others:
            other.carried = not other.carries
    else:
        motion.carried = any(other.carries for other in others)
