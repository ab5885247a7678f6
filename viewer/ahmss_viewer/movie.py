"""Writes pictures as an MP4 film, by the ffmpeg that imageio-ffmpeg brings."""

from __future__ import annotations

import subprocess
from pathlib import Path
from types import TracebackType

import imageio_ffmpeg
import numpy as np
from numpy.typing import NDArray

from ahmss.errors import DataError

__all__ = ["Movie", "check_writable"]


def check_writable(path: Path) -> None:
    """Fail before the work and not after it.

    Raises:
        DataError: no file can be written at this path.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        new = not path.exists()
        with path.open("ab"):
            pass
        if new:
            path.unlink()
    except OSError as error:
        raise DataError(path, "", f"can't be written here: {error.strerror}; name another file") from error


class Movie:
    """An H.264 film of fixed rate; pictures (height, width, 3) uint8 of one size, even in both directions.

    `quick` compresses less, so that a running world keeps the cores.

    Raises:
        DataError: from the start, `add` or `close`, where the file can't be written (a full disk).
    """

    def __init__(self, path: Path, size: tuple[int, int], rate: float, *, quick: bool = False) -> None:
        check_writable(path)
        self.path, self.frames, self._said = path, 0, ""
        command = [
            imageio_ffmpeg.get_ffmpeg_exe(), "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24",
            "-s", f"{size[0]}x{size[1]}", "-r", f"{rate:g}", "-i", "-", "-an", "-c:v", "libx264", "-pix_fmt", "yuv420p",
            "-crf", "20", "-preset", "ultrafast" if quick else "veryfast", "-movflags", "+faststart",
            "-f", "mp4", str(path),
        ]  # fmt: skip
        # In a session of its own, so that an interrupt typed at the terminal does not cut the film off.
        self._ffmpeg = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, bufsize=0,
            start_new_session=True,
        )  # fmt: skip

    def add(self, picture: NDArray[np.uint8]) -> None:
        """Append one picture."""
        rest = memoryview(np.ascontiguousarray(picture).data).cast("B")
        pipe = self._ffmpeg.stdin
        try:
            while pipe is not None and len(rest):
                rest = rest[pipe.write(rest) :]
        except OSError as error:
            raise self._fault() from error
        self.frames += 1

    def close(self) -> None:
        """Finish the file."""
        if self._ffmpeg.stdin is None or self._ffmpeg.stdin.closed:
            return
        code = self._end()
        if not self.frames:
            self.path.unlink(missing_ok=True)  # a film of nothing is no film
        elif code:
            raise self._fault()

    def __enter__(self) -> Movie:
        """The movie itself."""
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        """Close; where something else went wrong already, that is what is told."""
        if error is None:
            self.close()
        else:
            self._end()

    def _end(self) -> int:
        """Close the pipe and wait for ffmpeg; its exit code."""
        pipe, log = self._ffmpeg.stdin, self._ffmpeg.stderr
        if pipe is not None and not pipe.closed:
            pipe.close()
        if log is not None and not log.closed:
            self._said = log.read().decode("utf-8", "replace")
            log.close()
        return self._ffmpeg.wait()

    def _fault(self) -> DataError:
        """One sentence from ffmpeg's many."""
        self._end()
        lines = [line.strip() for line in self._said.splitlines() if line.strip()]
        reason = "the disk is full" if "No space left" in self._said else "ffmpeg stopped"
        if lines and reason == "ffmpeg stopped":
            reason += f" ({lines[-1][:120]})"
        return DataError(self.path, "", f"the film can't be written: {reason}; free some space or name another file")
