"""The database part: from what was typed to what is to be started, by what objectdb/ and humandb/ say now."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from msgspec import UNSET

from ahmss.algorithm import messages
from ahmss.body.array import Array
from ahmss.database.missing import check_files
from ahmss.database.parameter import fill
from ahmss.database.records import Affordance, AlgorithmEntry, HumanModel
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, CommandError, WorkspaceError
from ahmss.main import which_hand
from ahmss.main.afforded import Actor, Meant, meant, why_not
from ahmss.main.command import Act
from ahmss.main.company import KIND
from ahmss.main.description import Description, Scene, describe, describe_human, four, triple
from ahmss.main.details import PATIENCE, frames_of, patience_of, refuse_incomplete, refuse_unknown
from ahmss.main.laid import laid, refuse_no_room
from ahmss.main.naming import find_object
from ahmss.main.occupied import refuse_occupied
from ahmss.main.order import Order
from ahmss.main.passing import GIVE, PASSING, RECEIVE, passed, refuse_full, taking
from ahmss.main.suggesting import some
from ahmss.main.tops import height_of_what_is_under, place_on_top
from ahmss.main.who_reaches import who_reaches
from ahmss.world.schema import ObjectRecord

__all__ = ["Database"]

_THERE = 0.5  # metres: how far an object may be from the place by which it is named
_REACHED = 0.15  # metres from an object within which a palm need not reach for it any more


class Database:
    """What main asks objectdb/, humandb/ and algorithms/; files are read anew when they change."""

    def __init__(self, workspace: Workspace) -> None:
        self.workspace = workspace

    def human(self, body: str, name: str = "") -> HumanModel:
        """A human model; where `body` is empty the one called like the human, or the first of humandb/."""
        names = self.workspace.humans.names()
        if not body and not names:
            raise WorkspaceError(
                f"{self.workspace.root}/humandb: no human there; `ahmss init DIR` lays out a workspace"
            )
        return self.workspace.humans.get(body or (name if name in names else names[0]))

    def walks(self) -> list[tuple[AlgorithmEntry, Path]]:
        """The algorithms of motions that say themselves when they are over, and the motion data of these."""
        found: dict[Path, AlgorithmEntry] = {}
        owned: set[Path] = set()
        for name in self.workspace.objects.names():
            with contextlib.suppress(AhmssError):  # a broken file hides its own kind only; who names it is told
                kind = self.workspace.objects.get(name)
                for affordance in kind.affordances.values():
                    if affordance.frames == 0 and affordance.motion is not None:
                        entry = self.workspace.algorithms.find(affordance.human_algorithm, kind.directory)
                        own = affordance.motion.parent == kind.directory
                        if affordance.motion not in found or (own and affordance.motion not in owned):
                            found[affordance.motion] = entry  # whose motion it is, rather than who steps with it
                        if own:  # what the kind says first, rather than what is said of every kind
                            owned.add(affordance.motion)
        return [(entry, motion) for motion, entry in found.items()]

    def order(self, act: Act, scene: Scene, actor: Actor) -> Order:
        """Resolve an act: its object, the action that it affords, the algorithms, the goal.

        Raises:
            CommandError: no such object or action, or a detail that it does not take; says what there is.
            DataError: a file that it needs is wrong.
        """
        name = self._object_of(act, scene)
        what = meant(self.workspace, scene, name, act.action)
        name, kind, affordance = what.name, what.kind, what.affordance
        if affordance.hold in PASSING:
            return self._pass(act, what, scene, actor)
        human = self.workspace.algorithms.find(affordance.human_algorithm, kind.directory)
        mover = affordance.object_algorithm
        entry = self.workspace.algorithms.find(mover, kind.directory) if mover else None
        title = f"{name} {act.action}"
        refuse_unknown(title, act.parameters, affordance, human, entry)
        given = {**affordance.parameters, **dict(act.parameters)}
        if PATIENCE not in (human.parameters or {}):  # it is main's own
            given.pop(PATIENCE, None)
        try:
            parameters = fill(human.parameters, given, kind.states)
            object_parameters = fill(entry.parameters, given) if entry else {}
        except ValueError as error:
            raise CommandError(f"{title}: parameter {error}") from None
        refuse_incomplete(title, act, affordance)
        check_files(self.workspace, kind, affordance.name)
        at = which_hand.places(kind, affordance, scene.pose(name))
        hand = which_hand.choose(act, affordance, at, actor, name)
        goal = self._goal(act, scene, scene.pose(name))
        if goal.object is not None and goal.object.kind == KIND and goal.object.name == actor.name:
            raise CommandError(f"{title}: {actor.name} is oneself; name a place, or somebody else")
        if "goal_position" in affordance.asks and name in actor.holds:
            goal = self._put(goal, act, scene, actor, name, hand)
        return Order(
            act, name, affordance, human, entry, frames_of(act, affordance, human), act.after, hand, goal,
            parameters, object_parameters, patience=patience_of(title, act, parameters),
        )  # fmt: skip

    def orders(self, acts: Sequence[Act], scene: Scene, actor: Actor) -> list[Order]:
        """Resolve a line's acts, each as `order` does, with what comes first where an act begins with the line."""
        found: list[Order] = []
        for act in acts:
            order = self.order(act, scene, actor)
            first = None if act.follows else self.first(order, scene, actor)
            if first is not None:
                order = replace(order, act=replace(act, after=0, follows=True), after=0)
            found += [order] if first is None else [first, order]
        return found

    def first(self, order: Order, scene: Scene, actor: Actor) -> Order | None:
        """What brings the hand to where an order takes place, where the order asks for that and the hand is not there.

        Raises:
            CommandError, DataError: as `order`.
        """
        record, act = scene.objects[order.object], order.act
        at = which_hand.places(self.workspace.objects.get(record.kind), order.affordance, scene.pose(order.object))
        if not order.affordance.first or which_hand.away(order.hand, at, actor) <= _REACHED:
            return None
        waits = tuple((name, value) for name, value in act.parameters if name == PATIENCE)
        before = Act(order.object, order.affordance.first, after=act.after, hand=act.hand, parameters=waits)
        return self.order(before, scene, actor)

    def check(self, order: Order, scene: Scene, actor: Actor) -> None:
        """Whether the motion may start now: its `when`, its `needs`, and who holds the object.

        Raises:
            CommandError: it may not; says what is the matter.
        """
        record = scene.objects.get(order.object)
        if record is None:
            raise CommandError(f"{order.title}: there is no {order.object} any more")
        name = order.whom or order.object
        if name not in scene.objects:
            raise CommandError(f"{order.title}: {name} is gone")
        record = scene.objects[name]
        kind = self.workspace.objects.get(record.kind)
        site = kind.affordances[order.affordance.name].site if order.whom else order.affordance.site
        affordance = msgspec.structs.replace(order.affordance, site=site)
        what = Meant(name, record, kind, affordance, scene.pose(name))
        reason = why_not(what, actor, order.title)
        if reason:
            raise CommandError(who_reaches(reason, scene, what, actor))
        if "goal_position" in affordance.asks and name in actor.holds and order.goal.place is not None:
            refuse_occupied(self.workspace, scene, order.title, name, np.array(order.goal.place), actor.root)
        if affordance.hold == "release" and affordance.motion and affordance.frames and name in actor.between:
            place = laid(affordance.motion, scene.pose(name))
            refuse_no_room(self.workspace, scene, order.title, name, place, actor)
        if order.affordance.hold == GIVE:
            refuse_full(scene, order.title, name)

    def start(
        self, order: Order, kind: str, scene: Scene, actor: Actor, seed: int, rate: float, *, carried: bool = False,
        others: Sequence[Order] = (),
    ) -> messages.Start:  # fmt: skip
        """The START message of the order's human or object algorithm ("human" or "object"), made with others."""
        entry = order.human_algorithm if kind == "human" else order.object_algorithm
        assert entry is not None
        told = Description(self.workspace, scene, entry, actor.holds, actor.name)
        motion = order.affordance.motion
        return messages.Start(
            kind="human" if kind == "human" else "object",
            human=actor.skeleton.to_record(),
            pose=messages.PoseRecord(triple(actor.root), [four(q) for q in actor.rotations]),
            frames=order.frames,
            rate=rate,
            wish=order.wish or UNSET,
            carried=carried or UNSET,
            ways=entry.ways or UNSET,
            seed=seed,
            object=told.object(order.object),
            site=order.affordance.site or "",
            goal=told.goal(order.goal),
            motion=str(motion) if motion else None,
            parameters=order.parameters if kind == "human" else order.object_parameters,
            hand=_side(order.hand),
            busy=sorted(_side(hand) for hand in actor.full) or UNSET,
            held=_in_hands(scene, actor) or UNSET,
            led=_led(others, actor) or UNSET,
            hold=_hold(order.affordance.hold),
            world=told.world(order.object, actor.root),
            directory=str(entry.directory),
        )

    def _pass(self, act: Act, what: Meant, scene: Scene, actor: Actor) -> Order:
        """What is given to, or received from, a human: the motion is about the thing, and the human is its goal."""
        affordance, whom = what.affordance, what.name
        named = find_object(scene, act.goal_object) if act.goal_object else ""
        thing = passed(scene, actor, whom, affordance, act.hand, named)
        title = f"{whom} {affordance.name}"
        human = self.workspace.algorithms.find(affordance.human_algorithm, what.kind.directory)
        kind, takes = taking(self.workspace, scene.objects[thing])
        refuse_unknown(title, act.parameters, affordance, human, None)
        mover = None
        if affordance.hold == RECEIVE and takes.object_algorithm:
            mover = self.workspace.algorithms.find(takes.object_algorithm, kind.directory)
        try:
            parameters = fill(human.parameters, {**affordance.parameters, **dict(act.parameters)})
            object_parameters = fill(mover.parameters, takes.parameters) if mover else {}
        except ValueError as error:
            raise CommandError(f"{title}: parameter {error}") from None
        hand = actor.holds[thing] if affordance.hold == GIVE else act.hand or which_hand.free(actor)
        goal = messages.Goal(object=describe_human(self.workspace, scene, whom))
        return Order(
            act, thing, msgspec.structs.replace(affordance, site=takes.site), human, mover,
            frames_of(act, affordance, human), act.after, hand, goal, parameters, object_parameters, whom,
        )  # fmt: skip

    def _object_of(self, act: Act, scene: Scene) -> str:
        """The object that an act means, by its name or by a place."""
        if act.object:
            return self._named(scene, act.object)
        place = np.array(act.object_place)
        near: list[tuple[float, str]] = []
        for name, record in scene.objects.items():
            if act.action in self._affordances(record):
                near.append((float(np.linalg.norm(scene.pose(name)[: len(place)] - place)), name))
        distance, name = min(near, default=(math.inf, ""))
        if distance > _THERE:
            where = " ".join(f"{x:g}" for x in place)
            raise CommandError(f'no object within {_THERE} m of {where} affords "{act.action}"')
        return name

    def _named(self, scene: Scene, name: str) -> str:
        """The object of a name; a kind of which there is none yet is told how to be added."""
        try:
            return find_object(scene, name)
        except CommandError:
            several = any(full.endswith(f"/{name}") for full in scene.objects)
            if several or name not in self.workspace.objects.names():
                raise
            if such := [full for full, record in scene.objects.items() if record.kind == name]:
                raise CommandError(f'no object is called "{name}"; of that kind there are: {some(such)}') from None
            raise CommandError(
                f'no object "{name}" in the world; add one: `add {name} at X Y Z`, in a scene or at a console'
            ) from None

    def _affordances(self, record: ObjectRecord) -> dict[str, Affordance]:
        try:
            return self.workspace.objects.get(record.kind).affordances
        except AhmssError:  # a broken file hides its own kind only; who names it is told
            return {}

    def _goal(self, act: Act, scene: Scene, pose: Array) -> messages.Goal:
        """The goal in the world; a height that was left out is the object's own."""
        place, target = None, None
        if act.goal_place:
            place = (act.goal_place[0], act.goal_place[1], (*act.goal_place, float(pose[2]))[2])
        if act.goal_object:
            name = find_object(scene, act.goal_object)
            human = scene.objects[name].kind == KIND
            target = (
                describe_human(self.workspace, scene, name)
                if human
                else describe(
                    self.workspace.objects.get(scene.objects[name].kind), scene.objects[name], scene.pose(name)
                )
            )
            place = target.place
        facing = None if act.facing_deg is None else math.radians(act.facing_deg)
        posture = None
        if act.posture:
            path = self.workspace.inside(self.workspace.root, act.posture)
            if not path.is_file():
                raise CommandError(f'pose "{act.posture}": no such file in the workspace')
            posture = str(path)
        return messages.Goal(place, None, facing, posture, target)

    def _put(self, goal: messages.Goal, act: Act, scene: Scene, actor: Actor, held: str, hand: str) -> messages.Goal:
        """The goal of what is put down: a place on the thing that was said, or as high as what is under the place."""
        place = goal.place
        if act.goal_object:
            onto = find_object(scene, act.goal_object)
            place = triple(place_on_top(self.workspace, scene, held, onto, actor, hand))
        elif len(act.goal_place) == 2:
            place = (*act.goal_place, height_of_what_is_under(self.workspace, scene, held, act.goal_place))
        return msgspec.structs.replace(goal, place=place)


def _side(hand: str) -> Any:
    return hand if hand in ("right", "left") else ""


def _led(others: Sequence[Order], actor: Actor) -> list[Any]:
    """The hands of what the acting human holds and other motions are about: they have these arms."""
    about = {order.object for order in others}
    return sorted({_side(hand) for name, hand in actor.holds.items() if hand and name in about})


def _in_hands(scene: Scene, actor: Actor) -> dict[str, int]:
    """The numbers of what is in the acting human's hands, by side."""
    numbers = {name: scene.objects[name].id for name in actor.holds if name in scene.objects}
    held = {_side(actor.holds[name]): number for name, number in numbers.items()}
    held |= {side: number for name, number in numbers.items() if name in actor.between for side in ("right", "left")}
    return {side: number for side, number in held.items() if side}


def _hold(hold: str) -> Any:
    return {GIVE: "keep", RECEIVE: "take"}.get(hold, hold if hold in ("take", "keep", "release") else "")
