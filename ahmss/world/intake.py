"""Frames as they come in, checked and applied many at a time: each whole or not at all."""

from __future__ import annotations

import numpy as np

from ahmss.errors import ProtocolError, WorldError
from ahmss.world.frame import (
    FRAME_VERSION,
    HEADER,
    POSE_BYTES,
    ROW_BYTES,
    ROW_WIDTH,
    faulty,
    is_faulty_pose,
    is_faulty_row,
)
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
        frames: id and owner of the humans of whom frames came since the caller last cleared it.
        taken: how many frames have come.
    """

    def __init__(self, space: Space) -> None:
        self.frames: dict[int, bytes] = {}
        self.taken = 0
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

    def take(self, owner: bytes, data: bytes | memoryview) -> None:
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
            things = self._held(person.record.name, frame, data)
            self._moving.append((len(self._staged), things, bytes(data[_BODY:])))
        person.frame = frame
        start = len(self._staged) * self._stride
        self._bytes[start : start + POSE_BYTES] = data[HEADER.size : _BODY]
        self._staged.append((owner, number, frame))
        self.frames[number] = owner
        self.taken += 1

    def flush(self) -> list[tuple[bytes, Refused]]:
        """Apply what is staged; the refusals with whom they are for."""
        count = len(self._staged)
        if not count:
            return []
        bad = self._write_one() if count == 1 else self._write_all(count)
        for at, things, data in self._moving:
            if at not in bad:
                moved = np.frombuffer(data, "<f8").reshape(-1, ROW_WIDTH)
                self._space.things.place(self._staged[at][0], things, moved[:, 1:])
        refusals = [self._refuse(*self._staged[at]) for at in bad]
        self._staged.clear()
        self._moving.clear()
        return refusals

    def _write_one(self) -> list[int]:
        """Write the only staged pose, or say that it is bad."""
        pose = self._poses[0]
        if is_faulty_pose(pose[:POSE_WIDTH]):
            return [0]
        _, number, frame = self._staged[0]
        pose[POSE_WIDTH] = frame
        self._space.people.poses[number][:] = pose
        return []

    def _write_all(self, count: int) -> list[int]:
        """Write the staged poses, the newest of a human last; which of them are bad."""
        poses = self._poses[:count]
        bad = faulty(poses[:, :3], poses[:, 3:POSE_WIDTH].reshape(count, -1, 4))
        poses[:, POSE_WIDTH] = [frame for _, _, frame in self._staged]
        table = self._space.people.poses
        rows = np.array([table.rows[number] for _, number, _ in self._staged])
        good = np.flatnonzero(~bad)
        table.data[rows[good]] = poses[good]
        return [] if len(good) == count else np.flatnonzero(bad).tolist()

    def _held(self, human: str, frame: int, data: bytes | memoryview) -> list[Thing]:
        """The objects that a frame moves: all must be held by its human and have poses."""
        known = self._space.things.by_id
        things: list[Thing] = []
        for row in np.frombuffer(data, "<f8", offset=_BODY).reshape(-1, ROW_WIDTH).tolist():
            thing = known.get(row[0])
            if thing is None:
                raise WorldError(f"frame {frame} of {human} was refused whole: no object {row[0]:g} is in the world")
            if thing.holder != human:
                raise WorldError(f"frame {frame} of {human} was refused whole: it does not hold {thing.name}")
            if is_faulty_row(row):
                raise WorldError(f"frame {frame} of {human} was refused whole: {thing.name} has no place or rotation")
            things.append(thing)
        return things

    @staticmethod
    def _refuse(owner: bytes, number: int, frame: int) -> tuple[bytes, Refused]:
        reason = f"frame {frame} was refused whole: a place is not finite or too far, or a rotation is not unit"
        return owner, Refused(0, reason, number, frame)
