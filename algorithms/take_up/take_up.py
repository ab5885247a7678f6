"""Taking something up: the hand comes, closes, and brings it to the ear, or before the eyes.

Who does not reach so far steps to where they do, where the action names a walk library.

The reach is that of `reach`, the grip that of `grasp`. A left hand meets the site mirrored. How it is held to the ear,
`ahmss.skills.at_ear` says. What is read has its text facing along its z, and who reads it at its x.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ahmss.algorithm import HumanPose, HumanTask, Transform, run
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE
from ahmss.body.links import fingers
from ahmss.body.quaternion import from_axis_angle, multiply, rotate, slerp
from ahmss.errors import AlgorithmError
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import Holding, opener
from ahmss.grasping.power import power
from ahmss.grasping.precision import precision
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.steps import Steps
from ahmss.reaching.goal import Goal
from ahmss.reaching.leaning import Stretch, looking
from ahmss.reaching.performing import Performed, perform
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.prism import Prism
from ahmss.reaching.reacher import Reacher
from ahmss.skills.around import half_closed
from ahmss.skills.at_ear import brought_to_ear
from ahmss.skills.at_ease import at_ease
from ahmss.skills.meanwhile import waited
from ahmss.skills.nearer import gone_nearer, short_of
from ahmss.skills.off_target import off_target
from ahmss.skills.out_of_reach import EXACT, refuse_far, refuse_short, tell_missed
from ahmss.skills.planning import planned
from ahmss.skills.reaching import Looking, performed, prisms_of, sides_of
from ahmss.skills.reading import before_eyes
from ahmss.skills.sitting import seat_of
from ahmss.skills.sunk import SUNK, lain_on, sunk
from ahmss.skills.word import closed_at_last

BEFORE, LIFTS = 0.08, 0.05  # metres before the grip at which the open hand is set; by which it is lifted first
COMES, CLOSES, HOLDS, RISES = 0.35, 0.35, 0.1, 0.3  # seconds
SPARE = 0.004  # metres by which fingers keep out of that farther if they can: it is laid down a little otherwise
OUT = (0.0, 0.003, 0.006, 0.009)  # metres nearer to the edge of it that a margin is pinched, 15 mm from there else
TURNS = np.radians([-40.0, -20.0, 0.0, 20.0, 40.0])  # of the hand about the site's z
LOOKS = 0.3  # seconds in which one looks at what is read
UP, X = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])


@dataclass(frozen=True)
class Taking:
    """A grip: its palms (n, 7) in the world, turned in different ways, and the fingers that hold."""

    palms: Array
    holding: Holding


def take_up(task: HumanTask) -> Iterator[Array | HumanPose]:
    """Frames (n, 260): the hand comes, closes, lifts, and brings it there."""
    if task.site is None or task.object is None or task.object.shape is None:
        raise AlgorithmError("what is taken up needs a shape, and a site where a hand takes it")
    if task.carried:
        raise AlgorithmError("walk there first, then take it up")
    gaze, frame = Looking(task, task.site.place), task.object.frame
    yield gaze.alone()
    grips: dict[str, Taking] = {}
    for side in sides_of(task):
        grips |= yield from gaze.during(_grips(task, side, task.site))
        yield gaze.alone()
    if not grips:
        raise AlgorithmError(f"no hand can close on {task.object.name} there; give the site another rotation")
    grips = yield from gaze.during(_above(task, grips, rotate(task.site.rotation, X)))
    goal = Goal(task.site.place, palms={side: taking.palms for side, taking in grips.items()})
    into = rotate(task.site.rotation, X)
    task, gaze, reaching, plan = yield from _planned(task, goal, -BEFORE * into, gaze)
    task.arrived()
    side = plan.reacher.side
    grip = Transform(plan.palm[:3] + BEFORE * into, plan.palm[3:])
    links, holding = list(fingers(side)), grips[side].holding
    then, closed = _closing(task, grip, into)
    wide = opener(Hand.of(task.human, side), holding)
    made = yield from performed(task, reaching, plan, gaze, (links, wide), then)
    refuse_short(task, plan, off_target(task, plan, made, then, closed > 0.0, goal.place))
    length = len(made.root) - len(then)
    made.rotations[length:, links] = slerp(wide, holding.shape, closed[:, None])
    yield from closed_at_last(at_ease(task, task.block(made.rotations, made.root, made.importance, made.targets)))
    yield from _brought(task, made, side, grip.inverse().then(frame))


def _planned(
    task: HumanTask, goal: Goal, off: Array, gaze: Looking
) -> Generator[Array, None, tuple[HumanTask, Looking, Reaching, Plan]]:
    """The plan of a reach to so far (3,) off the grip, from here or after steps to where the hand comes there.

    Who could bring it there from here only turned otherwise than it holds, its joints at their limits, or not quite,
    steps too.

    Raises:
        AlgorithmError: it is out of reach, and nobody steps there; says by how much.
    """
    reaching, prisms = Reaching(task.human, task.start.rotations, task.start.root), prisms_of(task)
    stays, plan = task.library is None or seat_of(task) is not None, None
    try:
        plan = yield from planned(task, reaching, goal, gaze, prisms, off)
    except AlgorithmError:
        if stays:
            raise
    if plan is not None and (stays or (plan.arm.found and plan.short <= EXACT)):
        return task, gaze, reaching, plan
    try:
        task, gaze = yield from gone_nearer(task, goal.place, lambda _: goal, gaze, prisms, _lacks)
    except AlgorithmError:
        if plan is None:
            raise
        return task, gaze, reaching, plan
    reaching = Reaching(task.human, task.start.rotations, task.start.root)
    return task, gaze, reaching, (yield from planned(task, reaching, goal, gaze, prisms, off))


def _lacks(arm: Stretch) -> str:
    """What an arm lacks to take it, as a clause; ""."""
    return short_of(arm, EXACT) or ("" if arm.found else "the hand can't be turned so that it holds it")


def _grips(task: HumanTask, side: str, site: Transform) -> Steps[dict[str, Taking]]:
    """How a hand takes it, by its side; empty where it can't."""
    thing = task.object
    assert thing is not None
    assert thing.shape is not None
    flat = thing.sites[task.message.site].grip == "precision"
    mirrored = Transform(site.place, multiply(site.rotation, from_axis_angle(X, np.pi)))
    met = site if side == "right" or flat else mirrored
    back, hand = thing.frame.inverse(), Hand.of(task.human, side)
    own = back.then(met)
    field = thing.shape.field(own.place)
    from_here = back.then(Transform(met.place - BEFORE * rotate(met.rotation, X), met.rotation)).row()
    if flat:
        holding = yield from precision(hand, field, from_here, back.then(site).row())
    else:
        holding = yield from power(hand, field, from_here, own.row())
    if holding is None or not holding.holds:
        return {}
    palm = thing.frame.then(Transform.of(holding.palm))
    turned = from_axis_angle(rotate(site.rotation, UP), TURNS)
    places = site.place + rotate(turned, palm.place - site.place)
    return {side: Taking(np.concatenate([places, multiply(turned, palm.rotation)], axis=-1), holding)}


def _above(task: HumanTask, grips: dict[str, Taking], into: Array) -> Steps[dict[str, Taking]]:
    """The grips without the palms whose fingers would be in what stands about, as the desk that it lies on, as they
    close or hold; where all would be, nearer to the edge of what is held. into: (3,) as the hand comes.

    Raises:
        AlgorithmError: all would; says by how much at the least.
    """
    assert task.object is not None
    prisms, found, least = lain_on(task.object, prisms_of(task)), dict[str, Taking](), np.inf
    grip = task.object.sites[task.message.site].grip
    for side, taking in grips.items():
        for out in OUT if grip == "precision" else OUT[:1]:
            palms = taking.palms.copy()
            palms[:, :3] -= out * into
            deep = sunk(task, side, palms, taking.holding.shape, prisms, grip)
            yield
            least = min(least, float(np.min(deep)))
            easily = deep < SUNK - SPARE
            if (clear := easily if easily.any() else deep < SUNK).any():
                found[side] = replace(taking, palms=palms[clear])
            if easily.any():
                break
    if not found:
        raise AlgorithmError(
            f"fingers would be {1000.0 * least:.0f} mm in what {task.object.name} lies on; lay it so that they come "
            "under it, its edge over that of a desk"
        )
    return found


def _closing(task: HumanTask, grip: Transform, into: Array) -> tuple[Array, Array]:
    """Palms (n, 7) from before the grip to it, while the hand closes, and up; how far the fingers are closed (n)."""
    assert task.object is not None
    counts = [round(seconds * task.rate) for seconds in (COMES, CLOSES, HOLDS, RISES)]
    share = [minimum_jerk(np.arange(1, count + 1) / count) for count in counts]
    zero = [np.zeros(count) for count in counts]
    back = np.concatenate([1.0 - share[0], zero[1], zero[2], zero[3]])
    begun = half_closed(BEFORE * back[: counts[0]], task.object.sites[task.message.site].grip)
    lifted = np.concatenate([zero[0], zero[1], zero[2], share[3]])
    palms = np.repeat(grip.row()[None], len(back), axis=0)
    palms[:, :3] += LIFTS * lifted[:, None] * UP - BEFORE * back[:, None] * into
    return palms, np.concatenate([begun, begun[-1] + (1.0 - begun[-1]) * share[1], zero[2] + 1.0, zero[3] + 1.0])


def _brought(task: HumanTask, made: Performed, side: str, held: Transform) -> Iterator[Array]:
    """Frames (n, 260) in which it is brought there, planned while the hand rests; `held` is it in the palm's frame."""
    rotations, root = made.rotations[-1], made.root[-1]
    shown = looking(task.human, rotations, root, made.targets[-1, GAZE, :3])
    reaching, prisms = Reaching(task.human, shown, root), prisms_of(task)
    last = task.block(made.rotations, made.root, made.importance, made.targets)[-1:]
    to_ear = task.parameter("to", "eyes") == "ear"
    work = brought_to_ear(task, reaching, side, held, prisms) if to_ear else _read(task, reaching, side, held, prisms)
    brought, _ = yield from waited(work, last)
    importance = np.maximum(brought.importance, made.importance[-1])
    yield at_ease(task, task.block(brought.rotations, brought.root, importance, brought.targets))


def _read(task: HumanTask, reaching: Reaching, side: str, held: Transform, prisms: Sequence[Prism]) -> Steps[Performed]:
    """The frames in which it comes before the eyes."""
    wanted, place = before_eyes(task, reaching, 1.0 if side == "left" else -1.0)
    back, n, reacher = held.inverse(), len(wanted.place), Reacher.of(task.human, side)
    palms = wanted.then(Transform(np.repeat(back.place[None], n, axis=0), back.rotation)).row()
    yield
    found = yield from reaching.posture(reacher, Goal(place, palms={side: palms}), prisms)
    refuse_far(task, side, found[2])
    yield
    plan = yield from reaching.way(reacher, found, place, prisms, 0.0)
    tell_missed(task, plan)
    length = round(plan.seconds * task.rate)
    time, looked = np.arange(1, length + 1) / length, minimum_jerk(np.arange(1, length + 1) / (LOOKS * task.rate))
    return (yield from perform(plan, time, place, looked))


if __name__ == "__main__":
    run(take_up)
