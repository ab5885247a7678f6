"""What a main or a viewer uses to talk to the virtual-space server.

A frame loop calls `publish` and `poll`, which never block. Requests come in two kinds: `begin(request)` never blocks
and gives a Pending; the named methods (`add`, `claim`, ...) wait for the answer and raise WorldError with its reason.
In lockstep, `publish` sends frame k and `collect` waits until the world has completed it.
"""

from __future__ import annotations

import json
import time
from collections.abc import Sequence
from types import TracebackType
from typing import Any

import numpy as np
import zmq

from ahmss.body.array import Array
from ahmss.errors import ProtocolError, Unreachable
from ahmss.world import frame as frames
from ahmss.world import schema
from ahmss.world.address import Address, parse
from ahmss.world.ahead import Ahead
from ahmss.world.asking import Asking
from ahmss.world.keys import ClientKeys
from ahmss.world.link import Link, Pending
from ahmss.world.own import Own, OwnHumans
from ahmss.world.schema import Reply, Request, Scene, Snapshot
from ahmss.world.subscription import Subscription
from ahmss.world.view import World

__all__ = ["WorldClient"]

_MOST_REFUSALS = 100
_SCENES = 20  # how often `refresh` asks for a scene that fits the snapshot


class WorldClient(Asking):
    """A connection to the virtual-space server that lasts: it reconnects, and comes back with what it held.

    Args:
        address: `HOST`, `HOST:PORT` or nothing for this machine.
        keys: for a server on another machine (`ahmss.world.keys.read_client`).
        timeout: seconds that a waiting method waits.
        follow: take the published snapshots (a viewer, a main in real time). Without, `poll` gives what requests and
            ticks brought.
        context: a ZeroMQ context to share between many clients of one process.

    Attributes:
        world: the newest world, changed in place by `poll`, `collect` and `refresh`.
        refusals: reasons of refused frames and of requests that nobody waits for, newest last; the caller clears it.

    Raises:
        Unreachable: from the first call that needs an answer, where no server gives one.
    """

    def __init__(
        self,
        address: str | Address = "",
        *,
        keys: ClientKeys | None = None,
        timeout: float = 5.0,
        follow: bool = True,
        context: zmq.Context[zmq.Socket[bytes]] | None = None,
    ) -> None:
        super().__init__()
        self.address = parse(address) if isinstance(address, str) else address
        self.timeout = timeout
        self.world = World()
        self.refusals: list[str] = []
        self.lockstep = False
        self._keys, self._follow = keys, follow
        self._context = context or zmq.Context()
        self._owns_context = context is None
        self._own = OwnHumans()
        self._closed = False
        self._ahead = Ahead(lambda data: self._link.send(data))
        self._snapshots = Subscription(self._context, self.address, keys)
        self._shown: Snapshot | None = None
        self._scene: Pending | None = None
        self._link = Link(self._context, self.address, keys, self._greet, self._answered, self._unasked)

    def __enter__(self) -> WorldClient:
        """The client itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Close."""
        self.close()

    def another(self) -> WorldClient:
        """A second connection to the same server, for use in another thread; the caller closes it."""
        return WorldClient(self.address, keys=self._keys, timeout=self.timeout, follow=False)

    def close(self) -> None:
        """Close the sockets. Humans that have not left stay for the server's grace time."""
        if self._closed:
            return
        self._closed = True
        self._link.close()
        self._snapshots.close()
        if self._owns_context:
            self._context.term()

    # The frame path: never blocks

    @property
    def connected(self) -> bool:
        """Whether there is a connection now; it comes back by itself."""
        return self._link.is_up

    @property
    def is_current(self) -> bool:
        """Whether `world` is all that the newest snapshot tells: the scene under it has come too."""
        return self._shown is not None and self._shown.revision == self.world.revision

    def publish(
        self,
        human: str,
        frame: int,
        root: Array,
        rotations: Array,
        moved: Array | None = None,
        way: Array | None = None,
    ) -> bool:
        """Send a human's frame and the objects that it moves, as one update.

        Args:
            human: its name; it has joined.
            frame: rises with each call.
            root: (3,) world place of the hips joint.
            rotations: (43, 4).
            moved: (m, 8) rows of object id, place, rotation in the world, each held by the human.
            way: (6, 2) where the human means to be, see `ahmss.motion.way`; None, or NaN: not known.

        Returns:
            False where it could not be sent (no connection): the frame is lost, as it should be.
        """
        own = self._own[human]
        own.last = data = frames.pack(own.id, frame, root, rotations, moved, way)
        if moved is not None and len(moved):
            own.places.update((int(row[0]), row[1:]) for row in moved)
        if not self._link.is_up:
            self._link.pump()
        if not self.lockstep:
            return self._link.is_up and self._link.send(data)
        if moved is not None and len(moved):
            self.world.place_own(moved[:, 0], moved[:, 1:])
        self._ahead.publish(data)
        return self._link.is_up

    def poll(self) -> World:
        """Take in what has come and give the newest world."""
        self._link.pump()
        try:
            if (snapshot := self._snapshots.take()) is not None:
                self._see(snapshot)
        except ProtocolError as error:
            self._note(str(error))
        self._fetch_scene()
        return self.world

    def rest(self, seconds: float) -> None:
        """Sleep until a snapshot or a reply comes, at most `seconds`; `poll` then takes it."""
        poller = zmq.Poller()
        for socket in (self._link.socket, self._snapshots.socket):
            if socket is not None:
                poller.register(socket, zmq.POLLIN)
        poller.poll(int(max(0.0, seconds) * 1000 + 0.5))

    def begin(self, request: Request) -> Pending:
        """Ask without waiting; `poll` or `collect` brings the answer into the Pending."""
        self._ahead.send()
        return self._link.ask(request)

    def finish(self, pending: Pending, timeout: float | None = None) -> Reply:
        """Wait for what `begin` asked. Raises as the named methods do."""
        return self._link.wait(pending, self.timeout if timeout is None else timeout)

    def call(self, request: Request) -> Reply:
        """Ask, and wait for the answer."""
        return self.finish(self.begin(request))

    # Lockstep

    def collect(self, behind: int = 0, timeout: float = 60.0) -> World:
        """Lockstep: wait until the world has completed all but the last `behind` published frames.

        A main alone waits for nobody: with `behind` above 0 it may be as many as 32 frames ahead of the world, but
        while something falls each frame must see the one before.

        Raises:
            Unreachable: it has not in `timeout` seconds; another main hangs, or the server is gone.
        """
        limit = time.monotonic() + timeout
        behind = self._ahead.allowed(behind)
        while self._ahead.is_over(behind):
            self._link.take_one()
            if time.monotonic() > limit or not self._link.is_up:
                raise Unreachable(
                    f"the server at {self.address} has not completed the frame in {timeout:g} s; "
                    "another main may hang: see the server's log"
                )
        return self.world

    def sync(self, human: str, line: str, names: Sequence[str]) -> Pending:
        """Come to a line of the script; the Pending is done when every named human has. Never blocks."""
        return self.begin(schema.Sync(human, line, list(names)))

    # Requests that wait for the answer

    def refresh(self) -> World:
        """Ask for the scene and the present snapshot (a viewer with `--request`; a main after `join`)."""
        self._see(self.ask(schema.GetSnapshot(), Snapshot))
        for _ in range(_SCENES):  # in lockstep the snapshot is of the last tick, the scene may be of the next
            if self.is_current:
                break
            self.ask(schema.GetScene(), Scene)
            self._see(self.ask(schema.GetSnapshot(), Snapshot))
        return self.world

    def join(
        self,
        name: str,
        body: str,
        root: Array,
        rotations: Array,
        *,
        skeleton: dict[str, Any],
        shape: bytes = b"",
        texture: bytes = b"",
        group: str = "",
    ) -> int:
        """A human enters the world; returns its id. The assets are sent where the server lacks them."""
        pose = np.concatenate([root, rotations.reshape(-1)]).astype("<f8").tobytes()
        record = json.dumps(skeleton, sort_keys=True).encode()
        hashes = [self.put_asset(data) for data in (record, shape, texture)]
        request = schema.Join(name, body, pose, hashes[0], hashes[1], hashes[2], group=group)
        self.hello()
        joined = self.ask(request, schema.Joined)
        assets = {key: data for key, data in zip(hashes, (record, shape, texture), strict=True) if data}
        self._own[name] = Own(request, joined.id, assets)
        return joined.id

    # How

    def _greet(self) -> None:
        """At each new connection: who are you, and here are my humans with what they hold."""
        self._ahead.forget()
        self._link.ask(schema.Hello())
        self._rejoin()

    def _rejoin(self) -> None:
        """Come back with each human."""
        for request in self._own.to_return(self.world):
            self._link.ask(request)

    def _answered(self, request: Request, reply: Reply) -> None:
        """Keep in mind what an answer means for later."""
        if isinstance(reply, schema.Welcome):
            self._subscribe(reply)
        elif isinstance(reply, Scene):
            self._load(reply)
        elif isinstance(reply, schema.Joined) and isinstance(request, schema.Join):
            self._ahead.begin(reply.tick)
            for reason in self._own.joined(request, reply):
                self._note(reason)
        elif isinstance(reply, schema.Done):
            self._ahead.falls(reply.ticks)
            self._own.granted(request)

    def _subscribe(self, welcome: schema.Welcome) -> None:
        """Follow the published snapshots; again where a restarted server has them on another port."""
        self.lockstep, self._ahead.alone = welcome.lockstep, welcome.alone
        if self._follow:
            self._snapshots.follow(welcome.snapshots)

    def _see(self, snapshot: Snapshot) -> None:
        self._shown = snapshot
        self.world.show(snapshot)

    def _load(self, scene: Scene) -> None:
        self.world.load(scene)
        if self._shown is not None and self._shown.revision == scene.revision:
            self.world.show(self._shown)

    def _fetch_scene(self) -> None:
        """A snapshot of another revision than the scene's: ask for the scene, once at a time."""
        if self._scene is not None and not self._scene.done:
            return
        stale = self._shown is not None and self._shown.revision != self.world.revision
        self._scene = self._link.ask(schema.GetScene()) if stale else None

    def _unasked(self, reply: Reply) -> None:
        if isinstance(reply, schema.Ticked):
            self._ahead.complete(reply.tick)
            self.world.apply(reply)
        elif isinstance(reply, schema.JoinFirst):
            self._rejoin()
        elif isinstance(reply, schema.Refused):
            self._note(reply.reason)

    def _note(self, reason: str) -> None:
        self.refusals.append(reason)
        del self.refusals[:-_MOST_REFUSALS]
