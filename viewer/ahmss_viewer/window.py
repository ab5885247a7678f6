"""The window: orbit camera, follow, pause, names, an overlay with frame rate and age of the world."""

from __future__ import annotations

import time
from contextlib import ExitStack
from typing import Any

import pyglet
from pyglet.window import key, mouse

from ahmss.errors import DependencyError
from ahmss_viewer.aim import Aim, Arrivals
from ahmss_viewer.camera import View
from ahmss_viewer.caption import Flat, Writer
from ahmss_viewer.feed import LiveFeed, ReplayFeed
from ahmss_viewer.framing import Follower
from ahmss_viewer.graphics import WINDOW_CURE
from ahmss_viewer.mirror import Mirror
from ahmss_viewer.names import name_flats
from ahmss_viewer.options import ViewOptions, ViewReport
from ahmss_viewer.pace import Pace
from ahmss_viewer.painter import Painter
from ahmss_viewer.source import Live, Replay
from ahmss_viewer.stage import Stage
from ahmss_viewer.target import Screen

__all__ = ["show"]

_HELP = """drag  turn        right drag, shift drag  move        wheel  nearer, farther
f  follow the human        r  find a good view        space  pause the view
n  names        o  overlay        h  this help        q, escape  close"""
_REPLAY_HELP = "\nleft, right  one second back, on        home  from the start"
_HELP_S = 10.0
_TURN, _ZOOM = 0.008, 0.9
_DARK = (30, 34, 40, 200)


def show(options: ViewOptions) -> ViewReport:
    """Open a window and show the world until it is closed, or until `options.seconds` are over.

    Raises:
        DependencyError: no window can be opened here.
        DataError: the recording can't be read.
    """
    with ExitStack() as stack:
        source = Replay(options.replay) if options.replay is not None else None
        if source is None:
            source = Live(options.address, keys=options.keys, request=options.request)
        stack.callback(source.close)
        window = open_window(options.size)
        stack.callback(window.close)
        return _Viewer(options, source, window).run()


def open_window(size: tuple[int, int]) -> Any:
    """A window with OpenGL 3.3, one sample a pixel.

    Raises:
        DependencyError: the display refuses.
    """
    try:
        config = pyglet.gl.Config(double_buffer=True, depth_size=24, major_version=3, minor_version=3)
        return pyglet.window.Window(*size, caption="AHMSS", resizable=True, config=config, vsync=False)
    except Exception as error:
        reason = str(error) or type(error).__name__
        raise DependencyError(f"no window can be opened ({reason}); run: {WINDOW_CURE}, or use --headless") from error


class _Viewer:
    """The window's state and its loop."""

    def __init__(self, options: ViewOptions, source: Live | Replay, window: Any) -> None:
        self.options, self.window = options, window
        self.feed = ReplayFeed(source) if isinstance(source, Replay) else LiveFeed(source)
        self.stage, self.painter, self.writer, self.pace = Stage(), Painter(fine=bool(options.fine)), Writer(), Pace()
        self.mirror = Mirror(self.stage, source.asset, source.skeleton)
        self.aim, self.arrivals = Aim(options), Arrivals()
        self.view = View()
        self.touched = self.paused = self.closed = False  # touched: the camera is where a person put it
        self.names, self.overlay = options.names, options.overlay is not False
        self.help: bool | None = None  # nobody has asked: at first it is shown
        self.following: Follower | None = Follower(options.follow) if options.follow else None
        self.begun = time.monotonic()
        self.stale = True
        window.push_handlers(
            on_close=self.on_close, on_key_press=self.on_key_press, on_mouse_drag=self.on_mouse_drag,
            on_mouse_scroll=self.on_mouse_scroll, on_resize=self.on_resize, on_expose=self.on_expose,
        )  # fmt: skip

    def run(self) -> ViewReport:
        """Events, the newest world, a picture; a picture only where something is new."""
        while not self.closed:
            self.window.switch_to()
            self.window.dispatch_events()
            if self.closed or self._over():
                break
            fresh = self.feed.wait(0.012 if self.stale else 0.05)
            if fresh and not self.paused:
                self.mirror.show(self.feed.world)
                self.stale = True
            if self.stale or self.feed.silent or self.paused:
                self._draw(fresh=fresh and not self.paused)
        return self._report()

    def _over(self) -> bool:
        return self.options.seconds is not None and time.monotonic() - self.begun >= self.options.seconds

    def _draw(self, *, fresh: bool) -> None:
        """One picture."""
        self.stale = False
        size = self.window.get_framebuffer_size()
        if self.arrivals.due(self.stage) and not self.touched:
            self.view = self.aim.begin(self.stage, self.painter)
        if not self.paused:
            self.view = self._followed(size[0] / size[1])
        self.painter.draw(self.stage, self.view, size, Screen(*size), self._flats(size))
        self.window.flip()
        if fresh:
            self.stage.tick()
            self.pace.shown(self.feed.age(), ages=isinstance(self.feed, LiveFeed))

    def _followed(self, aspect: float) -> View:
        """The view a moment later: after the human who is followed, or after those who leave a picture nobody set."""
        if self.following is not None:
            return self.following.step(self.view, self.stage, aspect, self.pace.last)
        if self.touched:
            return self.view
        self.aim.view = self.view
        return self.aim.step(self.stage, self.pace.last)

    def _flats(self, size: tuple[int, int]) -> list[Flat]:
        """What is written over the picture."""
        flats = name_flats(self.stage, self.view, size, self.writer) if self.names else []
        state = self._state() if self.overlay else ""
        if state:
            flats.append(self.writer.flat(state, 10, 10))
        asked = self.help if self.help is not None else time.monotonic() - self.begun < _HELP_S
        if asked:
            text = _HELP + (_REPLAY_HELP if isinstance(self.feed, ReplayFeed) else "")
            height = 18 * (text.count("\n") + 1)
            flats.append(self.writer.flat(text, 10, size[1] - height - 30, size=13, paper=_DARK))
        return flats

    def _state(self) -> str:
        """The overlay's lines."""
        lines = [self.pace.text(), *self.feed.lines()]
        if self.paused:
            lines.append("paused: space goes on")
        if self.following is not None:
            lines.append(f"following {self.following.name}")
        lines += self.mirror.problems[-2:]
        return "\n".join(filter(None, lines))

    def _report(self) -> ViewReport:
        report = ViewReport(self.feed.name, tuple(self.window.get_size()), self.pace.pictures, self.pace.seconds)
        report.faces, report.problems, report.ages = self.stage.faces(), self.mirror.problems, self.pace.ages
        return report

    # events

    def on_close(self) -> bool:
        """Leave the loop; the window itself is closed after it."""
        self.closed = True
        return True

    def on_expose(self) -> None:
        """The window was uncovered."""
        self.stale = True

    def on_resize(self, _width: int, _height: int) -> bool:
        """The next picture has the new size."""
        self.stale = True
        return True

    def on_mouse_drag(self, _x: int, _y: int, dx: int, dy: int, buttons: int, modifiers: int) -> None:
        """Turn or move the camera."""
        height = max(1, self.window.get_size()[1])
        if buttons & (mouse.RIGHT | mouse.MIDDLE) or modifiers & key.MOD_SHIFT:
            self.view = self.view.pan(-dx / height, -dy / height)
            self.following = None
        elif buttons & mouse.LEFT:
            self.view = self.view.orbit(-_TURN * dx, -_TURN * dy)
        self.stale = self.touched = True

    def on_mouse_scroll(self, _x: int, _y: int, _dx: float, dy: float) -> None:
        """Nearer or farther."""
        self.view = self.view.zoom(_ZOOM**dy)
        self.stale = self.touched = True

    def on_key_press(self, symbol: int, _modifiers: int) -> bool:
        """One key, one thing."""
        self.stale = True
        if symbol in (key.Q, key.ESCAPE):
            self.closed = True
        elif symbol == key.SPACE:
            self.paused = not self.paused
            self.feed.hold(self.paused)
        elif symbol == key.N:
            self.names = not self.names
        elif symbol == key.O:
            self.overlay = not self.overlay
        elif symbol == key.H:
            self.help = not self.help if self.help is not None else time.monotonic() - self.begun >= _HELP_S
        elif symbol == key.R:
            self.touched = False
            self.view = self.aim.begin(self.stage, self.painter)
        elif symbol == key.F:
            self._follow_next()
        elif symbol in (key.LEFT, key.RIGHT, key.HOME):
            self.feed.jump({key.LEFT: -1.0, key.RIGHT: 1.0}.get(symbol, -1e9))
        return True

    def _follow_next(self) -> None:
        """The first human, the next one, nobody."""
        names = [actor.name for actor in self.stage.actors.values()]
        known = self.following.name if self.following is not None else None
        at = names.index(known) + 1 if known in names else 0
        self.following = Follower(names[at]) if at < len(names) else None
