"""Writes pictures as an MP4 film, by the ffmpeg that imageio-ffmpeg brings."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path
from types import TracebackType
from typing import Any

import imageio_ffmpeg
import numpy as np
from numpy.typing import NDArray

from ahmss.errors import AhmssError, DataError

__all__ = ["Movie", "check_writable"]


def check_writable(path: Path) -> None:
    """Fail before the work and not after it.

    Raises:
        DataError: no file can be written at this path.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("ab"):
            pass
        if path.stat().st_size == 0:
            path.unlink()
    except OSError as error:
        raise DataError(path, "", f"can't be written here: {error.strerror}; name another file") from error


class Movie:
    """An H.264 film of fixed rate; pictures (height, width, 3) uint8 of one size, even in both directions.

    Raises:
        DataError: from the start, `add` or `close`, where the file can't be written (a full disk).
    """

    def __init__(self, path: Path, size: tuple[int, int], rate: float, *, quick: bool = False) -> None:
        check_writable(path)
        self.path, self.frames = path, 0
        begin: Any = imageio_ffmpeg.write_frames
        self._writer: Any = begin(
            str(path), size, fps=rate, codec="libx264", macro_block_size=2, ffmpeg_log_level="error", quality=None,
            output_params=["-crf", "20", "-preset", "ultrafast" if quick else "veryfast", "-movflags", "+faststart"],
        )  # fmt: skip
        self._writer.send(None)

    def add(self, picture: NDArray[np.uint8]) -> None:
        """Append one picture."""
        try:
            self._writer.send(np.ascontiguousarray(picture))
        except (OSError, StopIteration) as error:
            raise self._fault(error) from error
        self.frames += 1

    def close(self) -> None:
        """Finish the file."""
        try:
            self._writer.close()
        except (OSError, RuntimeError) as error:
            raise self._fault(error) from error
        if self.frames and (not self.path.exists() or not self.path.stat().st_size):
            raise self._fault(OSError("ffmpeg wrote nothing"))

    def __enter__(self) -> Movie:
        """The movie itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Close; where something else went wrong already, that is what is told."""
        if error is None:
            self.close()
        else:
            with contextlib.suppress(AhmssError):
                self.close()

    def _fault(self, error: BaseException) -> DataError:
        """One sentence from ffmpeg's many."""
        text = str(error)
        reason = "ffmpeg stopped"
        if "No space left" in text or _is_full(self.path):
            reason = "the disk is full"
        elif isinstance(error, OSError) and error.strerror and "pipe" not in error.strerror.lower():
            reason = error.strerror
        return DataError(self.path, "", f"the film can't be written: {reason}; free some space or name another file")


def _is_full(path: Path) -> bool:
    """Whether the disk of this path has less than a megabyte left."""
    try:
        state = os.statvfs(path.parent)
    except OSError:
        return False
    return state.f_bavail * state.f_frsize < 1 << 20
