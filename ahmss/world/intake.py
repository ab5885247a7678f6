"""Frames as they come in, checked and applied many at a time: each whole or not at all."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ahmss.errors import ProtocolError, WorldError
from ahmss.world.frame import FRAME_VERSION, HEADER, POSE_BYTES, ROW_BYTES, ROW_WIDTH, faulty
from ahmss.world.schema import POSE_WIDTH, Refused
from ahmss.world.space import Space
from ahmss.world.things import Thing

__all__ = ["Intake", "UnknownHuman"]

_MOST_STAGED = 256
_BODY = HEADER.size + POSE_BYTES


class UnknownHuman(WorldError):
    """A frame of a human that its sender has not joined."""


class Intake:
    """Takes frames of all humans and writes their poses into the space.

    `take` checks what one message alone can be checked for; poses are checked together in `flush`, which must be
    called before anything else reads or changes the space.

    Attributes:
        frames: id and owner of the humans that were moved since the caller last cleared it.
    """

    def __init__(self, space: Space) -> None:
        self.frames: dict[int, bytes] = {}
        self._space = space
        self._poses = np.zeros((_MOST_STAGED, POSE_WIDTH + 1))
        self._bytes = self._poses.data.cast("B")
        self._stride = (POSE_WIDTH + 1) * 8
        self._staged: list[tuple[bytes, int, int]] = []
        self._moving: list[tuple[int, list[Thing], bytes]] = []

    @property
    def is_full(self) -> bool:
        """Whether `flush` must be called before the next `take`."""
        return len(self._staged) >= _MOST_STAGED

    def take(self, owner: bytes, data: bytes) -> None:
        """Stage one frame.

        Raises:
            ProtocolError: the bytes are no frame.
            UnknownHuman: the sender must join first.
            WorldError: it moves an object that its human does not hold.
        """
        if len(data) < _BODY:
            raise ProtocolError(f"a frame is at least {_BODY} bytes, this is {len(data)}")
        _, version, count, number, frame = HEADER.unpack_from(data)
        if version != FRAME_VERSION or len(data) != _BODY + count * ROW_BYTES:
            raise ProtocolError(f"a frame of version {version} with {count} objects is not {len(data)} bytes")
        person = self._space.people.by_id.get(number)
        if person is None or person.owner != owner:
            raise UnknownHuman(f"no human {number} of yours is in the world; join first")
        if frame <= person.frame:
            return
        if count:
            things = self._held(person.record.name, data)
            self._moving.append((len(self._staged), things, data[_BODY:]))
        person.frame = frame
        start = len(self._staged) * self._stride
        self._bytes[start : start + POSE_BYTES] = data[HEADER.size : _BODY]
        self._staged.append((owner, number, frame))

    def flush(self) -> list[tuple[bytes, Refused]]:
        """Apply what is staged; the refusals with whom they are for."""
        count = len(self._staged)
        if not count:
            return []
        poses = self._poses[:count]
        bad: NDArray[np.bool_] = faulty(poses[:, :3], poses[:, 3:POSE_WIDTH].reshape(count, -1, 4))
        poses[:, POSE_WIDTH] = [frame for _, _, frame in self._staged]
        if self._moving:
            self._check_objects(bad)
        table = self._space.people.poses
        rows = table.rows
        if bad.any():
            good = np.flatnonzero(~bad)
            table.data[[rows[self._staged[i][1]] for i in good]] = poses[good]
        else:
            table.data[[rows[number] for _, number, _ in self._staged]] = poses
        for at, things, data in self._moving:
            if not bad[at]:
                moved = np.frombuffer(data, "<f8").reshape(-1, ROW_WIDTH)
                self._space.things.place(self._staged[at][0], things, moved[:, 1:])
        refusals = [self._refuse(*self._staged[i]) for i in np.flatnonzero(bad)]
        self.frames.update((number, owner) for owner, number, _ in self._staged)
        self._staged.clear()
        self._moving.clear()
        return refusals

    def _held(self, human: str, data: bytes) -> list[Thing]:
        """The objects that a frame moves; all must be held by its human."""
        moved = np.frombuffer(data, "<f8", offset=_BODY)[::ROW_WIDTH].tolist()
        known = self._space.things.by_id
        things = [known.get(number) for number in moved]
        for number, thing in zip(moved, things, strict=True):
            if thing is None:
                raise WorldError(f"{human} moves object {number:g}, which is not in the world")
            if thing.holder != human:
                raise WorldError(f"{human} moves {thing.name}, which it does not hold; claim it first")
        return [thing for thing in things if thing is not None]

    def _check_objects(self, bad: NDArray[np.bool_]) -> None:
        """An update with one bad object is bad as a whole."""
        for at, _, data in self._moving:
            moved = np.frombuffer(data, "<f8").reshape(-1, ROW_WIDTH)
            bad[at] |= faulty(moved[:, 1:4], moved[:, None, 4:]).any()

    @staticmethod
    def _refuse(owner: bytes, number: int, frame: int) -> tuple[bytes, Refused]:
        reason = f"frame {frame} was refused whole: a place is not finite or too far, or a rotation is not unit"
        return owner, Refused(0, reason, number, frame)
