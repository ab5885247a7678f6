"""Arms of who walks are drawn in where their swing would take a hand through a thing beside the way.

A hand that hangs beside a counter comes up before the belly, as people do who pass or turn close by, and goes down
again when there is room; what would still be in a thing, on the way there too, is moved aside. Past other people they
swing less (`ahmss.skills.arms_in`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.arm import Arm, hand_angles, with_hand
from ahmss.body.arm_swing import HAND, limits_of
from ahmss.body.array import Array
from ahmss.body.inverse import solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import align, conjugate, from_matrix, multiply, rotate, slerp, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.motion.edit import floor_frame
from ahmss.reaching.prism import Prism, clearance
from ahmss.skills.arms_in import ArmsIn
from ahmss.skills.hanging import Hanging
from ahmss.skills.reaching import prisms_of
from ahmss.walking.walkers import Walker

__all__ = ["Tucking", "tucked"]

_SIDES: tuple[str, ...] = ("right", "left")
_ARM = ("upper_arm", "lower_arm")
_LEAST, _ENOUGH = 0.045, 0.12  # metres from a hand to things: nearer it is drawn in, farther let down again
_BESIDE, _FIRST = 0.25, 240  # metres, frames: who sets out from beside a thing turns there, and is careful for so long
_ASKED = 0.26  # metres: what is farther from a hand than both of these is not asked how far
_SEEN = 40  # frames that are looked ahead
# Seconds of each of three lags one after the other, by which an arm sets out and arrives softly; the same of one whose
# hand comes from elsewhere than where it hangs, and turns for that, too.
_LAG, _LAG_COMING = 0.09, 0.16
_OTHERS = 0.6  # radians from what a walk has given: an arm that is so far off is another motion's
_COMES, _MOVES, _STRAY = 60, 0.02, 0.1  # frames, radians, radians: what sets out from elsewhere comes, and how straight
_CARES = 1.5  # an arm's importance when it is drawn in: more than that of what else moves it by the way
_RESTS = 1e-4  # by so little a row differs from the last of who stands: arms have come to where they stay
_NONE = 1e-4  # so little an arm is not drawn in any more
_LOOKS = 4  # frames after which who stands, the arms at rest, looks again whether they are to stay there
_SUNK, _LOW = 0.02, 0.3  # metres under a top on which its skin is, and over it, that a hand may be which is let down
_NEAR = 1.0  # metres from the hips beyond which nothing is in a hand's way
_TUCKED = np.array([0.17, 0.08, 1.06])  # of a palm, shares of a stature of 1.72 m: ahead, aside, height
_STATURE = 1.72
_UP = np.array([0.0, 0.0, 1.0])
_NO_TURN = np.array([1.0, 0.0, 0.0, 0.0])


class Tucking:
    """How far each arm is drawn in, from piece to piece of a walk; hands that hold something are left alone.

    first: frames in which it is careful, as who sets out from beside a thing turns there. but: an arm that is left
    alone as well, and with it the task's object, which it moves. others: who else is on the floor now; None: nobody.
    """

    def __init__(
        self, task: HumanTask, first: int = _FIRST, but: str = "", others: Callable[[], Sequence[Walker]] | None = None
    ) -> None:
        self._first, self._about = first, others
        self._task = task
        self._given = self._first_given = np.zeros((0, 4))
        self._skeleton, self._coming = task.human, set[str]()
        self._rates = [1.0 - np.exp(-1.0 / (lag * task.rate)) for lag in (_LAG, _LAG_COMING)]
        self._sides = [side for side in _SIDES if side not in task.busy and side != but]
        self._prisms = [prism for prism in prisms_of(task) if not (but and prism.sought)]
        self._hanging = {side: Hanging(task.human, side, task.rate) for side in self._sides}
        self._past = ArmsIn(task.human, task.rate, self._sides)
        self._level = {side: np.zeros(3) for side in _SIDES}
        self._wanted = dict.fromkeys(_SIDES, first > 0)
        # As they were after each frame of the last piece.
        self._after: dict[str, list[tuple[Array, bool]]] = {side: [] for side in _SIDES}
        self._frames, self._last = 0, (np.zeros((0, 0)), np.zeros((0, 0)))
        self._rests, self._rested = False, 0  # whether the arms do, and for how many frames one has not looked
        self._pose = tucked(task.human) if self._prisms else np.zeros((0, 4))
        for side in self._already():
            self._level[side][:], self._wanted[side] = 1.0, True
            arm = slice(INDEX[f"{side}_upper_arm"], INDEX[f"{side}_hand"] + 1)
            self._pose[arm] = task.start.rotations[arm]  # it stays as it is
        self._lifted = self._over_something()
        for side in self._lifted:
            self._level[side][:], self._wanted[side] = 1.0, True

    def _over_something(self) -> list[str]:
        """The arms whose hand is just over a thing as one sets out, a table, say: let down at once it goes through."""
        start, found = self._task.start, list[str]()
        near = _about(self._prisms, start.root[None])
        if not near:
            return found
        places, turned = forward(start.rotations[None], start.root[None], self._skeleton.offsets)
        for side in self._sides:
            points = _points(self._skeleton, places, turned, side)[0]
            for prism in near:
                over = points[prism.over(points)]
                if len(over) and -_SUNK < (over[:, 2] - prism.tops(over)).min() < _LOW:
                    found.append(side)
                    break
        return found

    def _already(self) -> list[str]:
        """The arms that are drawn in as one sets out, as one came there: let down at once they would be in things."""
        if not len(self._pose):
            return []
        off = _angles(self._pose, self._task.start.rotations)
        return [side for side in self._sides if max(off[INDEX[f"{side}_{link}"]] for link in _ARM) < _OTHERS]

    def over(self, rows: Array) -> Array:
        """POSE rows (n, 260) of a walk, the arms drawn in where that is needed."""
        begun, self._frames = self._frames, self._frames + len(rows)
        walked, last = self._last
        stands = rows.shape == walked.shape and not (np.abs(rows - walked) > _RESTS).any()  # who waits does not change
        stays = stands and not begun < self._first <= begun + len(rows)  # from there on less is enough
        if stays and self._rests and self._rested < _LOOKS:
            self._rested += len(rows)
            return last.copy()
        past = self._past.over(rows, [] if self._about is None else self._about())
        made = self._made(past, self._others(begun), begun)
        self._rests, self._rested = stays and bool(np.abs(made - last).max() < _RESTS), 0
        if not len(self._given):
            self._first_given = made[0, 4:176].reshape(43, 4).copy()
        self._given, self._last = made[-1, 4:176].reshape(43, 4).copy(), (rows.copy(), made.copy())
        return made

    def keep(self, count: int) -> None:
        """Of the last piece so many frames were shown: the arms go on as after these."""
        given, made = self._last
        if count == len(given):
            return
        self._past.keep(count)
        self._frames -= len(given) - count
        self._last, self._rests = (given[:count], made[:count]), False
        self._given = made[count - 1, 4:176].reshape(43, 4).copy()
        for side in self._sides:
            if self._after[side]:
                level, self._wanted[side] = self._after[side][count - 1]
                self._level[side][:] = level
                self._hanging[side].back(count)

    def _made(self, rows: Array, others: Sequence[str], begun: int) -> Array:
        """The rows, the arms drawn in but those that are others'; `begun`: frames of the walk before these."""
        root, rotations = rows[:, 1:4], rows[:, 4:176].reshape(-1, 43, 4)
        for after in self._after.values():
            after.clear()
        near = _about(self._prisms, root)
        if begun == 0:
            off = _angles(rotations[0], self._task.start.rotations)
            self._coming = {side for side in self._sides if off[INDEX[f"{side}_hand"]] > _OTHERS}
        elif begun >= _COMES:
            self._coming.clear()
        drawn_in = max(float(level.max()) for level in self._level.values()) >= _NONE
        if not near and not drawn_in and all(arm.still for arm in self._hanging.values()):
            return rows
        made, out = rows.copy(), rotations.copy()
        places, turned = forward(rotations, root, self._skeleton.offsets)
        for side in self._sides:
            if side in others:  # let go softly: at once the hand would jump where the arm is its own after all
                share = np.array([self._comes_to(side, 0.0) for _ in rows])
                self._hanging[side].forget()
            else:
                gap = clearance(near, _points(self._skeleton, places, turned, side), _ASKED).min(axis=-1)
                share = np.array(self._levels(side, gap, begun))
            arm = slice(INDEX[f"{side}_upper_arm"], INDEX[f"{side}_hand"] + 1)
            end = align(np.broadcast_to(self._pose[arm], rotations[:, arm].shape), rotations[:, arm])
            out[:, arm] = slerp(rotations[:, arm], end, share[:, None])
            if side not in others:
                share = np.maximum(share, self._hanging[side].over(near, out, root))
            made[:, 176 + arm.start : 176 + arm.stop] += _CARES * share[:, None]
        made[:, 4:176] = out.reshape(-1, 172)
        return made

    def _others(self, begun: int) -> list[str]:
        """The arms that another motion has: they are not where the last piece has left them, and do not come.

        Who sets out with an arm raised takes a moment to let it down to where the walk has it.
        """
        if not len(self._given):
            return []
        start, present = self._task.start.rotations, self._task.present.rotations
        first, now = multiply(conjugate(self._first_given), start), multiply(conjugate(self._given), present)
        off = _angles(_NO_TURN, now)
        stray = off + _angles(first, now) - _angles(_NO_TURN, first)  # of what is left of how far off it was
        comes = (_angles(start, present) > _MOVES) & (stray < _STRAY) & (begun < _COMES)
        elsewhere = (off > _OTHERS) & ~comes
        return [side for side in _SIDES if any(elsewhere[INDEX[f"{side}_{link}"]] for link in _ARM)]

    def _levels(self, side: str, gap: Array, begun: int) -> list[float]:
        """How far the arm is drawn in at each frame, 0 to 1, by how far its hand, hanging, is from things (n).

        begun: frames of the walk before these.
        """
        levels: list[float] = []
        gaps = gap.tolist()
        for k in range(len(gaps)):
            coming = min(gaps[k : k + _SEEN])
            enough = _BESIDE if begun + k < self._first else _ENOUGH
            lifted = side in self._lifted and begun + k < _COMES
            self._wanted[side] = lifted or coming < (enough if self._wanted[side] else _LEAST)
            levels.append(self._comes_to(side, float(self._wanted[side])))
        return levels

    def _comes_to(self, side: str, wanted: float) -> float:
        """How far the arm is drawn in a frame later, softly on its way to what is wanted."""
        level, rate = self._level[side], self._rates[side in self._coming]
        for i in range(len(level)):
            level[i] += rate * (wanted - level[i])
            wanted = float(level[i])
        self._after[side].append((level.copy(), self._wanted[side]))
        return wanted


def _angles(a: Array, b: Array) -> Array:
    """How far (43,) joints turn from one pose (43, 4) to another, radians."""
    return np.linalg.norm(to_rotation_vector(multiply(conjugate(a), b)), axis=-1)


def _points(skeleton: Skeleton, places: Array, turned: Array, side: str) -> Array:
    """Points (n, 4, 3) of a forearm and hand: its middle, the wrist, the knuckles, the fingers' tips."""
    forearm, hand, knuckle, tip = (
        INDEX[f"{side}_{name}"] for name in ("lower_arm", "hand", "middle_proximal", "middle_distal")
    )
    end = places[:, tip] + rotate(turned[:, tip], skeleton.tips[tip])
    middle = 0.5 * (places[:, forearm] + places[:, hand])
    return np.stack([middle, places[:, hand], places[:, knuckle], end], axis=1)


def _about(prisms: Sequence[Prism], root: Array) -> list[Prism]:
    """The prisms that come within an arm's length of the hips (n, 3) on their way."""
    low, high = (root[:, :2].min(axis=0) - _NEAR).tolist(), (root[:, :2].max(axis=0) + _NEAR).tolist()
    return [prism for prism in prisms if not prism.is_beyond((*low, -np.inf), (*high, np.inf))]


def tucked(skeleton: Skeleton, higher: float = 0.0) -> Array:
    """A pose (43, 4), both hands before the belly, palms towards it as far as the wrists go, fingers inwards.

    higher: metres by which they are before the chest instead, of who is 1.72 m tall.
    """
    rotations, root = skeleton.upright()
    place, turn = floor_frame(rotations, root)
    targets = np.zeros((5, 8))
    for row, sign in enumerate((-1.0, 1.0)):
        at = (_TUCKED * np.array([1.0, sign, 1.0]) + higher * _UP) * skeleton.stature / _STATURE
        # Palm to the belly and a little down, the thumb up: x out of the palm, z to the thumb.
        out = np.array([-0.8, 0.0, -0.6])
        up = np.array([-0.6, 0.0, 0.8])
        palm = from_matrix(np.stack([out, np.cross(up, out), up], axis=-1))
        targets[row, :3], targets[row, 3:7], targets[row, 7] = place + rotate(turn, at), multiply(turn, palm), 1.0
    made = solve(skeleton, rotations, root, targets)
    for side in _SIDES:
        arm, links = Arm.of(skeleton, side), slice(INDEX[f"{side}_upper_arm"], INDEX[f"{side}_hand"] + 1)
        own, (low, high) = arm.from_pose(made[links]), limits_of(arm)[HAND].T
        made[links] = arm.into_pose(with_hand(own, np.clip(hand_angles(own), low, high)))
    return made
