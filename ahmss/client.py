"""What a human model uses to move a human: `ahmss main --port` on the other side.

    with Client() as ken:
        for thing in ken.seen():
            print(thing.name, thing.distance, ken.afforded(thing.name))
        opened = ken.do("door", "open", frames=120)
        opened.wait()
        ken.wait_until("lamp", "light", "==", "on", timeout=5.0)

Metres, degrees (to the left), seconds, frames (60 to the second as a rule). Of names the last part is enough where that
is clear: `cup` for `room/cup`.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from types import TracebackType
from typing import TypeVar

import msgspec
import zmq

from ahmss.errors import ActionFailed, NoAnswer, PortRefused
from ahmss.port import schema
from ahmss.port.acts import act
from ahmss.port.address import address_of
from ahmss.port.schema import Act, Affordances, Event, Person, Reply, Request, Result, Self, Thing
from ahmss.world.keys import read_client
from ahmss.world.schema import StateValue

__all__ = ["Act", "Affordances", "Client", "Event", "Handle", "Person", "Result", "Self", "Thing", "act"]

_LONGEST_MS = 3_600_000
_SLICE = 1.0  # seconds that one question waits; other threads may ask in between
_OVER = ("done", "failed", "cancelled")
R = TypeVar("R")


class Client:
    """A connection to one main, which moves one human. Usable from several threads, and as a context manager.

    Args:
        address: `PORT`, `HOST` or `HOST:PORT` of the main's port; nothing is the usual one of this machine.
        keys: the directory with client.key and server.pub, for a main on another machine.
        timeout: seconds within which a main answers.

    Raises:
        NoAnswer: from the first question, where no main answers.
    """

    def __init__(self, address: str = "", *, keys: Path | None = None, timeout: float = 5.0) -> None:
        self.address, self.timeout = address_of(address), timeout
        self._lock = threading.Lock()
        self._number = 0
        self._keys = None if keys is None else read_client(keys)
        self._context: zmq.Context[zmq.Socket[bytes]] = zmq.Context()
        self._socket = self._connect()

    def __enter__(self) -> Client:
        """The client itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Close."""
        self.close()

    def close(self) -> None:
        """Close the connection; what was accepted goes on."""
        self._socket.close(0)
        self._context.term()

    # What is

    def me(self) -> Self:
        """The human: name, place, heading, eyes, what it holds, what it does."""
        return self._ask(schema.GetSelf(), schema.Self)

    def objects(self) -> list[Thing]:
        """All objects, each with its sentence, place (metres), distance, direction, states and holder."""
        return [thing for page in self._pages(seen=False) for thing in page.objects]

    def seen(self) -> list[Thing]:
        """What the human sees now: within 60 degrees of its line of sight, and hidden by no other object."""
        return [thing for page in self._pages(seen=True) for thing in page.objects]

    def humans(self) -> list[Person]:
        """The other humans, each with its place (metres), heading, distance and direction."""
        return self._ask(schema.GetObjects(), schema.Objects).humans

    def object(self, name: str) -> Thing:
        """One object. PortRefused: there is none of that name; says which are meant."""
        if not name:  # asked for by no name are all
            raise PortRefused('no object ""; `objects` tells which there are')
        return self._ask(schema.GetObjects(name), schema.Objects).objects[0]

    def state(self, name: str) -> dict[str, StateValue]:
        """The states of an object, by their names."""
        return self.object(name).states

    def afforded(self, name: str) -> Affordances:
        """What an object affords this human: `now`, and `later` with the reason why not now.

        `parameters` are an action's own; every action takes `patience` besides, seconds to wait for what another has.
        """
        return self._ask(schema.GetAffordances(name), schema.Affordances)

    # What is to be done

    def do(
        self, object: str | Sequence[float], action: str, *, to: str | Sequence[float] = (),  # noqa: A002
        facing_deg: float | None = None, hand: str = "", pose: str = "", frames: int | None = None,
        parameters: Mapping[str, str | float] | None = None,
    ) -> Handle:  # fmt: skip
        """Make one motion, once those before are done.

        Args:
            object: its name, or the place x, y[, z] where it is, metres; a text as "0.2 -0.9" is one, too.
            action: one of those that it affords.
            to: the goal, likewise: x, y[, z] in metres or another object's name.
            facing_deg: where to face at the goal, degrees about z from +x.
            hand: "left" or "right"; left out: the nearer free one.
            pose: a clip whose last frame is the goal's posture.
            frames: how long; left out: as the action has it.
            parameters: of its algorithms, by name.

        Returns:
            A handle at once; the motion begins with the next frame.

        Raises:
            PortRefused: it can't be done; its sentence says what can.
        """
        return self.together(act(
            object, action, to=to, facing_deg=facing_deg, hand=hand, pose=pose, frames=frames, parameters=parameters
        ))  # fmt: skip

    def together(self, *acts: Act) -> Handle:
        """Make motions together (fused), each `after` its frames; one that `follows` begins after the one before it."""
        return self._do(schema.Do(list(acts)))

    def do_line(self, line: str) -> Handle:
        """Carry out a `do` line of the grammar: `do floor walk to cup with cup reach then cup grasp`."""
        return self._do(schema.Do(line=line))

    def stop(self) -> None:
        """Give up everything that this human does or is to do; what it holds stays in its hand."""
        self._ask(schema.Stop(), schema.Done)

    def pause(self, seconds: float) -> None:
        """Let seconds of the world pass; frames are counted, not the clock here."""
        end = self.me()
        frames = end.frame + round(seconds * end.rate)
        while (left := (frames - self.me().frame) / end.rate) > 0.0:
            time.sleep(min(left, _SLICE))

    # What comes of it

    def wait_until(
        self, name: str, state: str, operator: str, value: StateValue, *, timeout: float = 60.0
    ) -> StateValue:
        """Wait until an object's state compares so with a value, at most `timeout` seconds; the state then.

        Raises:
            PortRefused: no such object, state or operator, or a value that the state never has.
            TimeoutError: it does not compare so; says what the state is.
        """
        end = time.monotonic() + timeout
        while True:
            seconds = max(0.0, min(_SLICE, end - time.monotonic()))
            found = self._ask(schema.WaitState(name, state, operator, value, seconds), schema.Compared, seconds)
            if found.holds:
                return found.value
            if time.monotonic() >= end:
                raise TimeoutError(
                    f"{found.object} {state} is {found.value} after {timeout:g} s, not {operator} {value}"
                )

    def events(self, since: int = 0, timeout: float = 0.0) -> tuple[list[Event], int]:
        """What happened from event `since` on, waiting at most `timeout` seconds for one; and what to ask for next."""
        end = time.monotonic() + timeout
        while True:
            seconds = max(0.0, min(_SLICE, end - time.monotonic()))
            found = self._ask(schema.GetEvents(since, seconds), schema.Events, seconds)
            if found.events or time.monotonic() >= end:
                return found.events, found.next
            since = max(since, found.next)

    def result(self, number: int, seconds: float = 0.0) -> Result:
        """What became of a line, by its number; waits at most `seconds` (0 to 60) for its end."""
        return self._ask(schema.Await(number, seconds), schema.Result, seconds)

    def cancel(self, number: int) -> Result:
        """Give up one line."""
        return self._ask(schema.Cancel(number), schema.Result)

    # How

    def _do(self, request: schema.Do) -> Handle:
        accepted = self._ask(request, schema.Accepted)
        return Handle(self, accepted.number, accepted.line)

    def _pages(self, *, seen: bool) -> Iterator[schema.Objects]:
        page = self._ask(schema.GetObjects(seen=seen), schema.Objects)
        yield page
        while page.next:
            page = self._ask(schema.GetObjects(seen=seen, skip=page.next), schema.Objects)
            yield page

    def _ask(self, request: Request, expected: type[R], seconds: float = 0.0) -> R:
        """Ask and wait for the answer, `seconds` longer than `timeout`."""
        with self._lock:
            reply = self._exchange(request, self.timeout + seconds)
        if isinstance(reply, schema.Refused):
            raise PortRefused(reply.reason)
        if not isinstance(reply, expected):
            raise PortRefused(f"the main at {self.address} answered {type(request).__name__} by {type(reply).__name__}")
        return reply

    def _exchange(self, request: Request, timeout: float) -> Reply:
        self._number += 1
        number = self._number
        data = schema.encode(msgspec.structs.replace(request, request=number))
        if len(data) > schema.LARGEST:
            raise PortRefused(f"a request of {len(data)} bytes is too long; allowed are {schema.LARGEST}: ask for less")
        try:
            self._socket.send(data, zmq.NOBLOCK)
        except zmq.Again:
            raise self._nobody() from None
        end = time.monotonic() + timeout
        while (left := end - time.monotonic()) > 0.0:
            if not self._socket.poll(min(int(left * 1000) + 1, _LONGEST_MS)):
                break
            reply = schema.decode_reply(self._socket.recv())
            if reply.request in (number, 0):  # a late answer to a question that was given up is passed over
                return reply
        raise self._nobody()

    def _nobody(self) -> NoAnswer:
        """Nobody answers: what is under way is given up, so that it does not come when somebody is there again."""
        self._socket.close(0)
        self._socket = self._connect()
        return NoAnswer(
            f"no main answers at {self.address}; start one with `ahmss up --port {self.address.port}`, "
            "or check the address and the keys"
        )

    def _connect(self) -> zmq.Socket[bytes]:
        socket = self._context.socket(zmq.DEALER)
        socket.setsockopt(zmq.LINGER, 0)
        socket.setsockopt(zmq.IPV6, int(":" in self.address.host))
        if self._keys is not None:
            self._keys.secure(socket)
        socket.connect(self.address.endpoint())
        return socket


class Handle:
    """A line that was accepted.

    Attributes:
        number: of the line. line: how it was understood.
    """

    def __init__(self, client: Client, number: int, line: str) -> None:
        self._client = client
        self.number, self.line = number, line
        self._last: Result | None = None

    @property
    def progress(self) -> Result:
        """How far it is: `status`, `frames` since it began, `parts` with the frame of each motion."""
        return self._look(0.0)

    @property
    def result(self) -> Result | None:
        """What became of it, once it is over; None before."""
        found = self._look(0.0)
        return found if found.status in _OVER else None

    def wait(self, timeout: float = 600.0, *, check: bool = True) -> Result:
        """Wait until it is over, at most `timeout` seconds.

        Raises:
            ActionFailed: it failed or was cancelled, with the reason; not with `check=False`.
            TimeoutError: it goes on.
        """
        end = time.monotonic() + timeout
        while True:
            found = self._look(max(0.0, min(_SLICE, end - time.monotonic())))
            if found.status in _OVER:
                break
            if time.monotonic() >= end:
                raise TimeoutError(f"{self.line}: still {found.status} after {timeout:g} s")
        if check and found.status != "done":
            raise ActionFailed(f"{self.line}: {found.reason or found.status}")
        return found

    def cancel(self) -> Result:
        """Give it up: its motions stop with the next frame, or it never begins."""
        self._last = self._client.cancel(self.number)
        return self._last

    def _look(self, seconds: float) -> Result:
        if self._last is None or self._last.status not in _OVER:
            self._last = self._client.result(self.number, seconds)
        return self._last
