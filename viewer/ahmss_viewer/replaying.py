"""Pictures of a recording without a window: every frame as a film, a contact sheet, one snapshot."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from ahmss.errors import CommandError, DataError
from ahmss_viewer.aim import Aim
from ahmss_viewer.camera import View
from ahmss_viewer.choosing import without_hidden
from ahmss_viewer.cuts import Shot, shots
from ahmss_viewer.framing import Interest, fit, interest, shape_of, work
from ahmss_viewer.looking import Looking
from ahmss_viewer.mirror import Mirror
from ahmss_viewer.movie import Movie, check_writable
from ahmss_viewer.options import CUTS, ViewOptions, ViewReport
from ahmss_viewer.sheet import Sheet, save_picture
from ahmss_viewer.source import Replay
from ahmss_viewer.studio import Studio

__all__ = ["replay"]

_TILE = 340  # the width of a tile of 16:9; one of another shape has its area
_TILE_SHAPES = (0.75, 16 / 9)  # of what width over height a tile may be
_TILES = 24
_GLANCES, _MOMENTS = 40, 16  # ticks that are looked at to find the view
_PRESSED = 6  # ticks for which a button is pressed at least

Progress = Callable[[int, int], None]


def replay(options: ViewOptions, path: Path, progress: Progress | None = None) -> ViewReport:
    """Draw what the options ask for from a recording.

    Raises:
        DataError: the recording can't be read, or a file not be written.
        DependencyError: nothing here draws without a window.
    """
    for file in (options.record, options.snapshot, options.sheet):
        if file is not None:
            check_writable(file)
    with ExitStack() as stack:
        source = Replay(path)
        stack.callback(source.close)
        if not len(source):
            raise DataError(path, "", "this recording holds no frame; record again")
        studio = stack.enter_context(Studio(fine=options.fine is not False))
        return _Run(options, source, studio, progress).run()


class _Run:
    """One pass over a recording."""

    def __init__(self, options: ViewOptions, source: Replay, studio: Studio, progress: Progress | None) -> None:
        self.options, self.source, self.studio, self.progress = options, source, studio, progress
        self.mirror = Mirror(studio.stage, source.asset, source.skeleton)
        self.aim = Aim(options)
        self.size = (options.size[0] // 2 * 2, options.size[1] // 2 * 2)
        self.last = len(source) - 1
        if options.seconds is not None:
            self.last = min(self.last, max(0, round(options.seconds * source.rate) - 1))
        self.report = ViewReport(str(source.path), self.size)
        self.tile = (_TILE, round(_TILE * self.size[1] / self.size[0]))
        self.tile_view: View | None = None
        self.touched: set[int] = set()
        self.shots: list[Shot] = []

    def run(self) -> ViewReport:
        """The view first, then the pictures."""
        wanted = self._survey()
        if self.options.camera == CUTS:
            self.shots = self._cut()
        else:
            self._show(0)
            view = self.aim.begin(self.studio.stage, self.studio.painter, wanted, self._moments())
            if self.options.sheet is not None:
                self._choose_tile(view, wanted)
        start = time.perf_counter()
        if self.options.record is not None or self.options.sheet is not None:
            self._film()
        if self.options.snapshot is not None:
            self._snapshot(self.options.snapshot)
        self.report.seconds = time.perf_counter() - start
        self.report.faces = self.studio.stage.faces()
        self.report.problems = self.mirror.problems
        return self.report

    def _survey(self) -> Interest | None:
        """What is of interest in the whole motion, glanced at here and there; None where the options fix the camera."""
        found: Interest | None = None
        peopled = False
        ticks = np.unique(np.linspace(0, self.last, _GLANCES).astype(int))
        self.touched = self._find_touched(range(0, self.last + 1, _PRESSED))
        for tick in ticks:
            self._show(int(tick))
            now = interest(self.studio.stage, self.options.follow, self.touched)
            if now is None or (peopled and not self.studio.stage.actors):
                continue  # before the humans came
            if self.studio.stage.actors and not peopled:
                peopled, found = True, None
            found = now if found is None else found.joined(now)
        if self.options.follow and not any(a.name == self.options.follow for a in self.studio.stage.actors.values()):
            there = ", ".join(a.name for a in self.studio.stage.actors.values()) or "none"
            raise CommandError(f'no human "{self.options.follow}" to follow in {self.source.path}; there is: {there}')
        return found

    def _find_touched(self, ticks: Iterable[int]) -> set[int]:
        """The objects that move between these ticks: those that a human acts on."""
        first: dict[int, bytes] = {}
        touched: set[int] = set()
        for tick in ticks:
            for number, pose in zip(*self.source.show(tick).poses(), strict=True):
                if first.setdefault(int(number), pose.tobytes()) != pose.tobytes():
                    touched.add(int(number))
        return touched

    def _choose_tile(self, view: View, wanted: Interest | None) -> None:
        """A tile is small: it takes the shape of what is to be seen, where the options leave the camera free."""
        options = self.options
        free = options.camera == "auto" and not (options.follow or options.position or options.look_at)
        if wanted is None or not free:
            return
        stage, painter = self.studio.stage, self.studio.painter
        wide = self.size[0] / self.size[1]
        points = without_hidden(stage, painter, wanted, view, wide, self._moments())
        aspect = float(np.clip(shape_of(view, points), *_TILE_SHAPES))
        height = np.sqrt(_TILE * _TILE * 9 / 16 / aspect)
        self.tile = (round(aspect * height), round(height))
        self.tile_view = fit(view, points, self.tile[0] / self.tile[1], 0.9)

    def _moments(self) -> Iterator[Interest]:
        """Some moments of the motion, each on the stage when it is given."""
        for tick in np.unique(np.linspace(0, self.last, _MOMENTS).astype(int)):
            self._show(int(tick))
            now = interest(self.studio.stage, self.options.follow, self.touched)
            if now is not None and self.studio.stage.actors:
                yield now

    def _film(self) -> None:
        """Every frame, as film, and every n-th on the sheet."""
        options, rate = self.options, self.source.rate
        every = options.every or max(1, round((self.last + 1) / _TILES))
        sheet = Sheet(title=f"{self.source.path.name}   every {every} of {self.last + 1} frames at {rate:g} a second")
        with ExitStack() as stack:
            movie = None
            if options.record is not None:
                movie = stack.enter_context(Movie(options.record, self.size, options.rate or rate))
            step = 1 if movie is not None else every
            for tick in range(0, self.last + 1, step):
                view = self._view(tick, step / rate)
                if movie is not None:
                    begin = time.perf_counter()
                    picture = self.studio.picture(view, self.size, names=options.names)
                    self.report.draws.append(time.perf_counter() - begin)
                    movie.add(picture)
                    self.report.pictures += 1
                if options.sheet is not None and tick % every == 0:
                    small = self.studio.picture(self.tile_view or view, self.tile, names=options.names, best=True)
                    sheet.add(small, self.source.world.tick, tick / rate)
                    self.report.pictures += movie is None
                if self.progress is not None:
                    self.progress(tick + 1, self.last + 1)
        if options.record is not None:
            self.report.files.append(str(options.record))
        if options.sheet is not None:
            sheet.save(options.sheet)
            self.report.files.append(str(options.sheet))

    def _snapshot(self, path: Path) -> None:
        """One picture at the time asked for, else at the end."""
        at = self.last if self.options.at is None else round(self.options.at * self.source.rate)
        view = self._view(int(np.clip(at, 0, self.last)), 10.0)
        save_picture(self.studio.picture(view, self.size, names=self.options.names, best=True), path)
        self.report.pictures += 1
        self.report.files.append(str(path))

    def _cut(self) -> list[Shot]:
        """The shots of the whole recording."""
        aspect = self.size[0] / self.size[1]
        look = Looking(self.studio.stage, self.studio.painter, aspect)
        found = shots(look, self._at_hand, self.last + 1, self.source.rate, aspect)
        look.close()
        return found

    def _at_hand(self, tick: int) -> Interest | None:
        """What hands do at a tick, which is on the stage then."""
        self._show(tick)
        return work(self.studio.stage, self.options.follow, self.touched)

    def _view(self, tick: int, seconds: float) -> View:
        """Bring the stage to a tick, so many seconds after the one before; from where it is seen."""
        self._show(tick)
        for shot in self.shots:
            if shot.first <= tick < shot.end:
                self.aim.view = shot.view(tick)
        return self.aim.step(self.studio.stage, seconds, whole=True)

    def _show(self, tick: int) -> None:
        self.mirror.show(self.source.show(tick))
