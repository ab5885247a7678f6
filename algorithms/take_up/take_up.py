"""Taking something up: the hand comes, closes, and brings it to the ear, or before the eyes.

Who does not reach so far steps to where they do, where the action names a walk library.

The reach is that of `reach`, the grip that of `grasp`. A left hand meets the site mirrored. What is held to the ear has
its ends along its y axis (property `ends`, metres from its middle) and its openings looking along its -z; the end at
the thumb comes to the ear. What is read has its text facing along its z, and who reads it at its x.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass, replace

import numpy as np

from ahmss.algorithm import HumanPose, HumanTask, Transform, run
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import from_axis_angle, from_matrix, multiply, rotate, slerp
from ahmss.errors import AlgorithmError
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import Holding, opener
from ahmss.grasping.power import power
from ahmss.grasping.precision import precision
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.steps import Steps
from ahmss.reaching.elbow import hangs, swung
from ahmss.reaching.goal import Goal
from ahmss.reaching.leaning import Stretch, looking
from ahmss.reaching.performing import Performed, perform
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.reacher import Reacher, seat
from ahmss.skills.around import half_closed
from ahmss.skills.at_ease import at_ease
from ahmss.skills.meanwhile import waited
from ahmss.skills.nearer import gone_nearer, short_of
from ahmss.skills.out_of_reach import refuse_far, tell_missed
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
EAR = np.array([-0.024, 0.086, 0.098])  # from between the eyes: up, to the side, back
LIPS = np.array([-0.055, 0.034, -0.012])  # a little beside the mouth
ROLLS, LIFTED = (-45.0, -30.0, -15.0, 0.0, 15.0, 30.0, 45.0), (0.0, 10.0, 20.0)  # degrees, about it and off the cheek
GAP = 0.008  # metres between ear and what is held to it
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
    tell_missed(task, plan)
    length = len(made.root) - len(then)
    made.rotations[length:, links] = slerp(wide, holding.shape, closed[:, None])
    yield from closed_at_last(at_ease(task, task.block(made.rotations, made.root, made.importance, made.targets)))
    yield from _brought(task, made, side, grip.inverse().then(frame))


def _planned(
    task: HumanTask, goal: Goal, off: Array, gaze: Looking
) -> Generator[Array, None, tuple[HumanTask, Looking, Reaching, Plan]]:
    """The plan of a reach to so far (3,) off the grip, from here or after steps to where the hand comes there.

    Who could bring it there from here only turned otherwise than it holds, its joints at their limits, steps too.

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
    if plan is not None and (stays or plan.arm.found):
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
    return short_of(arm) or ("" if arm.found else "the hand can't be turned so that it holds it")


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
    reaching = Reaching(task.human, shown, root)
    last = task.block(made.rotations, made.root, made.importance, made.targets)[-1:]
    to_ear = task.parameter("to", "eyes") == "ear"
    sign = 1.0 if side == "left" else -1.0
    wanted, place = _to_ear(task, reaching, side) if to_ear else before_eyes(task, reaching, sign)
    back, n = held.inverse(), len(wanted.place)
    palms = wanted.then(Transform(np.repeat(back.place[None], n, axis=0), back.rotation)).row()
    reacher, prisms = Reacher.of(task.human, side), prisms_of(task)

    def work() -> Steps[Performed]:
        chosen = palms
        if to_ear:
            seen = looking(task.human, reaching.base.rotations, reaching.base.root, place)
            spine = seat(task.human, seen, reaching.base.root)
            cost, _ = hangs(reacher, palms, spine, reaching.present(reacher))
            chosen = palms[[int(cost.argmin())]]
        yield
        found = yield from reaching.posture(reacher, Goal(place, palms={side: chosen}), prisms)
        refuse_far(task, side, found[2])
        yield
        plan = yield from reaching.way(reacher, found, place, prisms, 0.0)
        tell_missed(task, plan)
        length = round(plan.seconds * task.rate)
        time, looked = np.arange(1, length + 1) / length, minimum_jerk(np.arange(1, length + 1) / (0.3 * task.rate))
        brought = yield from perform(plan, time, place, looked)
        if to_ear:
            _out_of_the_trunk(task, brought, plan, time)
        return brought

    brought, _ = yield from waited(work(), last)
    importance = np.maximum(brought.importance, made.importance[-1])
    yield at_ease(task, task.block(brought.rotations, brought.root, importance, brought.targets))


def _out_of_the_trunk(task: HumanTask, brought: Performed, plan: Plan, time: Array) -> None:
    """Have the elbow swing out of the trunk on the way, and hang as low as it can."""
    reacher, gaze = plan.reacher, brought.targets[:, GAZE]
    seen = looking(task.human, brought.rotations, brought.root, gaze[:, :3], gaze[:, 7])
    palms = plan.palms(time)
    present = reacher.arm.from_pose(plan.start.rotations[reacher.links])
    brought.rotations[:, reacher.links] = swung(reacher, palms, seat(task.human, seen, brought.root), present)
    brought.targets[:, reacher.row, :7] = palms


def _to_ear(task: HumanTask, reaching: Reaching, side: str) -> tuple[Transform, Array]:
    """The frames (n) in which it is at ear and mouth, and the place ahead that is looked at."""
    assert task.object is not None
    skeleton, heading = task.human, reaching.heading
    ahead = np.array([np.cos(heading), np.sin(heading), 0.0])
    base = reaching.base
    eyes = _head(task, base.rotations, base.root).apply(skeleton.eye)
    place = eyes + 2.0 * ahead - 0.1 * UP
    seen = looking(skeleton, base.rotations, base.root, place)
    head = _head(task, seen, base.root)
    sign = 1.0 if side == "left" else -1.0
    mirrored, scale = np.array([1.0, sign, 1.0]), skeleton.stature / 1.70
    ear = head.apply(skeleton.eye + scale * EAR * mirrored + np.array([0.0, sign * GAP, 0.0]))
    lips = head.apply(skeleton.eye + scale * LIPS * mirrored)
    half = float(task.object.properties.get("ends", 0.07))
    along = (lips - ear) / np.linalg.norm(lips - ear)
    out = rotate(head.rotation, np.array([0.0, sign, 0.0]))
    out = out - (out @ along) * along
    out = out / np.linalg.norm(out)
    y = -sign * along
    turn = from_matrix(np.stack([np.cross(y, out), y, out], axis=-1))
    roll, lift = (np.radians(a.ravel()) for a in np.meshgrid(ROLLS, LIFTED, indexing="ij"))
    turned = multiply(from_axis_angle(along, -sign * roll), turn)
    turned = multiply(from_axis_angle(np.cross(out, along), -lift), turned)
    mouthpiece = np.array([0.0, sign * half, float(task.object.properties.get("opening", 0.0))])
    return Transform(ear - rotate(turned, mouthpiece), turned), place


def _head(task: HumanTask, rotations: Array, root: Array) -> Transform:
    places, turned = forward(rotations, root, task.human.offsets)
    return Transform(places[INDEX["head"]], turned[INDEX["head"]])


if __name__ == "__main__":
    run(take_up)
