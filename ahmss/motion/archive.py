"""Arrays by name in one `.npz` without pickles: the same content gives the same bytes, and hostile files only fail."""

from __future__ import annotations

import io
import os
import tokenize
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ahmss.errors import DataError

__all__ = ["names", "read", "write"]

_LARGEST = 256 * 2**20  # bytes of one array once unpacked: some 20 hours at 60 Hz would be hostile, not long
_UNREADABLE = (  # what zipfile and numpy raise at content that is not theirs, encrypted or hostile
    OSError, ValueError, EOFError, RuntimeError, MemoryError, SyntaxError, TypeError, KeyError, UnicodeError,
    zlib.error, zipfile.BadZipFile, tokenize.TokenError,
)  # fmt: skip
_FIXED_DATE = (1980, 1, 1, 0, 0, 0)


def read(path: Path, what: str) -> dict[str, Any]:
    """The raw arrays by name; members are read whole first, so that checksums are checked before content.

    Args:
        path: the file.
        what: what it should be, for the messages: "motion clip".

    Raises:
        DataError: the file is missing, broken or too large.
    """
    arrays: dict[str, Any] = {}
    try:
        with zipfile.ZipFile(path) as archive:
            for entry in archive.infolist():
                if entry.file_size > _LARGEST:
                    raise DataError(path, entry.filename, f"{entry.file_size} bytes; at most {_LARGEST} are allowed")
                content = io.BytesIO(archive.read(entry))
                arrays[entry.filename.removesuffix(".npy")] = np.lib.format.read_array(content, allow_pickle=False)
    except FileNotFoundError:
        raise DataError(path, "", f"no such {what}") from None
    except _UNREADABLE as error:
        raise DataError(path, "", f"not a {what} that can be read ({error}); it must be an .npz file") from error
    return arrays


def names(path: Path, what: str) -> set[str]:
    """The names of the arrays, none of which is unpacked.

    Raises:
        DataError: the file is missing or broken.
    """
    try:
        with zipfile.ZipFile(path) as archive:
            return {entry.filename.removesuffix(".npy") for entry in archive.infolist()}
    except FileNotFoundError:
        raise DataError(path, "", f"no such {what}") from None
    except _UNREADABLE as error:
        raise DataError(path, "", f"not a {what} that can be read ({error}); it must be an .npz file") from error


def write(path: Path, arrays: Mapping[str, Any]) -> None:
    """Write arrays in their order; the file takes its name when it is whole, so that a broken end leaves none."""
    path.parent.mkdir(parents=True, exist_ok=True)
    unfinished = path.with_name(f".{path.name}.{os.getpid()}")
    with zipfile.ZipFile(unfinished, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, value in arrays.items():
            buffer = io.BytesIO()
            np.lib.format.write_array(buffer, np.asanyarray(value), allow_pickle=False)
            entry = zipfile.ZipInfo(f"{name}.npy", _FIXED_DATE)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, buffer.getvalue())
    unfinished.replace(path)
