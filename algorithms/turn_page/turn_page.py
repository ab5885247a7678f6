"""Turning a leaf: thumb and index take its lower outer corner, lead it over the rings, and let it fall behind.

The object's properties say where its hinge is and the axis about which leaves turn, the corner where they are taken,
and how many there are. Its states follow: `turn`, how far the leaf is, and `page`, how many are turned.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass

import numpy as np

from ahmss.algorithm import HumanPose, HumanTask, Transform, run
from ahmss.body.array import Array
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import from_axis_angle, from_matrix, multiply, rotate, slerp
from ahmss.errors import AlgorithmError
from ahmss.grasping.fingertips import Fingertips
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.fingers import opened
from ahmss.reaching.comfort import discomfort
from ahmss.reaching.leaning import stretch_of
from ahmss.reaching.performing import Performed
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.standing import Posture
from ahmss.skills.at_ease import resampled, times_at_ease
from ahmss.skills.out_of_reach import refuse_far, tell_missed
from ahmss.skills.reaching import Looking, performed
from ahmss.skills.reading import brought

BEFORE, OVER = 0.06, 0.05  # metres beside the leaf at which the hand is set; over it, on its way home
COMES, CLOSES, LEADS, OPENS, RETURNS = 0.3, 0.2, 0.8, 0.15, 0.6  # seconds
LED, WHOLE = np.radians([120.0, 358.0])  # of its turn, that the hand leads it; all
TURNS_ALONG, LOOKS = (0.0, 0.2, 0.4, 0.6, 0.8), 6  # shares of its turn that the hand may make; how often that is judged
PINCH = np.array([0.125, 0.045, -0.022])  # where the pads meet, in the hand: on, out of the palm, to the little finger
ASIDE, TILT = np.radians([-20.0, 0.0, 20.0, 40.0, 60.0, 80.0]), np.radians([-60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0])
SHORT = 200.0  # what a metre costs by which the arm is too short
FEWER, LITTLE = 4, 0.4  # every so many palms show whether a hand comes there; turning along so much
GOES_OVER = 30  # frames in which the elbow comes back to where it was at the leaf
BENT = 0.01  # what counts as so many metres that are missed: a joint that would have to go beyond what it can
NEARLY = 0.005  # metres that the hand may stop short of a leaf that can be brought nearer
MISSED = 0.01  # metres that it may stop short of it at all: the leaf would turn by itself


@dataclass(frozen=True)
class Leaf:
    """A leaf in the world: hinge and axis (3,), the corner where it is taken (3,), and the frame of what it is in."""

    hinge: Array
    axis: Array
    corner: Array
    frame: Transform


Reached = tuple[Leaf, Reaching, Looking, Plan, float]


def turn_page(task: HumanTask) -> Iterator[Array | HumanPose]:
    """Frames: the hand comes, takes the leaf, leads it over, lets it go, and goes back."""
    page, side = _page(task), "left" if task.hand == "right" else "right"
    task, (leaf, reaching, gaze, plan, along) = yield from _reached_or_brought(task, side)
    out = _out(leaf)
    palm = Transform(plan.palm[:3] - BEFORE * out, plan.palm[3:])
    links = list(fingers(side))
    wide = opened(side)
    then, closed, angle = _led(task, leaf, palm, out, along)
    back = task.parameter("back", False)
    if back:  # the same the other way round
        then, closed, angle = _backwards(then, closed, angle, task)
    made = yield from performed(task, reaching, plan, gaze, (links, wide), then)
    length = len(made.root) - len(then)
    made.rotations[length:, links] = slerp(wide, _pinched(task, side), closed[:, None])
    rows = task.block(made.rotations, made.root, made.importance, made.targets)
    rows = np.concatenate([rows, _back(task, made, length, plan.reacher.links)])
    times = times_at_ease(task, rows)
    led = (times > length - 1) & (times <= length + len(then) - 1)
    first, last = int(led.argmax()), len(led) - int(led[::-1].argmax())
    rows, shares = resampled(rows, times), np.interp(times, length + np.arange(len(then)), angle / WHOLE)
    yield rows[:first]
    for row, share in zip(rows[first:last], shares[first:last], strict=True):
        pose = HumanPose.of(row)
        yield HumanPose(pose.rotations, pose.root, pose.importance, pose.targets, _told(page, float(share), back=back))
    yield rows[last:]


def _missed(task: HumanTask, side: str) -> Callable[[Transform, Posture], float]:
    """By how much, metres, a hand misses the leaf of the task's object at a frame, the trunk as in a posture."""
    reacher = Reacher.of(task.human, side)
    present = reacher.arm.from_pose(task.start.rotations[reacher.links])

    def misses(frame: Transform, posture: Posture) -> float:
        spine = seat(task.human, posture.rotations, posture.root)
        leaf = _leaf(task, frame)
        palms = Transform.of(_palms(task, side, leaf)[::FEWER])
        led = [_with_leaf(leaf, palms, float(angle), LITTLE).row() for angle in LED * np.array([0.0, 0.5, 1.0])]
        led.append(Transform(palms.place + BEFORE * _out(leaf), palms.rotation).row())  # where the hand is set first
        _, found, missing = discomfort(reacher, np.stack(led), spine, present)
        return float((np.maximum(missing, 0.0) + BENT * ~found).max(axis=0).min())

    return misses


def _reached_or_brought(task: HumanTask, side: str) -> Generator[Array, None, tuple[HumanTask, Reached]]:
    """The task, and how the free hand comes to the leaf; where it does not, as what was just received is held
    elsewhere than before the eyes, after the other hand has brought it there (n, 260).

    Raises:
        AlgorithmError: the arm is too short for it, and the other can't bring it nearer.
    """
    try:
        return task, (yield from _reached(task, side, NEARLY))
    except AlgorithmError:
        pass
    try:
        moved = yield from brought(task, "left" if side == "right" else "right", _missed(task, side))
    except AlgorithmError:  # there is no better place, so as near as it comes
        moved = task
    return moved, (yield from _reached(moved, side, MISSED))


def _reached(task: HumanTask, side: str, most: float) -> Generator[Array, None, Reached]:
    """The leaf as it lies now, and how the free hand comes to it: who, the gaze on its way, and as of `_planned`.

    Raises:
        AlgorithmError: that arm is too short for it, or the hand stops more than `most` metres short of it.
    """
    leaf = _leaf(task)
    gaze = Looking(task, leaf.frame.place)
    yield gaze.alone()
    reaching = Reaching(task.human, task.start.rotations, task.start.root)
    palms = _palms(task, side, leaf)
    plan, along = yield from _planned(task, reaching, palms, side, leaf, gaze, BEFORE * _out(leaf), most)
    return leaf, reaching, gaze, plan, along


def _out(leaf: Leaf) -> Array:
    """The way (3,) from its corner, unit, on which the hand is beside a leaf."""
    return rotate(leaf.frame.rotation, np.array([0.3, 1.0, 0.3]) / np.linalg.norm([0.3, 1.0, 0.3]))


def _planned(
    task: HumanTask, reaching: Reaching, palms: Array, side: str, leaf: Leaf, gaze: Looking, off: Array,
    most: float,
) -> Generator[Array, None, tuple[Plan, float]]:  # fmt: skip
    """The plan of the hand that does not hold it, the trunk as it is: the book would go along. And how far the hand
    turns along with the leaf, of its turn: so that the arm has it easy all the way.
    """
    reacher, start = Reacher.of(task.human, side), reaching.start
    present, spine = reaching.present(reacher), seat(task.human, start.rotations, start.root)
    angles = LED * np.linspace(0.0, 1.0, LOOKS)
    found: list[tuple[float, int, float]] = []
    for along in TURNS_ALONG:
        yield from gaze.if_there_is_time()
        path = [_with_leaf(leaf, Transform.of(palms), float(angle), along).row() for angle in angles]
        cost, _, missing = discomfort(reacher, np.stack([*path, palms + np.append(off, np.zeros(4))]), spine, present)
        cost = (cost + SHORT * np.maximum(missing, 0.0)).max(axis=0)
        found.append((float(cost.min()), int(cost.argmin()), along))
    _, best, along = min(found)
    which, arm = yield from gaze.during(stretch_of(reacher, palms[best : best + 1], start, present, []))
    refuse_far(task, side, arm)
    palm = palms[best + which] + np.append(off, np.zeros(4))
    looked = float(gaze.turned(np.array([gaze.frames + 1]))[0])
    plan = yield from gaze.during(reaching.way(reacher, (start, palm, arm), gaze.place, [], looked))
    if float(np.linalg.norm(plan.palm[:3] - palm[:3])) > most:
        raise AlgorithmError(
            f"the {side} hand stops {1000.0 * plan.short:.0f} mm short of the leaf, as far as the arm goes; "
            f"put it down, and take it up with the {side} hand"
        )
    tell_missed(task, plan)
    return plan, along


def _with_leaf(leaf: Leaf, palms: Transform, angle: Array | float, along: float) -> Transform:
    """Palms (n) that took a leaf's corner when it lay, now that it has turned by an angle (n), radians."""
    around, turned = from_axis_angle(leaf.axis, angle), from_axis_angle(leaf.axis, along * np.asarray(angle))
    held = leaf.hinge + rotate(around, leaf.corner - leaf.hinge)
    return Transform(held + rotate(turned, palms.place - leaf.corner), multiply(turned, palms.rotation))


def _leaf(task: HumanTask, at: Transform | None = None) -> Leaf:
    """The leaf as it lies now, or where what it is in is at a frame.

    Raises:
        AlgorithmError: its properties do not say where it is taken.
    """
    thing = task.object
    if thing is None or "corner" not in thing.properties or "hinge" not in thing.properties:
        raise AlgorithmError("turning a page needs the object's properties `hinge`, `turns_about` and `corner`")
    if task.carried:
        raise AlgorithmError("stand still to turn a page")
    frame = thing.frame if at is None else at
    axis = rotate(frame.rotation, np.array(thing.properties.get("turns_about", (1.0, 0.0, 0.0)), float))
    hinge = frame.apply(np.array(thing.properties["hinge"], float))
    return Leaf(hinge, axis, frame.apply(np.array(thing.properties["corner"], float)), frame)


def _page(task: HumanTask) -> float:
    """How many leaves are turned.

    Raises:
        AlgorithmError: there is none to turn.
    """
    assert task.object is not None
    page, pages = float(task.object.states.get("page", 0.0)), float(task.object.properties.get("pages", 1.0))
    if task.parameter("back", False) and page < 1.0:
        raise AlgorithmError(f"{task.object.name} is closed")
    if not task.parameter("back", False) and page >= pages:
        raise AlgorithmError(f"the last page of {task.object.name} is open")
    return page


def _told(page: float, share: float, *, back: bool) -> dict[str, float]:
    """The states while a leaf has turned by a share."""
    if back:
        return {"page": page - 1.0, "turn": round(share, 3)}
    return {"turn": round(share, 3)} if share < 0.999 else {"turn": 0.0, "page": page + 1.0}


def _pinch(side: str) -> Array:
    """Where the pads meet (3,), in the hand's frame."""
    return PINCH * np.array([1.0, -1.0 if side == "right" else 1.0, 1.0])


def _pinched(task: HumanTask, side: str) -> Array:
    """Rotations (14, 4) of fingers, those of thumb and index with their pads together."""
    tips, shape, first = Fingertips.of(task.human, side), opened(side), fingers(side)[0]
    scale = task.human.stature / 1.76
    place, sign = scale * _pinch(side)[None], -1.0 if side == "right" else 1.0
    into = np.array([[-0.35, 0.937 * sign, 0.0]])
    shape[:2] = tips.thumb(place, -into)[0]
    for finger, on in (("index", 0.0), ("middle", 0.019), ("ring", 0.038), ("little", 0.055)):
        start = INDEX[f"{side}_{finger}_proximal"] - first
        aside = place + scale * np.array([[-0.35 * on, -0.12 * sign * on, on]])
        shape[start : start + 3] = tips.finger(finger, aside, into)[0]
    return shape


def _palms(task: HumanTask, side: str, leaf: Leaf) -> Array:
    """Palms (n, 7) whose pinch is at the leaf's corner, turned in different ways."""
    sign = 1.0 if side == "right" else -1.0
    x, y, z = np.eye(3)
    # The hand points to the rings, its palm's way out along the page's: fingers behind the leaf, the thumb before it.
    ahead, palm = -sign * y, z
    hand_y = -sign * palm
    flat = from_matrix(np.stack([ahead, hand_y, np.cross(ahead, hand_y)], axis=-1))
    aside, tilt, over = (a.ravel() for a in np.meshgrid(ASIDE, TILT, (0.0, np.pi), indexing="ij"))
    turn = multiply(from_axis_angle(z, -sign * aside), multiply(from_axis_angle(x, tilt), flat))
    turn = multiply(turn, from_axis_angle(x, over))  # or the fingers before it, the thumb behind
    world = multiply(leaf.frame.rotation, turn)
    grip = task.human.grips[0 if side == "right" else 1]
    pinch = task.human.stature / 1.76 * _pinch(side)
    wrist = leaf.corner - rotate(world, np.broadcast_to(pinch, (len(world), 3)))
    return np.concatenate([wrist + rotate(world, grip[:3]), multiply(world, grip[3:])], axis=-1)


def _led(task: HumanTask, leaf: Leaf, palm: Transform, out: Array, along: float) -> tuple[Array, Array, Array]:
    """Palms (n, 7) beside the leaf, with it, and back over it; how far the fingers are closed (n); its angle (n)."""
    counts = [round(seconds * task.rate) for seconds in (COMES, CLOSES, LEADS, OPENS, RETURNS)]
    share = [minimum_jerk(np.arange(1, count + 1) / count) for count in counts]
    zero = [np.zeros(count) for count in counts]
    beside = np.concatenate([1.0 - share[0], zero[1], zero[2], zero[3], share[4]])
    hand = LED * np.concatenate([zero[0], zero[1], share[2], zero[3] + 1.0, 1.0 - share[4]])
    lift = np.sin(np.pi * np.concatenate([zero[0], zero[1], zero[2], zero[3], share[4]]))
    closed = np.concatenate([zero[0], share[1], zero[2] + 1.0, 1.0 - share[3], zero[4]])
    falls = np.concatenate([share[3] * 0.2, 0.2 + 0.8 * minimum_jerk(1.8 * np.arange(1, counts[4] + 1) / counts[4])])
    angle = np.concatenate([zero[0], zero[1], LED * share[2], LED + falls * (WHOLE - LED)])
    led = _with_leaf(leaf, palm, hand, along)
    up = rotate(leaf.frame.rotation, np.array([0.0, 0.0, 1.0]))
    places = led.place + BEFORE * beside[:, None] * out + OVER * lift[:, None] * up
    return np.concatenate([places, led.rotation], axis=-1), closed, angle


def _backwards(then: Array, closed: Array, angle: Array, task: HumanTask) -> tuple[Array, Array, Array]:
    """The same frames the other way round: the hand goes over first, and brings the leaf."""
    count = round((COMES + CLOSES) * task.rate)
    beside = np.repeat(then[:1], count, axis=0)
    return (
        np.concatenate([then[::-1], beside]), np.concatenate([closed[::-1], np.zeros(count)]),
        np.concatenate([angle[::-1], np.zeros(count)]),
    )  # fmt: skip


def _back(task: HumanTask, made: Performed, length: int, arm: slice) -> Array:
    """Frames (n, 260) in which the hand goes back the way that it came."""
    rows = task.block(made.rotations, made.root, made.importance, made.targets)[:length][::-1]
    rotations = made.rotations[:length][::-1].copy()
    share = minimum_jerk(np.arange(1, length + 1) / GOES_OVER)[:, None]
    last = np.broadcast_to(made.rotations[-1, arm], rotations[:, arm].shape)
    rotations[:, arm] = slerp(last, rotations[:, arm], share)
    rows[:, 4:176] = rotations.reshape(length, 172)
    return rows


if __name__ == "__main__":
    run(turn_page)
