"""Pictures of a running world without a window: the newest world after each picture, never a queue of old ones."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Generator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from types import FrameType

import numpy as np
from numpy.typing import NDArray

from ahmss.errors import Unreachable
from ahmss_viewer.aim import Aim, Arrivals
from ahmss_viewer.caption import Flat
from ahmss_viewer.mirror import Mirror
from ahmss_viewer.movie import Movie, check_writable
from ahmss_viewer.options import ViewOptions, ViewReport
from ahmss_viewer.pace import Pace
from ahmss_viewer.sheet import Sheet, save_picture
from ahmss_viewer.source import Live
from ahmss_viewer.studio import Studio

__all__ = ["watch"]

_RATE = 30.0
_TILE, _EVERY = 320, 30
_NOBODY_S = 10.0
_PATIENCE_S = 2.0  # a snapshot waits so long for a human to come


@dataclass
class Stop:
    """Set by a signal, or by whoever runs the viewer in a thread."""

    asked: bool = False


def watch(
    options: ViewOptions, stop: Stop | None = None, progress: Callable[[int, int], None] | None = None
) -> ViewReport:
    """Follow a server until `seconds` are over, the snapshot is taken, or a signal (interrupt, terminate) comes.

    `progress` is told the pictures drawn, of 0 that are to be, after each of them.

    Raises:
        Unreachable: until the end no world was seen; a snapshot alone waits 10 s for one.
        DataError: a file can't be written.
        DependencyError: nothing here draws without a window.
    """
    for file in (options.record, options.snapshot, options.sheet):
        if file is not None:
            check_writable(file)
    with ExitStack() as stack:
        held = stack.enter_context(_signals(stop or Stop()))
        studio = stack.enter_context(Studio(fine=_alone(options) if options.fine is None else options.fine))
        source = Live(options.address, keys=options.keys, request=options.request)
        stack.callback(source.close)
        return _Watch(options, source, studio, held, progress).run()


class _Watch:
    """One run of the headless viewer."""

    def __init__(
        self,
        options: ViewOptions,
        source: Live,
        studio: Studio,
        stop: Stop,
        progress: Callable[[int, int], None] | None,
    ) -> None:
        self.options, self.source, self.studio, self.stop, self.progress = options, source, studio, stop, progress
        self.mirror = Mirror(studio.stage, source.asset, source.skeleton)
        self.aim, self.arrivals = Aim(options), Arrivals()
        self.size = (options.size[0] // 2 * 2, options.size[1] // 2 * 2)
        self.report = ViewReport(source.name, self.size)
        self.pace = Pace()
        self.sheet = Sheet(title=f"{self.report.source}   {time.strftime('%Y-%m-%d %H:%M')}")
        self.next_tile = 0
        self.first_tick = -1

    def run(self) -> ViewReport:
        """The loop: newest world, picture, files."""
        begin = time.monotonic()
        with ExitStack() as stack:
            movie = None
            if self.options.record is not None:
                movie = stack.enter_context(
                    Movie(self.options.record, self.size, self.options.rate or _RATE, quick=True)
                )
            picture: NDArray[np.uint8] | None = None
            shown = -1.0  # when the first world was there that holds something
            while not self.stop.asked and not self._over(begin):
                fresh = self.source.wait(0.02 if movie is not None else 0.1)
                taken = time.monotonic()
                if fresh or (picture is not None and self.source.silent):
                    picture = self._draw(fresh=fresh)
                if shown < 0.0 and (self.studio.stage.actors or self.studio.stage.things):
                    shown = taken
                if picture is not None and movie is not None and shown >= 0.0:
                    self._film(movie, picture, time.monotonic() - shown)
                if picture is not None and self._snapshot(time.monotonic() - begin):
                    break
            if movie is not None and picture is not None and not movie.frames:
                movie.add(picture)  # nobody came: the empty world
        self._finish()
        return self.report

    def _over(self, begin: float) -> bool:
        passed = time.monotonic() - begin
        if self.options.seconds is not None:
            return passed >= self.options.seconds
        return _alone(self.options) and self.source.world.revision < 0 and passed > _NOBODY_S

    def _draw(self, *, fresh: bool) -> NDArray[np.uint8]:
        """One picture of the newest world."""
        begin = time.perf_counter()
        if fresh:
            self.mirror.show(self.source.world)
        stage = self.studio.stage
        if self.arrivals.due(stage):
            self.aim.begin(stage, self.studio.painter)
        view = self.aim.step(stage, self.pace.last)
        picture = self.studio.picture(view, self.size, self._overlay(), names=self.options.names)
        if fresh:
            self.pace.shown(self.source.age())
            self.report.draws.append(time.perf_counter() - begin)
            self.report.faces = max(self.report.faces, stage.faces())
            self._tile()
            if self.progress is not None:
                self.progress(self.pace.pictures, 0)
        else:
            time.sleep(0.05)
        return picture

    def _overlay(self) -> list[Flat]:
        """Frame rate and age of the world, as text in the picture."""
        if not self.options.overlay:
            return []
        text = self.pace.text()
        if self.source.silent:
            text += "\nno news from the server; this is the last that was seen"
        return [self.studio.writer.flat(text.strip(), 10, 10)] if text else []

    def _film(self, movie: Movie, picture: NDArray[np.uint8], seconds: float) -> None:
        """Keep the film at the wall's time: a picture stands until the next one."""
        due = int(seconds * (self.options.rate or _RATE))
        while movie.frames <= due:
            movie.add(picture)

    def _tile(self) -> None:
        """Every n-th frame of the world onto the sheet; the first picture at or after it."""
        tick = self.source.world.tick
        if self.first_tick < 0:
            self.first_tick = self.next_tile = tick
        if self.options.sheet is None or tick < self.next_tile or not self.studio.stage.actors:
            return
        every = self.options.every or _EVERY
        self.next_tile = tick - (tick - self.first_tick) % every + every
        tile = (_TILE, round(_TILE * self.size[1] / self.size[0]))
        view = self.aim.step(self.studio.stage, 0.0)
        small = self.studio.picture(view, tile, names=self.options.names, best=True)
        self.sheet.add(small, tick, (tick - self.first_tick) / self.source.world.rate)

    def _snapshot(self, seconds: float) -> bool:
        """Draw the one picture, with care, as soon as there is somebody; True where that was all that was asked for."""
        path = self.options.snapshot
        if path is None or str(path) in self.report.files:
            return False
        if not self.studio.stage.actors and seconds < _PATIENCE_S:
            return False
        view = self.aim.step(self.studio.stage, 0.0)
        save_picture(self.studio.picture(view, self.size, self._overlay(), names=self.options.names, best=True), path)
        self.report.files.append(str(path))
        return _alone(self.options) and self.options.seconds is None

    def _finish(self) -> None:
        """The sheet, and the report. Unreachable: nothing was ever seen."""
        if self.source.world.revision < 0:
            name = self.source.name
            raise Unreachable(
                f"no virtual-space server answers at {name}; start one with `ahmss server`, or check the keys"
            )
        if self.options.record is not None:
            self.report.files.append(str(self.options.record))
        if self.options.sheet is not None:
            self.sheet.save(self.options.sheet)
            self.report.files.append(str(self.options.sheet))
        self.report.pictures, self.report.seconds = self.pace.pictures, self.pace.seconds
        self.report.ages = self.pace.ages
        self.report.problems = self.mirror.problems


def _alone(options: ViewOptions) -> bool:
    """Whether one picture is all that is asked for: it may take its time."""
    return options.snapshot is not None and options.record is None and options.sheet is None


@contextmanager
def _signals(stop: Stop) -> Generator[Stop]:
    """Interrupt and terminate end the loop in order, so that the film is finished."""

    def end(_number: int, _frame: FrameType | None) -> None:
        stop.asked = True

    kinds = (signal.SIGINT, signal.SIGTERM)
    try:
        old = [signal.signal(kind, end) for kind in kinds]
    except ValueError:  # not the main thread: its owner stops it
        yield stop
        return
    try:
        yield stop
    finally:
        for kind, handler in zip(kinds, old, strict=True):
            signal.signal(kind, handler)
