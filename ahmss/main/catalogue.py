"""What the dialogue can offer: the world's objects, what they afford now, the kinds that can be added."""

from __future__ import annotations

from collections.abc import Sequence

from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, CommandError
from ahmss.main.communication import Communication
from ahmss.main.database import find_object
from ahmss.main.dialogue import Listing
from ahmss.world.schema import ObjectRecord

__all__ = ["WorldCatalogue"]


class WorldCatalogue:
    """The dialogue's view of world and database; may be asked from another thread than the frame loop's."""

    def __init__(self, workspace: Workspace, communication: Communication) -> None:
        self._workspace, self._communication = workspace, communication

    def objects(self) -> Listing:
        """The objects in the world, each with its kind's sentence and its states."""
        entries: list[tuple[str, str]] = []
        for name, record in dict(self._communication.objects).items():
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
        """What an object affords in its present states."""
        full, record = self._record(name)
        kind = self._workspace.objects.get(record.kind)
        states = {state: value for state, value in record.states.items() if not isinstance(value, bool)}
        actions = kind.afforded(states)
        return Listing(f"what {full} affords", tuple((name, action.sentence) for name, action in actions.items()))

    def kinds(self) -> Listing:
        """The kinds of the object database, broken ones with what is wrong."""
        kinds = self._workspace.objects.list()
        return Listing("kinds of objects", tuple((kind.name, kind.error or kind.sentence) for kind in kinds))

    def asks(self, name: str, action: str) -> tuple[Sequence[str], int]:
        """What an action asks for, and its usual number of frames (0: as many as it needs)."""
        _, record = self._record(name)
        affordance = self._workspace.objects.get(record.kind).affordances.get(action)
        if affordance is None:
            raise CommandError(f'{name} does not afford "{action}"')
        return affordance.asks, affordance.frames

    def states(self, name: str) -> Sequence[str]:
        """The states that an object has."""
        return tuple(self._record(name)[1].states)

    def _record(self, name: str) -> tuple[str, ObjectRecord]:
        full = find_object(self._communication, name)
        return full, self._communication.objects[full]
