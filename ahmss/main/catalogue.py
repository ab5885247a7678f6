"""What the dialogue can offer: the world's objects, what they afford now, the kinds that can be added."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError
from ahmss.main.afforded import Actor, meant, offered, sentence_of
from ahmss.main.communication import Communication
from ahmss.main.company import KIND
from ahmss.main.dialogue import Listing
from ahmss.main.naming import find_object
from ahmss.world.schema import ObjectRecord

__all__ = ["WorldCatalogue"]


class WorldCatalogue:
    """The dialogue's view of world and database; may be asked from another thread than the frame loop's.

    Args:
        actor: gives the human that is to act, as it is now.
    """

    def __init__(self, workspace: Workspace, communication: Communication, actor: Callable[[], Actor]) -> None:
        self._workspace, self._communication, self._actor = workspace, communication, actor

    def objects(self) -> Listing:
        """The objects in the world, each with its kind's sentence and its states."""
        entries: list[tuple[str, str]] = []
        kinds = self._workspace.objects.names()
        for name, record in dict(self._communication.objects).items():
            if record.kind == KIND and KIND not in kinds:  # nothing says what humans afford
                continue
            try:
                sentence = self._workspace.objects.get(record.kind).sentence
            except AhmssError as error:
                sentence = str(error)
            states = ", ".join(f"{state} {value}" for state, value in record.states.items())
            held = f"held by {record.holder}" if record.holder else ""
            more = "; ".join(filter(None, (states, held)))
            entries.append((name, f"{sentence} ({more})" if more else sentence))
        return Listing("objects in the world", tuple(entries))

    def actions(self, name: str) -> Listing:
        """What an object affords to this human now."""
        full, record = self._record(name)
        kind, actor = self._workspace.objects.get(record.kind), self._actor()
        entries: list[tuple[str, str]] = []
        for action in kind.affordances.values():
            try:
                what = meant(self._workspace, self._communication, full, action.name)
            except AhmssError:  # what contained it is gone, or its file is broken: it is no choice now
                continue
            if offered(what, actor):
                entries.append(
                    (action.name, action.sentence or sentence_of(self._workspace, what.kind, what.affordance))
                )
        return Listing(f"what {full} affords", tuple(entries))

    def kinds(self) -> Listing:
        """The kinds of the object database, broken ones with what is wrong."""
        kinds = [kind for kind in self._workspace.objects.list() if kind.name != KIND]
        return Listing("kinds of objects", tuple((kind.name, kind.error or kind.sentence) for kind in kinds))

    def asks(self, name: str, action: str) -> tuple[Sequence[str], int]:
        """What an action asks for, and its usual number of frames (0: as many as it needs)."""
        full, _ = self._record(name)
        affordance = meant(self._workspace, self._communication, full, action).affordance
        return affordance.asks, affordance.frames

    def states(self, name: str) -> Sequence[str]:
        """The states that an object has."""
        return tuple(self._record(name)[1].states)

    def _record(self, name: str) -> tuple[str, ObjectRecord]:
        full = find_object(self._communication, name)
        return full, self._communication.objects[full]
