"""The journal: what objects there are, their states and resting poses, so that they survive a killed server.

`journal.bin` begins with `AHMSSJRN`; records follow: length u32, CRC-32 u32, msgpack of Put or Gone. Records are given
to the system at each tick, so a killed server loses nothing that a tick has shown; a thread asks the disk for them once
a second, so a power cut may cost the last second. A torn last record is dropped. The file is written anew, short, at
each start, and when it has grown far beyond what it says.
"""

from __future__ import annotations

import fcntl
import os
import struct
import threading
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path

import msgspec

from ahmss.errors import WorldError
from ahmss.world.changes import Changes
from ahmss.world.schema import ObjectRecord
from ahmss.world.things import Things

__all__ = ["Journal"]

_MAGIC = b"AHMSSJRN\x01\x00\x00\x00"
_HEAD = struct.Struct("<II")
_COMPACT_OVER = 16 << 20
_SYNC_S = 1.0


class Put(msgspec.Struct, frozen=True, tag="put"):
    """Objects as they stand now; holders are left out: who holds something says so when it comes back."""

    objects: list[ObjectRecord]


class Gone(msgspec.Struct, frozen=True, tag="gone"):
    """Ids of objects that were removed."""

    ids: list[int]


_encode = msgspec.msgpack.Encoder().encode
_decoder: msgspec.msgpack.Decoder[Put | Gone] = msgspec.msgpack.Decoder(Put | Gone)


class Journal:
    """Writes and reads the journal of one directory; one server at a time.

    Args:
        directory: made where it is missing.
        log: told once, in one sentence, when the disk takes no more; the world goes on without a journal.

    Raises:
        WorldError: another server uses the directory, or it can't be written.
    """

    def __init__(self, directory: Path, log: Callable[[str], None]) -> None:
        self._path = directory / "journal.bin"
        self._log = log
        self._failed = False
        self._written = 0
        self._dirty = threading.Event()
        self._stop = threading.Event()
        try:
            directory.mkdir(parents=True, exist_ok=True)
            self._lock = (directory / "lock").open("w")
        except OSError as error:
            raise WorldError(f"{directory}: the world can't be kept here: {error.strerror}") from error
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            self._lock.close()
            raise WorldError(f"{directory}: another server keeps its world here; stop it, or name another") from error
        self._file = self._path.open("ab")
        self._thread = threading.Thread(target=self._sync, name="journal", daemon=True)
        self._thread.start()

    def restore(self, things: Things) -> int:
        """Put back what the journal says, and write it anew; how many objects there are."""
        records = self._replay()
        for record in sorted(records.values(), key=lambda record: record.name.count("/")):
            things.restore(record)
        self._compact(things)
        return len(records)

    def write(self, changes: Changes, things: Things) -> None:
        """Append one tick's changes. Never raises: a full disk is said once."""
        if self._failed or not (changes.put or changes.gone):
            return
        put = [_rested(things, name) for name in changes.put if name in things.by_name]
        try:
            if changes.gone:
                self._append(Gone(changes.gone))
            if put:
                self._append(Put(put))
            self._file.flush()
            self._dirty.set()
            if self._written > _COMPACT_OVER:
                self._compact(things)
        except OSError as error:
            self._fail(error)

    def close(self) -> None:
        """Stop the thread, close the file, free the directory."""
        self._stop.set()
        self._dirty.set()
        self._thread.join()
        self._file.close()
        self._lock.close()

    def _append(self, event: Put | Gone) -> None:
        payload = _encode(event)
        self._file.write(_HEAD.pack(len(payload), zlib.crc32(payload)) + payload)
        self._written += len(payload)

    def _compact(self, things: Things) -> None:
        """Write the present world to a new file, and put that in the old one's place."""
        new = self._path.with_suffix(".new")
        try:
            old, self._file = self._file, new.open("wb")
            old.close()
            self._file.write(_MAGIC)
            self._append(Put([_rested(things, name) for name in things.by_name]))
            self._file.flush()
            os.fsync(self._file.fileno())
            os.replace(new, self._path)
            self._written = 0
        except OSError as error:
            self._fail(error)

    def _fail(self, error: OSError) -> None:
        self._failed = True
        self._log(f"{self._path}: the journal can't be written ({error.strerror}); objects placed from now on are lost "
                  "if the server stops; the world goes on")  # fmt: skip

    def _replay(self) -> dict[int, ObjectRecord]:
        records: dict[int, ObjectRecord] = {}
        for event in self._events():
            if isinstance(event, Put):
                records.update((record.id, record) for record in event.objects)
            else:
                for number in event.ids:
                    records.pop(number, None)
        return records

    def _events(self) -> Iterator[Put | Gone]:
        """All whole records, in order."""
        data = self._path.read_bytes()
        if data and not data.startswith(_MAGIC):
            raise WorldError(f"{self._path}: this is no journal of this version; move it away to begin an empty world")
        at = len(_MAGIC)
        while at + _HEAD.size <= len(data):
            size, check = _HEAD.unpack_from(data, at)
            start, at = at + _HEAD.size, at + _HEAD.size + size
            payload = data[start:at]
            if len(payload) < size or zlib.crc32(payload) != check:
                self._log(f"{self._path}: the last record was torn and is left out")
                return
            yield _decoder.decode(payload)

    def _sync(self) -> None:
        """Ask the disk to keep what was written, once a second, beside the server's loop."""
        while not self._stop.is_set():
            self._dirty.wait()
            self._dirty.clear()
            try:
                os.fsync(self._file.fileno())
            except (OSError, ValueError):  # the file was just replaced or closed, or `write` meets the same error
                continue
            self._stop.wait(_SYNC_S)


def _rested(things: Things, name: str) -> ObjectRecord:
    """The record as it stands after a restart: held by nobody."""
    return msgspec.structs.replace(things.record(things.by_name[name]), holder="", hand="")
