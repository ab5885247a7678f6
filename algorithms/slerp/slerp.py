"""From the present pose through the keyframes of a clip by slerp (Ichiguchi 2000, 5.3.3).

Every keyframe is reached at rest along a minimum-jerk profile. Hands with a target go there along their own path, the
orientation set before the place; the gaze goes first. Nothing here depends on what happens meanwhile, so the frames are
computed in blocks, all but a few in one; but what goes to the face of who is carried is computed frame by frame, for
the face goes along.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ahmss.algorithm import HumanTask, Transform, run
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import IDENTITY, multiply, normalize, rotate
from ahmss.body.quaternion import slerp as interpolate
from ahmss.errors import AlgorithmError
from ahmss.motion.clip import Clip
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.steps import Steps
from ahmss.reaching.standing import Posture
from ahmss.reaching.trunk_way import between
from ahmss.skills.at_mouth import with_ease
from ahmss.skills.idle_arms import IdleArms
from ahmss.skills.out_of_reach import come_nearer
from ahmss.skills.staging import Staged, face, stage
from ahmss.skills.trunk_clear import trunk_kept_clear

HANDS = ("right", "left")
GAZE = 4
TRUNK = [INDEX["hips"], INDEX["spine"]]
MOST_MISSING = 0.03  # metres beyond a stretched arm that are still tried for
HELD_WITHIN = 0.97  # of the arm's length: how far off what is held is at the most, once it is raised
MOST_MISSED = 0.06  # metres that are not told of: who was carried to a thing can't lean as who stands before it does
ON_FACE = Transform(np.zeros(3), IDENTITY)
CARRIED_IN = 16  # frames in which a hand that goes to the face has taken on the speed of the body
TURNED_BY = 0.75  # share of the time by which a hand has its orientation


@dataclass(frozen=True)
class Course:
    """At each of n frames: the keyframe that comes next, the share of the time to it, and the share of the way."""

    key: Array
    time: Array
    done: Array


def slerp(task: HumanTask) -> Iterator[Array]:
    """Frames from the present pose to the clip's last keyframe: the first at once, then all others (N - 1, 260).

    Who is carried is looked at once more before the last frame.
    """
    clip = task.posture or task.motion
    if clip is None:
        raise AlgorithmError("slerp needs a motion clip with keyframes, or a goal posture")
    staged = stage(task, clip if task.posture is None else _last(clip))
    if staged.clip.header.targets == "face" and task.hold == "keep":
        staged = with_ease(task, staged)
    frames = np.arange(1, task.length + 1)
    if not task.carried:  # who is carried comes nearer, or goes away
        _check_reach(task, staged)
        idle, k = IdleArms(task, _idle(task, staged)), 0
        work = _kept_clear(task, staged, idle)
        while k < task.length:
            yield idle.over(
                _block(task, staged, frames[k : k + 1]), frames[k : k + 1]
            )  # as soon after the start it is hardly elsewhere
            k += 1
            try:
                next(work)
            except StopIteration as found:
                staged = found.value
                break
        if k < task.length:
            yield idle.over(_block(task, staged, frames[k:]), frames[k:])
        return
    if staged.clip.header.targets == "face":
        yield from _on_the_way(task, staged, frames)
        return
    yield _block(task, staged, frames[:1])
    if task.length > 2:
        yield _block(task, staged, frames[1:-1])
    _tell_missed(task, staged)
    if task.length > 1:
        yield _block(task, staged, frames[-1:])


def _idle(task: HumanTask, staged: Staged) -> list[str]:
    """The sides of the arms that the clip does not lead."""
    led = staged.local[:, : len(HANDS), 7].any(axis=0)
    return [side for side, leads in zip(HANDS, led, strict=True) if not leads and side not in task.busy]


def _kept_clear(task: HumanTask, staged: Staged, idle: IdleArms) -> Steps[Staged]:
    """The clip with trunk and idle arms kept clear of things, in parts."""
    made = yield from trunk_kept_clear(task, staged)
    moved = [side for side in _idle(task, made) if made.clip.importance[:, INDEX[f"{side}_upper_arm"]].any()]
    if moved:
        rotations, root, _, _ = _poses(task, made, idle.seen)
        yield from idle.look(moved, rotations, root)
    return made


def _on_the_way(task: HumanTask, staged: Staged, frames: Array) -> Iterator[Array]:
    """The frames (1, 260) of a hand that goes to the face, wherever the body is carried meanwhile.

    All its way is known as the face sees it; where that is, is asked at each frame.
    """
    rotations, root, importance, seen = _poses(task, staged, frames, ON_FACE)
    known = minimum_jerk(frames / CARRIED_IN)  # the first frame does not say how fast the body is carried
    last = face(task, task.present.rotations, task.present.root)
    for i in range(len(frames)):
        now = face(task, task.present.rotations, task.present.root)
        base = Transform(now.place + known[i] * (now.place - last.place), now.rotation)
        last = now
        targets = seen[i : i + 1].copy()
        hands = targets[:, : len(HANDS)]
        for target in (hands, targets[:, GAZE]):
            target[..., :3] = base.apply(target[..., :3])
        hands[..., 3:7] = multiply(base.rotation, hands[..., 3:7])
        hands[hands[..., 7] == 0.0] = 0.0
        yield task.block(rotations[i : i + 1], root[i : i + 1], importance[i : i + 1], targets)


def _block(task: HumanTask, staged: Staged, frames: Array) -> Array:
    """The frames (n) asked for, as POSE rows (n, 260)."""
    return task.block(*_poses(task, staged, frames))


def _poses(
    task: HumanTask, staged: Staged, frames: Array, base: Transform | None = None
) -> tuple[Array, Array, Array, Array]:
    """Rotations, root, importance and targets of frames (n); targets are relative to a base, the clip's if left out."""
    course = _course(task.length, frames, staged.clip)
    key = course.key
    before = np.maximum(key - 1, 0)
    start = np.concatenate([task.start.rotations[None], staged.rotations])
    rotations = interpolate(start[key], staged.rotations[key], course.done[:, None])
    way = np.concatenate([task.start.root[None], staged.root])
    root = way[key] + course.done[:, None] * (staged.root[key] - way[key])
    for k, towards in enumerate(staged.towards):
        (some,) = np.nonzero(key == k)
        ends = Posture(start[k], way[k]), Posture(staged.rotations[k], staged.root[k])
        made = between(*ends, towards, course.done[some])
        rotations[np.ix_(some, TRUNK)], root[some] = made.rotations[:, TRUNK], made.root
    given = staged.clip.importance
    importance = given[before] + course.done[:, None] * (given[key] - given[before])
    if base is None:
        base = face(task, rotations, root) if staged.clip.header.targets == "face" else staged.base
    targets = _targets(task, staged, course, base)
    if staged.towards:
        some = targets[:, : len(HANDS), 7] > 0.0
        targets[:, : len(HANDS), :3][some] += _bowed(task, staged, course, Posture(rotations, root))[some]
    return rotations, root, importance, targets


def _bowed(task: HumanTask, staged: Staged, course: Course, made: Posture) -> Array:
    """How far (n, 2, 3) right and left shoulder are from the straight way between keyframes: their hands go along."""
    way = np.concatenate([task.start.root[None], staged.root])
    keys = np.concatenate([task.start.rotations[None], staged.rotations])
    joints = [INDEX[f"{side}_upper_arm"] for side in HANDS]
    stops = forward(keys, way, task.human.offsets)[0][:, joints]
    before = stops[course.key]
    straight = before + course.done[:, None, None] * (stops[course.key + 1] - before)
    return forward(made.rotations, made.root, task.human.offsets)[0][:, joints] - straight


def _last(clip: Clip) -> Clip:
    """The posture that a clip ends in."""
    targets = None if clip.targets is None else clip.targets[-1:]
    return Clip(
        clip.rotations[-1:], clip.root[-1:], clip.importance[-1:], clip.contacts[-1:], clip.rate, targets, clip.header
    )


def _course(length: int, frames: Array, clip: Clip) -> Course:
    """Spread the keyframes over the length asked for: at the header's times, evenly where it has none."""
    times = np.array(clip.header.times or np.arange(1, clip.frames + 1) / clip.frames)
    now = frames / length * times[-1]
    key = np.minimum(np.searchsorted(times, now - 1e-9), clip.frames - 1)
    starts = np.concatenate([[0.0], times[:-1]])
    time = np.clip((now - starts[key]) / (times - starts)[key], 0.0, 1.0)
    return Course(key, time, minimum_jerk(time))


def _targets(task: HumanTask, staged: Staged, course: Course, base: Transform | None) -> Array:
    """Targets (n, 5, 8): hands along their paths, feet where they stand, gaze."""
    targets = np.zeros((len(course.key), 5, 8))
    if staged.planted:
        targets[:, 2:4, :7], targets[:, 2:4, 7] = staged.feet, 1.0
    for row in range(2):
        if base is not None and staged.local[:, row, 7].any():
            targets[:, row] = _hand(task, staged, course, base, row)
    if base is not None:
        targets[:, GAZE] = _gaze(task, staged, course, base)
    return targets


def _hand(task: HumanTask, staged: Staged, course: Course, base: Transform, row: int) -> Array:
    """A hand's target (n, 8): by minimum jerk from key to key, each of them moving with what it is relative to.

    While the body is carried elsewhere, the hand leaves its place on it gradually: from where the face saw it, or
    where its way has nothing to do with the face the first key's weight grows.
    """
    frames = np.arange(len(course.key))
    shape = (len(frames), 7)
    ends = [np.broadcast_to(frame.row(), shape) for frame in _wanted_grips(task, staged, base, row)]
    to_face = staged.clip.header.targets == "face"
    before, present = ends[0], task.start.grip(HANDS[row])
    if task.carried and to_face:
        on_face = face(task, task.start.rotations, task.start.root).inverse().then(present)
        before = np.broadcast_to(base.then(on_face).row(), shape)
    elif not task.carried or _begins_there(task):
        before = np.broadcast_to(present.row(), shape)
    stops = np.stack([before, *ends])  # (K + 1, n, 7)
    a, b = stops[course.key, frames], stops[course.key + 1, frames]
    if to_face and not task.carried:  # led to where the face is now, a hand stays behind who rises
        there = face(task, staged.rotations[0], staged.root[0])
        b = np.where((course.key == 0)[:, None], _wanted_grips(task, staged, there, row)[0].row(), b)
    out = np.empty((len(frames), 8))
    done = course.done[:, None]
    out[:, :3] = a[:, :3] + done * (b[:, :3] - a[:, :3])
    rise = task.parameter("arc", 0.03) * 16.0 * course.done**2 * (1.0 - course.done) ** 2
    out[:, 2] += np.where((course.key == 0) & (not task.carried), rise, 0.0)
    out[:, 3:7] = interpolate(a[:, 3:], b[:, 3:], minimum_jerk(course.time / TURNED_BY))
    first = 0.0 if task.carried and not to_face and not _begins_there(task) else staged.local[0, row, 7]
    weights = np.concatenate([[first], staged.local[:, row, 7]])
    out[:, 7] = weights[course.key] + course.done * (weights[course.key + 1] - weights[course.key])
    return out


def _begins_there(task: HumanTask) -> bool:
    """Whether the way begins where the hand is: what it holds is moved away from where it stands itself."""
    return task.hold == "keep" and task.site is not None and task.goal_place is None


def _wanted_grips(task: HumanTask, staged: Staged, base: Transform, row: int) -> list[Transform]:
    """Where the palm shall be at each key, once or at each frame.

    While the object is held, the clip says where the object's site goes, and the palm stays on it as it is.
    """
    keys = [Transform.of(key) for key in staged.local[:, row, :7]]
    if staged.clip.header.targets == "face":
        keys = [_as_wide(task, key) for key in keys]
    wanted = [base.then(key) for key in keys]
    grip = task.start.grip(HANDS[row])
    if task.hold in ("keep", "release") and task.site is not None and task.object is not None:
        on_site = task.site.inverse().then(grip)
        wanted = [site.then(on_site) for site in wanted]
        if task.goal_place is not None:
            wanted[-1] = _goal(task, task.goal_place).then(task.object.frame.inverse().then(grip))
        elif task.hold == "keep" and not task.carried and staged.clip.header.targets != "face":
            wanted = [_within_reach(task, staged, row, key, palm) for key, palm in enumerate(wanted)]
    elif task.goal_place is not None:
        rotation = wanted[-1].rotation if task.goal_rotation is None else task.goal_rotation
        wanted[-1] = Transform(np.broadcast_to(task.goal_place, (*rotation.shape[:-1], 3)), rotation)
    return wanted


def _within_reach(task: HumanTask, staged: Staged, row: int, key: int, palm: Transform) -> Transform:
    """The palm of what is held at a key, drawn towards the shoulder of who straightens up, as far as the arm is short.

    A clip says how far something is raised over where it stood; that may have been low, or far off.
    """
    shoulder, wrist, length = _arm(task, row, staged.rotations[key], staged.root[key], palm)
    way = shoulder - wrist
    distance = float(np.linalg.norm(way))
    too_far = max(distance - HELD_WITHIN * length, 0.0)
    return Transform(palm.place + too_far / max(distance, 1e-9) * way, palm.rotation)


def _arm(task: HumanTask, row: int, rotations: Array, root: Array, palm: Transform) -> tuple[Array, Array, float]:
    """In a pose (43, 4), (3,): where the shoulder is (3,), where a palm's wrist is (3,), the arm's length in metres."""
    skeleton, side = task.human, HANDS[row]
    places, _ = forward(rotations, root, skeleton.offsets)
    upper, lower, hand = (INDEX[f"{side}_{link}"] for link in ("upper_arm", "lower_arm", "hand"))
    wrist = palm.then(Transform.of(skeleton.grips[row]).inverse()).place
    length = np.linalg.norm(skeleton.offsets[lower]) + np.linalg.norm(skeleton.offsets[hand])
    return places[upper], wrist, float(length)


def _as_wide(task: HumanTask, site: Transform) -> Transform:
    """The site (the middle of a rim) as a clip has it before the face, farther off by what the object is wider than the
    clip's: it is the edge that comes to the lips.
    """
    made_for = task.parameter("diameter", 0.0)
    if task.object is None or float(np.linalg.norm(site.place)) > made_for:  # elsewhere than at the lips
        return site
    wider = 0.5 * (float(task.object.properties.get("diameter", made_for)) - made_for)
    up = rotate(site.rotation, np.array([0.0, 0.0, 1.0]))
    away = site.place - (site.place @ up) * up
    return Transform(site.place + wider * away / max(float(np.linalg.norm(away)), 1e-9), site.rotation)


def _goal(task: HumanTask, place: Array) -> Transform:
    """Where the object shall stand: upright, its own heading kept unless another is asked for."""
    assert task.object is not None
    upright = normalize(task.object.rotation * np.array([1.0, 0.0, 0.0, 1.0]))
    return Transform(place, upright if task.goal_rotation is None else task.goal_rotation)


def _check_reach(task: HumanTask, staged: Staged) -> None:
    """Refuse what the arm is too short for in the clip's last pose, rather than stretch for it in the air.

    Raises:
        AlgorithmError: says by how much.
    """
    last = staged.clip.frames - 1
    first = next(_missing(task, staged, staged.rotations[last], staged.root[last], MOST_MISSING), None)
    if first is not None:
        side, missing = first
        raise AlgorithmError(f"the {side} arm is {missing:.2f} m too short for that from here; {come_nearer(task)}")


def _tell_missed(task: HumanTask, staged: Staged) -> None:
    """Say so where the body was not carried near enough, or is not yet, for a hand to be where it should be now."""
    for side, missing in _missing(task, staged, task.present.rotations, task.present.root, MOST_MISSED):
        task.note(
            f"when the {side} hand should have arrived, its arm was {missing:.2f} m too short; "
            "let it begin later (`after N`) or take more frames"
        )


def _missing(
    task: HumanTask, staged: Staged, rotations: Array, root: Array, most: float
) -> Iterator[tuple[str, float]]:
    """In a pose (43, 4), (3,) the arms that are too short for the clip's last hands, by more than `most`; metres."""
    last = staged.clip.frames - 1
    base = face(task, rotations, root) if staged.clip.header.targets == "face" else staged.base
    for row, side in enumerate(HANDS):
        if base is None or not staged.local[last, row, 7]:
            continue
        palm = _wanted_grips(task, staged, base, row)[last]
        shoulder, wrist, length = _arm(task, row, rotations, root, palm)
        missing = float(np.linalg.norm(wrist - shoulder)) - length
        if missing > most:
            yield side, missing


def _gaze(task: HumanTask, staged: Staged, course: Course, base: Transform) -> Array:
    """The gaze's target (n, 8), the next key's from the start: it goes first, as fast as main lets a head turn."""
    local = staged.local[course.key, GAZE]
    out = np.zeros((len(local), 8))
    out[:, :3] = base.apply(local[:, :3])
    out[:, 7] = local[:, 7] * task.parameter("gaze", 1.0)
    return out


if __name__ == "__main__":
    run(slerp)
