"""A hand reaches while another motion carries the body: it arrives when the body is near enough, wherever that is.

Where nobody said how many frames it takes, the hand sets out when the body will be near enough in the time that a reach
takes, and goes on as the body comes nearer: so it is there when the body is, neither before nor after. If the body goes
on past the place, the reach is over as soon as the hand has let go of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate, slerp
from ahmss.errors import AlgorithmError
from ahmss.motion.easing import minimum_jerk
from ahmss.reaching.carried import Carried
from ahmss.reaching.goal import Goal
from ahmss.reaching.performing import SHAPED_BY, Fingers
from ahmss.skills.giving_way import Things
from ahmss.skills.reaching import HEAD, sides_of

__all__ = ["reach_while_carried"]

_SPINE = INDEX["spine"]
_MOST_MISSED = 0.06  # metres that are not told of who was carried to a thing
_MOST_SHORT = 0.002  # the same of who was carried near enough
_RELAXED = 0.9  # seconds of a reach on the way
_SETS_OUT = 1.35  # seconds before the body is near enough: a hand that hangs beside a table is over its edge in time
_SLOWER = 0.5  # of its speed that a body keeps in the mean until the end of a reach: who arrives stops
_BENDS = 0.25  # metres that the waist gives to who stands where the walk has ended
_BENDS_IN = 0.8  # seconds
_HEAD_SECONDS = 0.6  # in which the gaze comes to its place, and in which it leaves it
_BESIDE = np.cos(np.radians(80.0))  # from ahead: what is farther round is not looked for
_AHEAD = np.array([0.0, 0.0, -1.0])  # of the hips
_LEVEL = np.array([1.0, 1.0, 0.0])
_GIVEN = 0.05  # metres that the waist gives on the way
_RESTING, _PATIENCE = 0.03, 0.5  # metres a second, seconds: who is carried so slowly for so long has arrived
_NEWEST = 0.06  # of the mean closing speed that the newest frame makes: the mean of about a third of a second
_LINGERS = 0.98  # of the time, where the hand waits for the waist
_ARM = 20.0  # its importance: of an arm that is high up even a little of a walk's, which hangs, is much
_HANGS_ON = 12  # frames: who is carried beyond the arm in these lets go of the place with the last frame
_RAISED = 0.4  # of the time: so far a hand goes at once, wherever the body is
_BEHIND = 0.08  # metres that a hand is behind on its way, for which the time waits
_STILL_GOES = 0.25  # of its pace, that it keeps where the body has come to rest: no more comes that it could wait for


def reach_while_carried(task: HumanTask, goal: Goal, shape: Callable[[str], Fingers]) -> Iterator[Array]:
    """Frames (1, 260) of a hand that is at its goal with the last of them, wherever the body is carried meanwhile.

    Args:
        task: carried.
        goal: where the palm shall be.
        shape: for a side the links of the fingers and the rotations that they come to.

    Raises:
        AlgorithmError: the body has come to rest too far away.
    """
    gaze, begun, nearing, things = _Gaze(task, goal.place), 0, _Nearing(task, goal), Things(task)
    relaxed, sets_out = (round(seconds * task.rate) for seconds in (_RELAXED, _SETS_OUT))
    last = task.present.root.copy()
    then = task.present.rotations.copy(), last
    while begun < _head_start(task.length, relaxed) if task.length else not nearing.near_in(sets_out):
        begun, last = begun + 1, task.present.root.copy()
        then = task.present.rotations.copy(), last
        yield task.block(task.start.rotations[None], task.start.root[None], *gaze.next())
    present = task.present
    carried = nearing.carried = Carried(task.human, goal, present.rotations, present.root, sides_of(task), then)
    links, end = shape(carried.reacher.side)
    before = present.rotations[links].copy()
    time, k = 0.0, begun
    while time < 1.0:
        k += 1
        time = (k - begun) / (task.length - begun) if task.length else nearing.time(time, relaxed, carried.behind)
        rotations, on = task.present.rotations, task.present.root - last
        last = task.present.root.copy()
        root = last + on  # about where it will be carried by this frame
        ahead = _SLOWER * (task.length - k) * on * _LEVEL if task.length else nearing.ahead
        near = things.about(root, carried.palm[:3], sought=True)
        made, target, spine = carried.step(rotations, root, time, ahead, near, settles=task.length > 0)
        nearing.nearest = min(nearing.nearest, carried.short)
        over = carried.let_go and not task.length
        if over:
            task.note(
                f"the {carried.reacher.side} hand came within {1000.0 * nearing.nearest:.0f} mm of its place in passing"
            )
        elif time == 1.0:
            _tell_missed(task, carried)
        made[INDEX["head"]] = task.start.rotations[INDEX["head"]]  # which the gaze turns
        made[links] = slerp(before, end, minimum_jerk(np.array([time / SHAPED_BY])))
        importance, targets = gaze.next()
        if time == 1.0 and carried.missing(made, root + _HANGS_ON * on) > 0.0:
            target[7] = 0.0  # the hand hangs on to the place until the next motion begins: here the arm would be torn
        targets[:, carried.reacher.row] = target
        importance[carried.reacher.links], importance[links] = _ARM, 1.0
        importance[_SPINE] = spine
        yield task.block(made[None], root[None], importance, targets)
        if over:
            return


def _head_start(length: int, relaxed: int) -> int:
    """Of so many frames those in which the eyes go first."""
    return max(min(2, length // 3), min(length // 3, length - relaxed))


class _Gaze:
    """Eyes and head on the goal (3,) from when it is not behind the body any more, or is not yet."""

    def __init__(self, task: HumanTask, place: Array) -> None:
        self._task, self._place, self._turned = task, place, 0.0

    def next(self) -> tuple[Array, Array]:
        """The importances (44,) and targets (1, 5, 8) of the next frame."""
        present = self._task.present
        ahead = rotate(present.rotations[0], _AHEAD) * _LEVEL
        towards = (self._place - present.root) * _LEVEL
        cosine = float(ahead @ towards) / max(float(np.linalg.norm(ahead) * np.linalg.norm(towards)), 1e-9)
        step = 1.0 / (_HEAD_SECONDS * self._task.rate)
        self._turned = float(np.clip(self._turned + (step if cosine > _BESIDE else -step), 0.0, 1.0))
        importance, targets = np.zeros(44), np.zeros((1, 5, 8))
        importance[INDEX["head"]] = HEAD
        targets[:, GAZE, :3], targets[:, GAZE, 7] = self._place, minimum_jerk(np.array(self._turned))
        return importance, targets


class _Nearing:
    """How the body comes nearer to a goal, from frame to frame.

    carried: the hand, once it is chosen; before, the one that would come there more easily counts. nearest: metres that
    it was from its place at the least.
    """

    def __init__(self, task: HumanTask, goal: Goal) -> None:
        self._task, self._goal, self._sides = task, goal, sides_of(task)
        self.carried: Carried | None = None
        self.nearest = np.inf
        self._before: Array | None = None
        self._missing = self._closing = self._begun = 0.0
        self._rested, self._towards = 0, np.zeros(3)
        self._patience, self._bends = round(_PATIENCE * task.rate), round(_BENDS_IN * task.rate)

    def near_in(self, frames: int) -> bool:
        """Take in the present; whether the arm reaches in so many frames, as the body has come nearer lately.

        Raises:
            AlgorithmError: the body has come to rest too far away.
        """
        task, present, before = self._task, self._task.present, self._before
        carried = self.carried or Carried(task.human, self._goal, present.rotations, present.root, self._sides)
        upright = present.rotations.copy()
        upright[_SPINE] = task.start.rotations[_SPINE]  # not as the waist has bent for the hand
        missing = carried.missing(upright, present.root) - _GIVEN
        self._towards = (carried.palm[:3] - present.root) * _LEVEL
        if before is not None:
            self._closing += _NEWEST * (self._missing - missing - self._closing)
            slow = float(np.linalg.norm((present.root - before)[:2])) * task.rate < _RESTING
            self._rested = self._rested + 1 if slow else 0
        self._missing, self._before = missing, present.root.copy()
        if self._rested == self._patience and missing + _GIVEN > _BENDS and self.nearest > _MOST_MISSED:
            short = f"{carried.reacher.side} arm is {missing + _GIVEN:.2f} m too short"
            raise AlgorithmError(f"the {short} for that where the walk has ended")
        self._begun = self._begun if self.carried else missing
        return self.rests or missing <= frames * max(self._closing, 0.0)

    @property
    def rests(self) -> bool:
        """Whether the body has come to rest."""
        return self._rested >= self._patience

    @property
    def waist(self) -> float:
        """How much of what is still missing is the waist's to give: of who has come to rest in the end all."""
        return float(minimum_jerk(np.array((self._rested - self._patience) / self._bends)))

    @property
    def ahead(self) -> Array:
        """How far (3,) the body is still to come nearer, metres."""
        towards = self._towards / max(float(np.linalg.norm(self._towards)), 1e-9)
        return (1.0 - self.waist) * max(self._missing, 0.0) * towards

    def time(self, before: float, frames: int, behind: float) -> float:
        """The share of the reach's time that the next frame is at, which follows the body.

        Args:
            before: that of the last frame.
            frames: those of a reach, which it does not go faster than.
            behind: metres by which the hand is behind on its way: the time waits for it.

        Raises:
            AlgorithmError: the body has come to rest too far away.
        """
        self.near_in(frames)
        pace = max(1.0 - behind / _BEHIND, _STILL_GOES if self.rests else 0.0)
        fastest = min(before + pace / frames, 1.0)
        if self._begun <= 0.0 or self.rests:
            return fastest if self._missing <= 0.0 or self.waist >= 1.0 else min(fastest, _LINGERS)
        return min(max(before, 1.0 - self._missing / self._begun, _RAISED), fastest)


def _tell_missed(task: HumanTask, carried: Carried) -> None:
    """Say so where the body was not carried near enough, or too far, for the hand to be where it should be now."""
    missing = carried.missing(task.present.rotations, task.present.root)
    hand = f"when the {carried.reacher.side} hand should have arrived, its"
    if carried.passed:
        task.note(
            f"{hand} place was passed already, {max(missing, 0.0):.2f} m beyond its arm; "
            "let it begin earlier (`after N`) or take fewer frames"
        )
    elif missing > _MOST_MISSED:
        task.note(f"{hand} arm was {missing:.2f} m too short; let it begin later (`after N`) or take more frames")
    elif carried.short > _MOST_SHORT:
        task.note(f"{hand} joints left it {1000.0 * carried.short:.0f} mm short of its place")
