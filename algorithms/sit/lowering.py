"""How the body goes down onto a seat, and up from it: trunk and hips, legs on feet that stay, hands to the thighs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.algorithm import HumanTask, Transform
from ahmss.body.array import Array
from ahmss.body.inverse import LEFT_FOOT, RIGHT_FOOT, grips, solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import align, conjugate, from_axis_angle, multiply, rotate, slerp
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.planting import feet
from ahmss.reaching.standing import Posture
from ahmss.skills.hands_aside import hands_aside
from ahmss.skills.on_thigh import on_thigh
from ahmss.skills.seat_ways import AT_EASE, Manner
from ahmss.skills.stepping import Stance
from ahmss.walking.library import BODY

__all__ = ["BORNE", "Move", "lowered"]

LEAN = np.radians(47.0)  # of the trunk, at the most
OF_HIPS = 0.6  # of the lean that the hips make
# Shares of the time of sitting down: the hips go, the seat bears them; the trunk leans, comes up again.
GOES, BORNE, LEANT, RISES = 0.08, 0.74, 0.54, 0.62
THERE = 0.45  # share of the time of standing up in which hands that were elsewhere come along
GOES_ALONG = 0.4  # of the way that a shoulder leans ahead, a hand that holds something
HELD_OVER, HELD_BEFORE = 0.27, 0.22  # metres over the seat, before the hips, of a hand that holds something, at least
UPWARD, LEFTWARD = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
SIDES = ("right", "left")


@dataclass(frozen=True, eq=False)
class Move:
    """Between standing and sitting: how one stands, how one sits, which way a sitter looks (radians), the seat, how."""

    stands: Stance | Posture
    sits: Stance
    heading: float
    seat: Transform
    manner: Manner = AT_EASE

    @property
    def left(self) -> Array:
        """The sitter's left (3,)."""
        return rotate(from_axis_angle(UPWARD, self.heading), LEFTWARD)

    @property
    def ahead(self) -> Array:
        """Where the sitter looks (3,)."""
        return np.array([np.cos(self.heading), np.sin(self.heading), 0.0])


def lowered(task: HumanTask, move: Move, begun: Stance, time: Array) -> Array:
    """POSE rows (n, 260) at shares of the time (n) from standing, 0, to sitting, 1."""
    down = minimum_jerk((time - GOES) / (BORNE - GOES))
    lean = move.manner.lean * LEAN * minimum_jerk(time / LEANT) * (1.0 - minimum_jerk((time - RISES) / (1.0 - RISES)))
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
    root[:, :2] = stands.root[:2] + (down**move.manner.back)[:, None] * way[:2]
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
    goes, rests = move.manner.hands
    share = minimum_jerk((time - goes) / (rests - goes))
    for row, side in enumerate(SIDES):
        shoulder = INDEX[f"{side}_upper_arm"]
        if side in task.busy:
            out[:, row, 3:7] = was[row, 3:]
            leant = (places[:, shoulder] - root) - (before[shoulder] - begun.root)
            leant[:, :2] *= GOES_ALONG  # the hand is drawn in while the trunk leans, so that it meets no table
            out[:, row, :3] = was[row, :3] + root - begun.root + leant
            out[:, row, :3] += _clear(move, out[:, row, :3], time)
            continue
        thigh = on_thigh(skeleton, places, side, move.heading)
        hung = hangs[row, :3] + places[:, shoulder] - above[shoulder]
        out[:, row, :3] = hung + share[:, None] * (thigh.place - hung)
        out[:, row, 3:7] = slerp(hangs[row, 3:], thigh.rotation, share)
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
