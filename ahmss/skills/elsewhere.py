"""What can't be done with a control from where one stands, done from elsewhere: as with the other hand, say.

Nobody goes anywhere in vain: what would come of it is worked out before the steps, while one looks at the control.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Generator, Iterator, Sequence
from typing import TypeVar

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.errors import AlgorithmError
from ahmss.motion.steps import Steps
from ahmss.reaching.plan import Reaching
from ahmss.skills.arm_clear import standing_about
from ahmss.skills.before_it import all_before, around_it
from ahmss.skills.come_to import come_to
from ahmss.skills.controls import gone_to
from ahmss.skills.reaching import Looking
from ahmss.skills.stands import is_taken, stance_at, standing
from ahmss.walking import goals

__all__ = ["or_elsewhere"]

Worked = TypeVar("Worked")
Result = TypeVar("Result")
Worth = Callable[[Reaching], float]
Attempt = Callable[[HumanTask, Looking, Worked | None, float], Generator[Array, None, Worked]]
_MOST, _FOR_ONE = 5, 2  # stands from which it is tried, and of those that are best for one hand alone
_CLEAN = 0.006  # metres: what is amiss by less is as good as can be
_LONG = 1.0  # seconds of thinking from which on it is told of what
_PLAINLY = 0.005  # metres by which what is worse than the best is not looked at further
_AMISS, _WORTH = 0.01, 0.004  # metres amiss from which on it is tried elsewhere, and by which that is to be better
_ASIDE = (0.14, -0.14, 0.3, -0.3, 0.0, 0.44, -0.44, 0.58, -0.58)  # metres that one stands aside of it
_AWAY = (0.54, 0.46, 0.62, 0.38)  # metres before it
_SAME = 0.08  # metres: stands so near to each other are one


def or_elsewhere(
    task: HumanTask,
    gaze: Looking,
    attempt: Attempt[Worked],
    worth: Worth,
    flaw: Callable[[Worked], float],
    amiss: Callable[[Worked], float] = lambda _: 0.0,
    at_best: float = np.inf,
    apart: Sequence[Worth] = (),
) -> Generator[Array, None, tuple[HumanTask, Looking, Worked]]:
    """What an attempt comes to from where one stands; where it is refused, or much amiss, from elsewhere, after steps.

    Of the places from where it comes off that with the least flaw; it is looked no further where that is next to none.

    Args:
        task: who uses a control; without a walk library nobody steps. gaze: on its way to the control.
        attempt: works it out in frames (1, 260) in which only the gaze moves, for who stands as the task begins; of
            what it came to when it was thought of from there, if it was, it makes the same again where that serves. It
            leaves early what has a greater flaw than so many metres.
        worth: how well it may come off from how somebody stands, as far as one sees at once; -inf: it won't. at_best:
            no stand is worth more. apart: the same of each of several hands alone: where it comes off from none of the
            stands that are best for either, those are tried that are best for one.
        flaw: metres by which what an attempt comes to is amiss. amiss: those for which one would rather go elsewhere.

    Raises:
        AlgorithmError: it is refused from everywhere; as it was from where one stands in the end.
    """
    for again in (True, False):  # who came there, and does not stand just as was thought, thinks once more
        here, refused = None, None
        try:
            here = yield from attempt(task, gaze, None, np.inf)
        except AlgorithmError as error:
            if task.library is None:
                raise
            refused = error
        if here is not None and (task.library is None or amiss(here) <= _AMISS):
            return task, gaze, here
        least = np.inf if here is None else flaw(here)
        thought = yield from _aloud(task, _thought(task, gaze, attempt, (worth, *apart), at_best, flaw, least))
        if here is not None and (not thought or thought[0][0] > amiss(here) - _WORTH):
            return task, gaze, here
        for _, stand, worked in thought:
            task.note(f"goes to {stand.place[0]:.2f} {stand.place[1]:.2f}, from where a hand has room")
            task, gaze = yield from gone_to(task, stand, gaze)
            try:
                return task, gaze, (yield from attempt(task, gaze, worked, np.inf))
            except AlgorithmError as error:
                refused = error
        if not (again and thought):
            break
    assert refused is not None
    raise refused


def _aloud(task: HumanTask, work: Generator[Array, None, Result]) -> Generator[Array, None, Result]:
    """Frames of thinking, of which is told what is thought of where they are many."""
    frames = 0
    while True:
        try:
            rows = next(work)
        except StopIteration as end:
            return end.value
        frames += len(rows)
        if frames > _LONG * task.rate:
            task.note("looks for a place from where a hand has room")
        yield rows


def _thought(
    task: HumanTask, gaze: Looking, attempt: Attempt[Worked], worths: Sequence[Worth], at_best: float,
    flaw: Callable[[Worked], float], least: float,
) -> Generator[Array, None, list[tuple[float, goals.Goal, Worked]]]:  # fmt: skip
    """What attempts come to from other stands, and their flaws, the best first, in frames (1, 260) of thinking.

    least: the flaw that there is already. worths: the stands that are best by one are tried where those by none before
    it serve.
    """
    thought: list[tuple[float, goals.Goal, Worked]] = []
    tried = [task.start.root[:2]]
    for number, worth in enumerate(worths):
        stands = yield from gaze.during(_stands(task, worth, at_best, tried))
        for stand in stands[: _FOR_ONE if number else _MOST]:
            tried.append(stand.place)
            worked = yield from _thought_of(task, stand, gaze, attempt, least + _PLAINLY)
            if worked is not None:
                thought.append((flaw(worked), stand, worked))
                least = min(least, thought[-1][0])
                if least <= _CLEAN:
                    break
        if least < np.inf:
            break
    return sorted(thought, key=lambda one: one[0])


def _thought_of(
    task: HumanTask, stand: goals.Goal, gaze: Looking, attempt: Attempt[Worked], most: float
) -> Generator[Array, None, Worked | None]:
    """What an attempt would come to from a stand, None: to nothing; in frames (1, 260) while that is thought of."""
    thought = come_to(task, stand)
    yield from gaze.if_there_is_time()
    work = attempt(thought, Looking(thought, gaze.place, in_thought=True), None, most)
    while True:
        try:
            next(work)
        except StopIteration as end:
            return end.value
        except AlgorithmError:
            return None
        yield from gaze.if_there_is_time()


def _stands(task: HumanTask, worth: Worth, at_best: float, but: Sequence[Array]) -> Steps[list[goals.Goal]]:
    """Where one might stand but for some places (2,), the best first; of the very best the first that are found."""
    taken, found, places = standing(task), list[tuple[float, goals.Goal]](), list(but)
    for stand in _all_around(task):
        if is_taken(stand, taken) or _near(stand, places):
            continue
        places.append(stand.place)
        found.append((worth(stance_at(task, stand)), stand))
        if sum(one[0] >= at_best for one in found) == _MOST:
            break
        yield
    found = [one for one in found if one[0] > -np.inf]
    return [stand for _, stand in sorted(found, key=lambda one: -one[0])][:_MOST]


def _all_around(task: HumanTask) -> Iterator[goals.Goal]:
    """Places before the control, facing as it does; where an arm may be in what it is on, beside it, too, facing it."""
    assert task.object is not None
    yield from all_before(task, itertools.product(_AWAY, _ASIDE))
    if standing_about(task):
        yield from around_it(task)


def _near(stand: goals.Goal, places: list[Array]) -> bool:
    return any(float(np.linalg.norm(stand.place - place)) < _SAME for place in places)
