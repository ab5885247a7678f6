"""From hand to hand: who gives waits for the world's answer, who receives until the world says that they have it."""

from __future__ import annotations

from collections.abc import Callable

from ahmss.main.claims import Claims, refusal
from ahmss.main.communication import Communication
from ahmss.main.motion import Motion
from ahmss.main.passing import GIVE, RECEIVE

__all__ = ["GivingOver"]

_RELUCTANT = 5.0  # seconds that a hand which has closed on what it is given waits for the other to let go


class GivingOver:
    """What one human gives and receives.

    Args:
        fail: gives up a motion for a reason.
        rate: frames a second.
    """

    def __init__(
        self, claims: Claims, communication: Communication, fail: Callable[[Motion, str], None], rate: float
    ) -> None:
        self._claims, self._communication, self._fail, self._rate = claims, communication, fail, rate

    def begin(self, motion: Motion, state: str) -> None:
        """An algorithm says that what it gives is in the other hand, or that the hand has closed on what it takes."""
        mover, order = motion.mover, motion.order
        if mover is not None:
            mover.closed = True
        if order.affordance.hold == GIVE and mover is not None and mover.granted:
            motion.passes = self._claims.give(mover, order.whom, state)
        elif order.affordance.hold == RECEIVE and mover is not None:
            motion.passes = 0

    def go_on(self, motion: Motion) -> None:
        """A frame of one that waits."""
        mover, passes = motion.mover, motion.passes
        assert mover is not None
        if isinstance(passes, int):
            motion.passes = passes + 1
            record = self._communication.world.objects.get(mover.name)
            if mover.granted:
                motion.passes = None
            elif record is None or passes > _RELUCTANT * self._rate:
                self._fail(motion, f"{motion.order.title}: {motion.order.whom} has not let go of {mover.name}")
            elif record.holder in ("", self._communication.human) and mover.claim is None:
                self._claims.receive(mover)
        elif passes is not None and passes.done:
            motion.passes = None
            if reason := refusal(passes):
                self._claims.take_back(mover)
                self._fail(motion, f"{motion.order.title}: {reason}; it stays in the hand")
