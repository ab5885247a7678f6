"""Side by side at a panel: an arm keeps out of those who stand beside, and waits for an arm that is in its way.

Others are where they are now: trunk, upper arms, forearms, hands, each as a segment with a thickness. Of the ways
that a reach may take, that is better which comes least near to them; where an arm of somebody would be met all the
same, and it works there, one waits before one's own goes out, for a while. So one does for who walks by, as they tell.
"""

from __future__ import annotations

from collections.abc import Generator

import numpy as np

from ahmss.algorithm.place import WorldObject
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.errors import AlgorithmError
from ahmss.reaching.performing import Performed
from ahmss.reaching.reacher import SIDES, Reacher
from ahmss.reaching.skin import skin_of
from ahmss.skills.reaching import Looking

__all__ = ["awaited", "crowding", "others_near", "refuse_head_in"]

_AIR = 0.02  # metres that are kept between an arm and another human
_SPARSE = 3  # every so many frames of a way are looked at
_PATIENCE = 6.0  # seconds that one waits for an arm that moves, or has moved so lately:
_IDLE, _SEEN = 1.0, 0.5  # seconds; who holds it there longer may do so for good; who is seen first to hold it, sooner
_SOON, _FINELY = 4, 4  # of the places that a way tells, and in between
_GOES = 0.15  # metres that they go to there: who goes less far stands
_MOVES = 0.004  # metres of a hand, in a frame more or less, that are no breathing
_ARM = ("shoulder", "elbow", "hand", "fingers")
_THICK = np.array([0.05, 0.042, 0.03])  # metres, around upper arm, forearm, hand
_TRUNK, _LOW = 0.13, 0.85  # metres: its radius, and from which height on it may be met
_ALONG = np.array([0.25, 0.5, 0.75, 1.0])[:, None]  # of the own upper arm
_HEAD, _UP_IT = INDEX["head"], np.array([[0.1, 0.0, 0.0], [0.17, 0.0, 0.0]])  # metres up in the head, to two balls
_HEAD_THICK, _HEAD_GIVES = np.array([0.09, 0.1]), 0.015  # metres; that it may be in somebody, as it is no balls


def others_near(task: HumanTask) -> list[WorldObject]:
    """The other humans whose arms are told of."""
    return [thing for thing in task.world.values() if thing.kind == "human" and "right_elbow" in thing.sites]


def crowding(task: HumanTask, made: Performed, side: str) -> float:
    """Metres by which an arm on its way would come nearer to others than one keeps, as they are now; else 0."""
    if not others_near(task):
        return 0.0
    own = _own(task, side, made.rotations[::_SPARSE], made.root[::_SPARSE])
    return max(0.0, *(_nearest(own, _segments(task, other)) for other in others_near(task)))


def refuse_head_in(task: HumanTask, made: Performed) -> None:
    """Refuse a way on which one's head would be in somebody who stands beside, as they are or when their arms hang.

    Raises:
        AlgorithmError: it would; says by how much, in whom, and what to do.
    """
    near = others_near(task)
    if not near:
        return
    points, radii = _head(task, made.rotations[::_SPARSE], made.root[::_SPARSE])
    for other in near:
        (begins, ends, thick), hanging = _segments(task, other), _hanging(task, other)
        now_or_then = np.concatenate([begins, hanging[0]]), np.concatenate([ends, hanging[1]])
        deep = _nearest((points, radii), (*now_or_then, np.concatenate([thick, hanging[2]]))) - _AIR
        if deep > _HEAD_GIVES:
            raise AlgorithmError(
                f"the head would be {1000.0 * deep:.0f} mm in {other.name}, who stands where one leans to; do it "
                "when they have gone"
            )


def awaited(task: HumanTask, made: Performed, side: str, gaze: Looking) -> Generator[Array, None, bool]:
    """Frames (1, 260) of looking there while an arm that works is in the way or somebody comes; whether there were any.

    Args:
        task: who reaches; where the number of frames was said nobody waits. made: the way. side: the hand. gaze: on it.
    """
    waited, watched = 0, {other.id: _Watched(task, other) for other in others_near(task)}
    own = _own(task, side, made.rotations[::_SPARSE], made.root[::_SPARSE]) if watched else None
    while own is not None and not task.length and waited < _PATIENCE * task.rate:
        hinders = [
            (other, why)
            for other in others_near(task)
            if other.id in watched and (why := _hinders(task, own, other, watched[other.id]))
        ]
        if not hinders:
            break
        if not waited:
            task.note(f"waits for {hinders[0][0].name}, {hinders[0][1]}")
        waited += 1
        yield gaze.alone()
    return waited > 0


def _hinders(task: HumanTask, own: tuple[Array, Array], other: WorldObject, watched: _Watched) -> str:
    """How somebody is in the way of an arm, in words: their arm works there, or they will be there soon; "": not."""
    begins, ends, radii = _segments(task, other)
    works = watched.works()
    if works and _nearest(own, (begins, ends, radii)) > 0.0:
        return "whose arm is in the way"
    soon = np.zeros((0, 2)) if other.way is None else other.way[:_SOON] - other.place[:2]
    if len(soon) and np.linalg.norm(soon[-1]) > _GOES:
        soon = np.concatenate([np.zeros((1, 2)), soon])
        at = np.arange(_FINELY * (len(soon) - 1) + 1) / _FINELY
        x, y = (np.interp(at, np.arange(len(soon)), axis) for axis in soon.T)
        on = np.stack([x, y, np.zeros(len(at))], axis=-1)
        there = (begins + on[:, None]).reshape(-1, 3), (ends + on[:, None]).reshape(-1, 3), np.tile(radii, len(on))
        if _nearest(own, there) > 0.0:
            return "who comes by"
    return ""


class _Watched:
    """Whether somebody's hands have moved lately."""

    def __init__(self, task: HumanTask, other: WorldObject) -> None:
        self._task, self._other = task, other
        self._was, self._still = self._hands(), round((_IDLE - _SEEN) * task.rate)

    def works(self) -> bool:
        """Whether a hand has moved, in the frames since this was asked first, or may have before; asked each frame."""
        now = self._hands()
        if float(np.linalg.norm(now - self._was, axis=-1).max()) > _MOVES:
            self._was, self._still = now, 0
        else:
            self._still += 1
        return self._still < _IDLE * self._task.rate

    def _hands(self) -> Array:
        return np.stack([self._other.site(f"{side}_hand", self._task.start.root).place for side in ("right", "left")])


def _nearest(own: tuple[Array, Array], other: tuple[Array, Array, Array]) -> float:
    """Metres by which an arm's points (n, m, 3), radii (m,), come nearer to another's segments than one keeps, where
    they are not so near already.
    """
    points, thick = own
    begins, ends, radii = other
    gap = np.full(len(points), np.inf)
    for begin, end, radius in zip(begins, ends, radii, strict=True):
        along = end - begin
        share = np.clip((points - begin) @ along / max(float(along @ along), 1e-9), 0.0, 1.0)
        away = np.linalg.norm(points - begin - share[..., None] * along, axis=-1) - thick - radius
        gap = np.minimum(gap, away.min(axis=-1))
    return float(min(_AIR, float(gap[0])) - gap.min())


def _own(task: HumanTask, side: str, rotations: Array, root: Array) -> tuple[Array, Array]:
    """Points (n, m, 3) of the own arm in poses (n, 43, 4), (n, 3), from under the shoulder on, and radii (m,)."""
    skin, radii = skin_of(Reacher.of(task.human, side), rotations, root)
    places, _ = forward(rotations, root, task.human.offsets)
    upper, lower = places[:, INDEX[f"{side}_upper_arm"]], places[:, INDEX[f"{side}_lower_arm"]]
    points = upper[:, None] + _ALONG * (lower - upper)[:, None]
    return np.concatenate([points, skin], axis=1), np.concatenate([np.full(len(_ALONG), _THICK[0]), radii])


def _head(task: HumanTask, rotations: Array, root: Array) -> tuple[Array, Array]:
    """The middles (n, 2, 3) of the balls of the own head in poses (n, 43, 4), (n, 3), and their radii (2,)."""
    places, turned = forward(rotations, root, task.human.offsets)
    return places[:, _HEAD, None] + rotate(turned[:, _HEAD, None], _UP_IT), _HEAD_THICK


def _hanging(task: HumanTask, other: WorldObject) -> tuple[Array, Array, Array]:
    """Where another's arms would be that are let down: beginnings and ends (4, 3), and their radii (4,)."""
    joints = np.stack([_joints(task, other, side) for side in SIDES])
    lengths = np.linalg.norm(np.diff(joints[:, :3], axis=1), axis=-1)  # of upper arms and forearms
    down = np.cumsum(lengths, axis=1)[..., None] * np.array([0.0, 0.0, -1.0])
    elbows, hands = (joints[:, 0] + down[:, k] for k in (0, 1))
    return np.concatenate([joints[:, 0], elbows]), np.concatenate([elbows, hands]), np.repeat(_THICK[:2], len(SIDES))


def _joints(task: HumanTask, other: WorldObject, side: str) -> Array:
    """Shoulder, elbow, hand and fingers (4, 3) of another, now."""
    return np.stack([other.site(f"{side}_{joint}", task.start.root).place for joint in _ARM])


def _segments(task: HumanTask, other: WorldObject) -> tuple[Array, Array, Array]:
    """Where another human is now: beginnings and ends (7, 3) of trunk and arms, and their radii (7,)."""
    arms = {side: _joints(task, other, side) for side in SIDES}
    top = 0.5 * (arms["right"][0] + arms["left"][0])
    foot = np.array([*other.place[:2], _LOW])
    begins = np.concatenate([foot[None], *(arm[:-1] for arm in arms.values())])
    ends = np.concatenate([top[None], *(arm[1:] for arm in arms.values())])
    return begins, ends, np.concatenate([[_TRUNK], _THICK, _THICK])
