"""Who of those in the world reaches what somebody else does not: they are named where it is refused."""

from __future__ import annotations

from ahmss.errors import AhmssError
from ahmss.main.afforded import Actor, Meant, comes_up_to, height_of, too_high
from ahmss.main.company import KIND
from ahmss.main.description import Scene

__all__ = ["who_reaches"]


def who_reaches(reason: str, scene: Scene, what: Meant, actor: Actor) -> str:
    """A reason why somebody can't do it now, with who could where it is that it is too high for them."""
    high, height = too_high(what, actor), height_of(what)
    if height is None or not high or not reason.endswith(high):
        return reason
    able: list[str] = []
    for name, record in scene.objects.items():
        if record.kind != KIND or name == actor.name:
            continue
        try:
            if height <= comes_up_to(scene.body(name).skeleton):
                able.append(name)
        except AhmssError:  # who can't be asked how tall they are is not named
            continue
    return f"{reason}; {' and '.join(able)} {'reaches' if len(able) == 1 else 'reach'} it" if able else reason
