"""What a main answers a human model: by the same grammar and the same checks as the dialogue.

Each answer is a generator: it yields WORKS between small pieces of work, and WAITS where only a later frame brings it
further. None of them waits for anything otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Generator
from typing import TYPE_CHECKING

import numpy as np

from ahmss.algorithm.messages import ObjectRecord
from ahmss.body.array import Array
from ahmss.body.floor_frame import floor_frame
from ahmss.database.parameter import Parameter, within
from ahmss.errors import AhmssError, CommandError
from ahmss.main.afforded import meant, offered, why_not
from ahmss.main.catalogue import WorldCatalogue
from ahmss.main.command import Do as DoLine
from ahmss.main.command import parse
from ahmss.main.comparing import Comparison
from ahmss.main.details import PATIENCE
from ahmss.main.joined import refuse_two_carriers
from ahmss.main.ledger import OVER, Ledger
from ahmss.main.naming import find_object, refuse_another
from ahmss.main.people import records as people
from ahmss.main.sight import WAITS, WORKS, Sight, eyes
from ahmss.main.who_reaches import who_reaches
from ahmss.port import schema
from ahmss.port.grammar import line_of
from ahmss.port.schema import Action, Affordances, Objects, Person, Reply, Request, Thing, Unavailable

if TYPE_CHECKING:
    from ahmss.main.process import MainProcess

__all__ = ["Answering", "Job"]

_LONGEST_WAIT = 60.0  # seconds of one question; who wants to wait longer asks again

Job = Generator[bool, None, Reply]


class Answering:
    """Answers requests about one human; belongs to the frame loop."""

    def __init__(self, main: MainProcess) -> None:
        self._main = main
        self.ledger = Ledger(main)
        self._sight = Sight(main.workspace)
        self._catalogue = WorldCatalogue(main.workspace, main.communication, lambda: main.actor)

    def answer(self, request: Request) -> Job:
        """The answer to a request, once the scene is set. The generator raises AhmssError where it is refused."""
        while self._main.agenda.scene:
            yield WAITS
        match request:
            case schema.GetSelf():
                return self._self(request)
            case schema.GetObjects():
                return (yield from self._objects(request))
            case schema.GetAffordances():
                return self._affordances(request)
            case schema.Do():
                return self._do(request)
            case schema.Cancel():
                return self._cancel(request)
            case schema.Stop():
                self._main.stop_motion()
                return schema.Done(request.request)
            case schema.Await():
                return (yield from self._await(request))
            case schema.WaitState():
                return (yield from self._wait_state(request))
            case schema.GetEvents():
                return (yield from self._events(request))

    # What is

    def _self(self, asked: schema.GetSelf) -> Reply:
        main, actor = self._main, self._main.actor
        place, facing = _stand(actor.rotations, actor.root)
        eye, ahead = eyes(actor)
        return schema.Self(
            asked.request, actor.name, main.body, actor.skeleton.stature, _three(place), facing, _three(eye),
            _three(ahead), dict(actor.holds), [entry.number for entry in self.ledger.open],
            str(main.communication.client.address), main.report.frames, main.setup.rate,
            main.pace.late, main.control.held_frames,
        )  # fmt: skip

    def _objects(self, asked: schema.GetObjects) -> Job:
        main = self._main
        scene = main.communication
        only = find_object(scene, asked.name) if asked.name else ""
        view = yield from self._sight.look(main.communication.world, lambda: main.actor)
        names = [only] if only else list(view.rows)
        actor = main.actor
        place, facing = _stand(actor.rotations, actor.root)
        first = max(0, asked.skip)
        humans = [] if first or only else [_person(record, place, facing) for record in people(scene.world, actor.name)]
        found: list[Thing] = []
        for index in range(first, len(names)):
            if len(found) == schema.PAGE:
                return Objects(asked.request, found, humans, index)
            seen = yield from view.search(names[index])
            thing = self._thing(names[index], place, facing, seen=seen)
            if thing is None and only:
                raise CommandError(f"there is no {only} any more")
            if thing is not None and (thing.seen or not asked.seen):
                found.append(thing)
            yield WORKS
        return Objects(asked.request, found, humans)

    def _thing(self, name: str, place: Array, facing: float, *, seen: bool) -> Thing | None:
        """An object as the human model is told of it; None where it is gone."""
        scene = self._main.communication
        record = scene.objects.get(name)
        if record is None:
            return None
        try:
            sentence = self._main.workspace.objects.get(record.kind).sentence
        except AhmssError as error:
            sentence = str(error)
        at = scene.pose(name)[:3]
        distance, direction = _way(at, place, facing)
        return Thing(
            name, record.kind, sentence, _three(at), distance, direction,
            bool(record.shape) and seen, dict(record.states),
            record.holder, record.hand, record.parent if record.attached else "",
        )  # fmt: skip

    def _affordances(self, asked: schema.GetAffordances) -> Reply:
        scene = self._main.communication
        name = find_object(scene, asked.object)
        now = [self._action(name, action, sentence) for action, sentence in self._catalogue.actions(name).entries]
        offers = {action.name for action in now}
        kind = self._main.workspace.objects.get(scene.objects[name].kind)
        later = [Unavailable(a, self._why_not(name, a)) for a in kind.affordances if a not in offers]
        return Affordances(asked.request, name, now, later)

    def _action(self, name: str, action: str, sentence: str) -> Action:
        main = self._main
        what = meant(main.workspace, main.communication, name, action)
        affordance, directory = what.affordance, what.kind.directory
        told: dict[str, str] = {}
        for algorithm in (affordance.human_algorithm, affordance.object_algorithm):
            declared = main.workspace.algorithms.find(algorithm, directory).parameters if algorithm else None
            bounded = within(declared or {}, affordance.parameters, what.kind.states)
            for key, parameter in bounded.items():
                told[key] = _in_words(parameter, affordance.parameters.get(key, parameter.default))
        return Action(action, sentence, list(affordance.asks), affordance.frames, told)

    def _why_not(self, name: str, action: str, *, waits: bool = False) -> str:
        """Why an action is not offered now; that another has the object is no reason for who waits."""
        main = self._main
        try:
            what = meant(main.workspace, main.communication, name, action)
        except AhmssError as error:
            return str(error)
        actor = main.actor
        reason = who_reaches(why_not(what, actor), main.communication, what, actor)
        if waits and what.record.holder not in ("", actor.name):
            return ""
        if not reason and not offered(what, actor):
            return f"{what.name} {action}: {what.record.holder} holds it; wait until it is let go"
        return reason

    # What is to be done

    def _do(self, asked: schema.Do) -> Reply:
        self.ledger.check_room()
        text = asked.line.strip() or line_of(asked.acts)
        try:
            line = parse(text)
        except CommandError as error:
            raise CommandError(f"{error}; the line was: {text}") from None
        main = self._main
        if not isinstance(line, DoLine):
            raise CommandError("the port takes lines that begin with do, as in: do door open")
        refuse_another(line.human, main.setup.human, main.communication.world.humans)
        self._check(line)
        waits = len(self.ledger.open)
        return schema.Accepted(asked.request, self.ledger.accept(line, text).number, text, waits)

    def _check(self, line: DoLine) -> None:
        """Refuse what can't be done: by its names at any time, by the states only where it begins at once."""
        main = self._main
        scene, actor = main.communication, main.actor
        orders = main.database.orders(line.acts, scene, actor)
        refuse_two_carriers(orders)
        if not main.agenda.done:
            return
        for order in orders:
            if not order.act.follows and not order.act.after:
                asked = order.whom or order.object  # what is given or taken is the thing, who affords it the human
                waits = PATIENCE in dict(order.act.parameters) and order.patience > 0.0
                reason = self._why_not(asked, order.affordance.name, waits=waits)
                if reason:
                    raise CommandError(f"{reason}; it affords now: {self._offers(asked)}")

    def _offers(self, name: str) -> str:
        return ", ".join(self._catalogue.actions(name).names) or "nothing"

    def _cancel(self, asked: schema.Cancel) -> Reply:
        entry = self.ledger.get(asked.number)
        if entry.status not in OVER:
            self._main.agenda.drop(entry.step)
        return self.ledger.result(entry, asked.request)

    # What comes of it

    def _await(self, asked: schema.Await) -> Job:
        entry, end = self.ledger.get(asked.number), self._end(asked.seconds)
        while entry.status not in OVER and self._main.report.frames < end:
            yield WAITS
        return self.ledger.result(entry, asked.request)

    def _wait_state(self, asked: schema.WaitState) -> Job:
        main = self._main
        end = self._end(asked.seconds)
        comparison = Comparison(
            main.workspace, main.communication, asked.object, asked.state, asked.operator, asked.value
        )
        while not comparison.holds and main.report.frames < end:
            yield WAITS
        return schema.Compared(asked.request, comparison.object, comparison.holds, comparison.value)

    def _events(self, asked: schema.GetEvents) -> Job:
        end = self._end(asked.seconds)
        while True:
            events, following, missed = self.ledger.events(asked.since)
            if events or self._main.report.frames >= end:
                return schema.Events(asked.request, events, following, missed)
            yield WAITS

    def _end(self, seconds: float) -> float:
        """The frame at which a question has waited long enough."""
        if not 0.0 <= seconds <= _LONGEST_WAIT:
            raise CommandError(
                f"seconds {seconds:g}: one question waits 0 to {_LONGEST_WAIT:g} s; ask again after that"
            )
        return self._main.report.frames + round(seconds * self._main.setup.rate)


def _stand(rotations: Array, root: Array) -> tuple[Array, float]:
    """Where a human stands (3,), and its heading in degrees."""
    place, turn = floor_frame(rotations, root)
    return place, round(math.degrees(2.0 * math.atan2(turn[3], turn[0])), 1)


def _way(at: Array, place: Array, facing: float) -> tuple[float, float]:
    """Level distance, metres, and direction, degrees to the left of ahead, from where a human stands to a place."""
    x, y = (at - place)[:2].tolist()
    direction = math.degrees(math.atan2(y, x)) - facing
    return round(math.hypot(x, y), 3), round((direction + 180.0) % 360.0 - 180.0, 1)


def _person(record: ObjectRecord, place: Array, facing: float) -> Person:
    """Another human, from where this one stands."""
    at = np.array(record.place)
    distance, direction = _way(at, place, facing)
    heading = math.degrees(2.0 * math.atan2(record.rotation[3], record.rotation[0]))
    return Person(record.name, _three(at), round((heading + 180.0) % 360.0 - 180.0, 1), distance, direction)


def _in_words(parameter: Parameter, usual: object) -> str:
    """A parameter's type, range, default and sentence."""
    words = [parameter.type]
    low, high = parameter.minimum, parameter.maximum
    if low is not None or high is not None:
        words.append(f"{'any' if low is None else f'{low:g}'} to {'any' if high is None else f'{high:g}'}")
    if parameter.unit:
        words.append(parameter.unit)
    stands_for_other = low is not None and isinstance(usual, int | float) and usual < low  # nobody is to type it
    if usual is not None and not stands_for_other:
        words.append(f"(usually {usual})")
    return " ".join(words) + (f": {parameter.sentence}" if parameter.sentence else "")


def _three(place: Array) -> schema.Place:
    """A place for a message, to a tenth of a millimetre."""
    x, y, z = np.round(place, 4).tolist()
    return (x, y, z)
