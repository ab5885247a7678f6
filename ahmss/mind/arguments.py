"""Arguments that a tool does not have, or not so: told in a sentence, out of what the tool says of itself."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from typing import Any

from ahmss.database.document import one_of

__all__ = ["unknown", "wrong"]

_TYPES = {
    "string": "a text", "number": "a number", "integer": "a whole number", "boolean": "true or false",
    "object": 'names with their values, as in {"position": "on"}', "array": "a list",
}  # fmt: skip
_LONGEST = 60  # characters of a value that are repeated


def unknown(tool: str, arguments: Iterable[str], schema: Mapping[str, Any]) -> str:
    """What is said of arguments that a tool does not have, by its schema; "" where it has all."""
    known = schema["properties"]
    for argument in arguments:
        if argument not in known:
            return f'{tool}: no argument "{argument}"{one_of(argument, known)}'
    return ""


def wrong(tool: str, arguments: Mapping[str, Any], name: str, schema: Mapping[str, Any], description: str) -> str:
    """What is said of an argument that is missing, or of a wrong type.

    Args:
        tool: its name. arguments: the given ones.
        name: of the argument.
        schema: the tool's; says the type.
        description: the tool's; its lines `NAME: sentence` say what each argument is.
    """
    found = re.search(rf"^\s*{re.escape(name)}: (.+(?:\n\s+[^:\n]+$)*)", description, re.M)
    meant = f": {' '.join(found[1].split()).rstrip('.')}" if found else ""
    takes = _taken(schema["properties"].get(name, {}))
    if name not in arguments:
        return f'{tool}: the argument "{name}" is missing; it is {takes}{meant}'
    value = json.dumps(arguments[name], ensure_ascii=False, default=str)
    value = value if len(value) <= _LONGEST else f"{value[:_LONGEST]}..."
    return f"{tool}: {name} {value} is not {takes}; give {takes}{meant}"


def _taken(schema: Mapping[str, Any]) -> str:
    """The types that an argument may have, in words."""
    kinds = [str(one.get("type", "null")) for one in schema.get("anyOf", [schema])]
    return " or ".join(_TYPES[kind] for kind in kinds if kind != "null") or "something else"
