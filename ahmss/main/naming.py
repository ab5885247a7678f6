"""Which object, and which human, is meant by a name."""

from __future__ import annotations

import re
from collections.abc import Iterable

from ahmss.errors import CommandError
from ahmss.main.company import Everything
from ahmss.main.description import Scene
from ahmss.main.suggesting import nearest, some

__all__ = ["find_object", "refuse_another"]

_PLACE = (2, 3)
_NUMBER = re.compile(r"[-+]?\d*\.?\d+")


def find_object(scene: Scene, name: str) -> str:
    """The full name of an object that was named by it or by its last parts (`cup` for `room/cup`).

    Raises:
        CommandError: none of that name, or more than one.
    """
    objects = scene.objects
    if name in objects:
        return name
    among = objects.called(name.rsplit("/", 1)[-1]) if isinstance(objects, Everything) else objects
    meant = [full for full in among if full.endswith(f"/{name}")]
    if len(meant) == 1:
        return meant[0]
    if meant:
        raise CommandError(f'which "{name}"? there are: {", ".join(meant)}')
    if len(name.split()) in _PLACE and all(_NUMBER.fullmatch(word) for word in name.split()):
        raise CommandError(f'"{name}" is a place, and was given as a name; give it as numbers, as in: to {name}')
    if all(_NUMBER.fullmatch(word) for word in name.split()):
        raise CommandError(f'"{name}" is no place; a place is X Y or X Y Z, in metres')
    near = nearest(name, scene.objects)
    hint = f"did you mean {near}?" if near else f"there are: {some(scene.objects)}"
    raise CommandError(f'no object "{name}" in the world; {hint}')


def refuse_another(named: str, own: str, here: Iterable[str]) -> None:
    """Refuse a line for somebody else; "" is for one's own human, too.

    Raises:
        CommandError: it is for another, or for nobody; says who is here.
    """
    if named not in ("", own):
        raise CommandError(f"this main moves {own}, not {named}; humans here: {', '.join(sorted(here))}")
