"""Objects brought into the world with their shapes: each shape once, in messages of a size that a server takes."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from functools import cache

import msgspec

from ahmss.database.placement import Placed
from ahmss.database.workspace import Workspace
from ahmss.errors import WorldError
from ahmss.world.client import WorldClient
from ahmss.world.schema import NewObject, StateValue

__all__ = ["deliver"]

_MOST_BYTES = 512 << 10  # in a message: the server takes no longer over it than a tick or two


def deliver(client: WorldClient, placed: Sequence[Placed], workspace: Workspace, keeper: str = "") -> None:
    """Add objects, parents before what they contain, all or none. Waits for the files and for the server.

    keeper: the human whose main has them follow their file from then on.

    Raises:
        AhmssError: a file is wrong, or the server refused; says why.
    """
    done: set[str] = set()
    try:
        for part in _parts(_described(client, placed, workspace)):
            client.add(part, keeper)
            done.update(new.name for new in part)
    except WorldError:
        for one in placed:
            if one.name in done and one.parent not in done:
                with contextlib.suppress(WorldError):  # the refusal is what is told
                    client.remove(one.name)
        raise


def _described(client: WorldClient, placed: Sequence[Placed], workspace: Workspace) -> list[NewObject]:
    """The objects as the server is told of them; shapes and textures are sent where it lacks them."""
    put = cache(client.put_asset)

    @cache
    def looks(kind: str) -> tuple[str, str, dict[str, StateValue], bool, str]:
        shape = workspace.objects.shape(kind)
        texture = shape.texture.data if shape is not None and shape.texture else b""
        record = workspace.objects.get(kind)
        states: dict[str, StateValue] = dict(record.initial_states)
        behaviour = put(record.behaviour.encode())
        return put(shape.glb if shape is not None else b""), put(texture), states, True, behaviour

    return [
        NewObject(one.name, one.kind, one.local_position, one.local_rotation, one.parent, *looks(one.kind))
        for one in placed
    ]


def _parts(objects: Sequence[NewObject]) -> Iterator[list[NewObject]]:
    """The objects in order, as many at a time as go into a message."""
    part: list[NewObject] = []
    size = 0
    for new in objects:
        length = len(msgspec.msgpack.encode(new))
        if part and size + length > _MOST_BYTES:
            yield part
            part, size = [], 0
        part.append(new)
        size += length
    yield part
