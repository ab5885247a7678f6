"""Opening and closing a door that one walks through: a hand takes the lever, the body steps along with the leaf.

One stands where the arm reaches the lever at the leaf's angle now, and steps to where it reaches it at the angle that
it is swung to; in between the hand goes along the lever's arc, and the object's own algorithm turns the leaf with it.
So one pushes from one side and pulls from the other.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator
from functools import partial
from itertools import product

import numpy as np
from doors import Door, door_of
from lever import grip
from scipy.ndimage import gaussian_filter1d

from ahmss.algorithm import HumanTask, Transform, run
from ahmss.body.arm_path import follow
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE, LEFT_FOOT, RIGHT_FOOT, grips, solve
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import rotate, slerp
from ahmss.grasping.clear import first_clear
from ahmss.grasping.hand import Hand
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.fingers import opened
from ahmss.motion.planting import feet
from ahmss.motion.steps import Steps
from ahmss.motion.way import staying, ways_of
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.waist import bent_towards
from ahmss.skills.controls import begun_at
from ahmss.skills.keeping import kept_clear
from ahmss.skills.meanwhile import Thinking, alongside
from ahmss.skills.pacing import paced
from ahmss.skills.reaching import Looking
from ahmss.skills.stepping import IMPORTANCE, Stance, end_of, ground_of, rows_of, stepped, until_free, walk_library
from ahmss.skills.tucking import Tucking
from ahmss.walking.goals import Goal
from ahmss.walking.journey import Standing, footing, stands_at
from ahmss.walking.trip import Ground, Trip

NEAR, MOST = (0.05, np.radians(5.0)), 2.0  # metres and radians: who stands so is not moved; metres that are stepped
COMES, CLOSES, OPENS, LEAVES = 0.95, 0.3, 0.25, 0.6  # seconds
WATCHES = 220 + 8 * GAZE + 7  # POSE: the weight of the gaze's target
LOOKS_UP = 0.7  # seconds in which the eyes leave the lever, once the leaf begins to turn
LOOSENS = 0.8  # seconds in which the free arm comes from how one stood to how it swings
BEFORE, BACK = 0.08, 0.07  # metres before the lever from which the hand comes, and to which it goes back
OPENED = 0.5  # of an open hand: as far as the fingers are opened before the lever, with the leaf behind it
# Ways onto the lever and off it, of which the first is gone that is clear of the door: metres by which the hand passes
# farther out of the leaf, and seconds by which it is there longer.
WAYS = tuple(product((0.0, 0.02, 0.04, 0.06, 0.09, 0.12), (0.0, 0.1, 0.2)))
LONGEST = 0.3  # of stature: a step backwards or aside that is made without turning about
TRIED = 53  # angles that are looked at in a frame
EASY, STRETCH = 0.86, 40.0  # share of the arm's length up to which it costs nothing, and what a whole one costs
APART, TOUCH = 0.36, 60.0  # metres between the hips and the leaf that are kept, and what one too few costs
PERSON, BESIDE = 0.28, 0.45  # metres that others are wide, from the leaf; and that one keeps from them, stepping along
SOFT, PADDED, EDGE = 9.0, 60, 0.3  # frames by which the leaf's way is smoothed; shares of it that begin and end softly


def swing(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260): steps to the lever, the hand takes it, steps with it, lets it go.

    What the other hand holds is kept out of frame and leaf.
    """
    return kept_clear(task, _swing(task), narrow=True)


def _swing(task: HumanTask) -> Iterator[Array]:
    """The frames (n, 260)."""
    walk_library(task)
    door = door_of(task)
    if task.length:
        task.note("a door takes as long as the steps along with it; the number of frames is not kept to")
    before = door.stand(door.angle)
    hand = Taking(task, door)
    steps = stepped(task, before, ground_of(task), near=NEAR, most=MOST, to=door.name)
    stance, made = yield from _thinking_ahead(task, steps, before, hand)
    told = f"is where {door.name} is swung, or where one steps with it, and does not go; ask them to move"
    yield from until_free(task, stance, hand.hindered, told)
    made = made or Thinking(hand.swings(stance))
    looked, gaze = 0, Looking(begun_at(task, stance.rotations, stance.root), hand.lever)  # as far as it is from here
    while made.part():
        task.refuse_rest()
        made.part()  # two a frame: one stands and looks at the lever meanwhile
        looked += 1
        yield _watching(_standing(task, stance, 1), hand.lever, gaze.turned(np.array([looked])))
    rows = made.found
    rows[:, WATCHES] *= gaze.turned(looked + np.arange(1.0, len(rows) + 1.0))
    for part in np.split(rows, hand.stands):
        task.refuse_rest()
        yield part


def _thinking_ahead(
    task: HumanTask, steps: Generator[Array, None, Stance], goal: Goal, hand: Taking
) -> Generator[Array, None, tuple[Stance, Thinking[Array] | None]]:
    """The frames of the steps to the lever, and with each a part of what comes next.

    Returns:
        how one stands then; what has been thought of it, if that was foreseen when the last step was begun.
    """
    foreseen, made = None, None
    while True:
        try:
            rows = next(steps)
        except StopIteration as end:
            stance: Stance = end.value
            same = foreseen is not None and np.array_equal(foreseen.rotations, stance.rotations)
            return stance, made if same and np.array_equal(foreseen.root, stance.root) else None
        if len(rows) > 1 and _stands(task, ends := end_of(task, rows), goal):
            foreseen, made = ends, Thinking(hand.swings(ends))
        yield from alongside(rows, made or hand.grip)


Part = tuple[Array, Array, Array, Array]


class Taking:
    """A hand that takes a door's lever, from the frame in which it sets out until it hangs again.

    What it does is told as rows (n, 260) of the body without it, palms (n, 7), fingers (n, 14, 4), and by which share
    (n) the waist helps. grip: how it is on the lever, to be thought of first. stands: the frames of `swings` before
    which one stands on both feet.
    """

    def __init__(self, task: HumanTask, door: Door) -> None:
        self.task, self.door, self.reacher = task, door, Reacher.of(task.human, door.hand)
        self.links = list(fingers(door.hand))
        self.grip = Thinking(grip(task, door))
        self.at_ease = task.start.rotations[self.links]
        self.stands: list[int] = []
        self.lever = door.leaf(door.angle).apply(door.lever)

    def swings(self, stance: Stance) -> Steps[Array]:
        """POSE rows (n, 272) of all of it, for who stands so."""
        task, door = self.task, self.door
        while self.grip.part():
            yield
        comes = yield from self._comes(stance)
        goes, then, ends = yield from self._goes(stance)
        leaves = yield from self._leaves(then)
        rows, palms, shape, bends = (np.concatenate(column) for column in zip(comes, goes, leaves, strict=True))
        _loosened(task, door.hand, rows, len(comes[0]))
        rows = Tucking(begun_at(task, stance.rotations, stance.root), but=door.hand).over(rows)
        yield
        yield  # nothing: of two parts a frame, this and the next are not to be in one
        steps = np.arange(len(rows))
        stands = (steps < len(comes[0])) | (steps >= len(rows) - len(leaves[0]))
        rows = self._brought(rows, palms, shape, bends)
        looks_up = minimum_jerk((steps - len(comes[0])) / (LOOKS_UP * task.rate))
        rows = _watching(rows, self.lever, 1.0 - looks_up)
        yield
        at = np.arange(float(len(rows)))
        bears = stands | np.isin(at, len(comes[0]) + np.array(ends))
        rows[:, 0] = at  # by which it is known where one stands when the hand has been slowed down
        made = paced(rows, [*range(43)[self.reacher.links], *self.links], stands)
        self.stands = [int(k) for k in np.flatnonzero(bears[np.rint(made[:, 0]).astype(int)]) if k > 0]
        made[:, 260:] = ways_of(made[:, 1:3], 0, len(made), task.rate).reshape(len(made), -1)
        return made

    def _comes(self, stance: Stance) -> Steps[Part]:
        """The hand comes to the lever and closes."""
        return self._clear(partial(self._coming, stance), self.door.angle, self._fist(np.zeros(1))[0])

    def _coming(self, stance: Stance, out: float, later: float) -> Part:
        comes, closes = _seconds(self.task, COMES + later), _seconds(self.task, CLOSES)
        n = len(comes) + len(closes)
        at = np.concatenate([comes, np.full(len(closes), COMES + later)])
        way = minimum_jerk(at / COMES)
        off = 1.0 - minimum_jerk((at - 0.55 * COMES - later) / (0.45 * COMES))
        on = self._off(self.door.angle, BEFORE * off, out * off)
        own = grips(self.task.human, stance.rotations, stance.root)[self.reacher.row]
        places = own[:3] + minimum_jerk(at / COMES / 0.9)[:, None] * (on[:, :3] - own[:3])
        palms = np.concatenate([places, slerp(own[3:], on[:, 3:], minimum_jerk(at / COMES / 0.8))], axis=1)
        fist, wide = self._fist(np.zeros(1)), self._wide(0.0)
        shape = np.concatenate(
            [
                slerp(stance.rotations[self.links], wide, minimum_jerk(comes / (0.6 * COMES))[:, None]),
                slerp(wide, fist, minimum_jerk(closes / CLOSES)[:, None]),
            ]
        )
        return _standing(self.task, stance, n), palms, shape, way

    def _goes(self, stance: Stance) -> Steps[tuple[Part, Stance, list[int]]]:
        """The steps along with the leaf; how one then stands, the arm hanging; and before which frames one stands."""
        task, door = self.task, self.door
        assert task.library is not None
        places = self._places()
        made: list[Array] = []
        ends: list[int] = []
        for place in places[1:]:
            trip = Trip(task.human, task.library, Ground(), place.place, place.facing)
            for piece in trip.pieces(stance.rotations, stance.root):
                made.append(rows_of(task, piece))
                yield
            stance = Stance(made[-1][-1, 4:176].reshape(43, 4), made[-1][-1, 1:4])
            ends.append(sum(map(len, made)))
        rows = np.concatenate(made)
        begin, end = places[0], places[-1]
        n = len(rows)
        share = self._shares(rows, begin.place, end.place)
        palms = self.grip.found.palms(door.angle + share * (door.wanted - door.angle), np.zeros(n))
        return (rows, palms, self._fist(share), np.ones(n)), stance, ends

    def _fist(self, share: Array) -> Array:
        """The fingers (n, 14, 4) about the lever when the leaf has gone such shares (n) of its way.

        The palm turns on the lever meanwhile: the fingers that come to lie nearer to it are less bent.
        """
        fists = self.grip.found.fists
        at = share * (len(fists) - 1)
        first = np.minimum(at.astype(int), len(fists) - 2)
        return slerp(fists[first], fists[first + 1], (at - first)[:, None])

    def _wide(self, share: float, opened_by: float = OPENED) -> Array:
        """The fingers (14, 4) as they are opened before and after that."""
        fist = self._fist(np.array([share]))[0]
        out = opened(self.door.hand, opened(self.door.hand, fist[:2])[:2])  # the thumb twice as far as usual
        wide = slerp(fist, out, opened_by)
        wide[:2] = out[:2]  # it passes the lever's end
        return wide

    def hindered(self, place: Array) -> bool:
        """Whether the leaf would hit who is at a place (2,) of the world, or one would walk into them."""
        door = self.door
        x, y, _ = door.closed.inverse().apply(np.array([*place, door.closed.place[2]])).tolist()
        away, way = float(np.hypot(x, y)), door.wanted - door.angle
        on = (np.arctan2(y, x) - door.angle) * np.sign(way)  # radians of the leaf's way before it comes to them
        wide = np.arcsin(min(PERSON / max(away, 1e-9), 1.0))
        swept = away < door.width + PERSON and 0.0 < on < abs(way) + wide
        return bool(swept) or any(np.linalg.norm(place - goal.place) < BESIDE for goal in self._places())

    def _places(self) -> list[Goal]:
        """From where one stands to where one stands then, by places so near to each other that nobody turns to walk."""
        door = self.door
        far = float(np.linalg.norm(door.stand(door.wanted).place - door.stand(door.angle).place))
        legs = max(int(np.ceil(far / (LONGEST * self.task.human.stature))), 1)
        return [door.stand(angle) for angle in np.linspace(door.angle, door.wanted, legs + 1)]

    def _shares(self, rows: Array, begin: Array, end: Array) -> Array:
        """How much of its way (n) the leaf has gone in frames (n, 260) of the steps from one place to another.

        As much as the steps, but where that would stretch the arm or bring the leaf onto the body.
        """
        door, skeleton = self.door, self.task.human
        rotations, root = rows[:, 4:176].reshape(-1, 43, 4), rows[:, 1:4]
        way = end - begin
        as_steps = np.maximum.accumulate(np.clip((root[:, :2] - begin) @ way / (way @ way), 0.0, 1.0))
        tried = np.linspace(0.0, 1.0, TRIED)
        angle = door.angle + tried * (door.wanted - door.angle)
        wrist, _ = self.reacher.hand(self.grip.found.palms(angle, np.zeros(TRIED)))
        shoulder = self.reacher.shoulder(seat(skeleton, rotations, root))
        stretched = np.linalg.norm(shoulder[:, None] - wrist, axis=-1) / self.reacher.length
        place = door.closed.inverse().apply(root)[:, None, :2]
        leaf = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
        along = np.clip((place * leaf).sum(axis=-1), 0.0, door.width)
        apart = np.linalg.norm(place - along[..., None] * leaf, axis=-1)
        # The leaf does not pass the body: who pulls it has it come towards them, who pushes it is behind it.
        touch = TOUCH * np.maximum(APART - apart, 0.0) ** 2
        pulls = door.side * (door.wanted - door.angle) > 0.0
        touch = np.maximum.accumulate(touch if pulls else touch[:, ::-1], axis=1)
        cost = (tried - as_steps[:, None]) ** 2 + STRETCH * np.maximum(stretched - EASY, 0.0) ** 2
        cost += touch if pulls else touch[:, ::-1]
        return _softly(np.maximum.accumulate(tried[cost.argmin(axis=1)]))

    def _leaves(self, stance: Stance) -> Steps[Part]:
        """The hand opens, comes off the lever, and hangs again."""
        return self._clear(partial(self._leaving, stance), self.door.wanted, self._fist(np.ones(1))[0])

    def _leaving(self, stance: Stance, out: float, later: float) -> Part:
        opens, leaves = _seconds(self.task, OPENS), _seconds(self.task, LEAVES + later)
        n = len(opens) + len(leaves)
        leaves = np.concatenate([np.zeros(len(opens)), leaves])
        off = minimum_jerk(leaves / (0.5 * (LEAVES + later)))
        away = minimum_jerk((leaves - 0.2 * LEAVES - later) / (0.8 * LEAVES))
        on = self._off(self.door.wanted, BACK * off, out * off)
        hangs = grips(self.task.human, stance.rotations, stance.root)[self.reacher.row]
        places = on[:, :3] + away[:, None] * (hangs[:3] - on[:, :3])
        palms = np.concatenate([places, slerp(on[:, 3:], hangs[3:], away)], axis=1)
        open_by = minimum_jerk(np.concatenate([opens / OPENS, np.ones(n - len(opens))]))
        shape = slerp(self._fist(np.ones(1)), self._wide(1.0), open_by[:, None])
        shape = slerp(shape, self._wide(1.0, opened_by=1.0), minimum_jerk(leaves / (0.4 * LEAVES))[:, None])
        shape = slerp(shape, self.at_ease, minimum_jerk((leaves - later - 0.4 * LEAVES) / (0.5 * LEAVES))[:, None])
        return _standing(self.task, stance, n), palms, shape, 1.0 - away

    def _off(self, angle: float, back: Array, out: Array) -> Array:
        """Palms (n, 7) at an angle of the leaf, metres (n) back from the lever and metres (n) farther out of it."""
        palms = self.grip.found.palms(np.full(len(back), angle), back)
        palms[:, :3] += out[:, None] * rotate(self.door.leaf(angle).rotation, np.array([0.0, self.door.side, 0.0]))
        return palms

    def _clear(self, made: Callable[[float, float], Part], angle: float, fist: Array) -> Steps[Part]:
        """Of ways onto the lever or off it, each made as it is tried, the first on which no finger is in the door."""
        thing = self.task.object
        if thing is None or thing.shape is None:
            return made(*WAYS[0])
        seen = self.door.leaf(angle).inverse()
        hand, field = Hand.of(self.task.human, self.door.hand), thing.shape.field(self.door.lever)
        parts: list[Part] = []

        def ways() -> Iterator[tuple[Array, Array]]:
            for way in WAYS:
                parts.append(made(*way))
                _, palms, shape, _ = parts[-1]
                yield seen.then(Transform.of(palms)).row(), shape

        held = seen.then(Transform.of(self._off(angle, np.zeros(1), np.zeros(1))[0])).row()
        chosen = yield from first_clear(hand, field, ways(), (held, fist))
        yield
        return parts[chosen]

    def _brought(self, rows: Array, palms: Array, shape: Array, bends: Array) -> Array:
        """Frames (n, 260) in which the arm brings the palm there, the elbow as its joints allow and without a jump."""
        n, skeleton, spine = len(rows), self.task.human, INDEX["spine"]
        out = rows.copy()
        rotations, root, targets = out[:, 4:176].reshape(n, 43, 4), out[:, 1:4], out[:, 220:260].reshape(n, 5, 8)
        wrist, _ = self.reacher.hand(palms)
        bent = bent_towards(self.reacher, rotations[:, 0], root, rotations[:, spine], wrist)
        rotations[:, spine] = slerp(rotations[:, spine], bent, bends)
        targets[:, self.reacher.row, :7], targets[:, self.reacher.row, 7] = palms, 1.0
        arm, spine_now = self.reacher.arm, seat(skeleton, rotations, root)
        present = arm.from_pose(rotations[0, self.reacher.links])
        way = follow(arm, self.reacher.wrist(palms, spine_now), present)
        rotations[:, self.reacher.links] = arm.into_pose(way.links)
        rotations[:] = solve(skeleton, rotations, root, targets)
        rotations[:, self.links] = shape
        importance = out[:, 176:220]
        importance[:, self.reacher.links] = importance[:, self.links] = 1.0
        importance[:, spine] = 1.0
        for busy in self.task.busy:
            importance[:, Reacher.of(skeleton, busy).links] = 0.0
        return out


def _stands(task: HumanTask, stance: Stance, goal: Goal) -> bool:
    """Whether one stands at a goal so."""
    standing = Standing.of(task.human, walk_library(task))
    now = footing(task.human, stance.rotations, stance.root, standing)
    return stands_at(standing, now, goal.place, goal.facing)


def _watching(rows: Array, place: Array, share: Array) -> Array:
    """POSE rows (n, 272) in which the eyes are on a place (3,) by such shares (n)."""
    out = rows.copy()
    targets = out[:, 220:260].reshape(len(out), 5, 8)
    targets[:, GAZE, :3], targets[:, GAZE, 7] = place, share
    return out


def _loosened(task: HumanTask, hand: str, rows: Array, first: int) -> None:
    """Let the free arm come from how one stood to how it swings in the steps, which are those of frames from `first`.

    A walk that ended beside a thing has left it drawn in.
    """
    rotations = rows[:, 4:176].reshape(-1, 43, 4)
    share = minimum_jerk(np.arange(1, len(rows) - first + 1) / (LOOSENS * task.rate))[:, None]
    for side in ("right", "left"):
        if side != hand:
            arm = Reacher.of(task.human, side).links
            rotations[first:, arm] = slerp(rotations[first - 1, arm], rotations[first:, arm], share)


def _softly(share: Array) -> Array:
    """A way (n) from 0 to 1 that begins and ends softly, and changes so in between."""
    padded = np.concatenate([np.full(PADDED, share[0]), share, np.full(PADDED, share[-1])])
    soft = gaussian_filter1d(padded, SOFT)[PADDED:-PADDED]
    time = np.arange(1, len(soft) + 1) / len(soft)
    soft = soft * minimum_jerk(time / EDGE)
    return soft + (1.0 - soft) * minimum_jerk((time - 1.0 + EDGE) / EDGE)


def _seconds(task: HumanTask, seconds: float) -> Array:
    """Seconds from the beginning, frame by frame (n)."""
    n = round(seconds * task.rate)
    return seconds * np.arange(1, n + 1) / n


def _standing(task: HumanTask, stance: Stance, n: int) -> Array:
    """POSE rows (n, 272) of standing as one stands."""
    targets = np.zeros((n, 5, 8))
    targets[:, RIGHT_FOOT : LEFT_FOOT + 1, :7] = feet(task.human, stance.rotations, stance.root)
    targets[:, RIGHT_FOOT : LEFT_FOOT + 1, 7] = 1.0
    rotations, root = np.repeat(stance.rotations[None], n, axis=0), np.repeat(stance.root[None], n, axis=0)
    return task.block(rotations, root, np.repeat(IMPORTANCE[None], n, axis=0), targets, staying(stance.root[:2]))


if __name__ == "__main__":
    run(swing)
