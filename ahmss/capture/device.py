"""A tracker as the program sees it: frames of fifteen stations, what was lost, and why it is silent."""

from __future__ import annotations

import queue
import threading
import time
from types import TracebackType

from ahmss.capture.assembly import Sweep
from ahmss.capture.config import TrackerConfig
from ahmss.capture.formats.losses import Losses
from ahmss.capture.merge import Merger
from ahmss.capture.plausible import Gate
from ahmss.capture.port import Port, numbering_of
from ahmss.capture.stations import TrackerFrame
from ahmss.capture.udp import UdpPort

__all__ = ["Tracker"]


class Tracker:
    """All lines of a tracker, merged. None of its methods but `stop` waits for anything.

    ```python
    with Tracker(load(Path("tracker.toml"))) as tracker:
        while capturing:
            for frame in tracker.poll():
                take(frame)
            show(tracker.silence)
    ```
    """

    def __init__(self, config: TrackerConfig) -> None:
        """Args: what is plugged in where."""
        self.config = config
        self._losses = Losses()
        self._sweeps: queue.SimpleQueue[tuple[int, Sweep]] = queue.SimpleQueue()
        self._ports = self._make_ports()
        self._merger = Merger(
            len(self._ports),
            config.rate,
            self._losses,
            ordered=config.kind != "ultratrak",
            together=len(config.line) > 1 and numbering_of(config) != "count",
        )
        self._gate = Gate(config.rows, config.rate, self._losses)

    def _make_ports(self) -> list[Port] | list[UdpPort]:
        if self.config.kind == "ultratrak":
            return [UdpPort(self.config, lambda sweep: self._sweeps.put((0, sweep)))]
        together = threading.Barrier(len(self.config.line))
        return [
            Port(self.config, line, lambda sweep, at=at: self._sweeps.put((at, sweep)), together)
            for at, line in enumerate(self.config.line)
        ]

    def __enter__(self) -> Tracker:
        """Start it."""
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop it."""
        self.stop()

    def start(self) -> None:
        """Open the lines and set the devices up, in the background; returns at once, and never raises for a device."""
        for port in self._ports:
            port.start()

    def stop(self) -> None:
        """Tell the devices to stop, and close the lines; waits for that. What `poll` has not given yet stays."""
        for port in self._ports:
            port.end()
        for port in self._ports:
            port.stop()

    def poll(self) -> list[TrackerFrame]:
        """The frames that came since the last call, in order; an empty list where there are none."""
        while True:
            try:
                line, sweep = self._sweeps.get_nowait()
            except queue.Empty:
                break
            self._merger.add(line, sweep)
        return [self._gate.frame(merged) for merged in self._merger.take(time.monotonic())]

    @property
    def losses(self) -> Losses:
        """What was lost since the start, on all lines."""
        return sum((port.losses for port in self._ports), self._losses)

    @property
    def silence(self) -> str:
        """Why a line has been silent for a second, and what to do, a sentence a line; "" while all is well."""
        now = time.monotonic()
        return "\n".join(trouble for port in self._ports if (trouble := port.trouble(now)))

    @property
    def ready(self) -> bool:
        """Whether a record came from every line."""
        return all(port.heard.records for port in self._ports)
