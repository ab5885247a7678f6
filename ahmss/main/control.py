"""The control part: starts, steps, watches and stops the algorithm processes of one human (Ichiguchi 2000, 4.2.4)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from ahmss.algorithm.messages import Meant, State
from ahmss.body.array import Array
from ahmss.database.statefile import HELD
from ahmss.errors import AhmssError
from ahmss.main.afforded import Actor
from ahmss.main.blending import Blending, Contribution
from ahmss.main.claims import Claims
from ahmss.main.communication import Communication
from ahmss.main.database import Database
from ahmss.main.giving_over import GivingOver
from ahmss.main.hearing import Hearing, in_words
from ahmss.main.motion import Motion, Mover
from ahmss.main.moving import Moving
from ahmss.main.order import Order
from ahmss.main.passing import GIVE
from ahmss.main.showing import Showing
from ahmss.main.starting import Starting
from ahmss.main.surroundings import NOTHING, among, latest
from ahmss.processes.answers import Answer, Arrived, Note
from ahmss.processes.launcher import Launcher
from ahmss.world.link import Pending

__all__ = ["Control"]

_SEEN = 6  # frames after which it is seen who was first
_RESTS = 4.0  # seconds in which a motion that is given up comes to rest


class Control:
    """All motions that one human makes now, and all objects that it moves.

    Args:
        say: is told in one line what went wrong; nothing here raises for a process.
        note: is told in one line what an algorithm wants the person to know.
        actor: gives the human as it is now.
        seed: of the run; each motion gets one of its own from it.
    """

    def __init__(
        self, database: Database, communication: Communication, launcher: Launcher, say: Callable[[str], None],
        note: Callable[[str], None], actor: Callable[[], Actor], *, rate: float, seed: int = 0,
    ) -> None:  # fmt: skip
        self._database, self._communication, self._launcher, self._rate = database, communication, launcher, rate
        self._motions: list[Motion] = []
        self._claims = claims = Claims(communication, actor)
        self._showing = showing = Showing(database.workspace, communication)
        self._hearing = Hearing(database.workspace, communication, say, note)
        self._starting = Starting(database, communication, launcher, claims, showing, note, actor, rate, seed)
        self._moving = Moving(claims, showing, communication, launcher, self._hearing)
        self._giving_over = GivingOver(claims, communication, self._fail, rate)
        self._number = 0
        self.held_frames = 0

    # What the console and the frame loop ask

    @property
    def failures(self) -> int:
        """How many motions and algorithms could not go on."""
        return self._hearing.failures

    @property
    def busy(self) -> bool:
        """Whether a motion is being made or waits for its start."""
        return bool(self._motions)

    @property
    def starts(self) -> bool:
        """Whether something starts with the next frame: a motion, or an object whose claim is under way."""
        waiting = [motion for motion in self._motions if motion.process is None and motion.countdown == 0]
        if any(motion.follows not in self._motions for motion in waiting):
            return True
        return self._claims.asking

    @property
    def holds(self) -> dict[str, str]:
        """The objects that were taken, each with the hand that holds it ("": none, it is sat on)."""
        return self._claims.holds

    @property
    def between(self) -> frozenset[str]:
        """Those of them that are held between both hands."""
        return self._claims.between

    @property
    def contributions(self) -> list[Contribution]:
        """What the motions give to this frame's blend."""
        return [motion.given for motion in self._motions if motion.given is not None]

    @property
    def under_way(self) -> list[tuple[Order, Contribution]]:
        """The orders whose motions have a frame in this blend, and what they give to it."""
        return [(motion.order, motion.given) for motion in self._motions if motion.given is not None]

    @property
    def progress(self) -> list[tuple[str, int, int]]:
        """Each motion's title, the frame that was asked for last, and its last frame (0: it says itself)."""
        return [(motion.order.title, motion.k, motion.last) for motion in self._motions]

    def begin(self, orders: Sequence[Order]) -> None:
        """Make these motions together, each after its own delay, or after the one that it follows."""
        for order in orders:
            before = self._motions[-1] if order.act.follows else None
            self._motions.append(self._motion(order, before))

    def stop(self) -> None:
        """Give up all motions, at once or, of such as can, as they have come to rest; what is in the hand stays there.

        Given up once more, those end at once, too.
        """
        for motion in list(self._motions):
            rests = motion.given is not None and motion.can_rest and motion.rests is None
            if rests and motion.process is not None and motion.process.active:
                motion.rests = round(_RESTS * self._rate)
                motion.process.rest()
            else:
                self._drop(motion)

    def reconcile(self) -> None:
        """Give up what the server says this human has no longer, as after a restart that lost the claim."""
        for mover in self._claims.lost():
            self._give_up(mover)

    def foresee(self, kinds: Iterable[str]) -> None:
        """Have what hands will ask of the shapes of some kinds made, where it is not kept yet, beside all else."""
        self._launcher.foresee(self._database.workspace.root, kinds)

    def close(self) -> None:
        """End all processes."""
        self._launcher.close()

    # A frame, in the order of the thesis

    def start_due(self) -> None:
        """Start the motions whose time has come, and ask them for their first frame."""
        for mover in self._claims.taken_away():
            self._give_up(mover)
        self._claims.settle_what_was_on_its_way()
        for motion in list(self._motions):
            self._check_company(motion)
            if motion.rests is not None:
                motion.rests -= 1
                if motion.rests < 0:
                    self._drop(motion)
            if motion.passes is not None:
                self._giving_over.go_on(motion)
        for motion in list(self._motions):
            if motion.follows in self._motions:
                continue
            if motion.process is None and motion.countdown > 0:
                motion.countdown -= 1
            elif motion.process is None:
                self._start(motion)
        for mover, reason in self._claims.granting(self._starting.begin_to_move):
            if not self._wait_again(mover, reason):
                self._refuse(mover, reason)

    def ask_humans(self) -> None:
        """Ask every human algorithm for its next frame."""
        for motion in self._motions:
            process = motion.process
            if process is None or not process.active or motion.passes is not None:
                continue
            humans = motion.order.human_algorithm.humans
            moved = latest(motion.missed, among(self._showing.changes, motion.knows, strangers=humans))
            if process.pending:
                motion.missed = moved
            elif not motion.asked_all:
                motion.k, motion.missed = motion.k + 1, NOTHING
                process.ask(self._showing.frame(motion.k, moved, motion.order.human_algorithm))

    def see(self, blending: Blending) -> None:
        """Take in the human's pose and what moved, for the frames that are asked for next."""
        self._showing.see(blending, self._moving.moved, self._motions, self._claims.movers)

    def collect_humans(self, patience: float) -> None:
        """Take the frames that the human algorithms have made, waiting at most `patience` seconds for the last."""
        owing = [process for motion in self._motions if (process := motion.process) is not None]
        if owing:
            self._launcher.wait(owing, patience)
        for motion in list(self._motions):
            if motion.process is not None:
                self._collect_human(motion)

    def ask_objects(self, blending: Blending) -> None:
        """Show the human's new frame to the object algorithms; one that is late is shown it later, none left out."""
        self.see(blending)
        self._moving.show(blending, self._motions)

    def collect_objects(self, blending: Blending, patience: float) -> Array | None:
        """Take where the objects are now; rows (m, 8) of those that moved, for the world."""
        return self._moving.collect(blending, self._motions, patience)

    def end_finished(self) -> None:
        """Let go of what ended with this frame, once the object's algorithm has seen all of it."""
        for motion in self._motions:
            motion.closing = motion.over and motion.lets_go and motion.mover is not None and motion.mover.behind
        self._end_accompanying()
        for motion in [motion for motion in self._motions if motion.over and not motion.closing]:
            self._end(motion)
        self._launcher.tend()

    def _end_accompanying(self) -> None:
        """What lasts as long as the others is over where none of them goes on, but such as wait for it."""
        for motion in self._motions:
            ends = motion.over and not motion.closing
            if not (ends or motion.accompanies or motion.follows in self._motions):
                return
        for motion in self._motions:
            motion.over = motion.over or motion.accompanies

    # Starting

    def _motion(self, order: Order, follows: Motion | None) -> Motion:
        self._number += 1
        return Motion(order, self._number, follows)

    def _start(self, motion: Motion) -> None:
        """Check, claim and start one motion, or what comes before it; where it can't be, say why."""
        try:
            first = self._starting.first(motion)
            if first is not None:
                motion.follows = self._motion(first, None)
                self._motions.insert(self._motions.index(motion), motion.follows)
                motion = motion.follows
            self._starting.start(motion, self._motions)
        except AhmssError as error:
            self._fail(motion, str(error))

    def _arrive(self, motion: Motion) -> None:
        """It has come to where it acts: what it moves is claimed, and planned for anew where it is otherwise by now."""
        claims = self._starting.comes_first(motion)
        motion.arrived = True
        if motion.rests is not None:  # it was to come to rest before it came
            self._drop(motion)
        if motion.rests is not None or not claims:
            return
        try:
            self._starting.check(motion)
        except AhmssError as error:
            self._fail(motion, str(error))
            return
        self._starting.claim(motion)

    def _wait_again(self, mover: Mover, reason: str) -> bool:
        """Whether a claim came second by a hair, and its motion waits now: then it begins anew."""
        motions = [motion for motion in self._motions if motion.mover is mover]
        second = any(f"{mover.name} is {how} by" in reason for how in ("held", "waited for"))
        if len(motions) != 1 or not second:
            return False
        motion = motions[0]
        if motion.waited >= motion.order.patience * self._rate:
            return False
        motion.begin_anew(_SEEN)
        self._claims.forget(mover)
        return True

    def _check_company(self, motion: Motion) -> None:
        """What is done to somebody who is gone has no sense any more."""
        for name in motion.company:
            if name not in self._communication.world.humans and motion in self._motions:
                self._fail(motion, f"{motion.order.title}: {name} is gone")

    def _refuse(self, mover: Mover, reason: str) -> None:
        """The object can't be had: its motion ends."""
        for motion in [motion for motion in self._motions if motion.mover is mover]:
            self._fail(motion, f"{motion.order.title}: {reason}")
        self._claims.forget(mover)

    def _give_up(self, mover: Mover) -> None:
        """The object is not this human's any more: let go of it at once, with the motions that need it in the hand."""
        mover.granted = False  # so nothing is there to be released
        self._communication.lose(mover.name)
        holder = self._claims.holder(mover.name)
        now = f"{holder} has {mover.name} now" if holder else f"{mover.name} is not in the hand any more; take it again"
        needing = [motion for motion in self._motions if motion.mover is mover or motion.keeps(mover.name)]
        for motion in needing:
            self._fail(motion, f"{motion.order.title}: {now}")
        if not needing:
            self._hearing.say(now)
        self._claims.forget(mover)

    # Answers

    def _collect_human(self, motion: Motion) -> None:
        process = motion.process
        assert process is not None
        came = False
        try:
            for message in process.receive():
                if isinstance(message, Answer):
                    motion.take(message.row)
                    came = True
                elif isinstance(message, State) and HELD in message.states:
                    self._giving_over.begin(motion, str(message.states[HELD]))
                elif isinstance(message, State):
                    self._hearing.change_states(message)
                elif isinstance(message, Note):
                    self._hearing.tell(motion.order, message.text)
                elif isinstance(message, Meant):
                    motion.meant = message
                elif isinstance(message, Arrived):
                    self._arrive(motion)
                    if motion.process is not process or motion not in self._motions:
                        return
                else:
                    motion.over = True
        except AhmssError as error:
            self._fail(motion, f"{motion.order.title}: {in_words(error)}")
            return
        if 0 < motion.last <= process.last:
            motion.over = True
        if motion.over and motion.mover is not None and motion.rests is None:
            motion.mover.closed = True  # whether it said so or not, what it closes is closed by now
        if not came:
            if process.pending:
                motion.held += 1
                self.held_frames += 1
            if motion.given is not None:
                motion.given.hold()

    # Ends

    def _end(self, motion: Motion) -> None:
        """A motion is complete."""
        self._motions.remove(motion)
        if motion.rests is not None:
            self._drop(motion)
            return
        if in_vain := self._hearing.in_vain(motion.order, motion.meant):
            self._fail(motion, in_vain)
            return
        if motion.process is not None:
            motion.process.stop()
        if motion.mover is not None and motion.lets_go:
            self._claims.release(motion.mover)

    def _fail(self, motion: Motion, reason: str) -> None:
        """A motion can't go on: the body keeps what it alone drove, the others go on."""
        self._hearing.fail(reason)
        self._drop(motion)

    def _drop(self, motion: Motion) -> None:
        if motion in self._motions:
            self._motions.remove(motion)
        for after in [other for other in self._motions if other.follows is motion]:
            self._drop(after)
        if motion.process is not None:
            motion.process.stop()
        mover = motion.mover
        if mover is None:
            return
        if isinstance(motion.passes, Pending):  # it is on its way into the other hand, or stays in this one
            self._claims.leave_on_its_way(mover, motion.passes)
        if motion.order.affordance.hold == GIVE:  # it stays in the hand
            return
        stays = mover.order.hand and (motion.can_rest or motion.given is None)  # the hand has not begun to let go
        lets_go = motion.order.affordance.hold == "release" and not stays
        if lets_go or not (mover.caught or mover.borne):
            self._claims.release(mover)
