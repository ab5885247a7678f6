"""A part of a thing between thumb and fingers: it is taken, goes its way with the hand, and is let go.

A tap's lever, a slide, a knob. The reach is that of `reach`, the grip that of `grasp` at a site with a precision grip:
the hand comes along its x, thumb and fingers close along its z. What the shipped algorithms that move a part share.
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.links import fingers
from ahmss.body.quaternion import slerp
from ahmss.errors import AlgorithmError
from ahmss.grasping.hand import Hand
from ahmss.grasping.holding import Holding
from ahmss.reaching.goal import Goal
from ahmss.reaching.going_on import GoingOn
from ahmss.reaching.performing import Performed
from ahmss.reaching.plan import Plan, Reaching
from ahmss.reaching.prism import Prism
from ahmss.skills.arm_clear import beyond, refuse_sunk, standing_about, sunk_at, sunk_in
from ahmss.skills.at_ease import at_ease
from ahmss.skills.box import Box
from ahmss.skills.brought_there import brought_there, held_ends
from ahmss.skills.clearing import KEEPS, WITHIN, gap_of, refuse_touching
from ahmss.skills.controls import beside, in_the_way, is_control, stood_before
from ahmss.skills.elbow_room import awaited, crowding, refuse_head_in
from ahmss.skills.elsewhere import or_elsewhere
from ahmss.skills.going_back import gone_back, rows_made
from ahmss.skills.in_part import InPart
from ahmss.skills.keeping import kept_clear
from ahmss.skills.leading import is_taken
from ahmss.skills.off_target import too_short
from ahmss.skills.opening import opens_by
from ahmss.skills.out_of_reach import EXACT, refuse_short
from ahmss.skills.part_course import along, course, moved
from ahmss.skills.part_ways import (
    Approach,
    Grip,
    Part,
    approaches,
    clearer,
    grip_of,
    kept_from,
    lasting,
    open_hand,
)
from ahmss.skills.past_the_rest import Rest
from ahmss.skills.reaching import Looking, performed, sides_of
from ahmss.skills.rolling_on import held_on, shapes_on
from ahmss.skills.smoothest import smoothest

__all__ = ["Part", "pinched"]

_MISSED, _ARM = 0.006, 0.09  # metres that thumb and fingers may be off, and how far they are from the palm
_MOST_LOOSE = 0.0022  # metres that fingers may be in the part or off what they give: their skin is 0.6 mm less deep
_GIVES = 0.003  # metres that fingers may be off what they hold, by their balls
_DEEP = 0.001  # metres that fingers may be in the part, by their balls, in which skin is less deep
_REFUSED = 1.0  # as metres: any way that is not refused is better, however near it comes to somebody
_SEEN_CLEAR = 0.008  # metres that the bones of a hand keep, where it is performed, so that no other way is tried
_MOST_WAYS = 3  # that are tried
_AS_WELL = 0.001  # metres by which what comes of a way may be worse than was thought, so that no other is tried
_NEARLY = 0.002  # metres by which a hand may come nearer to what is beside than palms promise, for the same
_OVER = (0.0, np.pi)  # the thumb on the one side of the part, and on the other: whichever is easier


def pinched(task: HumanTask, part: Part, other: Part | None = None) -> Iterator[Array]:
    """Frames (n, 260) of what `_pinched` does, what the other hand holds kept out of the way."""
    return kept_clear(task, _pinched(task, part, other))


def _pinched(task: HumanTask, part: Part, other: Part | None) -> Iterator[Array]:
    """Frames (n, 260): the hand comes, closes, moves the part, opens, and goes back the way that it came.

    Where the arm can't go all the way so it goes the other way, if there is one, with the same site. Where neighbours
    would be touched it comes and goes otherwise: from farther before the part, aslant, with other palms, the other
    hand, or from where one stands elsewhere. So it does where fingers would be in the part as the arm goes, or off it.

    Raises:
        AlgorithmError: thumb and fingers can't close there, it is out of reach, something is in the way, or the hand
            can't bring it where it is to go; says so.
    """
    gaze, taken, boxes = Looking(task, part.site.place), dict[str, list[Grip]](), kept_from(task, part)
    yield gaze.alone()
    for side in sides_of(task):
        for over in _OVER:
            if grip := grip_of(task, side, part, over):
                taken.setdefault(side, []).append(grip)
            yield gaze.alone()
    if boxes:  # where fingers that do nothing would be in what is beside it, thumb and index finger take it alone
        for side, found in taken.items():
            taken[side] = [clearer(task, part, grip, boxes) for grip in found]
            yield gaze.alone()
    if not taken:
        name = "it" if task.object is None else task.object.name
        raise AlgorithmError(f"thumb and fingers can't close on {name} there; give the site another rotation")
    ways = yield from approaches(task, part, taken, boxes, gaze)
    prisms, plates = in_the_way(task), standing_about(task)
    goal = Goal(part.site.place, palms=ways[0].clear)
    if is_control(task):
        task, gaze = yield from stood_before(task, goal, prisms, gaze)
    else:
        task.arrived()

    def attempt(
        task: HumanTask, gaze: Looking, thought: tuple[_Tried, bool] | None, most: float
    ) -> Generator[Array, None, tuple[_Tried, bool]]:
        first = None if thought is None else thought[0]
        return _worked_out(task, ways, other, taken, prisms, boxes, gaze, first, most)

    def worth(ways: Sequence[Approach], reaching: Reaching) -> float:
        """Metres that a hand would have to spare which comes there from so, less those that its arm is in plates."""
        found = lasting(reaching, ways, 1)
        if not found:
            return -np.inf
        return min(found[0].gap, KEEPS) - sunk_at(reaching, found[0].clear, part.site.place, plates)

    apart = [[way.by(side) for way in ways if side in way.palms] for side in taken] if len(taken) > 1 else []

    def amiss(worked: tuple[_Tried, bool]) -> float:
        """Metres for which one rather stands elsewhere: a hand's neighbours, or a wrist that does not go along."""
        return worked[0].amiss.touches if is_control(task) else worked[0].on_part

    task, gaze, (best, is_last) = yield from or_elsewhere(
        task, gaze, attempt, partial(worth, ways), lambda worked: worked[0].flaw, amiss, min(ways[0].gap, KEEPS),
        [partial(worth, own) for own in apart if own],
    )  # fmt: skip
    waited = yield from awaited(task, best.made, best.plan.reacher.side, gaze)
    refuse_head_in(task, best.made)  # somebody may have come meanwhile
    if (waited or not is_last) and best.made.looked < 1.0:  # the eyes have gone on since it was made
        best = replace(best, made=(yield from best.perform(best.plan)))
        _refuse(task, best)
    yield at_ease(task, np.concatenate([rows_made(task, best.made), best.back(task)]))


def _worked_out(
    task: HumanTask, ways: Sequence[Approach], other: Part | None, taken: dict[str, list[Grip]],
    prisms: Sequence[Prism], boxes: Sequence[Box], gaze: Looking, thought: _Tried | None, most: float,
) -> Generator[Array, None, tuple[_Tried, bool]]:  # fmt: skip
    """The best of some ways from where one stands, in frames (1, 260) of the gaze; and whether it was made last.

    thought: what it came to when it was thought of; what comes off as well is not looked further for. most: metres of
    flaw beyond which it is worse than what is known already.

    Raises:
        AlgorithmError: it is out of reach, something is in the way, or the hand can't bring it where it is to go.
    """
    brings, in_part = partial(along, ways[0].part), InPart(task)
    rest = Rest(task, in_part)
    reaching = GoingOn(task.human, task.start.rotations, task.start.root, brings)
    each = {side: [way.by(side) for way in ways if side in way.palms] for side in taken}  # for one hand alone
    left = lasting(reaching, ways, _MOST_WAYS) or list(ways[:1])
    enough = 0.0 if thought is None else thought.flaw + _AS_WELL
    left = left if thought is None else [thought.way, *left]
    best: _Tried | None = None
    refused: AlgorithmError | None = None
    one = None
    while left:
        way = left.pop(0)
        try:
            one = yield from _tried(task, way, other, taken, reaching, prisms, boxes, gaze, rest, in_part)
        except AlgorithmError as error:  # another way may be within reach
            refused = refused or error
        else:
            best = one if best is None or one.flaw < best.flaw else best
            if best.flaw <= enough or best.amiss.excess <= 0.0:
                break
            each.pop(one.plan.reacher.side, None)
            if one.on_part >= min(most, _REFUSED):  # wherever it comes from
                left = [way for way in (way.without(one.plan.reacher.side) for way in left) if way.palms]
        while not left and each and (best is None or _refused(task, best)):  # the ways are the clearest for both
            _, own = each.popitem()
            left = lasting(reaching, own, _MOST_WAYS) if own else []
    if best is None:
        assert refused is not None
        raise refused
    _refuse(task, best)
    return best, best is one


def _refuse(task: HumanTask, tried: _Tried) -> None:
    """Refuse what would not come off.

    Raises:
        AlgorithmError: why not.
    """
    refuse_short(task, tried.plan, tried.amiss.short)
    if short := _short(task, tried.part, tried.plan, tried.made):
        raise AlgorithmError(short)
    if not _is_taken(task, tried.part, tried.plan, tried.made):
        name = "it" if task.object is None else task.object.name
        raise AlgorithmError(
            f"thumb and index finger have no room to open about {name} and close on it; stand elsewhere, or use the "
            "other hand"
        )
    if touching := _touching(task, tried):
        raise touching
    refuse_sunk(task, tried.plan, *_shown(tried.made, tried.back(task)))
    refuse_head_in(task, tried.made)
    slips = is_control(task)  # whose hand goes as its neighbours leave it room
    if tried.amiss.loose > _MOST_LOOSE and not slips:
        name = "it" if task.object is None else task.object.name
        raise AlgorithmError(
            f"the {tried.plan.reacher.side} hand would not stay on {name} from here, fingers in it or off it by "
            f"{1000.0 * tried.amiss.loose:.0f} mm; use the other hand, or stand elsewhere"
        )


@dataclass(frozen=True)
class _Amiss:
    """Metres by which a hand misses or touches something on a way.

    flaw: all of them. touches: how much of them is that it comes too near to what is beside the part. excess: what is
    left of the flaw but for what comes of that with the clearest of the way's palms: no way that is no clearer has
    less. short: by how many the arm is too short for the part. loose: by how many fingers are in the part, or off it
    while they should hold it.
    """

    flaw: float
    excess: float
    touches: float
    short: float
    loose: float


@dataclass(frozen=True, eq=False)
class _Tried:
    """What comes of a way.

    amiss: in metres. on_part: how much of its flaw while the hand is on the part. way: that of its hand alone.
    perform: makes a plan's frames anew.
    """

    amiss: _Amiss
    on_part: float
    way: Approach
    plan: Plan
    made: Performed
    perform: Callable[[Plan], Generator[Array, None, Performed]]

    @property
    def flaw(self) -> float:
        """Metres by which the hand misses or touches something."""
        return self.amiss.flaw

    @property
    def part(self) -> Part:
        """The part, as it is come to."""
        return self.way.part

    def back(self, task: HumanTask) -> Array:
        """Frames (n, 260) in which it goes back."""
        return _back(task, self.part, self.plan, self.made)


def _refused(task: HumanTask, tried: _Tried) -> bool:
    """Whether it would not come off."""
    try:
        _refuse(task, tried)
    except AlgorithmError:
        return True
    return False


def _touching(task: HumanTask, tried: _Tried) -> AlgorithmError | None:
    """Why it is not to be made, where its hand would be in what is beside."""
    try:
        refuse_touching(task, tried.plan.reacher.side, *_shown(tried.made, tried.back(task)), beside(task))
    except AlgorithmError as error:
        return error
    return None


def _tried(
    task: HumanTask, way: Approach, other: Part | None, taken: dict[str, list[Grip]], reaching: Reaching,
    prisms: Sequence[Prism], boxes: Sequence[Box], gaze: Looking, rest: Rest, in_part: InPart,
) -> Generator[Array, None, _Tried]:  # fmt: skip
    """What comes of a way.

    Raises:
        AlgorithmError: it is out of reach so.
    """
    part = way.part
    instead = None if other is None else replace(other, off=part.off)
    goal = Goal(part.site.place, palms=way.clear)

    def perform(plan: Plan) -> Generator[Array, None, Performed]:
        grip = min(taken[plan.reacher.side], key=lambda grip: grip.turned_from(plan.palm))
        wide, near = open_hand(task, plan.reacher.side, grip.holding), beside(task)
        share = opens_by(task, plan.reacher.side, *moved(task, part, plan.palm), (wide, grip.holding.shape), near)
        plan = yield from gaze.during(rest.round(plan, part, slerp(grip.holding.shape, wide, share)))
        yield from gaze.if_there_is_time()

        def so(part: Part, goes: Part) -> Generator[Array, None, Performed]:
            return _made(task, part, goes, plan, gaze, reaching, grip.holding, rest, share)

        made = yield from brought_there(task, part, plan, partial(so, part))
        missed = _missed(task, part, plan, made)
        if instead is None or missed <= _MISSED:
            return made
        other = yield from so(instead, instead)
        return other if _missed(task, instead, plan, other) < missed else made

    near_by = max(_SEEN_CLEAR - way.gap, 0.0) + _NEARLY if boxes else 0.0  # what comes of the clearest palm
    known: dict[Performed, _Amiss] = {}

    def missed(plan: Plan, made: Performed) -> float:
        either = [_missed(task, one, plan, made) for one in (part, instead) if one is not None]
        fails = _short(task, part, plan, made) or not _is_taken(task, part, plan, made)
        return max(min(either) - _MISSED, 0.0) + (_REFUSED if fails else 0.0)

    def touched(plan: Plan, rotations: Array, root: Array) -> float:
        if not boxes:
            return 0.0
        gap, touching = (gap_of(task, plan.reacher.side, rotations, root, near) for near in (boxes, beside(task)))
        return max(_SEEN_CLEAR - gap, 0.0) + (_REFUSED if touching <= -WITHIN else 0.0)

    def amiss(plan: Plan, made: Performed) -> _Amiss:
        if made not in known:
            side, back = plan.reacher.side, _back(task, part, plan, made)
            shown, (then, closed) = _shown(made, back), moved(task, part, plan.palm)
            short, touches = too_short(task, plan, made, then, closed == 1.0), touched(plan, *shown)
            loose = _loose(task, part, plan, made, back, in_part)
            deep = max(loose - _DEEP, 0.0) + rest.depth(side, *shown) + beyond(sunk_in(task, side, *shown)[0])
            rest_of_it = (_REFUSED if short > EXACT else 0.0) + missed(plan, made) + crowding(task, made, side) + deep
            flaw = rest_of_it + touches
            known[made] = _Amiss(flaw, rest_of_it + max(touches - near_by, 0.0), touches, short, loose)
        return known[made]

    def on_part(plan: Plan, made: Performed) -> float:
        on = np.flatnonzero(moved(task, part, plan.palm)[1] > 0.0)
        on += len(made.root) - len(moved(task, part, plan.palm)[1])
        sunk = beyond(sunk_in(task, plan.reacher.side, made.rotations, made.root)[0])
        return missed(plan, made) + touched(plan, made.rotations[on], made.root[on]) + (_REFUSED if sunk else 0.0)

    def excess(plan: Plan, made: Performed) -> float:
        return amiss(plan, made).excess

    plan, made = yield from smoothest(task, reaching, goal, gaze, prisms, part.off, perform, excess)
    return _Tried(amiss(plan, made), on_part(plan, made), way.by(plan.reacher.side), plan, made, perform)


def _loose(task: HumanTask, part: Part, plan: Plan, made: Performed, back: Array, in_part: InPart) -> float:
    """Metres by which fingers are in the part at the most, in what is made and as they go back (m, 260); or off it by
    more than pads give way while they should hold it. A control's knob or cover slips in them, and is not lost.
    """
    reacher, n, m = plan.reacher, len(made.root), len(back)
    way, closed, _ = course(task, part)
    palms = np.concatenate([made.targets, back[:, 220:].reshape(m, 5, 8)])[:, reacher.row, :7]
    shapes = _shown(made, back)[0][:, list(fingers(reacher.side))]
    before = n - len(way)
    way, held = np.pad(way, (before, m)), np.pad(closed == 1.0, (before, m))
    on = reacher.side, part, palms, shapes, way, held
    return max(in_part.depth(*on), 0.0 if is_control(task) else in_part.off(*on) - _GIVES)


def _back(task: HumanTask, part: Part, plan: Plan, made: Performed) -> Array:
    """Frames (n, 260) in which the hand goes back the way that it came to the part."""
    return gone_back(task, made, len(made.root) - len(moved(task, part, plan.palm)[0]), plan.reacher.links)


def _shown(made: Performed, back: Array) -> tuple[Array, Array]:
    """Rotations (n, 43, 4) and root (n, 3) of what is made and of the rows (m, 260) in which it goes back."""
    rotations = np.concatenate([made.rotations, back[:, 4:176].reshape(-1, 43, 4)])
    return rotations, np.concatenate([made.root, back[:, 1:4]])


def _made(
    task: HumanTask,
    part: Part,
    goes: Part,
    plan: Plan,
    gaze: Looking,
    reaching: Reaching,
    holding: Holding,
    rest: Rest,
    share: float,
) -> Generator[Array, None, Performed]:
    """The frames of a plan, the hand going as the part `goes`, fingers opening by a share of as wide as they come."""
    side = plan.reacher.side
    then, closed = moved(task, goes, plan.palm)
    holding = held_on(task, part, side, plan.palm, holding)
    wide, links = slerp(holding.shape, open_hand(task, side, holding), share), list(fingers(side))
    made = yield from performed(task, reaching, plan, gaze, (links, wide), then, rest.on_way(side, part))
    n, way = len(then), course(task, part)[0]
    palms = made.targets[-n:, plan.reacher.row, :7]
    shapes = shapes_on(task, part, side, palms, way, closed == 1.0, holding)
    made.rotations[-n:, links] = slerp(wide, shapes, closed[:, None])
    return made


def _missed(task: HumanTask, part: Part, plan: Plan, made: Performed) -> float:
    """Metres by which a point of the hand at the part's distance from the palm is off at the most: the arm's joints."""
    then, closed = moved(task, part, plan.palm)
    n, holds = len(then), closed > 0.0
    got = grips(task.human, made.rotations[-n:], made.root[-n:])[:, plan.reacher.row]
    turned = 2.0 * np.arccos(np.clip(np.abs((got[:, 3:] * then[:, 3:]).sum(axis=-1)), 0.0, 1.0))
    return float((np.linalg.norm(got[:, :3] - then[:, :3], axis=-1) + _ARM * turned)[holds].max())


def _is_taken(task: HumanTask, part: Part, plan: Plan, made: Performed) -> bool:
    """Whether thumb and index finger close as they take the part, so that it is seen to be held."""
    closed, side = moved(task, part, plan.palm)[1], plan.reacher.side
    openings = Hand.of(task.human, side).openings(made.rotations[-len(closed) :, list(fingers(side))])[:, 0]
    takes = int(np.argmax(closed == 1.0))
    return is_taken(float(openings[takes]), float(openings[: takes + 1].max()))


def _short(task: HumanTask, part: Part, plan: Plan, made: Performed) -> str:
    """Why the part does not come to where it is to go; "" where it does, or nobody can tell."""
    if part.short is None:
        return ""
    return part.short(*held_ends(task, part, plan, made))
