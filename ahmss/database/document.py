"""One TOML file that a user wrote, read into typed records; a complaint names file, key, line and what is allowed."""

from __future__ import annotations

import difflib
import math
import re
from pathlib import Path
from typing import Any, TypeVar, get_args

import msgspec

from ahmss.errors import DataError

__all__ = ["Document", "one_of"]

T = TypeVar("T")
_MAX_BYTES = 4_000_000
_PLAIN_NAMES = {
    "str": "text in quotes",
    "int": "a whole number",
    "float": "a number",
    "bool": "true or false",
    "array": "a list [...]",
    "object": "a table",
    "null": "nothing",
}


def one_of(word: str, allowed: object) -> str:
    """`, did you mean "x"; this has: a, b` for a message about a name that is not among `allowed`."""
    names = sorted(str(name) for name in allowed)  # type: ignore[attr-defined]
    near = difflib.get_close_matches(word, names, n=1)
    hint = f', did you mean "{near[0]}"?' if near else ""
    shown = ", ".join(names[:20]) + (f" and {len(names) - 20} more" if len(names) > 20 else "")
    return f"{hint}; allowed: {shown or 'none'}"


class Document:
    """A TOML file: its raw `data` and the means to convert a part of it.

    Args:
        path: the file.
        label: how messages name it (its path from the workspace).

    Raises:
        DataError: missing, unreadable, too large, not UTF-8, not TOML, or it holds a number that is not finite.
    """

    def __init__(self, path: Path, label: str) -> None:
        self.path, self.label = path, label
        self.text = self._read()
        try:
            self.data: dict[str, Any] = msgspec.toml.decode(self.text)
        except msgspec.DecodeError as error:
            raise DataError(label, "", f"not TOML: {error}") from None
        except RecursionError:
            raise DataError(label, "", "nested too deeply") from None
        self._refuse_infinite(self.data, ())

    def _read(self) -> str:
        try:
            if self.path.stat().st_size > _MAX_BYTES:
                raise DataError(self.label, "", f"larger than {_MAX_BYTES // 1_000_000} MB; is it the right file?")
            return self.path.read_text(encoding="utf-8")
        except UnicodeDecodeError as error:
            raise DataError(self.label, "", f"not UTF-8 text (byte {error.start}); save it as UTF-8") from None
        except FileNotFoundError:
            raise DataError(self.label, "", "no such file") from None
        except OSError as error:
            raise DataError(self.label, "", f"can't be read: {error.strerror}") from None

    def _refuse_infinite(self, value: Any, place: tuple[str | int, ...]) -> None:
        if isinstance(value, float) and not math.isfinite(value):
            raise self.error(place, f"{value} is no number to use; give a finite one")
        children: list[tuple[str | int, Any]] = []
        if isinstance(value, dict):
            children = list(value.items())
        elif isinstance(value, list):
            children = list(enumerate(value))
        for key, child in children:
            self._refuse_infinite(child, (*place, key))

    def error(self, place: tuple[str | int, ...], message: str) -> DataError:
        """The error for what stands at `place`, keys and list indices from the top of the file."""
        dotted = _dotted(place)
        line = self.line(place)
        where = f"{dotted} (line {line})" if dotted and line else dotted
        return DataError(self.label, where, message)

    def convert(self, value: Any, kind: type[T], place: tuple[str | int, ...] = ()) -> T:
        """A raw value as `kind` (a msgspec struct or a plain type)."""
        try:
            return msgspec.convert(value, kind)
        except msgspec.ValidationError as error:
            raise self._explain(str(error), kind, place) from None

    def _explain(self, message: str, kind: type, place: tuple[str | int, ...]) -> DataError:
        """msgspec's message in plain words, with the keys that are allowed."""
        message, _, path = message.partition(" - at `$")
        place = (*place, *_parts(path.rstrip("`")))
        unknown = re.match(r"Object contains unknown field `(.*)`", message)
        if unknown:
            allowed = [f.encode_name for f in msgspec.structs.fields(_struct(kind))]
            return self.error((*place, unknown[1]), f'no key "{unknown[1]}" here{one_of(unknown[1], allowed)}')
        missing = re.match(r"Object missing required field `(.*)`", message)
        if missing:
            return self.error(place, f'the key "{missing[1]}" is missing')
        enum = re.match(r"Invalid enum value (.*)", message)
        if enum:
            allowed = _literals(kind, place[-1] if place else "")
            return self.error(place, f"{enum[1]} is not possible{one_of(enum[1].strip(chr(39)), allowed)}")
        plain = re.sub(r"`([a-z]+)( \| [a-z |]+)?`", lambda m: _plain(m[0]), message)
        return self.error(place, plain[0].lower() + plain[1:])

    def line(self, place: tuple[str | int, ...]) -> int:
        """The line (from 1) where `place` stands, or the nearest table above it; 0 where nothing is found."""
        keys = [str(part) for part in place]
        seen: dict[str, int] = {}
        best, depth, table = 0, 0, []
        for number, line in enumerate(self.text.splitlines(), start=1):
            header = re.match(r"\s*\[(\[?)([^\]]+)\]", line)
            if header:
                table = _keys(header[2])
                if header[1]:
                    dotted = ".".join(table)
                    seen[dotted] = seen.get(dotted, -1) + 1
                    table = [*table, str(seen[dotted])]
                here = table
            else:
                assignment = re.match(r"\s*((?:[\w-]+|\"[^\"]*\")(?:\s*\.\s*(?:[\w-]+|\"[^\"]*\"))*)\s*=", line)
                if not assignment:
                    continue
                here = [*table, *_keys(assignment[1])]
            if here == keys[: len(here)] and len(here) > depth:
                best, depth = number, len(here)
        return best


def _dotted(place: tuple[str | int, ...]) -> str:
    """`sites.handle.position[0]`."""
    out = ""
    for part in place:
        out += f"[{part}]" if isinstance(part, int) else f".{part}"
    return out.lstrip(".")


def _keys(dotted: str) -> list[str]:
    return [part.strip().strip('"') for part in dotted.split(".")]


def _parts(path: str) -> tuple[str | int, ...]:
    """The keys of a msgspec path such as `.a.b[0]`."""
    found = re.findall(r"\.([^.\[\]]+)|\[(\d+)\]", path)
    return tuple(int(index) if index else name for name, index in found)


def _plain(kinds: str) -> str:
    return " or ".join(_PLAIN_NAMES.get(kind, kind) for kind in kinds.strip("`").split(" | ") if kind != "null")


def _struct(kind: Any) -> Any:
    """The struct in `kind`, which may be optional."""
    return next((k for k in get_args(kind) if hasattr(k, "__struct_fields__")), kind)


def _literals(kind: Any, field: str | int) -> list[str]:
    """The values that a field of a struct may take."""
    for info in msgspec.structs.fields(_struct(kind)):
        if info.encode_name == field:
            flat: list[str] = []
            for argument in get_args(info.type):
                flat += [str(a) for a in (get_args(argument) or (argument,))]
            return [f or '""' for f in flat]
    return []
