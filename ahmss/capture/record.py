"""A session before the tracker: frames as they come become a take, which is saved whatever ends the session."""

from __future__ import annotations

import signal
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass
from threading import Event
from types import FrameType

import numpy as np

from ahmss.capture.config import TrackerConfig
from ahmss.capture.device import Tracker
from ahmss.capture.stations import TRACKED, Status, TrackerFrame
from ahmss.capture.take import Take, TakeHeader, from_frames
from ahmss.errors import DependencyError

__all__ = ["Progress", "header_of", "interruptible", "rate_of", "record"]

_LOOK = 0.004  # seconds between two looks at the tracker: a quarter of a frame at 60 Hz
_TELL = 0.25  # seconds between two words on how far it is
_GONE = 2.0  # seconds after its time is up for which a session waits for a tracker that fell silent
_PATIENCE = 15.0  # seconds for the first frame: a device that was just switched on takes 10


@dataclass(frozen=True)
class Progress:
    """How far a session is.

    frames so far; seconds since the first; silence: why nothing comes, or ""; troubled: links whose sensor now gives
    nothing or is weak.
    """

    frames: int
    seconds: float
    silence: str
    troubled: tuple[str, ...]

    @property
    def line(self) -> str:
        """In one line."""
        said = f"{self.seconds:.1f} s, {self.frames} frames" if self.frames else "waiting for the first frame"
        if self.troubled:
            said += "; weak or missing: " + (", ".join(self.troubled) if len(self.troubled) < len(TRACKED) else "all")
        return said + (f"; {self.silence}" if self.silence else "")


def record(
    config: TrackerConfig, seconds: float | None, tell: Callable[[Progress], None], origin: str = ""
) -> tuple[Take, str]:
    """Record until so many seconds have passed, or until Ctrl-C or SIGTERM; what has come by then is the take.

    Args:
        config: the tracker's.
        seconds: how long, from the first frame; None: until it is interrupted.
        tell: is told how far it is, four times a second.
        origin: what the take says of where it comes from.

    Returns:
        the take, and a sentence on what was lost on the way.

    Raises:
        DependencyError: nothing came at all; the message says why.
    """
    frames: list[TrackerFrame] = []
    with Tracker(config) as tracker:
        with interruptible() as over:
            _listen(tracker, frames, seconds, tell, over)
        silence = tracker.silence
    frames += tracker.poll()
    if not frames:
        raise DependencyError(silence or "it was interrupted before the first frame came; nothing is saved")
    frames = [frame for frame in frames if seconds is None or frame.time - frames[0].time <= seconds]
    return from_frames(frames, rate_of(frames, config.rate), header_of(config, origin)), tracker.losses.sentence


def header_of(config: TrackerConfig, origin: str) -> TakeHeader:
    """What a take of this tracker says of itself."""
    return TakeHeader(
        origin=origin or f"{config.kind} tracker",
        transmitter_rotation=config.transmitter_rotation,
        transmitter_place=config.transmitter.position,
    )


def rate_of(frames: list[TrackerFrame], nominal: float) -> float:
    """Frames a second as they really came: the configured rate unless the device's own time says another.

    A device or a line that can't keep the rate sends fewer; its frame numbers have no gaps then.
    """
    steps = frames[-1].number - frames[0].number
    seconds = frames[-1].time - frames[0].time
    if steps < nominal or seconds <= 0.0:  # less than a second tells too little
        return nominal
    measured = steps / seconds
    return nominal if abs(measured / nominal - 1.0) < 0.02 else round(measured, 2)


def _listen(
    tracker: Tracker, frames: list[TrackerFrame], seconds: float | None, tell: Callable[[Progress], None], over: Event
) -> None:
    """Take in frames until it is enough."""
    opened = began = told = time.monotonic()
    while not over.is_set():
        frames += tracker.poll()
        now = time.monotonic()
        past = frames[-1].time - frames[0].time if frames else 0.0
        if now - told >= _TELL:
            told = now
            tell(Progress(len(frames), past, tracker.silence, _troubled(frames)))
        began = now if not frames else began
        if seconds is not None and (past >= seconds or (now - began > seconds + _GONE and tracker.silence)):
            return
        if not frames and now - opened > _PATIENCE:
            return
        time.sleep(_LOOK)


def _troubled(frames: list[TrackerFrame]) -> tuple[str, ...]:
    """The links whose sensor is not good in the newest frame."""
    if not frames:
        return ()
    return tuple(TRACKED[int(i)] for i in np.flatnonzero(frames[-1].status != Status.GOOD))


@contextmanager
def interruptible() -> Generator[Event]:
    """An event that Ctrl-C or SIGTERM sets, so that what is within can end in order; a second one ends it at once."""
    over = Event()

    def interrupt(_signal: int, _frame: FrameType | None) -> None:
        if over.is_set():
            raise KeyboardInterrupt
        over.set()

    before = {number: signal.signal(number, interrupt) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield over
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
