"""Laying down what is held: it comes over its place, sinks, and the hand opens and draws back the way that it took it.

Where the hand is not to let go, it stays as it has put it there. Who does not reach so far steps to where they do,
where the action names a walk library.

The place is the goal that was said, its own x turned as the human faces away from it; or the site `rest` of what
contains it, as a cradle.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ahmss.algorithm import HumanTask, Transform, run
from ahmss.algorithm.place import WorldObject
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.errors import AlgorithmError
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.goal import Goal
from ahmss.reaching.leaning import Stretch
from ahmss.reaching.performing import Fingers, Performed
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.prism import Prism, clearance, in_the_way
from ahmss.reaching.reacher import Reacher, heading_of
from ahmss.reaching.skin import skin_of
from ahmss.skills.around import half_closed, half_of
from ahmss.skills.at_ease import at_ease
from ahmss.skills.letting_go import letting_go
from ahmss.skills.nearer import gone_nearer
from ahmss.skills.out_of_reach import tell_missed
from ahmss.skills.own_arm import in_own_arm
from ahmss.skills.own_head import at_own_head, in_own_head
from ahmss.skills.past_oneself import past_oneself
from ahmss.skills.planning import planned
from ahmss.skills.reaching import Looking, performed, prisms_of
from ahmss.skills.sunk import SUNK, sunk

OVER, BACK = 0.06, 0.15  # metres over its place to which it comes first; by which the hand is drawn back
SINKS, RESTS, OPENS, LEAVES = 0.4, 0.1, 0.3, 0.45  # seconds
TURNS = np.radians([0.0, -12.0, 12.0])  # of what is laid down anywhere
ANYHOW = np.radians(np.arange(-180.0, 180.0, 20.0))  # the same where the hand that has it can't so, held at a side, say
MOST_OFF, MOST_ASKEW = 0.005, 3.0  # metres and degrees by which it may come down beside its place
WITHIN = 0.01  # metres: a place that is so deep in a thing is in it, and not on it
EVERY, DEEP = 3, 0.004  # frames; metres in a thing that an arm may be by what its skin is told to be
STRETCHED = 0.98  # of the arm's length, at the end: farther one steps nearer
SURELY = 0.955  # the same from where one will stand
LATER = 0.55  # seconds by which the head turns later than the hand that has something at it comes off
BOWED, LOW = (
    np.cos(np.radians(60.0)),
    0.6,
)  # of a trunk: farther one steps nearer; of the hips' height: to what is lower not
TOUCHES = 0.2  # of the arm on its way, from where on it is tried from elsewhere
UP = np.array([0.0, 0.0, 1.0])


def lay_down(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260): it comes over its place and sinks; the hand opens and goes back."""
    if task.object is None or not task.hand:
        raise AlgorithmError("nothing is in the hand")
    if task.carried:
        raise AlgorithmError("stand still to lay it down; walk there first")
    held = task.start.grip(task.hand).inverse().then(task.object.frame).inverse()
    _refuse_sunk(task, held)
    place = _rests(task, 0.0, TURNS).place[0]
    gaze = Looking(task, place, after=LATER if at_own_head(task, task.hand, held.inverse()) else None)
    laid = yield from _laid(task, held, gaze)
    if (isinstance(laid, AlgorithmError) or laid.poor) and task.library is not None:
        goal = partial(_goal, task, held, turns=ANYHOW)
        try:
            task, gaze = yield from gone_nearer(
                task, gaze.place, goal, gaze, _prisms(task), partial(_lacks, task, most=SURELY)
            )
        except AlgorithmError as error:
            if isinstance(laid, AlgorithmError):
                raise
            if laid.bad:
                raise AlgorithmError(f"from here {laid.bad}, and {error}") from None
        else:
            laid = yield from _laid(task, held, gaze)
            if isinstance(laid, AlgorithmError):
                why = str(laid).partition(";")[0]
                raise AlgorithmError(f"{why}, even from where one stands nearest to it; say a place that is easier")
    if isinstance(laid, AlgorithmError):
        raise laid
    task.arrived()
    tell_missed(task, laid.plan)
    yield at_ease(task, laid.rows)


def _refuse_sunk(task: HumanTask, held: Transform) -> None:
    """Refuse a place where fingers would be in what it is laid on however it is turned, as in the middle of a table.

    Raises:
        AlgorithmError: they would; says by how much at the least.
    """
    assert task.object is not None
    least = float(_sunk(task, _goal(task, held, 0.0, ANYHOW)).min())
    if least >= SUNK:
        raise AlgorithmError(
            f"fingers would be {1000.0 * least:.0f} mm in what {task.object.name} is laid on; say a place where they "
            "come under it, its edge over that of a desk"
        )


def _sunk(task: HumanTask, goal: Goal) -> Array:
    """Metres (n) that the hand is in things with palms of a goal, but in what holds that place, as a shelf does."""
    shape = task.start.rotations[list(fingers(task.hand))]
    return sunk(task, task.hand, goal.palms[task.hand], shape, _about(task, goal.place), _grip(task))


def _about(task: HumanTask, place: Array) -> list[Prism]:
    """What is about a place (3,) but what holds it."""
    return [one for one in _prisms(task) if not one.sought and float(one.signed(place)) > -WITHIN]


def _lacks(task: HumanTask, arm: Stretch, most: float = STRETCHED) -> str:
    """What an arm lacks to lay something down well, stretched by so much of its length at the most, as a clause; ""."""
    short = (arm.stretched - most) * Reacher.of(task.human, task.hand).length
    if short > 0.0:
        return f"the {task.hand} arm is {max(short, 0.01):.2f} m too short to lay it there at ease"
    return "" if arm.found else f"the {task.hand} hand can't be turned so that it stands there"


@dataclass(frozen=True)
class Laid:
    """POSE rows (n, 260) of it, and its plan; poor: whether the arm is in things, beyond its limits or stretched out,
    or one bends flat over something; bad: why one had better leave it, as a clause, or "".
    """

    rows: Array
    plan: Plan
    poor: bool
    bad: str


def _laid(task: HumanTask, held: Transform, gaze: Looking) -> Generator[Array, None, Laid | AlgorithmError]:
    """It laid down from here, as it lies best, else turned as the hand that has it can; or why that can't be."""
    assert task.object is not None
    reaching = Reaching(task.human, task.start.rotations, task.start.root)
    named = task.object.sites.get(task.message.site)
    is_round = named is not None and named.free_axis == "z"
    found: Laid | AlgorithmError | None = None
    for turns in (ANYHOW,) if is_round else (TURNS, ANYHOW):
        goal = _goal(task, held, heading_of(task.start.rotations, task.start.root), turns)
        clear = _sunk(task, goal) < SUNK
        if turns is TURNS and not clear.any():
            continue
        if clear.any():
            goal = replace(goal, palms={task.hand: goal.palms[task.hand][clear]})
        try:
            plan = yield from planned(task, reaching, goal, gaze, _prisms(task), OVER * UP, most=MOST_OFF)
            found = yield from _performed(task, held, reaching, plan, gaze)
        except AlgorithmError as error:
            found = error
            continue
        break
    assert found is not None
    return found


def _performed(
    task: HumanTask, held: Transform, reaching: Reaching, plan: Plan, gaze: Looking
) -> Generator[Array, None, Laid]:
    """The frames of a plan, and of what follows it.

    Raises:
        AlgorithmError: as the arm is, it would not come to its place, or not lie there upright; says by how much.
    """
    assert task.object is not None
    palm = np.concatenate([plan.palm[:3] - OVER * UP, plan.palm[3:]])
    links = list(fingers(task.hand))
    shape = task.start.rotations[links]
    then, open_by, off = _then(task, held, palm)
    made = yield from _past_oneself(task, held.inverse(), reaching, plan, gaze, (links, shape), then)
    length = len(made.root) - len(then)
    palms, about = made.targets[length:, plan.reacher.row, :7], _about(task, _rests(task, 0.0, TURNS).place[0])
    made.rotations[length:, links] = letting_go(task, palms, shape, open_by, minimum_jerk(off / BACK), about)
    down = length + int(np.flatnonzero(open_by <= 0.0)[-1])
    there = made.targets[down, plan.reacher.row]
    off = float(np.linalg.norm(there[:3] - palm[:3]))
    askew = float(np.degrees(2.0 * np.arccos(min(1.0, abs(float(there[3:7] @ palm[3:]))))))
    if off > MOST_OFF or askew > MOST_ASKEW:
        raise AlgorithmError(
            f"from here {task.object.name} would come down {1000.0 * off:.0f} mm beside its "
            f"place and {askew:.0f} degrees askew, as far as the {task.hand} arm goes; say a place that is easier"
        )
    lacks, depth = _lacks(task, plan.arm), _depth(task, made)
    deep = f"the {task.hand} arm would be {1000.0 * depth:.0f} mm in something" if depth > DEEP else ""
    poor = bool(lacks or deep) or made.flaw > TOUCHES or _bows(task, made.rotations[down], made.root[down], palm[2])
    rows = task.block(made.rotations, made.root, made.importance, made.targets)
    return Laid(rows, made.plan, poor, lacks or deep)


def _bows(task: HumanTask, rotations: Array, root: Array, height: float) -> bool:
    """Whether who is so, (43, 4), (3,), bends flat over something to lay it down that high."""
    _, turned = forward(rotations, root, task.human.offsets)
    upright = float(rotate(turned[INDEX["spine"]], np.array([1.0, 0.0, 0.0]))[2])
    return upright < BOWED and height > LOW * task.start.root[2]


def _past_oneself(
    task: HumanTask,
    in_palm: Transform,
    reaching: Reaching,
    plan: Plan,
    gaze: Looking,
    shape: Fingers,
    then: Array,
) -> Generator[Array, None, Performed]:
    """The frames of a plan, by a way on which what is carried goes past the other arm and the head, if there is one."""
    tried: list[Performed] = []

    def perform(way: Plan) -> Generator[Array, None, Performed]:
        tried.append((yield from performed(task, reaching, way, gaze, shape, then)))
        return tried[-1]

    def deepest(made: Performed) -> tuple[float, Array]:
        return max((of(task, made, in_palm) for of in (in_own_arm, in_own_head)), key=lambda one: one[0])

    first = plan.turned_late() if at_own_head(task, task.hand, in_palm) else plan
    best = yield from past_oneself(first, perform, deepest)
    if best is not tried[-1] and (task.length or best.looked < 1.0):  # the eyes have gone on since it was made
        return (yield from performed(task, reaching, best.plan, gaze, shape, then))
    return best


def _depth(task: HumanTask, made: Performed) -> float:
    """Metres by which forearm or hand are in things at some frame, the last ones too; what one sits on is none."""
    points, radii = skin_of(made.plan.reacher, made.rotations[::EVERY], made.root[::EVERY])
    far = float(radii.max())
    low, high = points.min(axis=(0, 1)) - far, points.max(axis=(0, 1)) + far
    around = in_the_way(_prisms(task), task.start.root, task.start.root)
    near = [prism for prism in around if not prism.sought and prism.meets(low, high)]
    return float((radii - clearance(near, points, far)).max()) if near else 0.0


def _goal(task: HumanTask, held: Transform, facing: float, turns: Array) -> Goal:
    """Where the hand goes of who faces so, radians; `held` is the palm in the frame of what it holds."""
    rests = _rests(task, facing, turns)
    palms = rests.then(Transform(np.repeat(held.place[None], len(rests.place), axis=0), held.rotation)).row()
    return Goal(rests.place[0], palms={task.hand: palms})


def _rests(task: HumanTask, facing: float, turns: Array) -> Transform:
    """The frames (n) in which it may lie, of who faces so, radians, turned by so many (n) from towards them.

    Raises:
        AlgorithmError: neither a place was said, nor does it belong anywhere.
    """
    assert task.object is not None
    if task.goal_place is not None:
        turned = from_axis_angle(UP, facing + np.pi + turns)
        return Transform(np.repeat(task.goal_place[None], len(turned), axis=0), turned)
    home = _home(task)
    if home is None:
        raise AlgorithmError(f"{task.object.name} belongs nowhere here; say a place, as: to X Y Z")
    frame = home.site(task.parameter("rest", ""), task.start.root)
    return Transform(frame.place[None], frame.rotation[None])


def _home(task: HumanTask) -> WorldObject | None:
    """What contains it and has a place for it, where it is to lie there."""
    assert task.object is not None
    rest, inside = task.parameter("rest", ""), task.object.name.rpartition("/")[0]
    if task.goal_place is not None:
        return None
    return next((thing for thing in task.world.values() if thing.name == inside and rest in thing.sites), None)


def _prisms(task: HumanTask) -> list[Prism]:
    """What may be in the way; into what it is laid the fingers that hold it come, too."""
    return prisms_of(task, _home(task))


def _then(task: HumanTask, held: Transform, palm: Array) -> tuple[Array, Array, Array]:
    """Palms (n, 7) from over the place down to it, and away; how far the hand is open (n); metres that it is off."""
    seconds = (SINKS, RESTS, OPENS, LEAVES) if task.parameter("let_go", True) else (SINKS, RESTS, 0.0, 0.0)
    counts = [round(each * task.rate) for each in seconds]
    share = [minimum_jerk(np.arange(1, count + 1) / count) for count in counts]
    zero = [np.zeros(count) for count in counts]
    over = np.concatenate([1.0 - share[0], zero[1], zero[2], zero[3]])
    away = np.concatenate([zero[0], zero[1], zero[2], share[3]])
    palms = np.repeat(palm[None], len(over), axis=0)
    palms[:, :3] += OVER * over[:, None] * UP + BACK * away[:, None] * _back(task, held, palm)
    opens, leaves = (1.0 - half_of(_grip(task))) * share[2], 1.0 - half_closed(BACK * share[3], _grip(task))
    open_by = np.concatenate([zero[0], zero[1], opens, leaves])
    return palms, open_by, BACK * away


def _grip(task: HumanTask) -> str | None:
    """How the site says that it is held."""
    named = None if task.object is None else task.object.sites.get(task.message.site)
    return None if named is None else named.grip


def _back(task: HumanTask, held: Transform, palm: Array) -> Array:
    """The direction (3,) in which the opened hand leaves: back from a pinch, away from the palm of a fist."""
    assert task.object is not None
    named = task.object.sites.get(task.message.site)
    if named is None or named.grip != "precision":
        return rotate(palm[3:], np.array([-1.0, 0.0, 0.0]))
    site = held.inverse().then(Transform(np.array(named.position), np.array(named.rotation)))
    return -rotate(multiply(palm[3:], site.rotation), np.array([1.0, 0.0, 0.0]))


if __name__ == "__main__":
    run(lay_down)
