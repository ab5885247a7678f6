"""What the index finger's tip does at a control: it comes to a place before it, and goes its way from there.

One steps to where it comes off, if not from here. What the shipped algorithms that press and touch share.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.links import fingers
from ahmss.motion.steps import finished
from ahmss.reaching.goal import Goal
from ahmss.reaching.leaning import EASY, stretch_of
from ahmss.reaching.performing import Performed
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.pointing import pointing
from ahmss.reaching.prism import Prism, in_the_way
from ahmss.reaching.reacher import Reacher
from ahmss.skills.arm_clear import beyond, refuse_sunk, standing_about, sunk_at, sunk_in
from ahmss.skills.controls import in_the_way as before_it
from ahmss.skills.controls import stood_before
from ahmss.skills.elbow_room import awaited, crowding, refuse_head_in
from ahmss.skills.elsewhere import or_elsewhere
from ahmss.skills.off_target import off_target
from ahmss.skills.out_of_reach import EXACT, refuse_short
from ahmss.skills.reaching import Looking, performed
from ahmss.skills.smoothest import smoothest

__all__ = ["Touching", "by_fingertip"]

_SPARSE = 3  # every so many palms show how easily an arm comes there
_SUNK = 1000.0  # what a metre costs that an arm is in plates
_STRETCH, _FARTHEST = 25.0, 1.5  # what an arm's length beyond what is easy costs; arms' lengths beyond which none comes


@dataclass(frozen=True, eq=False)
class Touching:
    """What a fingertip does.

    goal: of the hand, its palms known. off: (3,) metres from there to where the tip is set first. out: (3,) unit, the
    way out of what is touched. face: (3,) where the tip is to come to. way: palms (n, 7) of what it does from a palm
    (7,) on, set first. prisms: what may be in its way.
    """

    goal: Goal
    off: Array
    out: Array
    face: Array
    way: Callable[[Array], Array]
    prisms: Sequence[Prism]

    def meant(self, plan: Plan) -> Plan:
        """The plan with the palm (7,) from which the way leads straight to what is touched.

        An arm may be too short for where the tip is set first, and long enough for what it is to touch.
        """
        palms = self.goal.palms[plan.reacher.side]
        palm = palms[np.abs(palms[:, 3:] @ plan.palm[3:]).argmax()]
        return replace(plan, palm=np.concatenate([palm[:3] + self.off, palm[3:]]), short=0.0)

    def course(self, reaching: Reaching, plan: Plan) -> Array:
        """Palms (n, 7) of the way of a plan: straight to what is touched and away, as far as the arm comes."""
        return reaching.in_reach(plan.reacher, plan.end, self.way(self.meant(plan).palm), self.goal.place)

    def lacks(self, reaching: Reaching, plan: Plan) -> float:
        """Metres by which its arm is too short for what is touched."""
        palm = self.meant(plan).palm
        palm[:3] -= self.off
        return float(np.linalg.norm((reaching.in_reach(plan.reacher, plan.end, palm, self.goal.place) - palm)[:3]))

    def missed(self, task: HumanTask, plan: Plan, made: Performed) -> float:
        """Metres by which the tip is off what it touches."""
        meant = self.meant(plan)
        way, before = self.way(meant.palm), float(self.off @ self.out)
        touching = (meant.palm[:3] - way[:, :3]) @ self.out >= before
        return off_target(task, meant, made, way, touching, self.face + before * self.out)

    def perform(self, task: HumanTask, plan: Plan, gaze: Looking) -> Generator[Array, None, Performed]:
        """The frames of a plan."""
        side, reaching = plan.reacher.side, _reaching(task)
        shape = list(fingers(side)), pointing(side)
        return performed(task, reaching, plan, gaze, shape, self.course(reaching, plan))


def _reaching(task: HumanTask) -> Reaching:
    return Reaching(task.human, task.start.rotations, task.start.root)


def by_fingertip(
    task: HumanTask, touching: Touching, gaze: Looking | None = None
) -> Generator[Array, None, tuple[HumanTask, Plan, Performed]]:
    """The task from where it comes off, after steps (n, 260) to there if need be, the plan, and what is made of it.

    Raises:
        AlgorithmError: it comes off nowhere; says why.
    """
    task, gaze = yield from stood_before(task, touching.goal, before_it(task), gaze)

    def attempt(
        task: HumanTask, gaze: Looking, _: tuple[Plan, Performed] | None, __: float
    ) -> Generator[Array, None, tuple[Plan, Performed]]:
        def touches(plan: Plan, made: Performed) -> float:
            deep, _ = sunk_in(task, plan.reacher.side, made.rotations, made.root)
            amiss = max(touching.missed(task, plan, made) - EXACT, 0.0) + beyond(deep)
            return crowding(task, made, plan.reacher.side) + amiss

        reaching = _reaching(task)
        plan, made = yield from smoothest(
            task, reaching, touching.goal, gaze, touching.prisms, touching.off,
            lambda plan: touching.perform(task, plan, gaze), touches, lambda plan: touching.lacks(reaching, plan),
        )  # fmt: skip
        refuse_sunk(task, plan, made.rotations, made.root)
        refuse_short(task, touching.meant(plan), touching.missed(task, plan, made))
        refuse_head_in(task, made)
        return plan, made

    plates = standing_about(task)

    def worth(reaching: Reaching) -> float:
        return _ease(reaching, touching, plates)

    task, gaze, (plan, made) = yield from or_elsewhere(task, gaze, attempt, worth, lambda _: 0.0)
    waited = yield from awaited(task, made, plan.reacher.side, gaze)
    refuse_head_in(task, made)  # somebody may have come meanwhile
    if waited and made.looked < 1.0:
        made = yield from touching.perform(task, plan, gaze)  # the eyes have gone on
    refuse_short(task, touching.meant(plan), touching.missed(task, plan, made))
    return task, plan, made


def _ease(reaching: Reaching, touching: Touching, plates: Sequence[Prism]) -> float:
    """How easily the better arm comes there from so, upright: the more, the better; -inf: not at all."""
    best, goal = -np.inf, touching.goal
    near = in_the_way(touching.prisms, reaching.base.root, goal.place)
    for side in goal.palms:
        reacher = Reacher.of(reaching.skeleton, side)
        palms = reaching.palms(reacher, goal)[::_SPARSE]
        _, arm = finished(stretch_of(reacher, palms, reaching.base, reaching.present(reacher), near))
        if arm.stretched < _FARTHEST:
            best = max(best, -arm.cost - _STRETCH * max(arm.stretched - EASY, 0.0))
    return best - _SUNK * sunk_at(reaching, goal.palms, goal.place, plates)
