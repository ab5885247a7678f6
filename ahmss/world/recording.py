"""A recording: every tick of the world with the scenes and the assets they need, in one file that stands alone.

The file begins with `AHMSSREC` and a version (u32). Records follow: length u32, kind u8, CRC-32 of the payload u32,
payload. A snapshot is one published by the server, its time being tick / rate, so that nothing of the clock on the wall
is in it. An asset comes before the first scene that names it. A file that was cut off is read up to its last whole
record.
"""

from __future__ import annotations

import json
import mmap
import struct
import zlib
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Any

import msgspec

from ahmss.errors import DataError
from ahmss.world.schema import HumanRecord, Scene, Snapshot, content_hash
from ahmss.world.view import World

__all__ = ["Reader", "Writer"]

_MAGIC = b"AHMSSREC"
_VERSION = 1
_FILE_HEAD = struct.Struct("<8sI")
_RECORD_HEAD = struct.Struct("<IBI")
_ASSET, _SCENE, _SNAPSHOT = 2, 3, 4
_HASH_LENGTH = 64
_BUFFER = 1 << 18

_encode = msgspec.msgpack.Encoder().encode
_scene_decoder = msgspec.msgpack.Decoder(Scene)
_snapshot_decoder = msgspec.msgpack.Decoder(Snapshot)


class Writer:
    """Writes a recording, byte for byte the same for the same world.

    Args:
        path: of the file; an old one is replaced.
        asset: gives the bytes of a hash, or None.

    Raises:
        DataError: the file can't be begun. Later, `write` raises OSError (a full disk); what is whole stays readable.
    """

    def __init__(self, path: Path, asset: Callable[[str], bytes | None]) -> None:
        self.path = path
        self._asset = asset
        self._written: set[str] = set()
        self._revision = -1
        self._number = 0  # scenes are counted anew: who else asked the server for one must not be seen in the file
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("wb", buffering=0)
        except OSError as error:
            raise DataError(path, "", f"a recording can't be written here: {error.strerror}") from error
        self._buffer = bytearray(_FILE_HEAD.pack(_MAGIC, _VERSION))

    def write(self, snapshot: Snapshot, scene: Callable[[], Scene]) -> None:
        """Add one tick; `scene` is asked for where the snapshot's revision is a new one."""
        if snapshot.revision != self._revision:
            self._revision = snapshot.revision
            self._number += 1
            self._write_scene(msgspec.structs.replace(scene(), revision=self._number))
        self._record(_SNAPSHOT, _encode(msgspec.structs.replace(snapshot, revision=self._number)))

    def flush(self) -> None:
        """Give what is buffered to the system."""
        left = memoryview(self._buffer)
        try:
            while left:
                left = left[self._file.write(left) :]
        finally:
            left.release()
            self._buffer = bytearray()

    def close(self) -> None:
        """Finish the file."""
        try:
            self.flush()
        finally:
            self._file.close()

    def _write_scene(self, scene: Scene) -> None:
        for record in (*scene.humans, *scene.objects):
            hashes = (record.shape, record.texture, getattr(record, "skeleton", ""), getattr(record, "behaviour", ""))
            for name in hashes:
                data = self._asset(name) if name and name not in self._written else None
                if data is not None:
                    self._written.add(name)
                    self._record(_ASSET, name.encode("ascii") + data)
        self._record(_SCENE, _encode(scene))

    def _record(self, kind: int, payload: bytes) -> None:
        self._buffer += _RECORD_HEAD.pack(len(payload), kind, zlib.crc32(payload))
        self._buffer += payload
        if len(self._buffer) > _BUFFER:
            self.flush()


class Reader:
    """Reads a recording in any order; `len` is its number of ticks.

    Attributes:
        is_whole: the file ends with a whole record (else it was cut off there).

    Raises:
        DataError: no such file, or no recording.
    """

    def __init__(self, path: Path | str) -> None:
        self.path = Path(path)
        try:
            with self.path.open("rb") as file:
                head = file.read(_FILE_HEAD.size)
                if len(head) < _FILE_HEAD.size or head[:8] != _MAGIC:
                    raise DataError(path, "", "this is no recording; make one with `ahmss play SCRIPT --record FILE`")
                if _FILE_HEAD.unpack(head)[1] != _VERSION:
                    raise DataError(path, "", "this recording was made by a newer AHMSS; update this one")
                self._data = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        except OSError as error:
            raise DataError(path, "", f"the recording can't be read: {error.strerror}") from error
        self._assets: dict[str, tuple[int, int]] = {}
        self._scenes: list[tuple[int, int]] = []
        self._ticks: list[tuple[int, int, int]] = []
        self._decoded: dict[int, Scene] = {}
        self.is_whole = self._index()

    def __len__(self) -> int:
        """How many ticks there are."""
        return len(self._ticks)

    def __enter__(self) -> Reader:
        """The reader itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Close."""
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._data.close()

    @property
    def rate(self) -> float:
        """Ticks a second."""
        return self.scene(0).rate if self._ticks else 60.0

    def scene(self, tick: int) -> Scene:
        """The scene that the n-th tick (from 0) differs from."""
        number = self._ticks[tick][2]
        if number not in self._decoded:
            start, size = self._scenes[number]
            self._decoded[number] = _scene_decoder.decode(self._data[start : start + size])
        return self._decoded[number]

    def snapshot(self, tick: int) -> Snapshot:
        """The n-th tick."""
        start, size, _ = self._ticks[tick]
        return _snapshot_decoder.decode(self._data[start : start + size])

    def show(self, tick: int, world: World) -> World:
        """Make `world` show the n-th tick; the same world again and again is fastest."""
        snapshot = self.snapshot(tick)
        if world.revision != snapshot.revision:
            world.load(self.scene(tick))
        world.show(snapshot)
        return world

    @property
    def assets(self) -> tuple[str, ...]:
        """The hashes of the assets that are in the file."""
        return tuple(self._assets)

    def asset(self, name: str) -> bytes:
        """A shape, texture or skeleton record by its hash. DataError: not in this recording."""
        if name not in self._assets:
            raise DataError(self.path, name[:12], "this asset is not in the recording, which was cut off")
        start, size = self._assets[name]
        data = self._data[start : start + size]
        if content_hash(data) != name:
            raise DataError(self.path, name[:12], "this shape or texture is damaged in the recording; record again")
        return data

    def skeleton(self, human: HumanRecord) -> dict[str, Any]:
        """The skeleton record of a human, for `Skeleton.from_record`."""
        return json.loads(self.asset(human.skeleton))

    def _index(self) -> bool:
        """Find all whole records; False where the file was cut off."""
        at, end = _FILE_HEAD.size, len(self._data)
        while at < end:
            start = at + _RECORD_HEAD.size
            if start > end:
                return False
            size, kind, check = _RECORD_HEAD.unpack_from(self._data, at)
            at = start + size
            if at > end or zlib.crc32(memoryview(self._data)[start:at]) != check:
                return False
            if kind == _ASSET:
                name = self._data[start : start + _HASH_LENGTH].decode("ascii", "replace")
                self._assets[name] = (start + _HASH_LENGTH, size - _HASH_LENGTH)
            elif kind == _SCENE:
                self._scenes.append((start, size))
            elif kind == _SNAPSHOT and self._scenes:
                self._ticks.append((start, size, len(self._scenes) - 1))
        return True
