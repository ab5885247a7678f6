"""What control keeps of each motion being made and of each object being moved."""

from __future__ import annotations

from collections import deque
from typing import NamedTuple

import numpy as np

from ahmss.algorithm.messages import Meant
from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import conjugate, multiply, rotate
from ahmss.main.afforded import Actor
from ahmss.main.blending import Contribution
from ahmss.main.order import Order
from ahmss.main.passing import GIVE, RECEIVE
from ahmss.main.surroundings import NOTHING, known, latest
from ahmss.processes.process import AlgorithmProcess
from ahmss.world.link import Pending

__all__ = ["Motion", "Mover", "Shown"]

_MOVED = 1e-3  # metres from which on an object counts as moved
_MOST = 600  # frames that wait to be shown to an algorithm that is late
_SIDES = ("right", "left")
_LEGS = [f"{side}_{link}" for side in _SIDES for link in ("upper_leg", "lower_leg", "foot")]
_BODY = np.array(
    [*(176 + INDEX[name] for name in ("hips", *_LEGS)), 219, 243, 251]
)  # importances, foot targets' weights


class Shown(NamedTuple):
    """What an object algorithm is shown of a frame: the human (190,), the palms (2, 7), what moved, rows (n, 8).

    closed: whether the hand that takes the object has closed by then.
    """

    human: Array
    grips: Array
    moved: Array
    closed: bool = False


class Mover:
    """An object that this human moves by an object algorithm.

    Attributes:
        name, id: of the object. pose: (7,) where it is now.
        caught: it is in the hand and goes where the hand goes, whatever its algorithm does.
        process: its algorithm, once the claim is granted; None before, and after the algorithm has failed.
        claim: the request under way. actor: the human before the first of `frames`.
        knows: ids of what its algorithm is told of when it moves.
        frames: those that its algorithm is still to be shown, while it is late with another or waits for its claim.
        over: its algorithm was stopped, it rests where it is. fresh: its pose differs from what the world was told.
        given: it comes from another hand, or has come back from it.
        closed: the hand that takes it has closed. told: its algorithm knows that.
    """

    def __init__(self, order: Order, number: int, pose: Array, claim: Pending | None, actor: Actor) -> None:
        self.order, self.actor = order, actor
        self.name, self.id = order.object, number
        self.pose = pose.copy()
        self.claim = claim
        self.granted = False
        self.process: AlgorithmProcess | None = None
        self.knows = known(())
        self.frames: deque[Shown] = deque()
        self.k = 0
        self.over = False
        self.fresh = False
        self.given = False
        self.closed = self.told = False
        self._start = pose[:3].copy()
        self._hand = _SIDES.index(order.hand) if order.hand in _SIDES else -1
        self._grips: Array | None = None  # for which its pose holds
        self._asked: Array | None = None  # those of the frame that its algorithm works at

    @property
    def behind(self) -> bool:
        """Whether its algorithm has still to answer what it was shown, or is to be shown."""
        process = self.process
        return process is not None and process.active and bool(process.pending or self.frames)

    @property
    def awaited(self) -> bool:
        """Whether it is behind, and is still to be waited for in this frame."""
        return self.behind and self.process is not None and not self.process.overdue

    @property
    def watches(self) -> bool:
        """Whether its algorithm is to see what the human does now; it will, where its claim is still to be granted."""
        if self.process is None:
            return self.claim is not None and not self.given
        return self.process.active

    @property
    def takes(self) -> bool:
        """Whether its algorithm goes on after the motion, until it is released."""
        return self.order.affordance.hold in ("take", RECEIVE)

    @property
    def awaits(self) -> bool:
        """Whether it is still in the hand of who gives it."""
        return self.order.affordance.hold == RECEIVE and not self.granted and self.claim is None

    @property
    def caught(self) -> bool:
        """Whether it is in the hand: it has left its place, or came from another hand."""
        if self.given:
            return self.granted
        return self.takes and bool(np.abs(self.pose[:3] - self._start).max() > _MOVED)

    @property
    def borne(self) -> bool:
        """Whether it is taken in no hand, and bears the body: a chair that is sat on."""
        return self.takes and not self.order.hand and self.closed

    def show(self, frame: Shown) -> None:
        """A new frame of the human, to be shown when its algorithm has answered those before, for a part is led there.

        What is caught goes with the hand in between; of that only the newest frame is wanted.
        """
        if self.frames and (self.caught or len(self.frames) >= _MOST):
            frame = frame._replace(moved=latest(self.frames.pop().moved, frame.moved))
        self.frames.append(frame)

    def next(self) -> Shown:
        """The frame that its algorithm is shown now."""
        frame = self.frames.popleft()
        self.k, self._asked = self.k + 1, frame.grips
        return frame

    def tells(self, frame: Shown) -> bool:
        """Whether its algorithm is told now, before it sees this frame, that the hand has closed: once, if it asks."""
        entry = self.order.object_algorithm
        news = frame.closed and not self.told and self.takes and entry is not None and entry.catches
        self.told = self.told or news
        return news

    def put(self, pose: Array) -> None:
        """Its algorithm has put it somewhere at the frame that it was shown last."""
        self.fresh = self.fresh or bool((pose != self.pose).any())
        self.pose, self._grips = pose, self._asked

    def stay(self, grips: Array) -> None:
        """The palms are at `grips` (2, 7): without an answer to that, what is caught keeps its place in the hand."""
        if self._grips is grips:
            return
        if self.caught and self._grips is not None and not self.over:
            self.pose = _carry(self.pose, self._grips[self._side()], grips[self._side()])
            self.fresh = True
        self._grips = grips

    def _side(self) -> int:
        """The row of the hand that holds it: as it was said, or the nearer one."""
        if self._hand < 0 and self._grips is not None:
            self._hand = int(np.argmin(np.linalg.norm(self._grips[:, :3] - self.pose[:3], axis=1)))
        return self._hand


def _carry(pose: Array, before: Array, now: Array) -> Array:
    """The pose (7,) of what is fixed to a frame that went from `before` to `now` (7,)."""
    back = conjugate(before[3:])
    inner = rotate(back, pose[:3] - before[:3])
    turn = multiply(back, pose[3:])
    return np.concatenate([now[:3] + rotate(now[3:], inner), multiply(now[3:], turn)])


class Motion:
    """One order being carried out.

    Attributes:
        number: tells motions apart in the blend. countdown: frames until it starts, once what it `follows` is over.
        process: its human algorithm. given: what it gives to the blend, once its first frame has come.
        knows: ids of what its algorithm is told of when it moves. missed: of these, what moved while it was not asked.
        passes: the answer awaited while what is in the hand changes hands, or how many frames one has waited for it.
        company: the humans that it is about. beside: those near, of whose arms it is told.
        carried: another motion carries the body, and this one's hips and legs do not count.
        k: the frame that was asked for last. over: it ends with this frame.
        closing: it would be over, but the algorithm of what it moves is late. held: how many frames came too late.
        arrived: it has come to where it acts. meant: what it is to bring about, as it said.
        met: how what it is about was as it began. waited: for how many frames another has had that.
        rests: for how many more it may come to rest.
    """

    def __init__(self, order: Order, number: int, follows: Motion | None = None) -> None:
        self.order, self.number, self.follows = order, number, follows
        self.countdown = order.after
        self.process: AlgorithmProcess | None = None
        self.given: Contribution | None = None
        self.mover: Mover | None = None
        self.knows, self.missed = known(()), NOTHING
        self.meant: Meant | None = None
        self.company: tuple[str, ...] = ()
        self.beside: tuple[str, ...] = ()
        self.passes: Pending | int | None = None
        self.met: tuple[object, ...] = ()
        self.arrived = False
        self.k = 0
        self.carried = False
        self.over = self.closing = False
        self.failed = False
        self.rests: int | None = None
        self.held = self.waited = 0

    @property
    def carries(self) -> bool:
        """Whether it takes the body elsewhere."""
        return self.order.human_algorithm.carries

    @property
    def comes(self) -> bool:
        """Whether it is still to come to where it acts."""
        return self.order.human_algorithm.arrives and not self.arrived

    @property
    def can_rest(self) -> bool:
        """Whether it comes to rest where it is to be given up now."""
        return (self.order.human_algorithm.rests or self.order.human_algorithm.arrives) and not self.arrived

    @property
    def accompanies(self) -> bool:
        """Whether it lasts as long as the others that are made with it."""
        return self.order.human_algorithm.accompanies and not self.order.frames

    @property
    def lets_go(self) -> bool:
        """Whether what it moves is free when it is over."""
        return self.mover is not None and (self.order.affordance.hold == "release" or not self.mover.takes)

    @property
    def last(self) -> int:
        """Its last frame; 0 where its algorithm says itself when it is over."""
        return 0 if self.order.wish else self.order.frames

    @property
    def asked_all(self) -> bool:
        """Whether it was asked for its last frame."""
        return 0 < self.last <= self.k

    def keeps(self, name: str) -> bool:
        """Whether it is made with that object in the hand."""
        return self.order.object == name and self.order.affordance.hold in ("keep", GIVE)

    def begin_anew(self, countdown: int = 0) -> None:
        """Start it again from how the body is, so many frames later."""
        if self.process is not None:
            self.process.stop()
        self.process = self.mover = self.given = self.meant = None
        self.k, self.countdown = 0, countdown

    def take(self, row: Array) -> None:
        """Its next frame has come."""
        if self.carried:
            row[_BODY] = 0.0
        if self.given is None:
            self.given = Contribution(self.number, row)
        else:
            self.given.advance(row)
