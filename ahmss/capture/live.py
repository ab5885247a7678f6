"""A tracker drives a virtual human while the person moves.

The human stands upright until the subject has stood still for a second: that calibrates it (5.1). From then on every
frame of the tracker becomes a frame of the human in the world.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import align, from_axis_angle, multiply
from ahmss.body.skeleton import Skeleton
from ahmss.capture.calibration import calibrate, link_rotations, spread
from ahmss.capture.clipping import joint_rotations
from ahmss.capture.config import TrackerConfig
from ahmss.capture.device import Tracker
from ahmss.capture.record import header_of, interruptible
from ahmss.capture.stations import TRACKED, Status, TrackerFrame
from ahmss.capture.take import from_frames
from ahmss.database.records import HumanModel
from ahmss.database.shape import Shape
from ahmss.errors import DependencyError
from ahmss.motion.hips_online import HipsOnline
from ahmss.world.client import WorldClient
from ahmss.world.link import Pending
from ahmss.world.schema import Heartbeat

__all__ = ["Latency", "Performer", "Puppet", "drive"]

_LOOK = 0.001  # seconds between two looks at the tracker
_MISSED = 0.2  # share of a sensor's readings that the upright second may lack; the last ones stand for them
_STILL = 2.0  # degrees RMS that the sensors of one who stands still stray from their mean
_UP = np.array([0.0, 0.0, 1.0])
_TELL = 5.0  # seconds between two words on the latency
_UNANSWERED = 120  # frames on the way to the server that are still waited for


@dataclass(frozen=True)
class Puppet:
    """Whom the tracker drives: name, body, where they stand at first (metres, radians), where the subject faces then.

    facing: against the transmitter's x axis, radians to the left; None takes it from the sensors' places.
    """

    human: str
    model: HumanModel
    place: tuple[float, float] = (0.0, 0.0)
    heading: float = 0.0
    facing: float | None = 0.0


@dataclass(frozen=True)
class Latency:
    """From a frame's last byte to the server's having taken it in and said so, milliseconds, over `frames` frames."""

    frames: int
    p50: float
    p99: float

    @classmethod
    def of(cls, seconds: Sequence[float]) -> Latency:
        """Of single times in seconds; none: all 0."""
        if not seconds:
            return cls(0, 0.0, 0.0)
        p50, p99 = np.percentile(np.array(seconds) * 1000.0, [50.0, 99.0])
        return cls(len(seconds), round(float(p50), 2), round(float(p99), 2))

    @property
    def sentence(self) -> str:
        """In one line."""
        if not self.frames:
            return "byte to server: not known, no answer came back in time"
        return f"byte to server: p50 {self.p50:.1f} ms, p99 {self.p99:.1f} ms over {self.frames} frames"


class Performer:
    """Tracker frames in, poses out; no pose until the subject has stood upright for a second.

    Args:
        skeleton: the human's measures.
        config: the tracker's.
        puppet: where the human stands at first, and where the subject faces.
    """

    def __init__(self, skeleton: Skeleton, config: TrackerConfig, puppet: Puppet) -> None:
        self._config, self._puppet = config, puppet
        self._fingers = skeleton.relaxed()[0][len(TRACKED) :]
        self._waiting: deque[TrackerFrame] = deque(maxlen=max(round(config.rate), 2))
        self._turns: Array | None = None
        self._turn = np.array([1.0, 0.0, 0.0, 0.0])
        self._hips = HipsOnline(skeleton, config.rate, np.array(puppet.place))
        self._number, self._last = 0, skeleton.upright()[0]

    @property
    def calibrated(self) -> bool:
        """Whether the subject has stood still."""
        return self._turns is not None

    def step(self, frame: TrackerFrame) -> tuple[Array, Array] | None:
        """Rotations (43, 4) and root (3,) in the world of one frame; None while it waits for the upright pose."""
        if self._turns is None and not self._calibrate(frame):
            return None
        assert self._turns is not None
        sensors = multiply(self._config.transmitter.rotation, frame.rotations)
        links = multiply(self._turn, link_rotations(sensors, self._turns))
        self._last = align(joint_rotations(links, self._fingers), self._last)
        since, self._number = max(frame.number - self._number, 1), frame.number
        return self._hips.step(self._last, since)

    def _calibrate(self, frame: TrackerFrame) -> bool:
        """Whether the last second shows the subject still, and has given the sensors' turns."""
        self._waiting.append(frame)
        if len(self._waiting) < (self._waiting.maxlen or 0):
            return False
        missing = np.mean([each.status >= Status.MISSING for each in self._waiting], axis=0)
        if missing.max() > _MISSED:
            return False
        take = from_frames(list(self._waiting), self._config.rate, header_of(self._config, ""))
        if np.degrees(spread(take.rotations, take.frames)[0]) > _STILL:
            return False
        found = calibrate(take, stretch=(0, take.frames), facing=self._puppet.facing)
        self._turns = found.sensor_to_link
        self._turn = from_axis_angle(_UP, np.array(self._puppet.heading - found.facing))
        self._number = frame.number - 1
        return True


def drive(
    config: TrackerConfig,
    puppet: Puppet,
    shape: Shape,
    client: WorldClient,
    say: Callable[[str], None],
    seconds: float | None = None,
) -> Latency:
    """Let the tracker drive a human of the world until so many seconds have passed, or Ctrl-C.

    Args:
        config: the tracker's.
        puppet: whom it drives.
        shape: of the human.
        client: not yet joined; stays open.
        say: is told what happens, a sentence each.
        seconds: how long; None: until it is interrupted.

    Raises:
        Unreachable: there is no server. WorldError: it refused. DependencyError: the human never moved; says why.
    """
    skeleton = puppet.model.skeleton
    rotations, root = skeleton.upright()
    rotations[0] = multiply(from_axis_angle(_UP, np.array(puppet.heading)), rotations[0])
    rotations[len(TRACKED) :] = skeleton.relaxed()[0][len(TRACKED) :]  # as they will be
    texture = shape.texture.data if shape.texture else b""
    client.join(
        puppet.human, puppet.model.name, root + np.array([*puppet.place, 0.0]), rotations,
        skeleton=skeleton.to_record(), shape=shape.glb, texture=texture, group=puppet.human,
    )  # fmt: skip
    say(f"{puppet.human} is in the world; stand upright and still for a second")
    session = _Session(config, puppet, client, say)
    try:
        with Tracker(config) as tracker, interruptible() as over:
            until = None if seconds is None else time.monotonic() + seconds
            while not over.is_set() and (until is None or time.monotonic() < until):
                session.look(tracker)
                time.sleep(_LOOK)
            silence = tracker.silence
        say(tracker.losses.sentence)
    finally:
        client.leave(puppet.human)
    if not session.published:
        raise DependencyError(silence or session.waited_for)
    return Latency.of(session.times)


class _Session:
    """What one drive has done so far."""

    def __init__(self, config: TrackerConfig, puppet: Puppet, client: WorldClient, say: Callable[[str], None]) -> None:
        self._performer = Performer(puppet.model.skeleton, config, puppet)
        self._human, self._client, self._say = puppet.human, client, say
        self._asked: deque[tuple[float, Pending]] = deque(maxlen=_UNANSWERED)
        self._frames = 0
        self._told, self._counted = time.monotonic(), 0
        self._silence = ""
        self.times: list[float] = []
        self.published = 0

    @property
    def waited_for(self) -> str:
        """Why the human has not moved, though the tracker is not silent."""
        if not self._frames:
            return "it ended before the first frame of the tracker came"
        return f"the subject did not stand upright and still for a second in {self._frames} frames: nothing moved"

    def look(self, tracker: Tracker) -> None:
        """Take in what the tracker has, move the human, hear the server."""
        newest: tuple[TrackerFrame, tuple[Array, Array]] | None = None
        for frame in tracker.poll():
            self._frames += 1
            waited = not self._performer.calibrated
            pose = self._performer.step(frame)
            if pose is not None:
                newest = frame, pose
                if waited:
                    self._say("calibrated: move")
        if newest is not None:
            frame, (rotations, root) = newest
            self.published += 1
            if self._client.publish(self._human, self.published, root, rotations):
                self._asked.append((frame.arrival, self._client.begin(Heartbeat())))
        self._client.poll()
        while self._asked and self._asked[0][1].done:
            self.times.append(time.monotonic() - self._asked.popleft()[0])
        self._tell(tracker)

    def _tell(self, tracker: Tracker) -> None:
        """Say why nothing comes, once; and how late the human is, now and then."""
        silence = tracker.silence
        if silence and silence != self._silence:
            self._say(silence)
        self._silence = silence
        now = time.monotonic()
        if now - self._told >= _TELL and len(self.times) > self._counted:
            self._say(Latency.of(self.times[self._counted :]).sentence)
            self._told, self._counted = now, len(self.times)
