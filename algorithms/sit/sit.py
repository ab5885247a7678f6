"""Sitting down on a seat, and standing up from it.

The feet stay. The trunk leans before the knees bend far, the hips go back and down with the weight over the feet until
the seat bears them, and the trunk comes up; standing up is the same in reverse order, a little quicker. Who stands
elsewhere goes to the object's site `stand` first. Who is to stand up from castors, and has no room, rolls back first.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import dataclass

import numpy as np

from ahmss.algorithm import HumanPose, HumanTask, Transform, run
from ahmss.algorithm.haste import hurried
from ahmss.body.array import Array
from ahmss.body.inverse import LEFT_FOOT, RIGHT_FOOT, grips, solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import align, conjugate, from_axis_angle, from_matrix, multiply, rotate, slerp
from ahmss.errors import AlgorithmError
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.planting import feet
from ahmss.reaching.standing import Posture
from ahmss.skills.begun import begun_at
from ahmss.skills.castors import rolled_to
from ahmss.skills.hands_aside import hands_aside
from ahmss.skills.rising import at_ease_on, drawn_in, risen
from ahmss.skills.seat_room import in_its_room
from ahmss.skills.sitting import Seated, heading_of, must_stand, seat_of
from ahmss.skills.stepping import IMPORTANCE, Stance, ground_of, stepped, until_free, walk_library
from ahmss.skills.word import closed_at_last
from ahmss.walking.goals import Goal, facing_of
from ahmss.walking.library import BODY
from ahmss.walking.obstacles import Obstacles

DOWN, UP = 2.1, 1.8  # seconds: sitting down takes 10 to 20 % longer than standing up
# The hips' height over what bears them, of the hip joints' distance from the middle: who is wide there is thick there.
OVER_SEAT = 1.415
NEAR, MOST, ASIDE = (0.06, np.radians(6.0)), 12.0, 0.15  # metres and radians: who stands so is not moved; metres walked
BACK, ROOM = (0.0, *np.arange(0.1, 1.0, 0.1).tolist()), 0.32  # metres rolled back to stand up; that are free then
TAKEN = 0.35  # metres from the seat's middle: who is so near is on it
LEAN = np.radians(47.0)  # of the trunk, at the most
OF_HIPS = 0.6  # of the lean that the hips make
RECLINES = np.radians(4.0)  # of the trunk on the seat
# Shares of the time of sitting down: the hips go, the seat bears them; the trunk leans, comes up again.
GOES, BORNE, LEANT, RISES = 0.08, 0.74, 0.54, 0.62
BACK_FIRST = 1.35  # exponent: above 1 the hips go down before they go back
ON_THIGH, OVER_THIGH, INWARD = 0.62, 0.062, np.radians(12.0)  # of the thigh; metres; of the resting hands
TURNS = 12  # frames to a standstill of who sits down, before they rise again
HANDS = 0.35, 0.95  # shares of the time in which free hands go to the thighs
THERE = 0.45  # share of the time of standing up in which hands that were elsewhere come along
GOES_ALONG = 0.4  # of the way that a shoulder leans ahead, a hand that holds something
HELD_OVER, HELD_BEFORE = 0.27, 0.22  # metres over the seat, before the hips, of a hand that holds something, at least
UPWARD, LEFTWARD = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
SIDES = ("right", "left")


@dataclass(frozen=True, eq=False)
class Move:
    """Between standing and sitting: how one stands, how one sits, which way a sitter looks in radians, the seat."""

    stands: Stance | Posture
    sits: Stance
    heading: float
    seat: Transform

    @property
    def left(self) -> Array:
        """The sitter's left (3,)."""
        return rotate(from_axis_angle(UPWARD, self.heading), LEFTWARD)

    @property
    def ahead(self) -> Array:
        """Where the sitter looks (3,)."""
        return np.array([np.cos(self.heading), np.sin(self.heading), 0.0])


def sit(task: HumanTask) -> Iterator[Array | HumanPose]:
    """Frames (n, 260): down onto the seat, or up from it."""
    if task.site is None or task.object is None:
        raise AlgorithmError("sit needs a site: the seat, its x where a sitter looks")
    if task.parameter("up", False):
        yield from _up(task)
        return
    task = yield from risen(task, IMPORTANCE, task.busy)
    assert task.site is not None
    assert task.object is not None
    if task.start.root[2] < task.site.place[2] + 2.0 * _thick(task):
        raise AlgorithmError(must_stand(task, "sit down"))
    walk_library(task)
    stand = task.object.site("stand", task.start.root)
    goal = Goal(stand.place[:2], facing_of(stand.rotation))
    if taken := in_its_room(task, task.object):
        out = f"`do {_name(task)} draw_out` first" if Seated(task.object).castors else "move one of them first"
        raise AlgorithmError(f"{_name(task)} is drawn up to {taken}, there is no room to sit down on it; {out}")
    yield from _free(task, Stance(task.start.rotations, task.start.root))
    stance = yield from stepped(task, goal, ground_of(task), near=NEAR, most=MOST, to=task.object.name)
    yield from _free(task, stance)
    task = yield from drawn_in(begun_at(task, stance.rotations, stance.root), IMPORTANCE, task.busy)
    yield from _down(task, Stance(task.start.rotations, task.start.root))


def _free(task: HumanTask, stance: Stance) -> Iterator[Array]:
    """Frames of standing while somebody else is on the seat."""
    seat = _seat(task)[1].place[:2]
    told = f"is where one sits on {_name(task)}; take another seat, or ask them to move"
    return until_free(task, stance, lambda place: float(np.linalg.norm(place - seat)) < TAKEN, told)


def _down(task: HumanTask, stance: Stance) -> Iterator[Array | HumanPose]:
    """Down onto the seat; who is to come to rest before it bears them rises again."""
    frames = hurried(task, round(DOWN * task.rate))
    move = Move(stance, _seated(task, stance), *_seat(task))
    time = np.arange(1, frames + 1) / frames
    rows, borne = _rows(task, move, stance, time), int(np.searchsorted(time, BORNE)) + 1
    for k in range(borne - 1):
        if task.rests:
            yield _rows(task, move, stance, _back(k / frames, 1.0 / frames))
        task.refuse_rest()
        yield rows[k : k + 1]
    yield from closed_at_last(rows[borne - 1 : borne])
    yield rows[borne:]


def _back(time: float, pace: float) -> Array:
    """Shares of the time (n) from one at which one goes on at a pace a frame, to where one turns round, and to 0."""
    turns = np.arange(TURNS, -TURNS, -1) / TURNS  # of the pace, from onward to back
    shares = time + pace * np.cumsum(turns)
    left = int(np.ceil(max(float(shares[-1]), 0.0) / pace))
    shares = np.concatenate([shares, shares[-1] - pace * np.arange(1, left + 1)])
    return np.append(shares[shares > 0.0], 0.0)


def _up(task: HumanTask) -> Iterator[Array]:
    """Raises: AlgorithmError: nobody sits there, or there is no room to stand."""
    off = task.start.root - _over(task, _seat(task)[1])
    if np.linalg.norm(off) > ASIDE:
        raise AlgorithmError(f"one must sit on {_name(task)} to stand up from it; the hips are elsewhere")
    task = yield from _rolled_back(task)
    heading, seat = _seat(task)
    frames = hurried(task, round(UP * task.rate))
    sits = Stance(task.start.rotations.copy(), task.start.root.copy())
    move = Move(at_ease_on(task, sits.rotations, sits.root), sits, heading, seat)
    yield _rows(task, move, sits, 1.0 - np.arange(1, frames + 1) / frames)


def _rolled_back(task: HumanTask) -> Generator[Array, None, HumanTask]:
    """The task from where there is room to stand; as it is, or, of who sits on castors, after rolling back (n, 260)."""
    seat = seat_of(task)
    if seat is None or not seat.castors or task.site is None:
        return task
    start, heading = task.start, heading_of(task.start.rotations)
    ground, ahead = ground_of(task), np.array([np.cos(heading), np.sin(heading)])
    about = [ring for ring, name in zip(ground.outlines, ground.names, strict=True) if name != seat.thing.name]
    stands = at_ease_on(task, start.rotations, start.root).root[:2]
    room = [
        far for far in BACK if float(Obstacles.of(about, 0.0).clearance(stands - far * ahead).min(initial=1.0)) > ROOM
    ]
    if not about or not room or room[0] == 0.0:
        return task
    rotations, root = start.rotations, start.root
    for rows in rolled_to(task, seat, [(start.root[:2] - far * ahead, heading) for far in room]):
        rotations, root = rows[-1, 4:176].reshape(43, 4), rows[-1, 1:4]
        yield rows
    moved = begun_at(task, rotations, root)
    moved.site = Transform(task.site.place + root - start.root, task.site.rotation)
    return moved


def _rows(task: HumanTask, move: Move, begun: Stance, time: Array) -> Array:
    """POSE rows (n, 260) at shares of the time (n) from standing, 0, to sitting, 1."""
    down = minimum_jerk((time - GOES) / (BORNE - GOES))
    lean = LEAN * minimum_jerk(time / LEANT) * (1.0 - minimum_jerk((time - RISES) / (1.0 - RISES)))
    rotations, root = _trunk(move, down, lean)
    targets = np.zeros((len(time), 5, 8))
    planted = feet(task.human, begun.rotations, begun.root)
    targets[:, RIGHT_FOOT : LEFT_FOOT + 1, :7], targets[:, RIGHT_FOOT : LEFT_FOOT + 1, 7] = planted, 1.0
    rotations = solve(task.human, rotations, root, targets)
    hands = targets.copy()
    hands[:, :2] = _hands(task, move, begun, time, rotations, root)
    rotations = solve(task.human, rotations, root, hands)
    moved = hands_aside(task, rotations, root)
    if moved.any():
        hands[:, :2, :3] += moved
        rotations = solve(task.human, rotations, root, hands)
    for row, side in enumerate(SIDES):  # what is held goes where it goes, whatever else is made
        if side in task.busy:
            targets[:, row] = hands[:, row]
    importance = np.zeros(44)
    importance[:BODY], importance[-1] = 1.0, 1.0
    importance[INDEX["head"]] = 0.08
    return task.block(rotations, root, np.repeat(importance[None], len(time), axis=0), targets)


def _trunk(move: Move, down: Array, lean: Array) -> tuple[Array, Array]:
    """Poses (n, 43, 4) and roots (n, 3): so far down (n) from standing, the trunk leant (n) radians more than then."""
    stands, sits, n = move.stands, move.sits, len(down)
    rotations = slerp(stands.rotations, sits.rotations, down[:, None])
    hips, spine = INDEX["hips"], INDEX["spine"]
    trunk = multiply(rotations[:, hips], rotations[:, spine])
    axis = np.broadcast_to(move.left, (n, 3))
    rotations[:, hips] = multiply(from_axis_angle(axis, OF_HIPS * lean), rotations[:, hips])
    leant = multiply(from_axis_angle(axis, lean), trunk)
    rotations[:, spine] = align(multiply(conjugate(rotations[:, hips]), leant), rotations[:, spine])
    back = from_axis_angle(np.broadcast_to(LEFTWARD, (n, 3)), -0.5 * lean)  # the head looks ahead, not at the knees
    rotations[:, INDEX["head"]] = multiply(rotations[:, INDEX["head"]], back)
    way = sits.root - stands.root
    root = stands.root + down[:, None] * way
    root[:, :2] = stands.root[:2] + (down**BACK_FIRST)[:, None] * way[:2]
    return rotations, root


def _hands(task: HumanTask, move: Move, begun: Stance, time: Array, rotations: Array, root: Array) -> Array:
    """Targets (n, 2, 8) of the palms: free ones between hanging and the thighs, others as they are, not tipped."""
    skeleton, n = task.human, len(time)
    out = np.zeros((n, 2, 8))
    out[..., 7] = 1.0
    places, _ = forward(rotations, root, skeleton.offsets)
    before, _ = forward(begun.rotations, begun.root, skeleton.offsets)
    was = grips(skeleton, begun.rotations, begun.root)
    above, _ = forward(move.stands.rotations, move.stands.root, skeleton.offsets)
    hangs = grips(skeleton, move.stands.rotations, move.stands.root)
    share = minimum_jerk((time - HANDS[0]) / (HANDS[1] - HANDS[0]))
    for row, side in enumerate(SIDES):
        shoulder = INDEX[f"{side}_upper_arm"]
        if side in task.busy:
            out[:, row, 3:7] = was[row, 3:]
            leant = (places[:, shoulder] - root) - (before[shoulder] - begun.root)
            leant[:, :2] *= GOES_ALONG  # the hand is drawn in while the trunk leans, so that it meets no table
            out[:, row, :3] = was[row, :3] + root - begun.root + leant
            out[:, row, :3] += _clear(move, out[:, row, :3], time)
            continue
        upper, lower = places[:, INDEX[f"{side}_upper_leg"]], places[:, INDEX[f"{side}_lower_leg"]]
        rest = upper + ON_THIGH * (lower - upper) + OVER_THIGH / 1.76 * skeleton.stature * UPWARD
        palm = _palm_down(side, move.heading)
        hung = hangs[row, :3] + places[:, shoulder] - above[shoulder]
        out[:, row, :3] = hung + share[:, None] * (rest - hung)
        out[:, row, 3:7] = slerp(hangs[row, 3:], palm, share)
        if time[0] > time[-1]:  # up, from wherever the hands are
            come = minimum_jerk((1.0 - time) / THERE)
            off = was[row, :3] - begun.root - (out[0, row, :3] - root[0])
            out[:, row, :3] += (1.0 - come)[:, None] * off
            out[:, row, 3:7] = slerp(was[row, 3:], out[:, row, 3:7], come)
    return out


def _clear(move: Move, palms: Array, time: Array) -> Array:
    """By how much (n, 3) a hand that holds something is brought over the lap, so that it is not beside the seat."""
    last = palms[np.argmax(time)]
    short = HELD_OVER + move.seat.place[2] - last[2]
    behind = HELD_BEFORE - (last - move.sits.root) @ move.ahead
    return minimum_jerk(time)[:, None] * (max(short, 0.0) * UPWARD + max(behind, 0.0) * move.ahead)


def _palm_down(side: str, heading: float) -> Array:
    """The rotation (4,) of a palm that lies on a thigh, the fingers ahead and a little inward."""
    sign = 1.0 if side == "right" else -1.0
    flat = np.array([[0.0, -sign, 0.0], [0.0, 0.0, sign], [-1.0, 0.0, 0.0]])  # columns: out of the palm, y, the thumb
    return multiply(from_axis_angle(UPWARD, heading + sign * INWARD), from_matrix(flat))


def _seat(task: HumanTask) -> tuple[float, Transform]:
    """Which way a sitter looks, radians, and the seat in the world."""
    assert task.site is not None
    return facing_of(task.site.rotation), task.site


def _thick(task: HumanTask) -> float:
    """How high the hips are over what bears them, metres."""
    return OVER_SEAT * abs(float(task.human.offsets[INDEX["right_upper_leg"], 1]))


def _over(task: HumanTask, seat: Transform) -> Array:
    """Where the hips are (3,) of who sits."""
    return seat.place + _thick(task) * UPWARD


def _seated(task: HumanTask, stance: Stance) -> Stance:
    """The trunk upright over the seat, the head as it is, the arms hanging as they hang."""
    heading, seat = _seat(task)
    rotations, _ = task.human.upright()
    rotations = rotations.copy()
    turn = from_axis_angle(UPWARD, heading)
    rotations[0] = multiply(turn, rotations[0])
    reclined = from_axis_angle(rotate(turn, LEFTWARD), -RECLINES)
    rotations[0] = align(multiply(reclined, rotations[0]), stance.rotations[0])
    kept = [i for i, link in enumerate(LINKS) if i >= BODY or link.endswith(("arm", "hand"))]
    rotations[kept] = stance.rotations[kept]
    return Stance(align(rotations, stance.rotations), _over(task, seat))


def _name(task: HumanTask) -> str:
    return "it" if task.object is None else task.object.name


if __name__ == "__main__":
    run(sit)
