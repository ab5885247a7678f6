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
from typing import Any, TypeVar, cast

import numpy as np
import zmq

from ahmss.body.array import Array
from ahmss.errors import ProtocolError, Unreachable, WorldError
from ahmss.world import frame as frames
from ahmss.world import schema
from ahmss.world.address import Address, parse
from ahmss.world.keys import ClientKeys
from ahmss.world.link import Link, Pending
from ahmss.world.own import Own, OwnHumans
from ahmss.world.schema import (
    CHUNK,
    HumanRecord,
    NewObject,
    ObjectPose,
    ObjectRecord,
    Reply,
    Request,
    Scene,
    Snapshot,
    StateValue,
    content_hash,
    decode_snapshot,
)
from ahmss.world.view import World

__all__ = ["WorldClient"]

_MOST_REFUSALS = 100
_SCENES = 20  # how often `refresh` asks for a scene that fits the snapshot
_BUNDLE = 8
_AHEAD = 32
_READABLE = int(zmq.POLLIN)
R = TypeVar("R")


class WorldClient:
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
        self._alone = False
        self._published = self._completed = self._calm = 0  # calm: the frame after which nothing falls
        self._unsent: list[bytes] = []
        self._snapshots: zmq.Socket[bytes] | None = None
        self._snapshot_port = 0
        self._shown: Snapshot | None = None
        self._scene: Pending | None = None
        self._skeletons: dict[str, dict[str, Any]] = {}
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
        if self._snapshots is not None:
            self._snapshots.close(0)
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
        self._published += 1
        if moved is not None and len(moved):
            self.world.place_own(moved[:, 0], moved[:, 1:])
        self._unsent.append(data)
        if not self._alone or len(self._unsent) >= _BUNDLE or self._published <= self._calm:
            self._send_frames()
        return self._link.is_up

    def poll(self) -> World:
        """Take in what has come and give the newest world."""
        self._link.pump()
        if self._snapshots is not None and cast(int, self._snapshots.getsockopt(zmq.EVENTS)) & _READABLE:
            try:
                self._see(decode_snapshot(self._snapshots.recv(zmq.NOBLOCK)))
            except ProtocolError as error:
                self._note(str(error))
        self._fetch_scene()
        return self.world

    def rest(self, seconds: float) -> None:
        """Sleep until a snapshot or a reply comes, at most `seconds`; `poll` then takes it."""
        poller = zmq.Poller()
        for socket in (self._link.socket, self._snapshots):
            if socket is not None:
                poller.register(socket, zmq.POLLIN)
        poller.poll(int(max(0.0, seconds) * 1000 + 0.5))

    def begin(self, request: Request) -> Pending:
        """Ask without waiting; `poll` or `collect` brings the answer into the Pending."""
        self._send_frames()
        return self._link.ask(request)

    def finish(self, pending: Pending, timeout: float | None = None) -> Reply:
        """Wait for what `begin` asked. Raises as the named methods do."""
        return self._link.wait(pending, self.timeout if timeout is None else timeout)

    # Lockstep

    def collect(self, behind: int = 0, timeout: float = 60.0) -> World:
        """Lockstep: wait until the world has completed all but the last `behind` published frames.

        A main alone waits for nobody: with `behind` above 0 it may be as many as 32 frames ahead of the world, but
        while something falls each frame must see the one before.

        Raises:
            Unreachable: it has not in `timeout` seconds; another main hangs, or the server is gone.
        """
        limit = time.monotonic() + timeout
        if self._alone and behind > 0 and self._published > self._calm:
            behind = _AHEAD
        else:
            self._send_frames()
        while self._published - self._completed > behind:
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

    def hello(self) -> schema.Welcome:
        """The server's present. Raises Unreachable where none answers."""
        return self._ask(schema.Hello(), schema.Welcome)

    def stats(self) -> schema.Stats:
        """How busy the server is."""
        return self._ask(schema.GetStats(), schema.Stats)

    def refresh(self) -> World:
        """Ask for the scene and the present snapshot (a viewer with `--request`; a main after `join`)."""
        self._see(self._ask(schema.GetSnapshot(), Snapshot))
        for _ in range(_SCENES):  # in lockstep the snapshot is of the last tick, the scene may be of the next
            if self.is_current:
                break
            self._ask(schema.GetScene(), Scene)
            self._see(self._ask(schema.GetSnapshot(), Snapshot))
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
        joined = self._ask(request, schema.Joined)
        assets = {key: data for key, data in zip(hashes, (record, shape, texture), strict=True) if data}
        self._own[name] = Own(request, joined.id, assets)
        return joined.id

    def leave(self, name: str, *, stay: bool = False) -> None:
        """The human leaves the world (`stay`: its body stays standing); what it holds rests where it is."""
        self._ask(schema.Leave(name, stay), schema.Done)

    def add(self, objects: Sequence[NewObject], keeper: str = "") -> list[ObjectRecord]:
        """Add objects, parents before what they contain, all or none; `keeper`: whose main follows their file."""
        return self._ask(schema.Add(list(objects), keeper=keeper), schema.Added).objects

    def remove(self, name: str, keeper: str = "") -> None:
        """Remove an object and what it carries; `keeper`: as its file says, which that human's main follows."""
        self._ask(schema.Remove(name, keeper=keeper), schema.Done)

    def move(self, poses: Sequence[ObjectPose], *, layout: bool = False, keeper: str = "") -> None:
        """Put objects elsewhere at once, all or none (`layout`: only while nobody has touched them)."""
        self._ask(schema.Move(list(poses), layout, keeper=keeper), schema.Done)

    def claim(self, human: str, objects: Sequence[str], hand: str = "") -> None:
        """The human alone moves these objects from now on, all or none; `hand`: it takes them in that hand."""
        self._ask(schema.Claim(human, list(objects), hand), schema.Done)

    def release(self, human: str, objects: Sequence[str]) -> None:
        """The human lets these objects go."""
        self._ask(schema.Release(human, list(objects)), schema.Done)

    def transfer(self, name: str, giver: str, taker: str, hand: str = "") -> None:
        """Give an object from hand to hand in one step; only the giver's main may ask."""
        self._ask(schema.Transfer(name, giver, taker, hand), schema.Done)

    def set_state(self, name: str, state: str, value: StateValue) -> None:
        """Set one state of one object."""
        self._ask(schema.SetState([schema.StateChange(name, state, value)]), schema.Done)

    def put_asset(self, data: bytes) -> str:
        """Give the server a shape, texture or skeleton record; returns its hash ("" for no bytes)."""
        if not data:
            return ""
        name, size, offset = content_hash(data), len(data), 0
        have = self._ask(schema.PutAsset(name, size, 0, b""), schema.AssetPart).offset
        while have < size:
            offset = have
            part = schema.PutAsset(name, size, offset, data[offset : offset + CHUNK])
            have = self._ask(part, schema.AssetPart).offset
            if have <= offset:
                raise WorldError(f"the server takes no more of asset {name[:12]}; try again")
        return name

    def get_asset(self, name: str) -> bytes:
        """A shape, texture or skeleton record by its hash. WorldError where the server has none of that name."""
        parts: list[bytes] = []
        have, size = 0, 1
        while have < size:
            part = self._ask(schema.GetAsset(name, have), schema.AssetPart)
            parts.append(part.data)
            size, have = part.size, have + len(part.data)
            if not part.data:
                break
        data = b"".join(parts)
        if content_hash(data) != name:
            raise WorldError(f"asset {name[:12]} came damaged from the server at {self.address}; ask again")
        return data

    def skeleton(self, human: HumanRecord) -> dict[str, Any]:
        """The skeleton record of a human (for `Skeleton.from_record`); kept after the first time."""
        if human.skeleton not in self._skeletons:
            self._skeletons[human.skeleton] = json.loads(self.get_asset(human.skeleton))
        return self._skeletons[human.skeleton]

    # How

    def _ask(self, request: Request, expected: type[R]) -> R:
        reply = self.finish(self.begin(request))
        if not isinstance(reply, expected):
            raise ProtocolError(f"world protocol: {type(request).__name__} was answered by {type(reply).__name__}")
        return reply

    def _send_frames(self) -> None:
        """Lockstep: send the frames that wait, several of a main alone in one message."""
        if not self._unsent:
            return
        data = self._unsent[0] if len(self._unsent) == 1 else frames.bundle(self._unsent)
        self._unsent.clear()
        self._link.send(data)

    def _greet(self) -> None:
        """At each new connection: who are you, and here are my humans with what they hold."""
        self._published = self._completed = self._calm = 0
        self._unsent.clear()
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
            self._published = self._completed = reply.tick
            for reason in self._own.joined(request, reply):
                self._note(reason)
        elif isinstance(reply, schema.Done):
            self._calm = max(self._calm, self._published + reply.ticks)
            self._own.granted(request)

    def _subscribe(self, welcome: schema.Welcome) -> None:
        """Follow the published snapshots; again where a restarted server has them on another port."""
        self.lockstep, self._alone = welcome.lockstep, welcome.alone
        if not self._follow or welcome.snapshots == self._snapshot_port:
            return
        if self._snapshots is not None:
            self._snapshots.close(0)
        socket = self._context.socket(zmq.SUB)
        socket.setsockopt(zmq.LINGER, 0)
        socket.setsockopt(zmq.CONFLATE, 1)
        socket.setsockopt(zmq.RECONNECT_IVL, 50)
        socket.setsockopt(zmq.RECONNECT_IVL_MAX, 1000)
        socket.setsockopt(zmq.SUBSCRIBE, b"")
        if self._keys is not None:
            self._keys.secure(socket)
        socket.connect(self.address.endpoint(welcome.snapshots))
        self._snapshots, self._snapshot_port = socket, welcome.snapshots

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
            self._completed = reply.tick
            self.world.apply(reply)
        elif isinstance(reply, schema.JoinFirst):
            self._rejoin()
        elif isinstance(reply, schema.Refused):
            self._note(reply.reason)

    def _note(self, reason: str) -> None:
        self.refusals.append(reason)
        del self.refusals[:-_MOST_REFUSALS]
