"""Controls on a panel: where one stands to use one, which neighbours a hand must not touch, and the steps there.

A control's frame has x out of the panel and z up along it, so that its y axis is to the right of who stands before it.
What it fills, its property `box` says, and who uses another leaves it alone. What the shipped algorithms that use
controls share, and an author may use.
"""

from __future__ import annotations

import itertools
from collections.abc import Generator, Iterable, Iterator, Sequence

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.errors import AlgorithmError
from ahmss.motion.steps import Steps
from ahmss.reaching.goal import Goal
from ahmss.reaching.leaning import Stretch, stretch_of
from ahmss.reaching.plan import Reaching
from ahmss.reaching.prism import Prism
from ahmss.reaching.reacher import Reacher
from ahmss.skills.arm_clear import standing_about, sunk_at
from ahmss.skills.before_it import all_before, around_it, before, front_of
from ahmss.skills.begun import begun_at
from ahmss.skills.box import Box, boxes_of, nearest
from ahmss.skills.neighbours import neighbours
from ahmss.skills.out_of_reach import EXACT, MOST_MISSING
from ahmss.skills.reaching import Looking, prisms_of, sides_of
from ahmss.skills.sighting import Sighting
from ahmss.skills.sitting import seat_of
from ahmss.skills.stands import is_taken, stance_at, standing
from ahmss.skills.stepping import ground_of, stepped, walk_library
from ahmss.walking import goals
from ahmss.walking.journey import Standing, footing
from ahmss.walking.obstacles import NEAREST, Obstacles

__all__ = [
    "around_it", "before", "beside", "clear_of", "front_of", "gone_to", "in_the_way", "is_control",
    "stood_before",
    "stretch_from",
]  # fmt: skip

_UP = np.array([0.0, 0.0, 1.0])
_SKIN, _NEARLY = 0.012, 0.002  # metres that the bones of a hand keep from what is beside a control
_FAR = 0.05  # metres: what is farther is as clear as can be
_FLAT = 0.004  # metres: what is no higher is in nobody's way
_AWAY = (0.54, 0.62, 0.46, 0.7, 0.38, 0.3)  # metres from the control to who stands before it, level; the best first
_ASIDE = 0.14  # metres that the hand's own side is before the control
_BESIDE = tuple(
    itertools.product((0.3, 0.42, 0.5, 0.56, 0.62), (0.54, 0.62, 0.46, 0.38))
)  # the same two, beside who stands there
_AT_EASE, _FROM_HERE = (
    0.9,
    1.02,
)  # of the arm's length: where one would stand; up to where one leans instead of stepping
_FACING = np.radians(55.0)  # that a control is aside of who uses it from where they stand
_SEEN_FROM = np.cos(np.radians(70.0))  # how far aside of a control's axis one may stand to use it
_MOST = 12.0  # metres that are walked to a control
_SUNK = 1000.0  # what a metre costs that an arm is in what a control is on
_LOW = 0.5  # of the hips' height: who is taller reaches no better what is under it
_STANDS_THERE = (0.05, np.radians(6.0))  # metres, radians
_SPARSE = 3  # every so many palms show how easily an arm comes there
_HEAD = INDEX["head"]
_OF_HEAD = slice(4 + 4 * _HEAD, 8 + 4 * _HEAD)  # its rotation in a row


def is_control(task: HumanTask) -> bool:
    """Whether the task's object is a control, before which one stands at ease to use it."""
    return task.object is not None and "box" in task.object.properties


def beside(task: HumanTask) -> list[Box]:
    """What the other controls fill near the one that is used."""
    return [box for thing in neighbours(task) for box in boxes_of(thing)]


def clear_of(boxes: Sequence[Box], palms: Array, points: Array) -> Array:
    """Of palms (n, 7) those whose hands' points (n, m, 3) are clear of boxes; the clearest where none is."""
    if not boxes:
        return palms
    gap = nearest(boxes, points, _FAR)
    return palms[gap > min(_SKIN, float(gap.max()) - _NEARLY)]


def in_the_way(task: HumanTask) -> list[Prism]:
    """What a hand on its way to a control keeps clear of: what stands about, its neighbours among that."""
    return [prism for prism in prisms_of(task) if not prism.sought and prism.high - prism.low > _FLAT]


def stood_before(
    task: HumanTask, goal: Goal, prisms: Sequence[Prism], gaze: Looking | None = None
) -> Generator[Array, None, tuple[HumanTask, Looking]]:
    """The task from where the control can be used, as it is or after steps (n, 260) to there; and the gaze on its way.

    Args:
        task: who uses the control; without a walk library nobody steps. goal: of the hand, its palms known.
        prisms: what may be in the way. gaze: where it is on its way already.

    Raises:
        AlgorithmError: no place to stand serves; says by how much the arm is too short from the best.
    """
    task, gaze = yield from _stood(task, goal, prisms, Looking(task, goal.place) if gaze is None else gaze)
    task.arrived()
    return task, gaze


def _stood(
    task: HumanTask, goal: Goal, prisms: Sequence[Prism], gaze: Looking
) -> Generator[Array, None, tuple[HumanTask, Looking]]:
    """As `stood_before`, before that is told."""
    assert task.object is not None
    if task.library is None:
        return task, gaze
    reaching = Reaching(task.human, task.start.rotations, task.start.root)
    here = yield from gaze.during(_stretch(task, reaching, goal))
    inside = "" if seat_of(task) else _stands_in(task)
    if inside:
        task.note(f"steps out of {inside}, which was moved onto where one stands")
    elif here.stretched < _FROM_HERE and here.found and _faces(task):
        return task, gaze
    stand = yield from gaze.during(_best_stand(task, goal, prisms))
    try:
        return (yield from gone_to(task, stand, gaze))
    except AlgorithmError:
        if not is_taken(stand, standing(task)):
            raise
        task = begun_at(task, task.present.rotations, task.present.root)  # they came meanwhile: one goes beside them
        gaze = Looking(task, goal.place)
        there = yield from gaze.during(_best_stand(task, goal, prisms))
        if is_taken(there, standing(task)):
            raise
    return (yield from gone_to(task, there, gaze))


def gone_to(
    task: HumanTask, stand: goals.Goal, gaze: Looking, to: str = ""
) -> Generator[Array, None, tuple[HumanTask, Looking]]:
    """The task from where one uses its control, after steps (n, 260) to there, the eyes on it while it is ahead.

    A gaze that is later than the hand stays as it is on the way, and with it the head, for what a hand has at it.

    Args:
        task: whose control. stand: where. gaze: on its way. to: what one steps to; left out: the task's object.

    Raises:
        AlgorithmError: it is too far, or nobody gets there.
    """
    assert task.object is not None
    steps = stepped(task, stand, ground_of(task), near=_STANDS_THERE, most=_MOST, to=to or task.object.name)
    watching = Sighting(gaze, float(gaze.turned(np.array([gaze.frames]))[0]), task.rate)
    while True:
        try:
            rows = next(steps)
        except StopIteration as end:
            if gaze.later:
                end.value.rotations[_HEAD] = task.start.rotations[_HEAD]
            moved = begun_at(task, end.value.rotations, end.value.root)
            return moved, gaze.of(moved) if gaze.later else watching.goes_on(moved)
        if gaze.later:
            rows = rows.copy()
            rows[:, _OF_HEAD] = task.start.rotations[_HEAD]
        yield rows if gaze.later else watching.over(rows)


def _faces(task: HumanTask) -> bool:
    """Whether the human stands before the control and looks there, more or less."""
    assert task.object is not None
    standing = Standing.of(task.human, walk_library(task))
    now = footing(task.human, task.start.rotations, task.start.root, standing)
    off = task.object.place[:2] - now.place
    length = max(float(np.linalg.norm(off)), 1e-9)
    aside = (np.arctan2(off[1], off[0]) - now.heading + np.pi) % (2.0 * np.pi) - np.pi
    return bool(abs(aside) < _FACING and -off @ front_of(task.object.frame) / length > _SEEN_FROM)


def _stands_in(task: HumanTask) -> str:
    """The thing that stands where the human stands; "" where none does."""
    ground = ground_of(task)
    around = Obstacles.of(ground.outlines, 0.0, names=ground.names)
    if not len(around.shapes):
        return ""
    near = around.clearance(task.start.root[:2])
    i = int(near.argmin())
    return around.names[i] if near[i] < 0.5 * NEAREST else ""


def _best_stand(task: HumanTask, goal: Goal, prisms: Sequence[Prism]) -> Steps[goals.Goal]:
    """Where the arm comes to the control most easily.

    Raises:
        AlgorithmError: nowhere; says by how much it is too short.
    """
    assert task.object is not None
    taken, plates = standing(task), standing_about(task)
    found = yield from _easiest(task, goal, _before_it(task, goal), plates)
    assert found is not None
    if found[3]:  # the arm would be in what the control is on: from beside it, facing it, perhaps not
        around = [(side, stand) for stand in around_it(task) for side in _sides(task, goal)]
        other = yield from _easiest(task, goal, around, plates)
        found = other if other is not None and other[0] < found[0] else found
    stand = found[1]
    if is_taken(stand, taken):
        beside_them = yield from _easiest(task, goal, _before_it(task, goal, _BESIDE), plates, taken)
        if beside_them is not None:
            _, there, arm, _ = beside_them
            if arm.found and arm.stretched < _FROM_HERE:
                return there
            if (yield from _leant(task, there, goal, prisms))[1].missing <= EXACT:
                return there
    side, arm = yield from _leant(task, stand, goal, prisms)
    if arm.missing > MOST_MISSING:
        x, y = stand.place.tolist()
        raise AlgorithmError(
            f"{task.object.name} is out of reach: the {side} arm is {arm.missing:.2f} m too short for it, even "
            f"from where one stands nearest to it, at {x:.2f} {y:.2f}; {_instead(task)}"
        )
    return stand


def _instead(task: HumanTask) -> str:
    """What to do where a control is out of reach."""
    assert task.object is not None
    height = float(task.object.place[2])
    if height < _LOW * task.start.root[2]:
        return f"it is only {height:.2f} m high: move it higher"
    return "have somebody taller do it, or move it"


def _leant(task: HumanTask, stand: goals.Goal, goal: Goal, prisms: Sequence[Prism]) -> Steps[tuple[str, Stretch]]:
    """The better arm of who would stand there, and how it comes to the goal, leaning."""
    reaching = stance_at(task, stand)
    reacher, (_, _, arm) = yield from reaching.better(goal, _sides(task, goal), prisms)
    return reacher.side, arm


def _before_it(
    task: HumanTask, goal: Goal, places: Iterable[tuple[float, float]] = tuple(itertools.product((_ASIDE,), _AWAY))
) -> Iterator[tuple[str, goals.Goal]]:
    """Hands, and for each where one stands, so far to the hand's other side and so far away, facing as the control."""
    places = list(places)
    for side in _sides(task, goal):
        own = 1.0 if side == "right" else -1.0
        for stand in all_before(task, [(away, own * aside) for aside, away in places]):
            yield side, stand


def _easiest(
    task: HumanTask,
    goal: Goal,
    stands: Iterable[tuple[str, goals.Goal]],
    plates: Sequence[Prism],
    taken: Sequence[Array] = (),
) -> Steps[tuple[float, goals.Goal, Stretch, float] | None]:
    """Of hands and stands the best: what it costs, how the arm comes from there, and how deep it is in plates, metres.

    None: all are too near to those taken.
    """
    best: tuple[float, goals.Goal, Stretch, float] | None = None
    served = ""
    for side, stand in stands:
        if side == served or is_taken(stand, taken):
            continue
        reaching = stance_at(task, stand)
        arm = yield from _stretch(task, reaching, goal, (side,))
        deep = sunk_at(reaching, {side: reaching.palms(Reacher.of(task.human, side), goal)}, goal.place, plates)
        worth = arm.cost + 40.0 * max(arm.stretched - _AT_EASE, 0.0) + (0.0 if arm.found else 20.0)
        worth += _SUNK * deep
        if best is None or worth < best[0]:
            best = worth, stand, arm, deep
        if arm.found and arm.stretched < _AT_EASE and not deep:
            served = side
        else:
            yield
    return best


def stretch_from(task: HumanTask, stand: goals.Goal, goal: Goal) -> Steps[Stretch]:
    """How the better arm of who would stand there comes to a goal, the trunk upright."""
    return (yield from _stretch(task, stance_at(task, stand), goal))


def _sides(task: HumanTask, goal: Goal) -> list[str]:
    """The hands that may be used and have palms there."""
    return [side for side in sides_of(task) if not goal.palms or side in goal.palms]


def _stretch(task: HumanTask, reaching: Reaching, goal: Goal, sides: tuple[str, ...] | None = None) -> Steps[Stretch]:
    """How the better arm comes to the goal, the trunk as it is."""
    found: list[Stretch] = []
    for side in _sides(task, goal) if sides is None else sides:
        reacher = Reacher.of(task.human, side)
        palms = reaching.palms(reacher, goal)[::_SPARSE]
        _, arm = yield from stretch_of(reacher, palms, reaching.base, reaching.present(reacher), ())
        found.append(arm)
        yield
    return min(found, key=lambda arm: (not arm.found, arm.cost))
