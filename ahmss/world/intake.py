"""Frames as they come in, checked and applied many at a time: each whole or not at all."""

from __future__ import annotations

import numpy as np

from ahmss.errors import ProtocolError, WorldError
from ahmss.world.frame import (
    HEADER,
    PLAIN,
    POSE_BYTES,
    ROW_BYTES,
    ROW_WIDTH,
    WAY_BYTES,
    WITH_WAY,
    faulty,
    faulty_ways,
    is_faulty_pose,
    is_faulty_row,
    is_faulty_way,
)
from ahmss.world.people import FRAME_NUMBER, PERSON_WIDTH, WAY
from ahmss.world.schema import POSE_WIDTH, WAY_WIDTH, Refused
from ahmss.world.space import Space
from ahmss.world.things import Thing

__all__ = ["Intake", "UnknownHuman"]

_MOST_STAGED = 256
_BODIES = {PLAIN: HEADER.size + POSE_BYTES, WITH_WAY: HEADER.size + POSE_BYTES + WAY_BYTES}
"""Bytes before the objects, by version."""

_NO_WAY = np.full(WAY_WIDTH, np.nan, "<f8").tobytes()


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
        self._poses = np.zeros((_MOST_STAGED, PERSON_WIDTH))
        self._bytes = self._poses.data.cast("B")
        self._stride = PERSON_WIDTH * 8
        self._staged: list[tuple[bytes, int, int]] = []
        self._moving: list[tuple[int, list[Thing], bytes]] = []
        self._tell_ways = False  # some of what is staged

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
        if len(data) < _BODIES[PLAIN]:
            raise ProtocolError(f"a frame is at least {_BODIES[PLAIN]} bytes, this is {len(data)}")
        _, version, count, number, frame = HEADER.unpack_from(data)
        body = _BODIES.get(version, 0)
        if not body or len(data) != body + count * ROW_BYTES:
            raise ProtocolError(f"a frame of version {version} with {count} objects is not {len(data)} bytes")
        person = self._space.people.by_id.get(number)
        if person is None or person.owner != owner:
            raise UnknownHuman(f"no human {number} of yours is in the world; join first")
        if frame <= person.frame:
            return
        if count:
            things = self._held(person.record.name, frame, data[body:])
            self._moving.append((len(self._staged), things, bytes(data[body:])))
        person.frame = frame
        start = len(self._staged) * self._stride
        way = start + POSE_BYTES
        if version == WITH_WAY:
            self._tell_ways = True
            self._bytes[start : way + WAY_BYTES] = data[HEADER.size : body]
        else:
            self._bytes[start:way] = data[HEADER.size : body]
            self._bytes[way : way + WAY_BYTES] = _NO_WAY
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
        refusals = [self._refuse(at) for at in bad]
        self._staged.clear()
        self._moving.clear()
        self._tell_ways = False
        return refusals

    def _write_one(self) -> list[int]:
        """Write the only staged pose, or say that it is bad."""
        pose = self._poses[0]
        if is_faulty_pose(pose[:POSE_WIDTH]) or (self._tell_ways and is_faulty_way(pose[WAY])):
            return [0]
        _, number, frame = self._staged[0]
        pose[FRAME_NUMBER] = frame
        self._space.people.poses[number][:] = pose
        return []

    def _write_all(self, count: int) -> list[int]:
        """Write the staged poses, the newest of a human last; which of them are bad."""
        poses = self._poses[:count]
        bad = faulty(poses[:, :3], poses[:, 3:POSE_WIDTH].reshape(count, -1, 4))
        if self._tell_ways:
            bad |= faulty_ways(poses[:, WAY])
        poses[:, FRAME_NUMBER] = [frame for _, _, frame in self._staged]
        table = self._space.people.poses
        rows = np.array([table.rows[number] for _, number, _ in self._staged])
        good = np.flatnonzero(~bad)
        table.data[rows[good]] = poses[good]
        return [] if len(good) == count else np.flatnonzero(bad).tolist()

    def _held(self, human: str, frame: int, data: bytes | memoryview) -> list[Thing]:
        """The objects that the rows of a frame move: all must be held by its human and have poses."""
        known = self._space.things.by_id
        things: list[Thing] = []
        for row in np.frombuffer(data, "<f8").reshape(-1, ROW_WIDTH).tolist():
            thing = known.get(row[0])
            if thing is None:
                raise WorldError(f"frame {frame} of {human} was refused whole: no object {row[0]:g} is in the world")
            if thing.holder != human:
                raise WorldError(f"frame {frame} of {human} was refused whole: it does not hold {thing.name}")
            if is_faulty_row(row):
                raise WorldError(f"frame {frame} of {human} was refused whole: {thing.name} has no place or rotation")
            things.append(thing)
        return things

    def _refuse(self, at: int) -> tuple[bytes, Refused]:
        owner, number, frame = self._staged[at]
        reason = f"frame {frame} was refused whole: a place is not finite or too far, or a rotation is not unit"
        if is_faulty_way(self._poses[at, WAY]):
            reason = f"frame {frame} was refused whole: its way is not finite or too far; NaN in all of it is not known"
        return owner, Refused(0, reason, number, frame)
