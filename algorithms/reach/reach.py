"""Reaching: a palm travels to a site of the object or to a place (Ichiguchi 2000, 5.3.3).

The eyes and the head go first. The hand goes by a minimum-jerk path around what is in the way, its orientation set
before its place; the trunk helps where the arm alone is too short. The plan is made in the first frames, a part in
each, while only the gaze moves. Who is carried reaches for the place in the world, from wherever the body then is.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from contextlib import suppress

import numpy as np

from ahmss.algorithm import HumanTask, run
from ahmss.body.array import Array
from ahmss.body.links import fingers
from ahmss.body.quaternion import from_axis_angle
from ahmss.errors import AlgorithmError
from ahmss.motion.fingers import opened
from ahmss.reaching.goal import Goal, turned_askew, turned_otherwise
from ahmss.reaching.performing import Fingers, Performed
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.prism import Prism
from ahmss.skills.before_grip import Before, goal_before, grips_before, refused
from ahmss.skills.carried import reach_while_carried
from ahmss.skills.grasping import read_shape
from ahmss.skills.in_target import in_target
from ahmss.skills.out_of_reach import EXACT, MOST_MISSING, refuse_far, stand_there, tell_missed
from ahmss.skills.planning import planned
from ahmss.skills.reaching import Looking, goal_of, performed, prisms_of, sides_of

FLAW, TOUCHES = 2.0, 0.2  # of the arm on its way, from where on another turn of the palm is tried; another hand
TOLD = 1.0, 1.0  # millimetres, degrees
_NEAR = 15.0, 15.0  # millimetres, degrees: farther off a hand is not brought to a thing
_SHORTER = 0.12  # metres that an arm is too short of which the hand may yet come askew: its wrist is nearer then
_PINCHES, _DEEP = 3, 0.002  # ways to come before a grip that are tried; metres in the thing
THUMB = np.radians(92.0)  # from along the hand, before it opens further


def reach(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260): a few in which the head turns while the way is planned, then all others."""
    if task.carried:
        return reach_while_carried(task, goal_of(task), lambda side: _shape(task, side))
    return _standing(task)


def _standing(task: HumanTask) -> Iterator[Array]:
    goal = goal_of(task)
    gaze = Looking(task, goal.place)
    reaching = Reaching(task.human, task.start.rotations, task.start.root)
    prisms = prisms_of(task)
    gripped = _is_gripped(task)
    if gripped:
        read_shape(task)
        yield gaze.alone()
        before = yield from gaze.during(grips_before(task, sides_of(task)))
        if before:
            made = yield from _before_grip(task, goal, before, gaze, reaching, prisms)
            tell_missed(task, made.plan)
            yield task.block(made.rotations, made.root, made.importance, made.targets)
            return
    plan = yield from _planned(task, goal, gaze, reaching, prisms, turned_askew(goal) if gripped else ())
    made = yield from performed(task, reaching, plan, gaze, _shape(task, plan.reacher.side))
    deep = in_target(task, made) if gripped else 0.0
    for other, side in _otherwise(task, reaching, goal, made, deep > _DEEP):
        try:
            plan = yield from planned(task, reaching, other, gaze, prisms, sides=(side,))
        except AlgorithmError:
            continue  # what was found first is done
        again = yield from performed(task, reaching, plan, gaze, _shape(task, side))
        then = in_target(task, again) if gripped else 0.0
        worse = max(then, _DEEP) - max(deep, _DEEP)
        if worse < 0.0 or (worse == 0.0 and again.flaw < made.flaw and _meets(goal, again) >= _meets(goal, made)):
            made, deep = again, then
        elif made.looked < 1.0:  # the eyes have gone on since it was made
            made = yield from performed(task, reaching, made.plan, gaze, _shape(task, made.plan.reacher.side))
    if task.goal_place is None and task.site is not None and (deep > _DEEP or not _is_near(goal, made)):
        raise AlgorithmError(_too_far_off(task, made))
    tell_missed(task, made.plan)
    _tell_turned(task, goal, made)
    yield task.block(made.rotations, made.root, made.importance, made.targets)


def _planned(
    task: HumanTask, goal: Goal, gaze: Looking, reaching: Reaching, prisms: Sequence[Prism], askew: Sequence[Goal]
) -> Generator[Array, None, Plan]:
    """The plan of a hand that comes as the thing asks or, where the arm does not come there well so, askew of it.

    Raises:
        AlgorithmError: it is out of reach, however it comes: says by how much, and what to do.
    """
    most = _SHORTER if askew else MOST_MISSING
    plan = yield from planned(task, reaching, goal, gaze, prisms, most=most)
    for other in askew:
        if _comes(plan) == (0.0, False):
            break
        with suppress(AlgorithmError):  # what was found first is done
            found = yield from planned(task, reaching, other, gaze, prisms, most=most)
            plan = min(plan, found, key=_comes)
    refuse_far(task, plan.reacher.side, plan.arm)
    return plan


def _comes(plan: Plan) -> tuple[float, bool]:
    """Metres by which an arm does not come to its palm, and whether its joints do not allow it: the less the better."""
    return max(plan.arm.missing - EXACT, 0.0), not plan.arm.found


def _before_grip(
    task: HumanTask, goal: Goal, left: list[Before], gaze: Looking, reaching: Reaching, prisms: Sequence[Prism]
) -> Generator[Array, None, Performed]:
    """The frames of a hand that comes before a grip, open around what it will take: of a few the best.

    Raises:
        AlgorithmError: it is out of reach; or none of the palms can be brought there clear of it, or close then: says
            by how much.
    """
    best: tuple[float, Performed, Before] | None = None
    made, why = None, None
    for _ in range(_PINCHES):
        try:
            plan = yield from planned(task, reaching, goal_before(goal, left), gaze, prisms)
        except AlgorithmError:
            if best is None and why is None:
                raise
            break  # what is left is out of reach
        own = [one for one in left if one.side == plan.reacher.side]
        one = min(own, key=lambda one: one.turned_from(plan.palm))
        left = [other for other in left if other is not one]
        if error := (yield from gaze.during(refused(task, one, plan))):
            why = why or error
            if left:
                continue
            break
        made = yield from performed(task, reaching, plan, gaze, (list(fingers(one.side)), one.fingers))
        off, turned = _off(made)
        flaw = max(in_target(task, made) / _DEEP, off / _NEAR[0], turned / _NEAR[1])
        best = (flaw, made, one) if best is None or flaw < best[0] else best
        if not left or (flaw < 1.0 and made.flaw < FLAW):
            break
    if best is None:
        assert why is not None
        raise why
    flaw, chosen, one = best
    if flaw > 1.0:
        raise AlgorithmError(_too_far_off(task, chosen))
    if chosen is not made and (task.length or chosen.looked < 1.0):  # the eyes have gone on since it was made
        chosen = yield from performed(task, reaching, chosen.plan, gaze, (list(fingers(one.side)), one.fingers))
    return chosen


def _otherwise(task: HumanTask, reaching: Reaching, goal: Goal, made: Performed, in_it: bool) -> list[tuple[Goal, str]]:
    """What else is tried, by which hand: the palm turned otherwise where the arm is badly off, the other hand where
    this one touches things; both where the hand would be in what it reaches for.
    """
    if task.length:
        return []
    reacher = made.plan.reacher
    found: list[tuple[Goal, str]] = []
    other = turned_otherwise(goal, reacher.side, reaching.palms(reacher, goal), made.plan.palm)
    if other is not None and (in_it or made.flaw > FLAW):
        found.append((other, reacher.side))
    if in_it or made.flaw > TOUCHES:
        found += [(goal, side) for side in sides_of(task) if side != reacher.side]
    return found


def _off(made: Performed) -> tuple[float, float]:
    """Millimetres and degrees of the palm from where it was to be in the end."""
    asked, palm = made.plan.palm, made.targets[-1, made.plan.reacher.row, :7]
    turned = float(np.degrees(2.0 * np.arccos(min(1.0, abs(float(palm[3:] @ asked[3:]))))))
    return 1000.0 * float(np.linalg.norm(palm[:3] - asked[:3])), turned


def _meets(goal: Goal, made: Performed) -> bool:
    """Whether the palm comes to where it was to be, and is turned so where that was asked."""
    off, turned = _off(made)
    return off <= TOLD[0] and (goal.rotation is None or turned <= TOLD[1])


def _is_gripped(task: HumanTask) -> bool:
    """Whether it reaches for a site that hands close on, of a thing whose shape is known, as the site is turned."""
    thing = task.object
    if thing is None or thing.shape is None or task.goal_place is not None or task.site is None:
        return False
    return (
        bool(thing.sites[task.message.site].grip)
        and task.goal_rotation is None
        and task.parameter("turn", "site") != "free"
    )


def _is_near(goal: Goal, made: Performed) -> bool:
    """Whether the palm comes so near to where it was to be that what follows may go on from there."""
    off, turned = _off(made)
    return off <= _NEAR[0] and (goal.rotation is None or turned <= _NEAR[1])


def _too_far_off(task: HumanTask, made: Performed) -> str:
    """Why the hand is not brought there."""
    thing, side = task.object, made.plan.reacher.side
    name = "it" if thing is None else thing.name
    off, turned = _off(made)
    there = stand_there(task) or f"stand elsewhere or turn {name}"
    mended = f"use the other hand, or {there}" if task.hand else there
    if off <= _NEAR[0] and turned <= _NEAR[1]:
        return f"the {side} hand would be {1000.0 * in_target(task, made):.0f} mm in {name}; {mended}"
    far = f"{off:.0f} mm and {turned:.0f} degrees from what was asked at {name}"
    return f"the {side} wrist does not turn so far: the palm would be {far}; {mended}"


def _tell_turned(task: HumanTask, goal: Goal, made: Performed) -> None:
    """Tell how far the palm is from where it was to be, where wrist and forearm do not turn so far."""
    if not _meets(goal, made):
        off, turned = _off(made)
        told = f"the {made.plan.reacher.side} wrist does not turn so far: the palm is {off:.0f} mm"
        task.note(f"{told} and {turned:.0f} degrees from what was asked")


def _shape(task: HumanTask, side: str) -> Fingers:
    """The links of the fingers and their rotations (n, 4) at the end; none where they are to stay.

    Round things come between fingers and thumb: that stands out of the palm, so that it passes them.
    """
    links = list(fingers(side)) if task.parameter("open", True) else []
    sign = 1.0 if side == "left" else -1.0
    thumb = from_axis_angle(np.array([[0.0, 0.0, sign], [0.0, 0.0, sign]]), np.array([THUMB, 0.0]))
    return links, opened(side, thumb if goal_of(task).around is not None else None)[: len(links)]


if __name__ == "__main__":
    run(reach)
