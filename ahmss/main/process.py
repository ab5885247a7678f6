"""The main process of one virtual human: the frame loop (Ichiguchi 2000, figure 4.9)."""

from __future__ import annotations

import math
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError
from ahmss.main.afforded import Actor
from ahmss.main.agenda import Agenda
from ahmss.main.blending import Blending
from ahmss.main.communication import Communication
from ahmss.main.control import Control
from ahmss.main.database import Database
from ahmss.main.expected import programs
from ahmss.main.layout import Layout
from ahmss.main.pace import Pace
from ahmss.main.port import HumanModelPort
from ahmss.main.report import Report
from ahmss.main.script import Step
from ahmss.main.stance import standing
from ahmss.processes.deadlines import Deadlines
from ahmss.processes.launcher import Launcher
from ahmss.world.address import Address
from ahmss.world.client import WorldClient
from ahmss.world.keys import ClientKeys

__all__ = ["MainProcess", "Setup"]

_FAST_PATIENCE = 10.0  # seconds after which `--fast` gives up who makes no frame, its processor free
_LOCKSTEP_PATIENCE = 0.5  # seconds that lockstep with a clock does
_SHARE = 0.5  # of a frame's time that real time waits for a frame
_FORESEES = 60  # frames between two looks at whether there are new kinds of objects
_REST = 60  # frames after the script in which the body comes to rest


@dataclass(frozen=True)
class Setup:
    """What a main is started with. `names` are all humans of the script, `group` its run; degrees and metres.

    lockstep: the server waits for every main each frame, and a motion that is late is waited for; so no frame is lost.
    fast: lockstep without a clock.
    port: where human models reach this main, None: nowhere. port_keys: what that needs beyond loopback.
    """

    human: str
    body: str = ""
    place: tuple[float, ...] = (0.0, 0.0)
    facing_deg: float = 0.0
    server: str = ""
    workspace: Path | None = None
    fast: bool = False
    lockstep: bool = False
    seed: int = 0
    rate: float = 60.0
    group: str = ""
    names: tuple[str, ...] = ()
    keys: ClientKeys | None = None
    port: Address | None = None
    port_keys: Path | None = None


class MainProcess:
    """One virtual human in the world: takes lines, makes frames.

    `frame` is to be called again and again, by `run` or by who has other things to do between. Lines come by
    `agenda.add` from any thread. Nothing that a file, a process or the server does ends the loop: it is said in a line.

    Args:
        setup: who and where.
        say: is told one line at a time what went wrong and what was done.

    Raises:
        AhmssError: from the start only: no such body, no server.
    """

    def __init__(self, setup: Setup, say: Callable[[str], None]) -> None:
        setup = replace(setup, lockstep=setup.lockstep or setup.fast)
        self.setup, self._say = setup, say
        self.workspace = Workspace.find(setup.workspace)
        self.database = Database(self.workspace)
        model = self.database.human(setup.body, setup.human)
        self.body = model.name
        rotations, root = standing(model, setup.place, setup.facing_deg)
        deadlines = Deadlines(frame=_FAST_PATIENCE) if setup.fast else Deadlines()
        self._client = WorldClient(setup.server, keys=setup.keys, follow=not setup.lockstep)
        self.communication = Communication(self._client, setup.human, lockstep=setup.lockstep, fast=setup.fast)
        try:
            shape = self.workspace.humans.shape(model.name)
            self.communication.join(model.name, model.skeleton, shape, root, rotations, setup.group or setup.human)
        except AhmssError:
            self._client.close()
            raise
        self.blending = Blending(model.skeleton, rotations, root, setup.rate)
        launcher = Launcher(deadlines=deadlines, notice=say, once=not setup.lockstep)
        for entry, motion in self.database.walks():  # a library takes longer to read than a motion may take to start
            launcher.prepare(entry, motion)
        launcher.expect(programs(self.workspace))
        self.control = Control(
            self.database, self.communication, launcher, self.trouble,
            self.note, lambda: self.actor, rate=setup.rate, seed=setup.seed,
        )  # fmt: skip
        self.agenda = Agenda(self, setup)
        self.layout = Layout(self.workspace, self.communication, self.trouble)
        self._foreseen: frozenset[str] = frozenset()  # kinds of objects
        self.pace = Pace(setup.rate, fast=setup.fast)
        self.report = Report(setup.human)
        self._patience = _SHARE * self.pace.period
        if setup.lockstep:
            self._patience = math.inf if setup.fast else _LOCKSTEP_PATIENCE  # `fast`: until it answers or is given up
        self.control.see(self.blending)
        self._connected = True
        self.port: HumanModelPort | None = None
        if setup.port is not None:
            try:
                self.port = HumanModelPort(self, setup.port, setup.port_keys)
            except AhmssError:
                self.close()
                raise

    @property
    def actor(self) -> Actor:
        """The human as it is now."""
        blending = self.blending
        body, control = self.setup.human, self.control
        return Actor(body, blending.skeleton, blending.root, blending.rotations, control.holds, control.between)

    def frame(self) -> None:
        """One frame: the command part's next line, then the motions, the blend, the objects, the world."""
        self._begin()
        self._go_on()

    def _begin(self) -> None:
        """The command part's next line; what starts is told so, and thinks from here on."""
        if self.agenda.asks_the_world or self.control.starts:
            self.communication.update(complete=True)
        self._listen()
        if self.port is not None:
            self.port.serve()
        self.agenda.step()
        self.control.start_due()

    def _go_on(self) -> None:
        """The rest of a frame: what is shown in it."""
        self.control.collect_humans(self._patience)
        self.blending.step(self.control.contributions)
        self.control.ask_objects(self.blending)
        self.control.ask_humans()
        self.communication.update(complete=False)  # while they compute
        moved = self.control.collect_objects(self.blending, self._patience)
        self.communication.publish(self.blending.root, self.blending.rotations, moved, self.blending.way)
        self.control.end_finished()
        self.report.frames += 1
        if not self.setup.lockstep:  # files change by the clock, and lockstep is to be the same at each run
            self.layout.follow(self.report.frames)
        if not self.setup.fast and self.report.frames % _FORESEES == 1:
            self._foresee()

    def _foresee(self) -> None:
        """Have what hands will ask of the kinds that are new in the world made before one of them does."""
        kinds = frozenset(record.kind for record in self.communication.world.objects.values())
        if new := sorted(kinds - self._foreseen):
            self.control.foresee(new)
        self._foreseen |= kinds

    def run(self, over: Callable[[], bool]) -> Report:
        """Make frames at the pace of the world until `over` says so and the body rests."""
        began = time.monotonic()
        resting = 0
        while not over() or (resting < _REST and not self.blending.resting):
            resting = resting + 1 if over() else 0
            if self.setup.lockstep:  # nothing comes meanwhile: who starts may think while the frame is awaited
                self._begin()
            left = self.pace.left()
            if left > 0.0:
                time.sleep(left)
            self.pace.advance()
            if self.setup.lockstep:
                self._go_on()
            else:
                self._guarded_frame()
        self.report.seconds = time.monotonic() - began
        self.report.late, self.report.held = self.pace.late, self.control.held_frames
        return self.report

    def play(self, steps: deque[Step]) -> Report:
        """Carry out a human's part of a script."""
        for step in steps:
            self.agenda.add(step)
        return self.run(lambda: self.agenda.done)

    def stop_motion(self) -> None:
        """Stop the present motion with the next frame and forget the lines that wait; from any thread."""
        self.agenda.clear()

    def close(self, *, stay: bool = False) -> None:
        """Leave the world and end all processes."""
        if self.port is not None:
            self.port.close()
        self.control.close()
        self.communication.leave(stay=stay)
        self._client.close()

    def _guarded_frame(self) -> None:
        """A frame whose errors become lines; the loop goes on. In lockstep it can't: to go on would be another run."""
        try:
            self.frame()
        except AhmssError as error:
            self._survive(str(error))
        except Exception as error:  # noqa: BLE001 - whatever it is, the person is told
            self._survive(f"a fault of the program itself: {type(error).__name__}: {error}")

    def _survive(self, reason: str) -> None:
        if reason not in self.report.messages[-1:]:
            self.trouble(reason)
        time.sleep(self.pace.period)

    def _listen(self) -> None:
        """What the server refused, and whether it is there."""
        if self.communication.refused:
            self.control.reconcile()
        for reason in self.communication.complaints():
            self.trouble(reason)
        connected = self.communication.connected
        if connected != self._connected:
            self._connected = connected
            server = self.communication.client.address
            self._say(
                f"the server at {server} is back" if connected else f"the server at {server} is gone; waiting for it"
            )

    def trouble(self, reason: str) -> None:
        """Say in one line what went wrong."""
        self.report.failures += 1
        self.report.messages.append(reason)
        self._say(reason)

    def note(self, text: str) -> None:
        """Say in one line what is worth knowing and no failure."""
        self.agenda.announce()  # what it is about comes first
        self.report.notes.append(text)
        self._say(text)
