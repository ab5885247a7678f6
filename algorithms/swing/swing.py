"""Opening and closing a door that one walks through: a hand takes the lever, the body steps along with the leaf.

One stands where the arm reaches the lever at the leaf's angle now, and steps to where it reaches it at the angle that
it is swung to; in between the hand goes along the lever's arc, and the object's own algorithm turns the leaf with it.
So one pushes from one side and pulls from the other.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np
from scipy.ndimage import gaussian_filter1d

from ahmss.algorithm import HumanTask, Transform, run
from ahmss.algorithm.pacing import paced
from ahmss.algorithm.stepping import IMPORTANCE, Stance, ground_of, rows_of, stepped, until_free, walk_library
from ahmss.algorithm.tucking import Tucking
from ahmss.body.arm_path import follow
from ahmss.body.array import Array
from ahmss.body.inverse import LEFT_FOOT, RIGHT_FOOT, grips, solve
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import from_axis_angle, from_matrix, multiply, rotate, slerp
from ahmss.errors import AlgorithmError
from ahmss.grasping.clear import first_clear
from ahmss.grasping.hand import Hand
from ahmss.grasping.rolling import wrapped_at
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.fingers import Cylinder, closed, opened
from ahmss.motion.planting import feet
from ahmss.motion.way import staying
from ahmss.reaching.reacher import Reacher, seat
from ahmss.reaching.waist import bent_towards
from ahmss.walking.goals import Goal
from ahmss.walking.pieces import ways_of
from ahmss.walking.trip import Ground, Trip

UPWARD = np.array([0.0, 0.0, 1.0])
WIDE = 1.3  # radians: the angle that the second of the places below is for
ARM = 0.68  # metres from the hinge to the lever that they are for
# Where one stands, in the closed leaf's frame: x, y in metres and the heading in degrees, with the leaf closed and wide
# open; and how the palm is on the lever, degrees by which it looks down and by which it is turned to the left. By the
# side of the leaf, -1 before it and 1 where it opens to, and the hand. Found by a search for what both shipped bodies
# do with the least bent wrist and the arm not stretched, clear of the leaf and the frame.
STANDS = {
    (-1, "right"): ((0.43, -0.42, 125.0), (0.49, 0.12, 152.0), (50.0, -10.0)),
    (-1, "left"): ((0.61, -0.50, 6.0), (0.47, 0.03, 20.0), (85.0, -26.0)),
    (1, "right"): ((0.84, 0.64, -43.0), (0.08, 1.25, -26.0), (50.0, -12.0)),
    (1, "left"): ((0.34, 0.51, -101.0), (-0.33, 0.61, -58.0), (50.0, 0.0)),
}
TURNS_ALONG = 0.5  # of the leaf's turn that the palm makes on the lever, even at half the way
NEAR, MOST = (0.05, np.radians(5.0)), 2.0  # metres and radians: who stands so is not moved; metres that are stepped
COMES, CLOSES, OPENS, LEAVES = 0.95, 0.3, 0.25, 0.6  # seconds
LOOSENS = 0.8  # seconds in which the free arm comes from how one stood to how it swings
BEFORE, BACK = 0.08, 0.07  # metres before the lever from which the hand comes, and to which it goes back
DIAMETER, INTO_FINGERS = 0.022, 0.0165  # metres: of a lever that does not say; how far it lies towards the fingers
PALM, SKIN = 0.0065, 0.003  # metres that palm and fingers are thicker than they are told to be
FISTS = 17  # angles of the leaf at which the fingers are closed about the lever
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


@dataclass(frozen=True, eq=False)
class Door:
    """A door, and from which side it is taken.

    closed: its frame when it is closed. angle, wanted: radians, now and then. side: on which one is, -1 or 1. lever:
    (3,) on that side, in the leaf's frame. width: of the leaf, metres.
    hand: that takes it.
    """

    name: str
    closed: Transform
    angle: float
    wanted: float
    side: int
    lever: Array
    width: float
    hand: str

    def stand(self, angle: float) -> Goal:
        """Where one stands to have the lever in hand at an angle."""
        first, last = (np.array(place) for place in STANDS[self.side, self.hand][:2])
        x, y, heading = first + np.clip(angle / WIDE, 0.0, 1.0) * (last - first)
        place = self.closed.apply(np.array([x + self.lever[0] - ARM, y, 0.0]))
        ahead = rotate(self.closed.rotation, np.array([np.cos(np.radians(heading)), np.sin(np.radians(heading)), 0.0]))
        return Goal(place[:2], float(np.arctan2(ahead[1], ahead[0])))

    def leaf(self, angle: float) -> Transform:
        """Its frame at an angle."""
        return self.closed.then(Transform(np.zeros(3), from_axis_angle(UPWARD, np.array(angle))))

    def yaw(self, angle: Array) -> Array:
        """Radians (n) by which the palm is turned to the left from how it is squarely on the closed leaf, at angles."""
        return TURNS_ALONG * angle + (1.0 - TURNS_ALONG) * 0.5 * WIDE + np.radians(STANDS[self.side, self.hand][2][1])

    def palms(self, palm: Transform, angle: Array, before: Array) -> Array:
        """The palm (n, 7) on the lever at angles (n), drawn back by metres (n); `palm` is on the closed leaf's."""
        leaf = from_axis_angle(np.broadcast_to(UPWARD, (*angle.shape, 3)), angle)
        yaw = self.yaw(angle)
        own = from_axis_angle(np.broadcast_to(UPWARD, (*angle.shape, 3)), yaw)
        turned = multiply(own, palm.rotation)
        around = rotate(leaf, self.lever) + rotate(own, palm.place - self.lever)
        places = around - before[:, None] * rotate(turned, np.array([1.0, 0.0, 0.0]))
        inner = Transform(places, turned)
        return Transform(
            np.broadcast_to(self.closed.place, places.shape), np.broadcast_to(self.closed.rotation, turned.shape)
        ).then(inner).row()  # fmt: skip


def swing(task: HumanTask) -> Iterator[Array]:
    """Frames (n, 260): steps to the lever, the hand takes it, steps with it, lets it go."""
    walk_library(task)
    door = _door(task)
    if task.length:
        task.note("a door takes as long as the steps along with it; the number of frames is not kept to")
    before = door.stand(door.angle)
    stance = yield from stepped(task, before, ground_of(task), near=NEAR, most=MOST, to=door.name)
    hand = Taking(task, door)
    told = f"is where {door.name} is swung, or where one steps with it, and does not go; ask them to move"
    yield from until_free(task, stance, hand.hindered, told)
    comes = hand.comes(stance)
    goes, then = hand.goes(stance)
    parts = (comes, goes, hand.leaves(then))
    rows, palms, shape, bends = (np.concatenate(column) for column in zip(*parts, strict=True))
    _loosened(task, door.hand, rows, len(comes[0]))
    rows = Tucking(task, but=door.hand).over(rows)
    steps = np.arange(len(rows))
    stands = (steps < len(comes[0])) | (steps >= len(rows) - len(parts[2][0]))
    made = paced(hand.brought(rows, palms, shape, bends), [*range(43)[hand.reacher.links], *hand.links], stands)
    made[:, 260:] = ways_of(made[:, 1:3], 0, len(made)).reshape(len(made), -1)
    yield made


Part = tuple[Array, Array, Array, Array]


class Taking:
    """A hand that takes a door's lever, from the frame in which it sets out until it hangs again.

    What it does is told as rows (n, 260) of the body without it, palms (n, 7), fingers (n, 14, 4), and by which share
    (n) the waist helps.
    """

    def __init__(self, task: HumanTask, door: Door) -> None:
        self.task, self.door, self.reacher = task, door, Reacher.of(task.human, door.hand)
        self.links = list(fingers(door.hand))
        self.palm, self.fists = _grip(task, door)
        self.at_ease = task.start.rotations[self.links]

    def comes(self, stance: Stance) -> Part:
        """The hand comes to the lever and closes."""
        parts = [self._coming(stance, *way) for way in WAYS]
        return self._clear(parts, self.door.angle, self._fist(np.zeros(1))[0])

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

    def goes(self, stance: Stance) -> tuple[Part, Stance]:
        """The steps along with the leaf, and how one then stands, the arm hanging."""
        task, door = self.task, self.door
        assert task.library is not None
        places = self._places()
        made: list[Array] = []
        for place in places[1:]:
            trip = Trip(task.human, task.library, Ground(), place.place, place.facing)
            made += [rows_of(task, piece) for piece in trip.pieces(stance.rotations, stance.root)]
            stance = Stance(made[-1][-1, 4:176].reshape(43, 4), made[-1][-1, 1:4])
        rows = np.concatenate(made)
        begin, end = places[0], places[-1]
        n = len(rows)
        share = self._shares(rows, begin.place, end.place)
        palms = door.palms(self.palm, door.angle + share * (door.wanted - door.angle), np.zeros(n))
        return (rows, palms, self._fist(share), np.ones(n)), stance

    def _fist(self, share: Array) -> Array:
        """The fingers (n, 14, 4) about the lever when the leaf has gone such shares (n) of its way.

        The palm turns on the lever meanwhile: the fingers that come to lie nearer to it are less bent.
        """
        at = share * (len(self.fists) - 1)
        first = np.minimum(at.astype(int), len(self.fists) - 2)
        return slerp(self.fists[first], self.fists[first + 1], (at - first)[:, None])

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
        wrist, _ = self.reacher.hand(door.palms(self.palm, angle, np.zeros(TRIED)))
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

    def leaves(self, stance: Stance) -> Part:
        """The hand opens, comes off the lever, and hangs again."""
        parts = [self._leaving(stance, *way) for way in WAYS]
        return self._clear(parts, self.door.wanted, self._fist(np.ones(1))[0])

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
        palms = self.door.palms(self.palm, np.full(len(back), angle), back)
        palms[:, :3] += out[:, None] * rotate(self.door.leaf(angle).rotation, np.array([0.0, self.door.side, 0.0]))
        return palms

    def _clear(self, parts: Sequence[Part], angle: float, fist: Array) -> Part:
        """Of ways onto the lever or off it the first on which no finger is in the door."""
        thing = self.task.object
        if thing is None or thing.shape is None:
            return parts[0]
        seen = self.door.leaf(angle).inverse()
        hand, field = Hand.of(self.task.human, self.door.hand), thing.shape.field(self.door.lever)
        ways = [(seen.then(Transform.of(palms)).row(), shape) for _, palms, shape, _ in parts]
        held = seen.then(Transform.of(self._off(angle, np.zeros(1), np.zeros(1))[0])).row()
        return parts[first_clear(hand, field, ways, (held, fist))]

    def brought(self, rows: Array, palms: Array, shape: Array, bends: Array) -> Array:
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


def _door(task: HumanTask) -> Door:
    thing = task.object
    if thing is None or task.site is None or not thing.sites:
        raise AlgorithmError("swing needs a door and the site of its lever")
    angle = float(thing.states.get("angle", 0.0))
    closed = Transform(thing.place.copy(), multiply(thing.rotation, from_axis_angle(UPWARD, -angle)))
    side = 1 if closed.inverse().apply(task.start.root)[1] > 0.0 else -1
    names = [name for name in (task.message.site, f"{task.message.site}_back") if name in thing.sites]
    size = thing.properties.get("size")
    width = float(size[0]) if isinstance(size, (list, tuple)) else float(thing.sites[names[0]].position[0])
    site = thing.sites[max(names, key=lambda name: side * thing.sites[name].position[1])]
    return Door(thing.name, closed, angle, task.parameter("to", 0.0), side, np.array(site.position), width, _hand(task))


def _hand(task: HumanTask) -> str:
    """Raises: AlgorithmError: both hands hold something."""
    free = [side for side in ("right", "left") if side not in task.busy]
    if task.hand:
        return task.hand
    if not free:
        raise AlgorithmError("both hands hold something; let go of it first")
    return free[0]


def _grip(task: HumanTask, door: Door) -> tuple[Transform, Array]:
    """The palm squarely on the lever, in the closed leaf's frame, from before and above; and the fingers (m, 14, 4)
    closed about it at even shares of the leaf's way.
    """
    assert task.object is not None
    side, into = door.hand, np.array([0.0, -float(door.side), 0.0])
    thumb = np.cross(into, UPWARD) * (1.0 if side == "left" else -1.0)
    pitch = np.radians(STANDS[door.side, side][2][0])
    out = np.cos(pitch) * into - np.sin(pitch) * UPWARD
    rotation = from_matrix(np.stack([out, np.cross(thumb, out), thumb], axis=1))
    radius = 0.5 * float(task.object.properties.get("knob_diameter", DIAMETER))
    to_fingers = np.cos(pitch) * UPWARD + np.sin(pitch) * into
    palm = Transform(door.lever - (radius + PALM) * out - INTO_FINGERS * to_fingers, rotation)
    angle = np.linspace(door.angle, door.wanted, FISTS)
    palm = Transform(palm.place - _too_deep(task, door, palm, angle) * out, rotation)
    row = Reacher.of(task.human, side).row
    seen = palm.then(Transform.of(task.human.grips[row]).inverse()).inverse()  # the leaf as the hand sees it
    fists: list[Array] = []
    for slant in (door.yaw(angle) - angle).tolist():
        along = rotate(from_axis_angle(UPWARD, np.array(-slant)), thumb)
        bar = Cylinder(seen.apply(door.lever), rotate(seen.rotation, along), radius + SKIN)
        fists.append(closed(task.human, side, bar))
    return palm, _by_shape(task, door, palm, angle, np.stack(fists))


def _too_deep(task: HumanTask, door: Door, palm: Transform, angle: Array) -> float:
    """Metres by which the palm is in the lever at some of the angles (m) of the leaf, where its shape is known."""
    thing = task.object
    if thing is None or thing.shape is None:
        return 0.0
    palms = _on_leaf(door, palm, angle)
    return float(Hand.of(task.human, door.hand).palm_depth(thing.shape.field(door.lever), palms).max(initial=0.0))


def _by_shape(task: HumanTask, door: Door, palm: Transform, angle: Array, fists: Array) -> Array:
    """The fists (m, 14, 4) closed onto the leaf's own shape at angles (m) of it, where that is known."""
    thing = task.object
    if thing is None or thing.shape is None:
        return fists
    palms = _on_leaf(door, palm, angle)
    return wrapped_at(Hand.of(task.human, door.hand), thing.shape.field(door.lever), palms, fists)


def _on_leaf(door: Door, palm: Transform, angle: Array) -> Array:
    """The palm (m, 7) as the leaf has it at angles (m)."""
    palms = Transform.of(door.palms(palm, angle, np.zeros(len(angle))))
    turned = multiply(door.closed.rotation, from_axis_angle(np.broadcast_to(UPWARD, (len(angle), 3)), angle))
    return Transform(np.broadcast_to(door.closed.place, (len(angle), 3)), turned).inverse().then(palms).row()


def _standing(task: HumanTask, stance: Stance, n: int) -> Array:
    """POSE rows (n, 272) of standing as one stands."""
    targets = np.zeros((n, 5, 8))
    targets[:, RIGHT_FOOT : LEFT_FOOT + 1, :7] = feet(task.human, stance.rotations, stance.root)
    targets[:, RIGHT_FOOT : LEFT_FOOT + 1, 7] = 1.0
    rotations, root = np.repeat(stance.rotations[None], n, axis=0), np.repeat(stance.root[None], n, axis=0)
    return task.block(rotations, root, np.repeat(IMPORTANCE[None], n, axis=0), targets, staying(stance.root[:2]))


if __name__ == "__main__":
    run(swing)
