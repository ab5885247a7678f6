"""The tables of docs/protocol.md, written from `messages`.

`python -m ahmss.algorithm.document docs/protocol.md` rewrites what stands between the markers.
"""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args, get_origin, get_type_hints

import msgspec
import numpy as np

from ahmss.algorithm import messages
from ahmss.algorithm.messages import Field, Kind
from ahmss.body.links import LINKS, PARENTS
from ahmss.body.skeleton import Skeleton

__all__ = ["rewrite", "tables"]

_BLOCKS = {
    "FRAME": messages.FRAME_HUMAN,
    "FRAME to an object algorithm": messages.FRAME_OBJECT,
    "each object that moved": messages.MOVED,
    "POSE": messages.POSE,
    "the way behind it": messages.WAY,
    "OBJECT": messages.OBJECT,
}
_STRUCTS: dict[str, type[msgspec.Struct]] = {
    "START": messages.Start,
    "START.pose": messages.PoseRecord,
    "START.object and each of START.world": messages.ObjectRecord,
    "each of an object's sites": messages.SiteRecord,
    "START.goal": messages.Goal,
    "READY": messages.Ready,
    "STATE": messages.State,
    "MEANT": messages.Meant,
}
_MARK = re.compile(r"(<!-- table: (?P<name>[^>]*) -->\n).*?(<!-- end -->)", re.DOTALL)


def tables() -> dict[str, str]:
    """Each table of the page by its name, in Markdown."""
    return (
        {"kinds": _kinds(), "links": _links(), "human": _human()}
        | {name: _block(block) for name, block in _BLOCKS.items()}
        | {name: _struct(struct) for name, struct in _STRUCTS.items()}
    )


def rewrite(page: str) -> str:
    """The page with the tables between its markers as they are now.

    Raises:
        KeyError: a marker names no table.
    """
    made = tables()
    return _MARK.sub(lambda mark: f"{mark[1]}\n{made[mark['name']]}\n{mark[3]}", page)


def _table(heads: tuple[str, ...], rows: Iterator[tuple[str, ...]]) -> str:
    """A Markdown table."""
    lines = [heads, tuple("---" for _ in heads), *rows]
    return "".join("| " + " | ".join(cell.replace("|", "\\|") for cell in line) + " |\n" for line in lines)


def _kinds() -> str:
    """The kinds of message."""
    rows = ((f"`{kind.name}`", str(int(kind)), "main" if kind < Kind.READY else "algorithm") for kind in Kind)
    return _table(("message", "kind", "sent by"), rows)


def _links() -> str:
    """The 43 links in their order."""
    rows = ((str(i), f"`{name}`", f"`{LINKS[parent]}`" if i else "the world") for i, (name, parent) in _parents())
    return _table(("row", "link", "its parent"), rows)


def _parents() -> Iterator[tuple[int, tuple[str, int]]]:
    """Each link's row, name and parent's row."""
    return enumerate(zip(LINKS, PARENTS, strict=True))


def _human() -> str:
    """The fields of a skeleton's record."""

    def shape(value: Any) -> str:
        if isinstance(value, str):
            return "text"
        return " x ".join(str(count) for count in np.shape(value)) or "number"

    record = Skeleton.of().to_record()
    return _table(("field", "numbers"), ((f"`{name}`", shape(value)) for name, value in record.items()))


def _block(block: tuple[Field, ...]) -> str:
    """A block of float64: where each field begins, in numbers."""

    def rows() -> Iterator[tuple[str, ...]]:
        first = 0
        for field in block:
            yield (str(first), str(field.count), f"`{field.name}`", field.meaning)
            first += field.count

    return _table(("from", "numbers", "field", "meaning"), rows()) + f"\n{messages.size(block)} numbers.\n"


def _struct(struct: type[msgspec.Struct]) -> str:
    """A JSON object: its fields, their types, whether they may be missing."""
    hints = get_type_hints(struct, include_extras=True)

    def rows() -> Iterator[tuple[str, ...]]:
        for field in msgspec.structs.fields(struct):
            annotated = hints[field.name]
            kind, meta = get_args(annotated)[:2]
            default = "always there" if field.required else f"`{_default(field)}`"
            yield (f"`{field.name}`", _type(kind), default, meta.description)

    return _table(("field", "type", "if missing", "meaning"), rows())


def _default(field: msgspec.structs.FieldInfo) -> str:
    """A field's default, as JSON."""
    value: Any = field.default
    if value is msgspec.NODEFAULT:
        value = field.default_factory() if callable(field.default_factory) else None
    return "false" if value is msgspec.UNSET else msgspec.json.encode(value).decode()


def _type(kind: Any) -> str:
    """A type in words of JSON."""
    named = {messages.Vector: "3 numbers", messages.Quaternion: "4 numbers", messages.Point: "2 numbers"}
    simple = {bool: "true or false", int: "integer", float: "number", str: "text", type(None): "null"}
    if kind in named:
        return named[kind]
    if kind in simple:
        return simple[kind]
    arguments = get_args(kind)
    origin = get_origin(kind)
    if origin is list:
        return f"list of: {_type(arguments[0])}"
    if origin is dict:
        return "object" if arguments[1] is Any else "object: by name, see below"
    if origin is messages.Literal:
        return " or ".join(f'`"{value}"`' for value in arguments)
    if inspect.isclass(kind):
        return "object, see below"
    return " or ".join(_type(argument) for argument in arguments if argument is not msgspec.UnsetType)


if __name__ == "__main__":
    path = Path(sys.argv[1])
    path.write_text(rewrite(path.read_text()))
