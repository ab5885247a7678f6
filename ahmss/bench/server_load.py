"""How many humans the server carries, and how soon a viewer sees a pose: a load of real sockets from real processes.

`most_humans` and `latency_ms` start a server, and this module again as the load (and as the viewer) in
processes of their own. Every human has its own connection and sends a message each tick.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import zmq

from ahmss.body.array import Array
from ahmss.body.skeleton import Skeleton
from ahmss.world import frame as frames
from ahmss.world import schema
from ahmss.world.address import parse
from ahmss.world.client import WorldClient
from ahmss.world.process import ServerProcess

__all__ = ["Load", "latency_ms", "most_humans", "tick_cost_us"]

_RATE = 60.0
_STEPS = (125, 250, 500, 1000, 1250, 1500, 2000)
_DELIVERED = 0.98
_WAY = np.zeros(schema.WAY_SHAPE)
_QUIET = Path(os.devnull)  # that the load goes away at the end is no news


class Load:
    """Many humans of one process, each with a connection of its own, without the cost of full clients.

    All tell a way with every frame, as who walks does.

    Args:
        address: of the server.
        count: how many humans; they are named `load_0`, `load_1`, ...
    """

    def __init__(self, address: str, count: int) -> None:
        _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
        resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
        self._context: zmq.Context[zmq.Socket[bytes]] = zmq.Context()
        self._context.set(zmq.MAX_SOCKETS, count + 16)
        rotations, root = Skeleton.of().upright()
        pose = np.concatenate([root, rotations.ravel()])
        self._sockets = [self._connect(address) for _ in range(count)]
        for number, socket in enumerate(self._sockets):
            socket.send(schema.encode(schema.Join(f"load_{number}", "load", pose.tobytes(), request=1)))
        self.ids = [self._joined(socket) for socket in self._sockets]
        self._messages = [bytearray(frames.pack(number, 0, root, rotations, way=_WAY)) for number in self.ids]

    def run(self, seconds: float, *, spread: bool) -> Array:
        """Send each human's frames at the world's rate; (n, 3) rows of id, frame, time sent (monotonic clock).

        spread: each human has its own phase in the tick; else all send as soon as the tick begins.
        """
        count, ticks = len(self._sockets), int(seconds * _RATE)
        sent = np.zeros((ticks, count, 3))
        sent[:, :, 0] = self.ids
        sent[:, :, 1] = np.arange(1, ticks + 1)[:, None]
        phases = np.linspace(0, 1 / _RATE, count, endpoint=False) if spread else np.zeros(count)
        begin = time.monotonic() + 0.1
        for tick in range(ticks):
            for number, (socket, message) in enumerate(zip(self._sockets, self._messages, strict=True)):
                wait = begin + tick / _RATE + phases[number] - time.monotonic()
                if wait > 1e-4:
                    time.sleep(wait)
                frames.HEADER.pack_into(message, 0, frames.KIND, frames.WITH_WAY, 0, self.ids[number], tick + 1)
                sent[tick, number, 2] = time.monotonic()
                try:
                    socket.send(message, zmq.NOBLOCK)
                except zmq.Again:
                    sent[tick, number, 2] = np.nan
        return sent.reshape(-1, 3)

    def close(self) -> None:
        """Close all connections."""
        for socket in self._sockets:
            socket.close(0)
        self._context.term()

    def _connect(self, address: str) -> zmq.Socket[bytes]:
        socket = self._context.socket(zmq.DEALER)
        socket.connect(parse(address).endpoint())
        return socket

    @staticmethod
    def _joined(socket: zmq.Socket[bytes]) -> int:
        reply = schema.decode_reply(socket.recv())
        if not isinstance(reply, schema.Joined):
            raise RuntimeError(f"the load can't join: {reply}")
        return reply.id


def watch(address: str, seconds: float) -> Array:
    """A viewer that looks as soon as something comes; (n, 3) rows of human id, newest frame seen, time seen."""
    seen: list[Array] = []
    with WorldClient(address) as client:
        client.hello()
        end = time.monotonic() + seconds
        sequence = -1
        while time.monotonic() < end:
            client.rest(0.1)
            world = client.poll()
            if world.sequence == sequence:
                continue
            sequence = world.sequence
            now = np.full(len(world.human_ids), time.monotonic())
            seen.append(np.stack([world.human_ids.astype(float), world.human_frames.astype(float), now], axis=1))
    return np.concatenate(seen)


def most_humans(steps: Sequence[int] = _STEPS, seconds: float = 4.0) -> dict[str, float]:
    """The most humans at 60 Hz of a server on one core with the 99th percentile of a tick's work under one frame.

    Returns:
        `humans`, `p99_ms` and `median_ms` at that number, and `delivered` (share of sent frames taken in).
    """
    best = {"humans": 0.0, "p99_ms": 0.0, "median_ms": 0.0, "delivered": 0.0}
    for count in steps:
        result = _load(count, seconds)
        if result["p99_ms"] >= 1e3 / _RATE or result["delivered"] < _DELIVERED:
            break
        best = result
    return best


def latency_ms(humans: int = 100, seconds: float = 5.0) -> dict[str, float]:
    """Milliseconds from a pose sent to the world seen by a viewer: `p50`, `p99`, `worst`."""
    with TemporaryDirectory() as place, ServerProcess(log=_QUIET) as server:
        files = [Path(place) / name for name in ("sent.npy", "seen.npy")]
        viewer = _spawn("watch", server.address, str(seconds + 6), str(files[1]))
        load = _spawn("send", server.address, str(humans), str(seconds), "spread", str(files[0]))
        for process in (load, viewer):
            if process.wait(seconds + 60):
                raise RuntimeError("the load or the viewer of the bench failed")
        sent, seen = (np.load(file) for file in files)
    delays = _delays(sent, seen) * 1e3
    p50, p99, worst = np.percentile(delays, (50, 99, 100)).tolist()
    return {"p50": p50, "p99": p99, "worst": worst}


def tick_cost_us(humans: int, seconds: float = 3.0) -> float:
    """Median microseconds of a tick's work with so many humans, frames taken in and snapshot sent."""
    return _load(humans, seconds)["median_ms"] * 1e3


def _load(count: int, seconds: float) -> dict[str, float]:
    """One number of humans against a server that has one core."""
    cores = sorted(os.sched_getaffinity(0))
    pin = ["taskset", "-c", str(cores[0])]
    with (
        ServerProcess(prefix=pin, lease_s=30.0, log=_QUIET) as server,
        WorldClient(server.address, follow=True) as client,
    ):
        before = client.stats()
        load = _spawn("send", server.address, str(count), str(seconds), "together", os.devnull, cores=cores[1:])
        limit = time.monotonic() + seconds + 120
        while load.poll() is None and time.monotonic() < limit:
            client.rest(0.1)
            client.poll()
        stats = client.stats()
        if load.wait(10):
            raise RuntimeError("the load of the bench failed")
    loaded = stats.busy_ms[-int((seconds - 1) * _RATE) :]
    delivered = (stats.frames - before.frames) / (count * int(seconds * _RATE))
    median, p99 = np.percentile(loaded, (50, 99)).tolist()
    return {"humans": count, "p99_ms": p99, "median_ms": median, "delivered": delivered}


def _delays(sent: Array, seen: Array) -> Array:
    """For each frame sent, how long until a snapshot with it or a later one of that human was seen, in seconds."""
    delays: list[Array] = []
    for number in np.unique(sent[:, 0]):
        mine, shown = sent[sent[:, 0] == number], seen[seen[:, 0] == number]
        at = np.searchsorted(shown[:, 1], mine[:, 1])
        known = at < len(shown)
        delays.append(shown[at[known], 2] - mine[known, 2])
    return np.concatenate(delays)


def _spawn(*arguments: str, cores: Sequence[int] = ()) -> subprocess.Popen[bytes]:
    pin = ["taskset", "-c", ",".join(map(str, cores))] if cores else []
    return subprocess.Popen([*pin, sys.executable, "-m", "ahmss.bench.server_load", *arguments])


def _main(arguments: Sequence[str]) -> None:
    """The child's part: `watch ADDRESS SECONDS FILE` or `send ADDRESS HUMANS SECONDS spread|together FILE`."""
    if arguments[0] == "watch":
        np.save(arguments[3], watch(arguments[1], float(arguments[2])))
        return
    load = Load(arguments[1], int(arguments[2]))
    sent = load.run(float(arguments[3]), spread=arguments[4] == "spread")
    load.close()
    if arguments[5] != os.devnull:
        np.save(arguments[5], sent)


if __name__ == "__main__":
    if sys.argv[1] == "all":
        print(json.dumps({"latency_ms": latency_ms(), "server": most_humans()}))
    else:
        _main(sys.argv[1:])
