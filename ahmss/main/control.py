"""The control part: starts, steps, watches and stops the algorithm processes of one human (Ichiguchi 2000, 4.2.4)."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterable, Sequence

import msgspec
import numpy as np

from ahmss.algorithm.haste import too_few
from ahmss.algorithm.messages import State
from ahmss.body.array import Array
from ahmss.database.statefile import HELD
from ahmss.errors import AhmssError, AlgorithmError, CommandError
from ahmss.main.afforded import Actor
from ahmss.main.blending import Blending, Contribution
from ahmss.main.claims import Claims, refusal, wants_free
from ahmss.main.communication import Communication
from ahmss.main.company import beside, met, numbers
from ahmss.main.database import Database
from ahmss.main.motion import Motion, Mover, Shown
from ahmss.main.order import Order
from ahmss.main.passing import GIVE, RECEIVE
from ahmss.main.showing import Showing
from ahmss.main.surroundings import NOTHING, among, known, latest
from ahmss.main.telling import told
from ahmss.processes.launcher import Launcher
from ahmss.processes.process import Answer, Arrived, Note
from ahmss.world.link import Pending

__all__ = ["Control"]

_LOG = logging.getLogger(__name__)
_SAYS_SO = 30  # frames after which who waits says so again
_SEEN = 6  # frames after which it is seen who was first
_RESTS = 4.0  # seconds in which a motion that is given up comes to rest
_RELUCTANT = 5.0  # seconds that a hand which has closed on what it is given waits for the other to let go


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
        self._database, self._communication, self._launcher, self._say = database, communication, launcher, say
        self._note, self._actor, self._rate, self._seed = note, actor, rate, seed
        self._motions: list[Motion] = []
        self._claims = Claims(communication, actor)
        self._showing = Showing(database.workspace, communication)
        self._number = 0
        self._moved = NOTHING
        self.failures = 0
        self.held_frames = 0

    # What the console and the frame loop ask

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
            self._number += 1
            before = self._motions[-1] if order.act.follows else None
            self._motions.append(Motion(order, self._number, before))

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
                self._go_on_passing(motion)
        for motion in list(self._motions):
            if motion.follows in self._motions:
                continue
            if motion.process is None and motion.countdown > 0:
                motion.countdown -= 1
            elif motion.process is None:
                self._start(motion)
        for mover, reason in self._claims.granting(self._begin_to_move):
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
        self._showing.see(blending, self._moved, self._motions, self._claims.movers)

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
        closing = [motion.mover for motion in self._motions if motion.closing]
        for mover in self._claims.movers:
            if mover.process is not None and mover.process.pending:  # an answer to an older frame, if it has come
                self._collect_object(mover)
            if mover.watches and mover not in closing:
                moved = among(self._showing.changes, mover.knows)
                mover.show(Shown(self._showing.human.copy(), blending.grips, moved, mover.closed))
            self._show_next(mover)

    def _show_next(self, mover: Mover) -> None:
        """Ask an object algorithm for the next of the frames that wait for it."""
        process = mover.process
        if process is not None and process.active and mover.frames and not process.pending:
            frame = mover.next()
            if mover.tells(frame):
                process.closed()
            process.ask(self._showing.shown(frame, mover.k, mover.pose, mover.order.object_algorithm))

    def collect_objects(self, blending: Blending, patience: float) -> Array | None:
        """Take where the objects are now; rows (m, 8) of those that moved, for the world."""
        if not self._claims.movers:
            self._moved = self._moved[:0]
            return None
        until = time.monotonic() + patience
        goes_on = True
        while goes_on:
            asked = [mover.process for mover in self._claims.movers if mover.process is not None]
            self._launcher.wait(asked, until - time.monotonic())
            for mover in self._claims.movers:
                self._collect_object(mover)
            goes_on = any(mover.behind for mover in self._claims.movers) and time.monotonic() < until
        rows: list[list[float]] = []
        for mover in self._claims.movers:
            mover.stay(blending.grips)
            if mover.granted and mover.fresh:
                rows.append([mover.id, *mover.pose])
                self._communication.put(mover.name, mover.pose)
                mover.fresh = False
        self._moved = np.array(rows).reshape(-1, 8)
        return self._moved if rows else None

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

    def _start(self, motion: Motion) -> None:
        """Check, claim and start one motion; where it can't be, say why."""
        order, seen, actor = motion.order, self._communication, self._actor()
        try:
            if order.act.follows:  # what hand is meant may have been decided by what came before
                motion.order = order = self._database.order(order.act, seen, actor)
            if self._waits(motion):
                return
            self._database.check(order, seen, actor)
            motion.met = self._as_it_is(order)
            motion.mover = None if self._comes_first(motion) else self._claims.claim(order)
            self._carry(motion)
            start = self._database.start(
                order, "human", seen, actor, self._next_seed(), self._rate, carried=motion.carried
            )
            motion.process = self._launcher.start(order.human_algorithm, start)
            if order.act.frames and order.frames > order.act.frames:
                self._note(f"{order.title}: {too_few(order.act.frames, order.frames)}")
        except AhmssError as error:
            self._fail(motion, str(error))
            return
        target = () if order.human_algorithm.world == "none" else (seen.objects[order.object].id,)
        motion.knows = known({*target, *numbers(start), *(record.id for record in start.world)})
        motion.company, motion.beside = met(start), beside(start)
        motion.k = 1
        motion.process.ask(self._showing.frame(1, NOTHING, order.human_algorithm))

    def _waits(self, motion: Motion) -> bool:
        """Whether what it is about is another's now, and it waits until it is let go.

        Raises:
            CommandError: it has waited long enough.
        """
        order, holder = motion.order, ""
        if order.patience and self._comes_first(motion):
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

    def _comes_first(self, motion: Motion) -> bool:
        """Whether it claims what it moves only when it has come there, so that nobody who stands before it waits."""
        order = motion.order
        claims = order.object_algorithm is not None and order.affordance.hold in ("", "take")
        return claims and motion.comes and order.object not in self._claims

    def _as_it_is(self, order: Order) -> tuple[object, ...]:
        """What a motion is planned from: where its object is, and in which states."""
        record = self._communication.world.objects.get(order.object)
        if record is None:
            return ()
        return (*self._communication.pose(order.object).tolist(), *sorted(record.states.items()))

    def _arrive(self, motion: Motion) -> None:
        """It has come to where it acts: what it moves is claimed, and planned for anew where it is otherwise by now."""
        claims, order = self._comes_first(motion), motion.order
        motion.arrived = True
        if motion.rests is not None:  # it was to come to rest before it came
            self._drop(motion)
        if motion.rests is not None or not claims:
            return
        try:
            self._database.check(order, self._communication, self._actor())
        except AhmssError as error:
            self._fail(motion, str(error))
            return
        if self._as_it_is(order) == motion.met:
            motion.mover = self._claims.claim(order)
        else:
            motion.begin_anew()

    def _carry(self, motion: Motion) -> None:
        """Of motions made together the one that takes the body elsewhere has its legs; once carried, always carried."""
        others = [other for other in self._motions if other is not motion]
        if motion.carries:
            for other in others:
                other.carried = not other.carries
        else:
            motion.carried = any(other.carries for other in others)

    def _begin_to_move(self, mover: Mover) -> None:
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

    # From hand to hand

    def _begin_passing(self, motion: Motion, state: str) -> None:
        """An algorithm says that what it gives is in the other hand, or that the hand has closed on what it takes."""
        mover, order = motion.mover, motion.order
        if mover is not None:
            mover.closed = True
        if order.affordance.hold == GIVE and mover is not None and mover.granted:
            motion.passes = self._claims.give(mover, order.whom, state)
        elif order.affordance.hold == RECEIVE and mover is not None:
            motion.passes = 0

    def _go_on_passing(self, motion: Motion) -> None:
        """Who gives waits for the answer, who receives until the world says that they have it."""
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
            self._say(now)
        self._claims.forget(mover)

    def _next_seed(self) -> int:
        """A seed for one process: the same in every run of the same script."""
        self._seed = (self._seed * 6364136223846793005 + 1442695040888963407) % 2**63
        return self._seed >> 16

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
                    self._begin_passing(motion, str(message.states[HELD]))
                elif isinstance(message, State):
                    self._change_states(message)
                elif isinstance(message, Note):
                    self._tell(motion.order, message.text)
                elif isinstance(message, Arrived):
                    self._arrive(motion)
                    if motion.process is not process or motion not in self._motions:
                        return
                else:
                    motion.over = True
        except AhmssError as error:
            self._fail(motion, f"{motion.order.title}: {_in_words(error)}")
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

    def _collect_object(self, mover: Mover) -> None:
        """Take what an object algorithm says, and show it the next frame that waits."""
        if mover.process is None:
            return
        try:
            for message in mover.process.receive():
                if isinstance(message, Answer):
                    mover.put(message.row[1:8])
                elif isinstance(message, State):
                    self._change_states(message)
                elif isinstance(message, Note):
                    self._tell(mover.order, message.text)
        except AhmssError as error:
            self._lose(mover, _in_words(error))
        self._show_next(mover)

    def _tell(self, order: Order, text: str) -> None:
        """An algorithm has something to say; what states its object has, as they are now."""
        thing = self._communication.objects.get(order.object)
        self._note(f"{order.title}: {told(text, thing.states if thing is not None else {})}")

    def _change_states(self, state: State) -> None:
        """An algorithm has changed the states of an object."""
        try:
            record = self._communication.world.object_by_id(state.object)
        except KeyError:
            self._say(f"an algorithm changes the state of object {state.object}, which is not in the world")
            return
        self._communication.set_states(record.name, state.states)

    # Ends

    def _end(self, motion: Motion) -> None:
        """A motion is complete."""
        self._motions.remove(motion)
        if motion.rests is not None:
            self._drop(motion)
            return
        if motion.process is not None:
            motion.process.stop()
        if motion.mover is not None and motion.lets_go:
            self._claims.release(motion.mover)

    def _fail(self, motion: Motion, reason: str) -> None:
        """A motion can't go on: the body keeps what it alone drove, the others go on."""
        self.failures += 1
        self._say(reason)
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
        lets_go = motion.order.affordance.hold == "release" and not (mover.order.hand and motion.can_rest)
        if lets_go or not (mover.caught or mover.borne):
            self._claims.release(mover)

    def _lose(self, mover: Mover, reason: str) -> None:
        """An object algorithm has failed: what is in the hand stays fixed to it, anything else stays where it is."""
        self.failures += 1
        mover.process = None
        mover.frames.clear()
        caught = mover.caught or (mover.takes and not any(motion.mover is mover for motion in self._motions))
        end = "stays fixed to the hand until it is released" if caught else "stays where it is"
        self._say(f"{mover.order.title}: {reason}; {mover.name} {end}")


def _in_words(error: AhmssError) -> str:
    """Why an algorithm gave up, as it says itself where it does; which one it was, and when, `--debug` shows."""
    _LOG.debug("%s", error)
    return (error.said if isinstance(error, AlgorithmError) else "") or str(error)
