"""What the algorithms of one human have to say: what went wrong, what the person is told, states that they change."""

from __future__ import annotations

import logging
from collections.abc import Callable

from ahmss.algorithm.messages import Meant, State
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, AlgorithmError
from ahmss.main.communication import Communication
from ahmss.main.enabling import not_enabled
from ahmss.main.left_behind import with_left_behind
from ahmss.main.order import Order
from ahmss.main.telling import told

__all__ = ["Hearing", "in_words"]

_LOG = logging.getLogger(__name__)


class Hearing:
    """Passes on what is heard; `failures` counts what went wrong.

    Args:
        say: is told in one line what went wrong.
        note: is told in one line what an algorithm wants the person to know.
    """

    def __init__(
        self,
        workspace: Workspace,
        communication: Communication,
        say: Callable[[str], None],
        note: Callable[[str], None],
    ) -> None:
        self._workspace, self._communication = workspace, communication
        self.say, self.note = say, note
        self.failures = 0

    def fail(self, reason: str) -> None:
        """Something went wrong."""
        self.failures += 1
        self.say(self._of_whom(reason, in_vain=True))

    def tell(self, order: Order, text: str) -> None:
        """An algorithm has something to say; what states its object has, as they are now."""
        thing = self._communication.objects.get(order.object)
        self.note(
            self._of_whom(f"{order.title}: {told(text, thing.states if thing is not None else {})}", in_vain=False)
        )

    def in_vain(self, order: Order, meant: Meant | None) -> str:
        """Why a motion that is over has failed: its object is not as it was to be. Empty where it is."""
        thing = self._communication.objects.get(order.object)
        if meant is None or thing is None:
            return ""
        for state, (least, most) in meant.states.items():
            now = thing.states.get(state)
            if isinstance(now, (int, float)) and not least <= now <= most:
                return f"{order.title}: {told(meant.otherwise, thing.states)}"
        return ""

    def _of_whom(self, text: str, *, in_vain: bool) -> str:
        """What is said, with what there is to know of those whom it names."""
        return with_left_behind(text, self._communication.world.humans.values(), in_vain=in_vain)

    def change_states(self, state: State) -> None:
        """An algorithm has changed the states of an object."""
        try:
            record = self._communication.world.object_by_id(state.object)
        except KeyError:
            self.say(f"an algorithm changes the state of object {state.object}, which is not in the world")
            return
        objects = self._communication.objects
        now = objects[record.name].states
        news = {key: value for key, value in state.states.items() if isinstance(value, str) and now.get(key) != value}
        for sentence in not_enabled(self._workspace, objects, record.name, news) if news else ():
            self.note(sentence)
        self._communication.set_states(record.name, state.states)


def in_words(error: AhmssError) -> str:
    """Why an algorithm gave up, as it says itself where it does; which one it was, and when, `--debug` shows."""
    _LOG.debug("%s", error)
    return (error.said if isinstance(error, AlgorithmError) else "") or str(error)
