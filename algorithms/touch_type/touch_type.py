"""Touch-typing: both hands come over the home row, and each key is pressed by the finger that has it.

The object's property `keys` says where the keys are and whose; the action's site is the middle of their tops, x to who
types and z up. Who stands elsewhere steps before them first, where the action names a walk library, and who sits on
castors rolls there. Standing or sitting, one bends no further than both arms ask for all keys of the text. At the end
the hands hover.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Mapping
from dataclasses import dataclass, replace

import numpy as np

from ahmss.algorithm import HumanTask, Transform, run
from ahmss.body.array import Array
from ahmss.body.inverse import grips, solve
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import conjugate, multiply, rotate, to_rotation_vector
from ahmss.errors import AlgorithmError
from ahmss.grasping.hand import FINGERS
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.steps import Steps
from ahmss.reaching.both import Between, posture_for_both
from ahmss.reaching.performing import Performed, perform
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.reacher import SIDES, Reacher
from ahmss.reaching.standing import Standing
from ahmss.skills.castors import drawn_up, rolled_to
from ahmss.skills.controls import before, begun_at, front_of, gone_to
from ahmss.skills.elbow_room import awaited
from ahmss.skills.keystrokes import CLICK, Key, Stroke, clicks, keys_of, strokes_of
from ahmss.skills.out_of_reach import MOST_MISSING, refuse_far, tell_missed
from ahmss.skills.reaching import Looking, prisms_of
from ahmss.skills.sitting import Seated, heading_of, seat_of
from ahmss.skills.stepping import ground_of, walk_library
from ahmss.skills.typing_hands import TypingHand
from ahmss.walking.goals import Goal
from ahmss.walking.journey import Standing as Stance
from ahmss.walking.journey import footing
from ahmss.walking.obstacles import Obstacles

ABOVE = 0.04  # metres over the keys to which the hands come, and to which they rise at the end
SINKS, BEGINS, ENDS, RISES = 0.3, 0.25, 0.3, 0.3  # seconds
FIRST = 12  # frames in which the motion is worked out
AT_ONCE = 12  # frames of fingers
AWAY, NEAR, FACING = 0.36, 0.1, np.radians(15.0)  # metres from the keys at which one stands; near enough there, facing
SITS = 0.38, 0.5, 0.04  # metres before the keys between which who sits is near enough, and aside of their middle
ALL_IN = 0.005  # seconds before a stroke's time it is in already
CLEAR, FARTHEST = 0.26, 0.25  # metres: what is nearer is in the way; so far aside of the keyboard nobody types
IN_TIME, JUMPS = 0.08, np.radians(40.0)  # seconds about its time in which a key writes; a finger's turn in one frame
MANY = 240  # frames that are worked out before a pause
TRAVEL = 0.0035  # metres of a key, where the object's properties do not say


def touch_type(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260): the hands come, sink, type, and rise a little."""
    if task.site is None or task.object is None:
        raise AlgorithmError("typing needs a site: the middle of the keys' tops, x to who types and z up")
    if task.carried:
        raise AlgorithmError("one types standing or sitting; walk there first, then type")
    if task.busy:
        raise AlgorithmError(f"typing takes both hands; the {task.busy[0]} one holds something")
    keys = keys_of(task.object.properties, task.object.name)
    strokes = strokes_of(task.parameter("text", ""), keys, task.random, SINKS + BEGINS)
    if not strokes:
        raise AlgorithmError('type what? add text="..."')
    hands = {side: TypingHand.of(task.human, side, keys) for side in SIDES}
    task, gaze = yield from _stood(task)
    task.arrived()
    yield gaze.alone()
    plans, made, typing, missed = yield from _worked_out(task, hands, strokes, gaze)
    if missed and (stand := _better_stand(task)) is not None:
        task, gaze = yield from gone_to(task, stand, gaze)
        plans, made, typing, missed = yield from _worked_out(task, hands, strokes, gaze)
    waited = False
    for side in SIDES:  # who works beside them is not reached through
        waited = (yield from awaited(task, made, side, gaze)) or waited
    if waited and made.looked < 1.0:  # the eyes have gone on
        made, typing = yield from _made(task, hands, plans, strokes, gaze)
    rows = task.block(made.rotations, made.root, made.importance, made.targets)
    first = len(rows) - len(typing.time)
    spoilt = yield from gaze.until(gaze.frames, typing.spoilt(task, made, first, keys))
    if spoilt:
        if (seat := seat_of(task)) is not None:
            raise AlgorithmError(f"it can't be typed, {spoilt}, from {_or_stand(seat)}")
        where = _in_the_way(task) or "come nearer to the middle of the keyboard"
        raise AlgorithmError(f"it can't be typed from here, {spoilt}; {where}")
    _refuse_missed(task, missed)
    for plan in plans.values():
        tell_missed(task, plan)
    yield rows[:first]
    for begin in range(first, len(rows), AT_ONCE):  # worked out while they are shown
        yield typing.fingers(task, made, first, slice(begin, begin + AT_ONCE))


@dataclass(frozen=True, eq=False)
class Typing:
    """The frames in which one types: their times (n,), how high the hands are over where they type (n,), and what."""

    hands: Mapping[str, TypingHand]
    strokes: list[Stroke]
    time: Array
    height: Array

    def fingers(self, task: HumanTask, made: Performed, first: int, some: slice) -> Array:
        """Some of the frames (n, 260), the fingers of both hands where they belong with the palms as they are."""
        assert task.site is not None
        assert task.object is not None
        travel = float(task.object.properties.get("travel", TRAVEL))
        rotations, back, shown = made.rotations[some].copy(), task.site.inverse(), _shown(task, made, some)
        own = slice(some.start - first, some.stop - first)
        for row, (side, hand) in enumerate(self.hands.items()):
            palms = back.then(Transform.of(shown[:, row])).row()
            palms[:, 2] -= self.height[own]
            rotations[:, list(fingers(side))] = hand.shapes(self.strokes, self.time[own], palms, travel)
        return task.block(rotations, made.root[some], made.importance[some], made.targets[some])

    def missed(self, task: HumanTask, made: Performed, first: int) -> dict[str, float]:
        """The keys that stay up, by name, and by how many metres their fingers stop short of pressing them."""
        assert task.site is not None
        assert task.object is not None
        travel = float(task.object.properties.get("travel", TRAVEL))
        back, into = task.site.inverse(), -(_up(task.site))
        found: dict[str, float] = {}
        for row, (side, hand) in enumerate(self.hands.items()):
            for stroke in (stroke for stroke in self.strokes if stroke.side == side):
                at = int(np.searchsorted(self.time, stroke.time - ALL_IN))
                palm = _shown(task, made, slice(first + at, first + at + 1))[:, row]
                shape = hand.shapes(self.strokes, self.time[[at]], back.then(Transform.of(palm)).row(), travel)
                pads = back.apply(hand.tips.pads(shape, palm, into)[0])
                pad = pads[("thumb", *FINGERS).index(stroke.finger)]
                off = np.append(hand.place_on(stroke), -CLICK * travel) - pad
                off = np.append(np.maximum(np.abs(off[:2]) - 0.5 * stroke.key.size.min(), 0.0), min(off[2], 0.0))
                if float(np.linalg.norm(off)) > 0.0:
                    name = stroke.key.name
                    found[name] = max(found.get(name, 0.0), float(np.linalg.norm(off)))
        return found

    def spoilt(self, task: HumanTask, made: Performed, first: int, keys: Mapping[str, Key]) -> Steps[str]:
        """What of the typing is not as it should be, in words: keys beside the text, fingers that jump; or ""."""
        assert task.site is not None
        assert task.object is not None
        back, into = task.site.inverse(), -(_up(task.site))
        own, pads = [*fingers("right"), *fingers("left")], list[Array]()
        turned = made.rotations[first - 1 : first, own]
        fastest = 0.0
        for begin in range(first, len(made.rotations), MANY):
            some = slice(begin, begin + MANY)
            rows, shown = self.fingers(task, made, first, some), _shown(task, made, some)
            shapes = rows[:, 4:176].reshape(-1, 43, 4)
            both = [
                hand.tips.pads(shapes[:, list(fingers(side))], shown[:, row], into)
                for row, (side, hand) in enumerate(self.hands.items())
            ]
            pads.append(back.apply(np.concatenate(both, axis=1)))
            turned = np.concatenate([turned[-1:], shapes[:, own]])
            turns = to_rotation_vector(multiply(conjugate(turned[:-1]), turned[1:]))
            fastest = max(fastest, float(np.linalg.norm(turns, axis=-1).max()))
            yield
        wrong = list[str]()
        for frame, name in clicks(np.concatenate(pads), keys, float(task.object.properties.get("travel", TRAVEL))):
            times = np.array([stroke.time for stroke in self.strokes if stroke.key.name == name])
            if not (np.abs(times - self.time[frame]) < IN_TIME).any():
                wrong.append(name)
        if wrong:
            return f"as fingers would press {', '.join(dict.fromkeys(wrong))} beside the text"
        return f"as fingers would jump by {np.degrees(fastest):.0f} degrees" if fastest > JUMPS else ""


def _shown(task: HumanTask, made: Performed, some: slice) -> Array:
    """The palms (n, 2, 7) in some of the frames, as the arms come to them."""
    rotations, root = made.rotations[some], made.root[some]
    return grips(task.human, solve(task.human, rotations, root, made.targets[some]), root)


def _stood(task: HumanTask) -> Generator[Array, None, tuple[HumanTask, Looking]]:
    """The task from where one types, as it is or after steps (n, 260) to before the keys; and the gaze on its way.

    Who sits, or has no walk library, stays.

    Raises:
        AlgorithmError: what stands there leaves no room before the keys.
    """
    gaze = Looking(task, task.site.place if task.site is not None else task.start.root)
    if (seat := seat_of(task)) is not None and seat.castors:
        return (yield from _rolled(task, seat, gaze))
    assert task.object is not None
    best = task.object.place[:2] + AWAY * front_of(task.object.frame)
    stand = _better_stand(task, best, NEAR, FACING)
    if stand is None:
        return task, gaze
    if (off := _aside(task, stand)) > FARTHEST and (way := _in_the_way(task)):
        raise AlgorithmError(f"one would stand {off:.2f} m aside of the keyboard's middle; {way}")
    return (yield from gone_to(task, stand, gaze))


def _better_stand(task: HumanTask, good: Array | None = None, near: float = 0.02, facing: float = 0.05) -> Goal | None:
    """Where one would stand to type; None where one does, so near and facing so, or can't go there.

    good: (2,) a place that is as good.
    """
    if task.library is None or Standing.of(task.human, task.start.rotations, task.start.root) is None:
        return None
    stand, stance = before(task, AWAY), Stance.of(task.human, walk_library(task))
    now = footing(task.human, task.start.rotations, task.start.root, stance)
    aside = abs(((stand.facing or 0.0) - now.heading + np.pi) % (2.0 * np.pi) - np.pi)
    places = [stand.place] if good is None else [stand.place, good]
    there = min(float(np.linalg.norm(place - now.place)) for place in places) < near and aside < facing
    return None if there else stand


def _rolled(task: HumanTask, seat: Seated, gaze: Looking) -> Generator[Array, None, tuple[HumanTask, Looking]]:
    """The task from where one sits drawn up to the keys, as it is or after rolling there (n, 260); and the gaze.

    Raises:
        AlgorithmError: what stands there leaves no room before the keys.
    """
    assert task.object is not None
    best = drawn_up(task.object)
    off = task.object.frame.inverse().apply(task.start.root)
    turned = abs((best[0][1] - heading_of(task.start.rotations) + np.pi) % (2.0 * np.pi) - np.pi)
    if SITS[0] < off[0] < SITS[1] and abs(off[1]) < SITS[2] and turned < FACING:
        return task, gaze
    rotations, root = task.start.rotations, task.start.root
    for rows in rolled_to(task, seat, best):
        rotations, root = rows[-1, 4:176].reshape(43, 4), rows[-1, 1:4]
        yield rows
    moved = begun_at(task, rotations, root)
    return moved, Looking(moved, gaze.place)


def _or_stand(seat: Seated) -> str:
    """A seat from which one can't type, and what to do, in words."""
    name = seat.thing.name
    return f"{name}; `do {name} stand_up` and type standing, or sit nearer to the middle of the keyboard"


def _aside(task: HumanTask, stand: Goal) -> float:
    """How far aside of the middle of the keys one would stand, metres."""
    assert task.object is not None
    front = front_of(task.object.frame)
    off = stand.place - task.object.place[:2]
    return abs(float(front[0] * off[1] - front[1] * off[0]))


def _in_the_way(task: HumanTask) -> str:
    """What stands where one would stand to type, and what to do, in words; "" where nothing does."""
    assert task.object is not None
    ground, at = ground_of(task), task.object.place[:2]
    if task.library is None or not ground.outlines:
        return ""
    around = Obstacles.of(ground.outlines, 0.0, names=ground.names)
    gap = np.where(around.clearance(at) > 0.0, around.clearance(at + AWAY * front_of(task.object.frame)), np.inf)
    i = int(gap.argmin())
    return f"{around.names[i]} stands before it: move that away first" if gap[i] < CLEAR else ""


def _refuse_missed(task: HumanTask, missed: Mapping[str, float]) -> None:
    """Refuse a text of which keys would stay up.

    Raises:
        AlgorithmError: some would; says which, by how much they are out of reach, and what to do.
    """
    if not missed:
        return
    far = f"{', '.join(missed)} would stay up, up to {1000.0 * max(missed.values()):.0f} mm out of reach of fingers"
    if (seat := seat_of(task)) is not None:
        raise AlgorithmError(f"it can't be typed, as {far}, from {_or_stand(seat)}")
    raise AlgorithmError(f"it can't be typed from here, as {far}; come nearer to the middle of the keyboard")


def _worked_out(
    task: HumanTask, hands: Mapping[str, TypingHand], strokes: list[Stroke], gaze: Looking
) -> Generator[Array, None, tuple[Mapping[str, Plan], Performed, Typing, Mapping[str, float]]]:
    """The plans of both hands, what is made of them, and the keys that would stay up, by how many metres.

    Raises:
        AlgorithmError: the keyboard is out of reach; says by how much.
    """
    plans = yield from _planned(task, hands, strokes, gaze)
    made, typing = yield from _made(task, hands, plans, strokes, gaze)
    return plans, made, typing, typing.missed(task, made, len(made.root) - len(typing.time))


def _planned(
    task: HumanTask, hands: Mapping[str, TypingHand], strokes: list[Stroke], gaze: Looking
) -> Generator[Array, None, Mapping[str, Plan]]:
    """The plan of either hand, from one posture.

    Raises:
        AlgorithmError: the keyboard is out of reach; says by how much.
    """
    assert task.site is not None
    reaching = Reaching(task.human, task.start.rotations, task.start.root)
    prisms = [replace(prism, sought=False) for prism in prisms_of(task)]  # fingers come over the keys, not through them
    above = Transform(task.site.place + ABOVE * _up(task.site), task.site.rotation)
    between: dict[str, Between] = {}
    for side, hand in hands.items():
        palms = yield from gaze.during(hand.palms())
        goes = hand.goes(strokes, palms[len(palms) // 2]) - np.array([0.0, 0.0, ABOVE])
        between[side] = Between(above.then(Transform.of(palms)).row(), rotate(task.site.rotation, goes))
    found = yield from gaze.during(posture_for_both(reaching, between, gaze.place, prisms))
    plans: dict[str, Plan] = {}
    for side, one in found.items():
        if one[2].missing > MOST_MISSING and (seat := seat_of(task)) is not None:
            raise AlgorithmError(f"the {side} arm is {one[2].missing:.2f} m too short for that from {_or_stand(seat)}")
        refuse_far(task, side, one[2])
        looked = float(gaze.turned(np.array([gaze.frames + 1]))[0])
        reacher = Reacher.of(task.human, side)
        plans[side] = yield from gaze.during(reaching.way(reacher, one, gaze.place, prisms, looked))
    first = gaze.frames + gaze.left(FIRST)
    looked = float(gaze.turned(np.array([first]))[0])
    return {side: reaching.set_out(plan, gaze.place, looked) for side, plan in plans.items()}


def _made(
    task: HumanTask, hands: Mapping[str, TypingHand], plans: Mapping[str, Plan], strokes: list[Stroke], gaze: Looking
) -> Generator[Array, None, tuple[Performed, Typing]]:
    """Both hands' frames as one, the fingers still as they are when they come; and what they are to do."""
    assert task.site is not None
    first = gaze.frames + gaze.left(FIRST)
    length = round(max(plan.seconds for plan in plans.values()) * task.rate)
    typed = round((strokes[-1].time + ENDS + RISES) * task.rate)
    share, time = np.arange(1, length + 1) / length, np.arange(1, typed + 1) / task.rate
    looked = gaze.turned(first + np.arange(1.0, length + typed + 1.0))
    rise = minimum_jerk((time - strokes[-1].time - ENDS) / RISES)
    height = ABOVE * (1.0 - minimum_jerk(time / SINKS) + rise)
    both: list[Performed] = []
    resting: dict[str, TypingHand] = {}
    for side, hand in hands.items():
        plan = plans[side]
        over = task.site.inverse().then(Transform.of(plan.palm)).row() - np.array([0.0, 0.0, ABOVE, 0.0, 0.0, 0.0, 0.0])
        resting[side] = hand.resting(over)
        then = np.repeat(over[None], typed, axis=0)
        then[:, :3] += resting[side].shifts(strokes, time)
        shape = resting[side].shapes(strokes, time[:1], then[:1], TRAVEL)[0]
        then[:, 2] += height
        then = Transform(task.site.apply(then[:, :3]), multiply(task.site.rotation, then[:, 3:])).row()
        work = perform(plan, share, gaze.place, looked, (list(fingers(side)), shape), then)
        both.append((yield from gaze.until(first, work)))
    return _joined(*both), Typing(resting, strokes, time, height)


def _joined(right: Performed, left: Performed) -> Performed:
    """The right hand's frames with the left arm of the left hand's."""
    first = INDEX["left_upper_arm"]
    links = [first, first + 1, first + 2, *fingers("left")]
    right.rotations[:, links] = left.rotations[:, links]
    right.targets[:, 1] = left.targets[:, 1]
    importance = np.maximum(right.importance, left.importance)
    return replace(right, importance=importance, jumps=right.jumps or left.jumps)


def _up(site: Transform) -> Array:
    """The z axis (3,) of the keys."""
    return site.apply(np.array([0.0, 0.0, 1.0])) - site.place


if __name__ == "__main__":
    run(touch_type)
