"""A walker of our own, for where no person is at hand: poses that follow a plan of footsteps.

The feet are planted to the plan; the hips follow them as a pendulum does; pelvis, trunk, arms and head move as they are
known to in normal gait, each in proportion to what the feet do, so one rule serves straight steps, starts, stops and
turns.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, maximum_filter1d

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import align, conjugate, from_axis_angle, multiply
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk
from ahmss.walking.balance import pendulum
from ahmss.walking.feet import FootTracks, tracks
from ahmss.walking.footsteps import Footsteps
from ahmss.walking.gait import GAIT, Gait
from ahmss.walking.legs import hip_joints, reach, solve_legs
from ahmss.walking.library import BODY, RATE

__all__ = ["Performed", "Stand", "perform"]

_X, _Y, _Z = np.eye(3)
_SHIFT = 0.56  # seconds before the first foot lifts in which the weight goes over the other
_CATCH = 0.48  # seconds after the last has landed until the weight is over both
_CAUGHT = 0.12  # seconds before it lands: when it begins to go there
_BRAKE = (0.17, 0.9)  # how far ahead of the ankle the last foot to strike is pushed on, share of hip height; seconds
_SWAYS = 0.5  # seconds, about as long as a step: slower is no swaying
_STRETCH = 0.998  # of a leg's length that a leg may have


@dataclass(frozen=True)
class Stand:
    """The pose in which a walk begins and ends, heading 0, the hips over the origin: rotations (43, 4), root (3,)."""

    rotations: Array
    root: Array


@dataclass(frozen=True)
class Performed:
    """What was performed: rotations (F, 15, 4), root (F, 3), bearing (F, 2, 3), body (F,) the body's heading."""

    rotations: Array
    root: Array
    bearing: NDArray[np.bool_]
    body: Array


def perform(skeleton: Skeleton, stand: Stand, plan: Footsteps, gait: Gait = GAIT) -> Performed:
    """Walk a plan, 60 frames a second."""
    times = np.arange(round(plan.seconds * RATE) + 1) / RATE
    feet = tracks(skeleton, gait, plan, times)
    body = _heading(plan, times, 0.0)
    share, size = _weight(plan, times), _size(plan, times)
    ahead = _ahead(feet, body) / (gait.step * float(stand.root[2]))
    level = _level(skeleton, stand, gait, plan, times, share, body)
    phase = _phase(gait, plan, times)
    hips = _hips(gait, body, ahead, share, size, phase)
    root = np.empty((len(times), 3))
    root[:, :2] = level
    root[:, 2] = stand.root[2] * (1.0 - _sinking(gait, phase, size))
    root[:, 2] -= _too_high(skeleton, hips, root, feet)
    rotations = np.repeat(stand.rotations[None, :BODY], len(times), axis=0)
    rotations[:, 0] = multiply(hips, stand.rotations[0])
    _upper_body(rotations, stand, gait, plan, times, body, ahead, root, size)
    solve_legs(skeleton, rotations, root, feet.ankles, feet.rotations)
    for frame in range(1, len(rotations)):
        rotations[frame] = align(rotations[frame], rotations[frame - 1])
    return Performed(rotations, root, feet.bearing, body)


def _heading(plan: Footsteps, times: Array, ahead: float) -> Array:
    """The body's heading (F,), turning from a little before a foot lifts until it lands."""
    heading, before = np.full(len(times), plan.body), plan.body
    for step in plan.steps:
        begin, end = step.lift - 0.15 - ahead, step.land - ahead
        heading += (step.body - before) * minimum_jerk((times - begin) / (end - begin))
        before = step.body
    return heading


def _weight(plan: Footsteps, times: Array) -> Array:
    """The right foot's share of the weight (F,)."""
    share, now = np.full(len(times), 0.5), 0.5
    begin = None
    for step in plan.steps:
        wanted = 1.0 if step.foot == 1 else 0.0
        begin = step.lift - _SHIFT if begin is None else begin
        share += (wanted - now) * minimum_jerk((times - begin) / max(step.lift - begin, 0.05))
        now, begin = wanted, step.land
    if begin is not None:
        share += (0.5 - now) * minimum_jerk((times - begin + _CAUGHT) / (_CATCH + _CAUGHT))
    return share


def _size(plan: Footsteps, times: Array) -> Array:
    """How much of a full step is being made (F,), 0 to 1."""
    fine = np.zeros(len(times))
    for step in plan.steps:
        fine[(times >= step.lift - 0.05) & (times <= step.land + 0.08)] = max(step.push, step.strike)
    return _smooth(fine, 0.12)


def _smooth(values: Array, seconds: float) -> Array:
    return gaussian_filter1d(values, seconds * RATE, axis=0, mode="nearest")


def _ahead(feet: FootTracks, body: Array) -> Array:
    """How far the right foot is ahead of the left (F,), metres."""
    way = feet.ankles[:, 0, :2] - feet.ankles[:, 1, :2]
    return np.cos(body) * way[:, 0] + np.sin(body) * way[:, 1]


def _level(
    skeleton: Skeleton, stand: Stand, gait: Gait, plan: Footsteps, times: Array, share: Array, body: Array
) -> Array:  # fmt: skip
    """The hips' places (F, 2)."""
    scale = float(stand.root[2])
    resting = _resting(skeleton, stand)
    push = np.zeros((len(times), 2))
    for foot, weight in ((0, share), (1, 1.0 - share)):
        rolled, place, heading = _under(gait, plan, foot, times, resting, scale)
        push += weight[:, None] * (place + rolled[:, None] * np.stack([np.cos(heading), np.sin(heading)], axis=-1))
    # Along the body's heading people go more evenly than a pendulum, for they push off and roll over their feet.
    weight, even = pendulum(push, gait.sway, RATE), pendulum(push, gait.even, RATE)
    ahead = np.stack([np.cos(body), np.sin(body)], axis=-1)
    weight += ahead * np.einsum("fi,fi->f", ahead, even - weight)[:, None]
    if plan.steps:
        first, last = plan.steps[0].lift, plan.steps[-1].land
        grown = minimum_jerk(times / (0.9 * first))[:, None]
        weight = push[0] + grown * (weight - push[0])
        settled = minimum_jerk((times - last) / (times[-1] - last))[:, None]
        weight = weight + settled * (push[-1] - weight)
    return weight


def _resting(skeleton: Skeleton, stand: Stand) -> float:
    """How far the hips are ahead of the ankles in standing, metres."""
    places, _ = forward(stand.rotations, stand.root, skeleton.offsets)
    ankles = places[[INDEX["right_foot"], INDEX["left_foot"]]]
    return float(stand.root[0] - ankles[:, 0].mean())


def _under(
    gait: Gait, plan: Footsteps, foot: int, times: Array, resting: float, scale: float
) -> tuple[Array, Array, Array]:
    """Of a foot: how far ahead of its ankle the weight is on it (F,), where the ankle is flat (F, 2), its heading."""
    rolled = np.full(len(times), resting)
    place, heading = np.repeat(plan.feet[foot].place[None], len(times), 0), np.full(len(times), plan.feet[foot].heading)
    steps = [step for step in plan.steps if step.foot == foot]
    for step, following in zip(steps, [*steps[1:], None], strict=True):
        now = times >= 0.5 * (step.lift + step.land)
        place[now], heading[now] = step.landing.place, step.landing.heading
        begin = resting + step.strike * (gait.roll[0] * scale - resting)
        push = 0.0 if following is None else following.push
        end = resting + push * (gait.roll[1] * scale - resting)
        until = step.land + 0.6 if following is None else following.lift
        u = np.clip((times[now] - step.land) / (until - step.land), 0.0, 1.0)
        rolled[now] = begin + (end - begin) * u
        if following is None:  # who stops pushes the floor ahead of them
            v = np.clip((times[now] - step.land) / _BRAKE[1], 0.0, 1.0)
            rolled[now] += _BRAKE[0] * scale * step.strike * 64.0 * (v * (1.0 - v)) ** 3
    if steps:
        before = times < 0.5 * (steps[0].lift + steps[0].land)
        end = resting + steps[0].push * (gait.roll[1] * scale - resting)
        rolled[before] = resting + (end - resting) * minimum_jerk((times[before] - steps[0].lift + 0.4) / 0.4)
    return rolled, place, heading


def _hips(gait: Gait, body: Array, ahead: Array, share: Array, size: Array, phase: Array) -> Array:
    """The hips' rotations (F, 4) against standing: the side of the leg ahead goes ahead, the other drops."""
    turn = np.radians(gait.turn) * _smooth(ahead, 0.075)
    leading = np.roll(share, -5)
    leading[-5:] = share[-1]
    side = np.radians(gait.list) * size * _smooth(2.0 * leading - 1.0, 0.06)
    q = multiply(from_axis_angle(_Z, body + turn), from_axis_angle(_X, -side))
    tilt = gait.tilt + gait.nod * _smooth(np.cos(2.0 * np.pi * (phase - gait.nod_at)), 0.03)
    return multiply(q, from_axis_angle(_Y, np.radians(tilt) * size))


def _phase(gait: Gait, plan: Footsteps, times: Array) -> Array:
    """How many steps have been made (F,): a whole number at each landing."""
    lands = np.array([step.land for step in plan.steps])
    if not len(lands):
        return np.zeros(len(times))
    spacing = gait.frames / RATE
    knots = np.concatenate([lands[:1] - spacing * np.arange(4, 0, -1), lands, lands[-1:] + spacing * np.arange(1, 5)])
    return np.interp(times, knots, np.arange(len(knots)))


def _sinking(gait: Gait, phase: Array, size: Array) -> Array:
    """How far the hips are below standing (F,), as a share of their height."""
    bob = _smooth(np.cos(2.0 * np.pi * (phase - gait.low)), 0.03)
    return size * (gait.sink + gait.bob * bob)


def _too_high(skeleton: Skeleton, hips: Array, root: Array, feet: FootTracks) -> Array:
    """By how much the hips must come down (F,), metres, so that both legs reach their feet."""
    joints = hip_joints(skeleton, hips, root)
    way = joints - feet.ankles
    level = np.einsum("fsi,fsi->fs", way[..., :2], way[..., :2])
    allowed = np.sqrt(np.maximum((_STRETCH * reach(skeleton)) ** 2 - level, 1e-4))
    over = np.maximum(way[..., 2] - allowed, 0.0).max(axis=1)
    return _smooth(maximum_filter1d(over, round(0.05 * RATE), mode="nearest"), 0.03)


def _upper_body(
    rotations: Array, stand: Stand, gait: Gait, plan: Footsteps, times: Array, body: Array, ahead: Array, root: Array,
    size: Array,
) -> None:  # fmt: skip
    """Spine, head and arms into the rotations (F, 15, 4)."""
    swing, level = _smooth(ahead, 0.07), root[:, :2]
    hips = rotations[:, 0]
    speedup = _smooth(np.gradient(np.gradient(level, 1.0 / RATE, axis=0), 1.0 / RATE, axis=0), 0.12)
    along = np.cos(body) * speedup[:, 0] + np.sin(body) * speedup[:, 1]
    lean = np.radians(np.clip(gait.lean * along, -4.0, 6.0))
    chest = multiply(
        from_axis_angle(_Z, body - np.radians(gait.turn * (gait.trunk - 1.0)) * swing), from_axis_angle(_Y, lean)
    )
    q_spine = multiply(chest, multiply(stand.rotations[0], stand.rotations[1]))
    rotations[:, 1] = multiply(conjugate(hips), q_spine)
    looking = from_axis_angle(_Z, _heading(plan, times, gait.ahead))
    turned = body + np.clip(_angle(looking) - body, -0.45, 0.45)
    looking = _kept_in_sight(gait, turned, root, float(stand.root[2]))
    q_head = multiply(looking, multiply(stand.rotations[0], multiply(stand.rotations[1], stand.rotations[2])))
    rotations[:, 2] = multiply(conjugate(q_spine), q_head)
    late = np.interp(times - gait.arm_lag, times, swing)
    for side, sign in (("right", -1.0), ("left", 1.0)):
        forward_by = np.radians(gait.arm) * sign * late + np.radians(gait.arm_ahead) * size
        bend = np.radians(gait.elbow) * (sign * late + np.abs(late)) * 0.5 + np.radians(4.0) * sign * late
        for link, angle in ((f"{side}_upper_arm", forward_by), (f"{side}_lower_arm", bend)):
            own = stand.rotations[INDEX[link]]
            base = UPRIGHT[INDEX[link]]
            turned = multiply(multiply(base, from_axis_angle(_Y, angle)), conjugate(base))
            rotations[:, INDEX[link]] = multiply(turned, own)


def _kept_in_sight(gait: Gait, turned: Array, root: Array, standing: float) -> Array:
    """The head's rotations (F, 4): it keeps to a place ahead while the body rises and sways (Moore et al. 1999)."""
    swayed = root[:, :2] - _smooth(root[:, :2], _SWAYS)
    left = np.cos(turned) * swayed[:, 1] - np.sin(turned) * swayed[:, 0]
    down = (root[:, 2] - standing) / gait.sight
    return multiply(from_axis_angle(_Z, turned - left / gait.sight), from_axis_angle(_Y, down))


def _angle(q: Array) -> Array:
    return np.unwrap(2.0 * np.arctan2(q[:, 3], q[:, 0]))


UPRIGHT: Array = Skeleton.of().upright()[0]
