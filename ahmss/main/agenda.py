"""The lines that wait to be carried out, one after another, each when the one before is done."""

from __future__ import annotations

import contextlib
import math
import threading
from collections import deque
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Protocol

from ahmss.errors import AhmssError, CommandError, WorldError
from ahmss.main.aside import aside, at_once
from ahmss.main.command import Add, Do, Human, Line, Remove, Set, Sync, Wait
from ahmss.main.company import KIND
from ahmss.main.comparing import Comparison, spoken
from ahmss.main.joined import lasting, refuse_two_carriers, title
from ahmss.main.kept import is_about, still_in_hand
from ahmss.main.naming import find_object, refuse_another
from ahmss.main.order import Order
from ahmss.main.script import Step
from ahmss.world.link import Pending
from ahmss.world.schema import Remove as RemoveRequest
from ahmss.world.schema import Request

if TYPE_CHECKING:
    from ahmss.main.process import MainProcess, Setup

__all__ = ["Agenda", "Follower"]

_REFUSED_IN = 0.4  # seconds, by the frames, in which what can't be done is refused as a rule
_LONGEST_WAIT = 60.0  # seconds, by the frames


class Follower(Protocol):
    """Is told what becomes of each line, in the frame loop."""

    def began(self, step: Step) -> None:
        """It is being carried out."""
        ...

    def ended(self, step: Step, *, failed: bool) -> None:
        """It is over; what went wrong was said before."""
        ...

    def dropped(self, step: Step) -> None:
        """It was given up, begun or not."""
        ...


class Agenda:
    """What the human is to do next. `add` may be called from any thread, the rest belongs to the frame loop.

    `said` is told what came of a line that is not a motion (`cup_2 is in the world`), `follower` what of every line.
    `scene` are the lines that set the scene, as far as they are not over: who asks what is here waits for them.
    """

    def __init__(self, main: MainProcess, setup: Setup) -> None:
        self._main, self._setup = main, setup
        self._steps: deque[Step] = deque()
        self._dropped: deque[Step] = deque()
        self._waits: Callable[[], bool] | None = None
        self._lock = threading.Lock()
        self._unfinished = 0
        self._cut = False
        self._doing = self._announcement = ""
        self._announced_at = 0  # the main's frame
        self._failures = self._parts = 0
        self._now: Step | None = None
        self.scene: list[Step] = []
        self._orders: list[Order] = []
        self._wrong = self._wrong_before = 0
        self.said: Callable[[str], None] = _keep_quiet
        self.follower: Follower | None = None

    @property
    def done(self) -> bool:
        """Whether nothing is left to do."""
        return self._unfinished == 0

    @property
    def asks_the_world(self) -> bool:
        """Whether the next step depends on how the world is now."""
        return self._waits is not None or (bool(self._steps) and not self._main.control.busy)

    def add(self, step: Step) -> None:
        """Append a line."""
        with self._lock:
            self._steps.append(step)
            self._unfinished += 1

    def set_the_scene(self, lines: Iterable[Line]) -> None:
        """Append the lines that set the scene."""
        self.scene = [Step(line, 0, "") for line in lines]
        for step in self.scene:
            self.add(step)

    def clear(self) -> None:
        """Forget all lines; the present motion stops with the next frame. What is added after this is carried out."""
        with self._lock:
            self._dropped += self._steps
            self._steps.clear()
            self._cut, self._unfinished = True, 1

    def drop(self, step: Step) -> None:
        """Give up one line: the present one stops now, one that waits never begins. The others go on."""
        with self._lock:
            if step in self._steps:
                self._steps.remove(step)
                self._dropped.append(step)
        if step is self._now:
            self._break_off()
        self._tell_of_the_dropped()
        self._count()

    def step(self) -> None:
        """Go on with the next lines, until one takes time."""
        if self._cut:
            self._cut = False
            self._break_off()
        self._tell_of_the_dropped()
        self._tell_of_the_end()
        while not self._busy():
            self._settle()
            if not self._steps:
                break
            self._now = step = self._steps.popleft()
            self._wrong_before = self._wrong + self._main.control.failures
            if self.follower is not None:
                self.follower.began(step)
            try:
                self._carry_out(step)
            except AhmssError as error:
                self._trouble(step, error)
        self._count()

    def _break_off(self) -> None:
        """The present line ends here."""
        self._waits, self._doing, self._announcement = None, "", ""
        self._main.control.stop()
        if self._now is not None:
            self._dropped.append(self._now)
            self._now = None

    def _settle(self) -> None:
        """The present line, if there is one, is over."""
        step, self._now = self._now, None
        if step is None:
            return
        self._leave_scene(step)
        if self.follower is not None:
            failed = self._wrong + self._main.control.failures > self._wrong_before
            self.follower.ended(step, failed=failed)

    def _leave_scene(self, step: Step) -> None:
        self.scene = [other for other in self.scene if other is not step]

    def _tell_of_the_dropped(self) -> None:
        while self._dropped:
            step = self._dropped.popleft()
            self._leave_scene(step)
            if self.follower is not None:
                self.follower.dropped(step)

    def _tell_of_the_end(self) -> None:
        """Say once that the motions of the last line are over; of those that failed that was said already."""
        control = self._main.control
        if self._doing and not control.busy:
            failed = control.failures - self._failures
            if failed == 0:
                self.announce()
                self.said(f"{self._doing}: done")
                self._tell_of_what_is_held()
            elif failed < self._parts:
                self.said(f"{self._doing}: done, but for what could not be")
            self._doing = self._announcement = ""
        elif self._main.report.frames >= self._announced_at:
            self.announce()

    def _tell_of_what_is_held(self) -> None:
        """Say of what was brought somewhere that a hand has it still, but of what the next line is about."""
        main = self._main
        following = self._steps[0].line if self._steps else None
        orders = [order for order in self._orders if not is_about(following, order.object)]
        for sentence in still_in_hand(orders, main.communication.objects, self._setup.human, main.workspace):
            main.note(sentence)

    def announce(self) -> None:
        """Say what is being done, if that was not said yet: not before it is known that it can be."""
        text, self._announcement = self._announcement, ""
        if text:
            self.said(text)

    def _busy(self) -> bool:
        if self._main.control.busy:
            return True
        waits, self._waits = self._waits, None  # one that fails is not asked again
        if waits is not None and waits():
            self._waits = waits
            return True
        return False

    def _count(self) -> None:
        with self._lock:
            busy = self._main.control.busy or self._waits is not None or self._cut
            self._unfinished = len(self._steps) + busy

    # The kinds of line

    def _carry_out(self, step: Step) -> None:
        match step.line:
            case Do() as line:
                self._do(line)
            case Wait() as line:
                self._wait(line, step)
            case Sync():
                if len(self._setup.names) > 1:
                    scene = self._main.communication
                    self._await(scene.sync(str(step.number), self._setup.names), step, unseen=scene.news())
            case Add() as line:
                self._add(line, step)
            case Remove(name=name):
                scene = self._main.communication
                name = find_object(scene, name)
                self._change(RemoveRequest(name), step, f"{name} is gone", lambda: name in scene.objects)
            case Set() as line:
                self._set(line, step)
            case Human(name=name):
                raise CommandError(f"another human needs a main of its own; type: ahmss main --human {name}")

    def _do(self, line: Do) -> None:
        refuse_another(line.human, self._setup.human, self._main.communication.world.humans)
        main = self._main
        actor = main.actor
        orders = main.database.orders(line.acts, main.communication, actor)
        refuse_two_carriers(orders)
        main.control.begin(orders)
        self._orders = orders
        self._doing, self._failures, self._parts = title(orders), main.control.failures, len(orders)
        self._announcement = f"{self._doing}: {lasting(orders, self._setup.rate)}"
        self._announced_at = main.report.frames + round(_REFUSED_IN * self._setup.rate)

    def _wait(self, line: Wait, step: Step) -> None:
        refuse_another(line.human, self._setup.human, self._main.communication.world.humans)
        if not line.object:
            frames = round(line.seconds * self._setup.rate)
            end = self._main.report.frames + frames
            self._waits = lambda: self._main.report.frames < end
            return
        main = self._main
        comparison = Comparison(main.workspace, main.communication, line.object, line.state, line.operator, line.value)
        # Where nothing else goes on than a script, what takes longer never comes; a person may take any time.
        usual = _LONGEST_WAIT if self._setup.fast else math.inf
        seconds = usual if line.within is None else line.within
        end = main.report.frames + seconds * self._setup.rate

        def waits() -> bool:
            if comparison.holds:
                self.said(f"{comparison.object} {line.state} is {spoken(comparison.value)}")
                return False
            if main.report.frames < end:
                return True
            self._trouble(step, CommandError(comparison.missed(seconds)))
            return False

        self._waits = waits

    def _add(self, line: Add, step: Step) -> None:
        """Shapes are read and sent in a thread, so that the body stays alive; in lockstep at once."""
        main = self._main
        if line.kind == KIND:
            raise CommandError(f"another human needs a main of its own; type: ahmss main --human {line.name or 'NAME'}")
        scene = main.communication
        name = scene.free_name(line)
        begin = at_once if self._setup.lockstep else aside
        errand = begin(lambda: scene.add(line, name, main.workspace))
        unseen = scene.news()

        def waits() -> bool:
            if not errand.done():
                return True
            try:
                placed = errand.result()
                if unseen():
                    return True
                main.layout.remember(placed)
                inside = len(placed) - 1
                more = f", with {inside} objects in it" if inside else ""
                self.said(f"{name} is in the world{more}")
            except AhmssError as error:
                self._trouble(step, error)
            return False

        self._waits = waits

    def _set(self, line: Set, step: Step) -> None:
        scene = self._main.communication
        name = find_object(scene, line.object)
        states = self._main.workspace.objects.get(scene.objects[name].kind).states
        state = states.get(line.state)
        if state is None:
            raise CommandError(f'{name} has no state "{line.state}"; it has: {", ".join(states) or "none"}')
        value = state.parse(line.value)
        if value is None:
            raise CommandError(f'{name} {line.state} can\'t be "{line.value}"; allowed: {state.allowed}')
        self._await(scene.set_state(name, line.state, value), step, f"{name} {line.state} is {value}")

    def _change(self, request: Request, step: Step, then: str, unseen: Callable[[], bool] = bool) -> None:
        """Ask the server to change the scene; in lockstep at once, so that no frame shows it half set."""
        client = self._main.communication.client
        pending = client.begin(request)
        if self._setup.lockstep:
            with contextlib.suppress(WorldError):  # `pending` keeps the reason
                client.finish(pending)
                client.refresh()
        self._await(pending, step, then, unseen)

    def _await(self, pending: Pending, step: Step, then: str = "", unseen: Callable[[], bool] = bool) -> None:
        """Wait for the server's answer, and until its effect is not `unseen` here, without stopping the frames."""

        def waits() -> bool:
            if not pending.done:
                return True
            try:
                pending.result()
                if unseen():
                    return True
                if then:
                    self.said(then)
            except WorldError as error:
                self._trouble(step, error)
            return False

        self._waits = waits

    def _trouble(self, step: Step, error: AhmssError) -> None:
        self._wrong += 1
        self._main.trouble(f"{step.where}: {error}" if step.where else str(error))


def _keep_quiet(text: str) -> None:
    """Tell nobody."""
    del text
