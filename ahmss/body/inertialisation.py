"""Inertialisation: where the source of a motion changes, what differs from the present decays smoothly.

The body carries on with the velocity that it has; the difference to the new source, and the difference in velocity, go
to zero along a quintic with no jump in acceleration (after Bollo, "Inertialization", GDC 2018). So nobody returns to
upright in between, and two motions need never be kept at once.
"""

from __future__ import annotations

from abc import ABC, abstractmethod

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, from_rotation_vector, multiply

__all__ = ["FARTHER", "Channel", "Inertialiser", "Places", "Rotations"]

FARTHER = 0.4
"""Of the frames of a stop at the present velocity, how many it goes on: less and less fast, and never back."""

_SECONDS = 0.4  # how long a difference takes to decay
_FASTEST = np.radians(318.0)  # a second, that a joint's difference decays at the most: 5.3 degrees in a frame at 60 Hz
_STEEPEST = 1.875  # of the quintic of an offset, as a share of the offset over its time
_DAMPING = 0.7  # of the velocity, a frame, where sources change so fast that the body carries on by itself for longer

Rows = NDArray[np.bool_]
Frames = NDArray[np.int_] | int


class Channel(ABC):
    """Rows of one kind of value, each smoothed across the changes of its own source; `present` came out last.

    At a row's change the output carries on for one frame with the present velocity, because the new source's velocity
    is known only with its second frame; from then on it is the source with a decaying offset.
    """

    _leap = np.inf  # metres or radians by which a source moves in a frame at the most: what is more is no velocity

    def __init__(
        self, rows: int, rate: float, seconds: float = _SECONDS, fastest: float = np.inf, stop: float = 0.0
    ) -> None:
        """Smooth some rows at a rate (frames a second) over some seconds, or longer.

        Args:
            rows: how many. rate: frames a second. seconds: in which a difference decays.
            fastest: metres or radians a second by which an offset decays at the most; a larger one takes longer.
            stop: seconds in which a velocity that differs comes to rest, what it goes on until then being an offset
                like another; 0: it decays as long as the offset, and goes back at up to half its speed.
        """
        self._stop = max(int(np.ceil(stop * rate)), 2) if stop else 0
        self._frames = max(int(np.ceil(seconds * rate)), 2)
        self._fastest = fastest / rate
        self._decays = np.full(rows, self._frames)  # frames that the row's difference takes
        self._frame = self._decays.copy()  # frames since the row's change; 0 waits for the second one
        self._active = False
        self.present: Array | None = None
        self._before: Array | None = None
        self._waiting: tuple[Array, Array, Array] | None = None  # source, output, output carried on once more
        self._offset, self._speed = np.zeros((rows, 3)), np.zeros((rows, 3))

    @property
    def settled(self) -> bool:
        """Whether nothing decays."""
        return not self._active

    def place(self, values: Array) -> None:
        """Stand still at these values, as after a jump that is meant."""
        self.present, self._before = values, None
        self._frame[:] = self._decays
        self._active = False

    def settle(self, values: Array) -> None:
        """Tell what this frame came out as in the end: the next present. Not copied, so not to be changed after."""
        self._before, self.present = self.present, values

    def step(self, source: Array, switched: Rows) -> Array:
        """The smoothed values of this frame; the source itself while nothing decays.

        Args:
            source: (rows, 3 or 4) this frame's values.
            switched: (rows,) whose source is another one from this frame on.
        """
        if self.present is None:
            self.place(source)
        if switched.any():
            self._active = True
        elif not self._active:
            return source
        self._frame += 1
        np.minimum(self._frame, self._decays, out=self._frame)
        if self._waiting is not None:
            self._learn(source)
        if switched.any():
            self._decays = np.where(switched, self._frames, self._decays)
            return self._carry_on(source, switched)
        self._active = bool((self._frame < self._decays).any())
        return self._with_offset(source)

    def _carry_on(self, source: Array, switched: Rows) -> Array:
        assert self.present is not None
        before = self.present if self._before is None else self._before
        again = (self._frame == 1)[:, None]
        velocity = np.where(again, _DAMPING, 1.0) * self._difference(before, self.present)
        output = self._add(self.present, velocity)
        self._waiting = (source, output, self._add(output, velocity))
        self._frame[switched] = 0
        return np.where(switched[:, None], output, self._with_offset(source))

    def _learn(self, source: Array) -> None:
        """With the second frame of the source, the first offset and its velocity (a frame) are known."""
        assert self._waiting is not None
        first, output, following = self._waiting
        chosen = self._frame == 1
        offset, next_offset = self._two_differences((first, output), (source, following))
        # A source whose first frame was but the pose as it was, while it thought, goes on from the second one.
        leaps = (np.linalg.norm(next_offset - offset, axis=-1) > self._leap)[:, None]
        going = self._difference(output, following)
        self._speed[chosen] = np.where(leaps, going, next_offset - offset)[chosen]
        offset = np.where(leaps, next_offset - going, offset)
        self._offset[chosen] = offset[chosen] + FARTHER * self._stop * self._speed[chosen]
        self._waiting = None
        if self._fastest < np.inf:
            needed = np.ceil(_STEEPEST * np.linalg.norm(self._offset[chosen], axis=-1) / self._fastest)
            self._decays[chosen] = np.maximum(needed, self._decays[chosen]).astype(int)

    def _with_offset(self, source: Array) -> Array:
        left, carried = _curves(self._frame, self._decays)
        if self._stop:
            to_go, carried = _curves(np.minimum(self._frame, self._stop), self._stop)
            carried = carried - FARTHER * self._stop * to_go
        return self._add(source, left[:, None] * self._offset + carried[:, None] * self._speed)

    @abstractmethod
    def _difference(self, a: Array, b: Array) -> Array:
        """What leads from a to b: (rows, 3)."""

    @abstractmethod
    def _two_differences(self, first: tuple[Array, Array], second: tuple[Array, Array]) -> tuple[Array, Array]:
        """The differences of two pairs that follow each other, without a jump between them."""

    @abstractmethod
    def _add(self, a: Array, difference: Array) -> Array:
        """The value that a difference (rows, 3) from a leads to."""


class Places(Channel):
    """Rows of places (rows, 3), metres."""

    def _difference(self, a: Array, b: Array) -> Array:
        return b - a

    def _two_differences(self, first: tuple[Array, Array], second: tuple[Array, Array]) -> tuple[Array, Array]:
        return first[1] - first[0], second[1] - second[0]

    def _add(self, a: Array, difference: Array) -> Array:
        return a + difference


class Rotations(Channel):
    """Rows of unit quaternions (rows, 4); differences are rotation vectors in the rotated frame, radians."""

    _leap = np.radians(20.0)

    def _difference(self, a: Array, b: Array) -> Array:
        return _logarithm(_short(multiply(conjugate(a), b)))

    def _two_differences(self, first: tuple[Array, Array], second: tuple[Array, Array]) -> tuple[Array, Array]:
        q1 = _short(multiply(conjugate(first[0]), first[1]))
        q2 = multiply(conjugate(second[0]), second[1])
        same_side = np.einsum("ni,ni->n", q1, q2) >= 0.0
        return _logarithm(q1), _logarithm(np.where(same_side[:, None], q2, -q2))

    def _add(self, a: Array, difference: Array) -> Array:
        return multiply(a, from_rotation_vector(difference))


class Inertialiser:
    """Smooths one human's pose: 43 rotations and the root, each across the changes of its own source.

    Each frame: `step` the blended pose, solve the targets, `settle` what came out. While nothing decays `step` gives
    back what it gets. At a change the blend's own previous rotations should be what came out too, so that joints that
    nobody drives stay where they are seen.
    """

    def __init__(self, rate: float, seconds: float = _SECONDS, joints: int = 43) -> None:
        """Smooth at a rate (frames a second) over some seconds, a joint that has far to turn for longer."""
        self.rotations = Rotations(joints, rate, seconds, _FASTEST)
        self.root = Places(1, rate, seconds)

    @property
    def settled(self) -> bool:
        """Whether nothing decays."""
        return self.rotations.settled and self.root.settled

    def place(self, rotations: Array, root: Array) -> None:
        """Stand still in a pose, rotations (43, 4) and root (3,): at the start, or after a jump that is meant."""
        self.rotations.place(rotations)
        self.root.place(root[None])

    def step(self, rotations: Array, root: Array, switched: Rows, root_switched: bool) -> tuple[Array, Array]:
        """The smoothed rotations (43, 4) and root (3,) of this frame.

        Args:
            rotations: (43, 4) blended, parent <- child.
            root: (3,) blended, metres.
            switched: (43,) joints whose source is another one from this frame on: a new owner, or the owner gone.
            root_switched: the same for the root.
        """
        return (
            self.rotations.step(rotations, switched),
            self.root.step(root[None], _SWITCHED if root_switched else _UNSWITCHED)[0],
        )

    def settle(self, rotations: Array, root: Array) -> None:
        """Tell the pose that came out in the end, targets solved: the next present. Not to be changed after."""
        self.rotations.settle(rotations)
        self.root.settle(root[None])


_SWITCHED, _UNSWITCHED = np.ones(1, bool), np.zeros(1, bool)


def _curves(frame: NDArray[np.int_], frames: Frames) -> tuple[Array, Array]:
    """So many frames (rows,) after a change: what is left of an offset, and frames of a velocity that it was carried.

    Both are quintics of no acceleration at the start and at rest at the end, after `frames` (rows,) or for all rows.
    """
    t = frame / frames
    return (1.0 - t) ** 3 * (1.0 + 3.0 * t + 6.0 * t**2), frames * t * (1.0 - t) ** 3 * (1.0 + 3.0 * t)


def _short(q: Array) -> Array:
    """q or -q, whichever turns by less than half a turn."""
    return np.where(q[:, :1] < 0.0, -q, q)


def _logarithm(q: Array) -> Array:
    """The rotation vectors (rows, 3) of q as it stands: up to a whole turn, so that no half turn is a jump."""
    sine = np.sqrt(np.einsum("ni,ni->n", q[:, 1:], q[:, 1:]))
    small = sine < 1e-12
    scale = np.where(small, 2.0, 2.0 * np.arctan2(sine, q[:, 0]) / np.where(small, 1.0, sine))
    return scale[:, None] * q[:, 1:]
