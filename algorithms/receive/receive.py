"""Taking what somebody gives: one turns to them, waits until it is held out, closes a hand on it, and draws it near.

It is held out when it is about half-way between both and still, and came there from where the giver had it, or has
long been there: what has just been drawn near is still as well. Where it was moved while the hand came, the hand comes
again. It comes from the side that is free of the other's. When it has closed, both stand still until the thing has
changed hands, and who has it now until the other's hand is away from it.
"""

from __future__ import annotations

from collections.abc import Generator, Iterable, Iterator, Sequence

import numpy as np

from ahmss.algorithm import HumanPose, HumanTask, Transform, run
from ahmss.algorithm.messages import Goal as MessageGoal
from ahmss.algorithm.place import WorldObject
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE
from ahmss.body.links import fingers
from ahmss.body.quaternion import from_axis_angle, rotate, slerp
from ahmss.errors import AlgorithmError
from ahmss.grasping.hand import Hand
from ahmss.grasping.power import power_at
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.edit import floor_frame
from ahmss.motion.fingers import opened
from ahmss.motion.steps import Steps
from ahmss.reaching.goal import Goal, palms_of
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.reacher import Reacher, seat
from ahmss.skills.at_ease import at_ease
from ahmss.skills.beside_hand import InHand, in_their_hand
from ahmss.skills.company import eye_of
from ahmss.skills.grasping import Closing, closing, closing_into, field_at, read_shape
from ahmss.skills.held_out import until_held_out
from ahmss.skills.margins import Margin, margins
from ahmss.skills.meanwhile import waited
from ahmss.skills.meeting import again
from ahmss.skills.out_of_reach import tell_missed
from ahmss.skills.planning import planned
from ahmss.skills.reaching import Looking, goal_of, performed, prisms_of
from ahmss.skills.sitting import seat_of

MOVED, TRIES = 0.04, 3  # metres that it may have moved while the hand came to it; times that the hand comes
ASLANT = np.radians([40.0, -40.0])  # from square to a margin, where a wrist needs it
TOO_FAR = 0.12  # metres from palm to thing beyond which closing the hand would catch nothing
OPPOSITE = np.radians([75.0, 105.0, 135.0])  # how far from straight opposite the giver's palm the own one may come
AS_OPPOSITE = 0.3  # of a cosine: what is opposite by less so, where a thing can be taken from one side only
BEFORE, AT = 0.03, 0.01  # metres before where it holds that a hand comes first; that it may be beside there
THUMB = np.radians(92.0)  # from along the hand, before it opens further
CLOSES, FIRMLY, DRAWS = 0.45, 0.3, 0.9  # seconds
GONE, LETS_GO = 0.1, 1.3  # metres by which the giver's opened hand has gone back; seconds that one waits for it
CARRIED = np.array([0.30, 0.20, 0.60])  # ahead, to the hand's side, height: shares of 1 m, 1 m and the stature
SEATED = 0.72  # of the height of the eyes of who sits
X = np.array([1.0, 0.0, 0.0])


def receive(task: HumanTask) -> Iterator[Array | HumanPose]:
    """Frames (n, 260) until the thing is before one's own body."""
    whom, side = task.goal_object, task.hand or "right"
    if whom is None or task.object is None:
        raise AlgorithmError("receive what, and from whom?")
    read_shape(task)
    first = None
    for _ in range(TRIES):
        yield from until_held_out(task, whom)
        task.arrived()
        begun = again(task)
        first = first or begun
        goal = _goal(begun)
        gaze = Looking(begun, goal.place)
        reaching = Reaching(begun.human, begun.start.rotations, begun.start.root)
        sides = list(margins(begun, side))
        held = None if sides else (yield from gaze.during(_in_hand(begun, whom, goal)))
        goals = (
            _at_margins(begun, side, sides, goal)
            if sides
            else (yield from gaze.during(_about(begun, whom, side, goal, held)))
        )
        plan = yield from _easiest(begun, goals, gaze, reaching)
        made = yield from performed(begun, reaching, plan, gaze, _opened(side))
        tell_missed(task, plan)
        rows = at_ease(begun, begun.block(made.rotations, made.root, made.importance, made.targets))
        yield rows
        if float(np.linalg.norm(task.object.place - begun.object.place)) < MOVED:
            break
    closes = _held_at(task, sides, plan.palm, side, round(CLOSES * task.rate))
    end, _ = yield from waited(_closing(closes, side, held, plan.palm), rows[-1:])
    closed = _closed(closes, side, end, rows[-1])
    yield closed
    pose = HumanPose.of(closed[-1])
    yield task.pose(pose.rotations, pose.root, pose.importance, pose.targets, {"held": "here"})
    yield from _until_let_go(task, whom, closed[-1:])
    if held is not None:
        yield from _firmly(task, side, held, pose)
    yield at_ease(task, _drawn(task, side, pose, first))


def _easiest(task: HumanTask, goals: Iterable[Goal], gaze: Looking, reaching: Reaching) -> Generator[Array, None, Plan]:
    """The plan of a reach to the first goal that the arm comes to as it should, or nearest to it.

    Raises:
        AlgorithmError: all are out of reach; says by how much.
    """
    best, refused = None, None
    for goal in goals:
        try:
            plan = yield from planned(task, reaching, goal, gaze, prisms_of(task))
            if best is None or plan.arm.found or plan.arm.cost < best.arm.cost:
                best = plan
            if plan.arm.found:
                break
        except AlgorithmError as error:
            refused = error
        yield gaze.alone()
    if best is None:
        assert refused is not None
        raise refused
    return best


def _at_margins(task: HumanTask, side: str, sides: list[Margin], goal: Goal) -> Iterator[Goal]:
    """Something flat: at a margin that the giver does not hold, and then those too that the hand comes to aslant."""
    for aslant in (None, *ASLANT):
        if aslant is not None:
            sides += margins(task, side, aslant)
        yield Goal(goal.place, palms={side: np.concatenate([margin.palms for margin in sides])})


def _held_at(task: HumanTask, sides: Sequence[Margin], palm: Array, side: str, frames: int) -> HumanTask:
    """The task of closing the hand: at the margin where it is (7,), if the thing has margins."""
    if not sides:
        return again(task, hand=side, frames=frames)
    here = min(sides, key=lambda margin: float(np.linalg.norm(margin.palms[:, :3] - palm[:3], axis=1).min()))
    return here.task(task, hand=side, frames=frames)


def _closing(task: HumanTask, side: str, held: InHand | None, palm: Array) -> Steps[Closing]:
    """How the hand closes that has come with its palm (7,) before the thing: past the giver's, if it can."""
    assert task.object is not None
    for holding in held.found if held is not None else ():
        there = task.object.frame.then(Transform.of(holding.palm))
        away = float(np.linalg.norm(there.apply(np.array([-BEFORE, 0.0, 0.0])) - palm[:3]))
        if held is not None and away < AT:
            return (yield from closing_into(task, side, holding, TOO_FAR, held.both))
    return (yield from closing(task, side, TOO_FAR))


def _goal(task: HumanTask) -> Goal:
    """Where the palm goes: as to a thing that stands."""
    return goal_of(again(task, goal=MessageGoal()))  # the thing, not who holds it


def _in_hand(task: HumanTask, whom: WorldObject, goal: Goal) -> Steps[InHand | None]:
    """The thing in the giver's hand, where that is around it."""
    if goal.around is None:
        return None
    assert task.object is not None
    assert task.site is not None
    field = field_at(task, task.object.frame.inverse().then(task.site).place)
    return (yield from in_their_hand(task, whom, _giving(task, whom).removesuffix("_hand"), field))


def _about(task: HumanTask, whom: WorldObject, side: str, goal: Goal, held: InHand | None) -> Steps[list[Goal]]:
    """The palms before it, where there is a choice opposite the palm of who holds it, and then from farther round.

    Of these first those from which the hand closes past that one.
    """
    reacher = Reacher.of(task.human, side)
    palms = palms_of(goal, reacher, reacher.shoulder(seat(task.human, task.start.rotations, task.start.root)))
    if goal.around is None:
        return [Goal(goal.place, palms={side: palms})]
    theirs = rotate(whom.site(_giving(task, whom), task.start.root).rotation, X)[:2]
    apart = rotate(palms[:, 3:], X)[:, :2] @ theirs
    sets = [apart < opposite for opposite in np.maximum(-np.cos(OPPOSITE), apart.min() + AS_OPPOSITE)]
    goals = [Goal(goal.place, palms={side: palms[some]}) for some in sets]
    if held is None:
        return goals
    assert task.object is not None
    frame, first = task.object.frame, np.argsort(apart)
    seen, axis = (frame.inverse().then(Transform.of(rows)).row() for rows in (palms[first], goal.around))
    grips = held.holdings(Hand.of(task.human, side), seen, axis, _opened(side)[1], BEFORE)
    held.found.extend((yield from grips))
    if held.found:
        before = frame.then(Transform.of(np.array([holding.palm for holding in held.found]))).row()
        before[:, :3] -= BEFORE * rotate(before[:, 3:], X)
        goals.insert(0, Goal(goal.place, palms={side: before}))
    return goals


def _opened(side: str) -> tuple[list[int], Array]:
    """The fingers as for something that comes between them and the thumb."""
    sign = 1.0 if side == "left" else -1.0
    thumb = from_axis_angle(np.array([[0.0, 0.0, sign], [0.0, 0.0, sign]]), np.array([THUMB, 0.0]))
    return list(fingers(side)), opened(side, thumb)


def _closed(task: HumanTask, side: str, end: Closing, last: Array) -> Array:
    """POSE rows (n, 260) in which the hand closes, the body as in the last row (260,) of the reach."""
    n, hand = task.length, list(fingers(side))
    rows = np.repeat(last[None], n, axis=0)
    time = np.arange(1, n + 1) / n
    rotations, targets = rows[:, 4:176].reshape(n, 43, 4), rows[:, 220:260].reshape(n, 5, 8)
    present = task.start.rotations[hand]
    if end.wide is None:
        rotations[:, hand] = slerp(present, end.shape, minimum_jerk(time)[:, None])
    else:
        wide = slerp(present, end.wide, minimum_jerk(time / 0.5)[:, None])
        late = minimum_jerk((time - 0.5) / 0.5)[:, None]
        rotations[:, hand] = np.where(late[..., None] > 0.0, slerp(end.wide, end.shape, late), wide)
    row, grip, done = targets[:, 0 if side == "right" else 1], task.start.grip(side), minimum_jerk(time / 0.75)
    row[:, :3] = grip.place + done[:, None] * (end.palm.place - grip.place)
    row[:, 3:7] = slerp(grip.rotation, end.palm.rotation, done)
    row[:, 7] = 1.0
    rows[:, [176 + link for link in hand]] = 1.0
    return rows


def _until_let_go(task: HumanTask, whom: WorldObject, row: Array) -> Iterator[Array]:
    """The row (1, 260) again until the giver's hand has left the thing, else drawn through its fingers."""
    hand = _giving(task, whom)
    had = whom.site(hand, task.start.root).place
    for _ in range(round(LETS_GO * task.rate)):
        yield row.copy()
        if float(np.linalg.norm(whom.site(hand, task.start.root).place - had)) > GONE:
            return


def _firmly(task: HumanTask, side: str, held: InHand, pose: HumanPose) -> Generator[Array, None, None]:
    """Frames (n, 260) in which the fingers close on the thing alone, the palm where it is.

    The pose is left as it then is.
    """
    thing, site, hand = task.object, task.site, list(fingers(side))
    assert thing is not None
    assert site is not None
    to_thing = thing.frame.inverse()
    palm = to_thing.then(task.present.grip(side)).row()
    row = task.block(pose.rotations[None], pose.root[None], pose.importance, pose.targets[None])
    holding, _ = yield from waited(
        power_at(Hand.of(task.human, side), held.thing, palm, to_thing.then(site).row()), row
    )
    if not holding.holds:
        return
    n = round(FIRMLY * task.rate)
    done = minimum_jerk(np.arange(1, n + 1) / n)[:, None]
    rows = np.repeat(row, n, axis=0)
    rows[:, 4:176].reshape(n, 43, 4)[:, hand] = slerp(pose.rotations[hand], holding.shape, done)
    yield rows
    pose.rotations[hand] = holding.shape


def _giving(task: HumanTask, whom: WorldObject) -> str:
    """The site of their palm that is nearest to the thing."""
    assert task.object is not None
    thing = task.object.place
    return min(
        ("right_hand", "left_hand"),
        key=lambda hand: float(np.linalg.norm(whom.site(hand, task.start.root).place - thing)),
    )


def _drawn(task: HumanTask, side: str, pose: HumanPose, begun: HumanTask) -> Array:
    """POSE rows (n, 260): the trunk straightens, and the hand brings the thing before the own body, turned as it is."""
    n = round(DRAWS * task.rate)
    done = minimum_jerk(np.arange(1, n + 1) / n)[:, None]
    here = Transform(*floor_frame(begun.start.rotations, begun.start.root))
    at = CARRIED * np.array([1.0, 1.0 if side == "left" else -1.0, task.human.stature])
    if seat_of(task) is not None:
        at[2] = SEATED * eye_of(begun)[2]
    rotations = np.repeat(pose.rotations[None], n, axis=0)
    body = [i for i in range(len(rotations[0])) if i not in fingers(side)]
    rotations[:, body] = slerp(pose.rotations[body], begun.start.rotations[body], done)
    root = pose.root + done * (begun.start.root - pose.root)
    targets = np.repeat(pose.targets[None], n, axis=0)
    row = 0 if side == "right" else 1
    grip = task.present.grip(side)
    targets[:, row, :3] = grip.place + done * (here.apply(at) - grip.place)
    targets[:, row, 3:7], targets[:, row, 7] = grip.rotation, 1.0
    targets[:, GAZE, 7] *= 1.0 - done[:, 0]
    return task.block(rotations, root, pose.importance, targets)


if __name__ == "__main__":
    run(receive)
