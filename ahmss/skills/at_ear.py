"""What is held to the ear: its one end at the ear, the other before the mouth, and nothing of it in the head.

It has its ends along its y axis (property `ends`, metres from its middle) and its openings looking along its -z; the
end at the thumb comes to the ear. The trunk is upright for it, or as it was when one sat: head and ear go with it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import GAZE
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, from_matrix, multiply, rotate
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.steps import Steps
from ahmss.reaching.elbow import hangs, swung
from ahmss.reaching.leaning import looking, stretch_of
from ahmss.reaching.performing import Performed, perform
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.prism import Prism
from ahmss.reaching.reacher import Reacher, heading_of, seat
from ahmss.reaching.standing import Posture
from ahmss.skills.out_of_reach import refuse_far, tell_missed
from ahmss.skills.own_head import head_of, in_head, in_own_head
from ahmss.skills.past_oneself import past_oneself

__all__ = ["brought_to_ear"]

_EAR = np.array([-0.024, 0.086, 0.098])  # from between the eyes: up, to the side, back
_LIPS = np.array([-0.055, 0.034, -0.012])  # a little beside the mouth
_ROLLS, _LIFTED = np.arange(-45.0, 46.0, 15.0), (0.0, 10.0, 20.0)  # degrees, about it, off the cheek
_GAPS = (0.008, 0.012)  # metres between ear and what is held to it
_SOME = 14  # frames that are looked at between two pauses
_STATURE = 1.70  # metres, of who has ear and lips there
_IN_HEAD, _SHORT, _OFF = 1000.0, 500.0, 100.0  # what a metre costs: in the head, that the arm is short, off the ear
_AHEAD, _UNDER = 2.0, 0.1  # metres before and under the eyes, where one looks
_LOOKS = 0.3  # seconds in which one does
_SPINE = INDEX["spine"]
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True, eq=False)
class _Ear:
    """Who holds it: their posture at the end, what they look at (3,), and their head then."""

    posture: Posture
    place: Array
    seen: Array
    head: Transform


def brought_to_ear(
    task: HumanTask, reaching: Reaching, side: str, held: Transform, prisms: list[Prism]
) -> Steps[Performed]:
    """The frames in which what a hand holds comes to ear and mouth, past the head, the elbow hanging as low as it can.

    Args:
        task: with its object's shape. reaching: who, as they are shown. side: of the hand.
        held: it in the palm's frame. prisms: what may be in the way.

    Raises:
        AlgorithmError: the arm does not come there.
    """
    assert task.object is not None
    reacher, ear = Reacher.of(task.human, side), _ear(task, reaching)
    (frames, off), back = _frames(task, ear.head, reacher.sign), held.inverse()
    palms = frames.then(Transform(np.repeat(back.place[None], len(frames.place), axis=0), back.rotation)).row()
    spine, present = seat(task.human, ear.seen, ear.posture.root), reaching.present(reacher)
    cost = _IN_HEAD * in_head(task.human, task.object, task.message.site, ear.head, frames) + _OFF * off
    cost += _SHORT * np.abs(reacher.missing(palms, spine))
    for first in range(0, len(palms), _SOME):
        yield
        cost[first : first + _SOME] += hangs(reacher, palms[first : first + _SOME], spine, present)[0]
    chosen = palms[[int(cost.argmin())]]
    yield
    _, arm = yield from stretch_of(reacher, chosen, ear.posture, present, ())
    refuse_far(task, side, arm)
    yield
    plan = yield from reaching.way(reacher, (ear.posture, chosen[0], arm), ear.place, prisms, 0.0)
    tell_missed(task, plan)

    def made(plan: Plan) -> Steps[Performed]:
        length = round(plan.seconds * task.rate)
        time, looked = np.arange(1, length + 1) / length, minimum_jerk(np.arange(1, length + 1) / (_LOOKS * task.rate))
        brought = yield from perform(plan, time, ear.place, looked)
        _out_of_the_trunk(task, brought, plan, time)
        yield
        return replace(brought, plan=plan)

    return (yield from past_oneself(plan, made, lambda made: in_own_head(task, made, held)))


def _ear(task: HumanTask, reaching: Reaching) -> _Ear:
    """Upright on the feet; of who sits, the waist as it was when the task began."""
    posture = reaching.base
    if reaching.standing is None:
        rotations = posture.rotations.copy()
        rotations[_SPINE] = task.start.rotations[_SPINE]
        posture = Posture(rotations, posture.root)
    heading = heading_of(posture.rotations, posture.root)
    ahead = np.array([np.cos(heading), np.sin(heading), 0.0])
    eyes = head_of(task.human, posture.rotations, posture.root).apply(task.human.eye)
    place = eyes + _AHEAD * ahead - _UNDER * _UP
    seen = looking(task.human, posture.rotations, posture.root, place)
    return _Ear(posture, place, seen, head_of(task.human, seen, posture.root))


def _frames(task: HumanTask, head: Transform, sign: float) -> tuple[Transform, Array]:
    """The frames (n) in which it is at ear and mouth of a head, and how far (n), metres, it is off the ear.

    sign: 1.0 at the left ear, -1.0 at the right.
    """
    assert task.object is not None
    mirrored, scale = np.array([1.0, sign, 1.0]), task.human.stature / _STATURE
    roll, lift, gap = (axis.ravel() for axis in np.meshgrid(np.radians(_ROLLS), np.radians(_LIFTED), _GAPS))
    ear = task.human.eye + scale * _EAR * mirrored
    ears = head.apply(ear + gap[:, None] * np.array([0.0, sign, 0.0]))
    lips = head.apply(task.human.eye + scale * _LIPS * mirrored)
    half = float(task.object.properties.get("ends", 0.07))
    along = _unit(lips - head.apply(ear + np.array([0.0, sign * _GAPS[0], 0.0])))
    out = rotate(head.rotation, np.array([0.0, sign, 0.0]))
    out = _unit(out - (out @ along) * along)
    y = -sign * along
    turn = from_matrix(np.stack([np.cross(y, out), y, out], axis=-1))
    turned = multiply(from_axis_angle(along, -sign * roll), turn)
    turned = multiply(from_axis_angle(np.cross(out, along), -lift), turned)
    earpiece = np.array([0.0, sign * half, float(task.object.properties.get("opening", 0.0))])
    return Transform(ears - rotate(turned, earpiece), turned), gap - _GAPS[0]


def _unit(v: Array) -> Array:
    return v / np.linalg.norm(v)


def _out_of_the_trunk(task: HumanTask, brought: Performed, plan: Plan, time: Array) -> None:
    """Have the elbow swing out of the trunk on the way, and hang as low as it can."""
    reacher, gaze = plan.reacher, brought.targets[:, GAZE]
    seen = looking(task.human, brought.rotations, brought.root, gaze[:, :3], gaze[:, 7])
    palms = plan.palms(time)
    present = reacher.arm.from_pose(plan.start.rotations[reacher.links])
    brought.rotations[:, reacher.links] = swung(reacher, palms, seat(task.human, seen, brought.root), present)
    brought.targets[:, reacher.row, :7] = palms
