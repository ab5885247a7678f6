"""The feet of a performance: planted exactly, rolled over heel and toe, swung from one footstep to the next.

A foot that bears turns about its heel while its toes are up, and about the tip of its toes while its heel is up (it is
rigid: it has no toe joint). In the air it goes by quintics in a frame that stands on the other foot and turns with the
body, so that a leg goes round the other in a turn.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.motion.easing import minimum_jerk
from ahmss.walking.footsteps import LEFT, Footsteps, Frame, Step
from ahmss.walking.gait import Gait

__all__ = ["FootTracks", "tracks"]

_UP, _LEFT = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
_HEEL, _BALL, _TOE = 0, 1, 2
_ROUND = 0.13  # sine of the pitch over which the lowest point of the swinging sole passes from toe to heel
_LEAP = (3, 10)  # how the toes leap early in the swing: u^3 (1 - u)^10
_TURNS_OUT = 0.75  # of a swing in which a foot turns outwards: with it its knee is sooner clear of the other leg
_FLAT = 1e-9  # radians
_TOUCHING = 2e-4  # metres


@dataclass(frozen=True)
class FootTracks:
    """Both feet at F times: ankles (F, 2, 3), rotations (F, 2, 4), bearing (F, 2, 3) of heel, ball and toe."""

    ankles: Array
    rotations: Array
    bearing: NDArray[np.bool_]


@dataclass
class _Stance:
    """A foot on the ground. place: of the ankle with the foot flat."""

    place: Frame
    land: float
    lift: float
    strike: float
    push: float


def tracks(skeleton: Skeleton, gait: Gait, plan: Footsteps, times: Array) -> FootTracks:
    """The feet of a plan at times (F,) in seconds."""
    right, left = (_track(skeleton, gait, plan, foot, times) for foot in (0, 1))
    return FootTracks(
        np.stack([right[0], left[0]], axis=1),
        np.stack([right[1], left[1]], axis=1),
        np.stack([right[2], left[2]], axis=1),
    )


def _track(
    skeleton: Skeleton, gait: Gait, plan: Footsteps, foot: int, times: Array
) -> tuple[Array, Array, NDArray[np.bool_]]:
    stances = _stances(plan, foot)
    steps = [step for step in plan.steps if step.foot == foot]
    soles = skeleton.soles * (1.0, 1.0 if foot == 0 else -1.0, 1.0)
    pitch, yaw = _angles(gait, stances, steps, times)
    ankles = np.empty((len(times), 3))
    on_ground = np.zeros(len(times), bool)
    for stance in stances:
        now = (times >= stance.land - 1e-9) & (times <= stance.lift + 1e-9)
        ankles[now] = _rolled(soles, stance, pitch[now], yaw[now])
        on_ground |= now
    for step, before, after in zip(steps, stances[:-1], stances[1:], strict=True):
        now = (times > step.lift + 1e-9) & (times < step.land - 1e-9)
        other = next(s for s in reversed(_stances(plan, 1 - foot)) if s.land <= step.lift + 1e-9)
        turned = (_heading_before(plan, step), other.place)
        ankles[now] = _swung(gait, soles, step, (before, after), turned, times[now], pitch[now])
    rotations = multiply(from_axis_angle(_UP, yaw), from_axis_angle(_LEFT, -pitch))
    heights = (ankles[:, None] + rotate(rotations[:, None], soles))[..., 2]
    bearing = (heights < _TOUCHING) & on_ground[:, None]
    return ankles, rotations, bearing


def _stances(plan: Footsteps, foot: int) -> list[_Stance]:
    out = [_Stance(plan.feet[foot], -np.inf, np.inf, 0.0, 0.0)]
    for step in plan.steps:
        if step.foot == foot:
            out[-1].lift, out[-1].push = step.lift, step.push
            out.append(_Stance(step.landing, step.land, np.inf, step.strike, 0.0))
    return out


def _angles(gait: Gait, stances: list[_Stance], steps: list[Step], times: Array) -> tuple[Array, Array]:
    """Pitch (toes up) and heading at the times: by minimum jerk from one posture of the foot to the next."""
    pitch, yaw = np.zeros(len(times)), np.full(len(times), stances[0].place.heading)
    for step, before, after in zip(steps, stances[:-1], stances[1:], strict=True):
        down, up = -np.radians(gait.push) * step.push, np.radians(gait.strike) * step.strike
        swing = step.land - step.lift
        standing = step.lift - before.land - gait.flat_time
        rising = max(min(gait.push_time * (0.4 + 0.6 * step.push), standing), 0.05)
        slowly = max(min(gait.rise_time * (0.4 + 0.6 * step.push), standing), rising)
        flat = gait.flat_time * (0.3 + 0.7 * step.strike)
        lifted = step.lift + gait.peak * swing
        rise = gait.rise * down
        for begin, end, by in (
            (step.lift - slowly, step.lift + gait.rise_over, rise),
            (step.lift - rising, lifted, down - rise),
            (lifted, step.land, up - down),
            (step.land, step.land + flat, -up),
        ):
            pitch += by * minimum_jerk((times - begin) / (end - begin))
        turn = after.place.heading - before.place.heading
        share = _TURNS_OUT if (turn > 0.0) == (step.foot == LEFT) else 1.0
        yaw += turn * minimum_jerk((times - step.lift) / (share * swing))
    return pitch, yaw


def _rolled(soles: Array, stance: _Stance, pitch: Array, yaw: Array) -> Array:
    """The ankle (F, 3) of a foot that bears: about its heel while its toes are up, else about its toes."""
    flat = np.array([stance.place.x, stance.place.y, -soles[0, 2]])
    heading = from_axis_angle(_UP, stance.place.heading)
    turned = multiply(from_axis_angle(_UP, yaw), from_axis_angle(_LEFT, -pitch))
    pivot = np.where((pitch > _FLAT)[:, None], soles[_HEEL], soles[_TOE])
    return flat + rotate(heading, pivot) - rotate(turned, pivot)


def _swung(
    gait: Gait, soles: Array, step: Step, ends: tuple[_Stance, _Stance], turning: tuple[float, Frame], times: Array,
    pitch: Array,
) -> Array:  # fmt: skip
    """The ankle (F, 3) in the air: level by a quintic that goes on with the push-off's speed and lands at rest.

    `turning` is the body's heading before, and where the other foot stands: in a turn a leg goes round the other.
    """
    before, after = ends
    since, standing = turning
    swing = step.land - step.lift
    u = (times - step.lift) / swing
    start, velocity, acceleration = _leaving(gait, soles, step, before)
    end = _rolled(soles, after, np.array([np.radians(gait.strike) * step.strike]), np.array([after.place.heading]))[0]
    origin = standing.place
    turn = (step.body - since) * minimum_jerk(u)
    local_end = _turned(end[:2] - origin, -(step.body - since))
    way = local_end - start[:2] + origin
    leaving = acceleration[:2] * swing**2 + gait.drawn * step.push * way
    slowing = -gait.slowing * step.strike * way
    level = _quintic(start[:2] - origin, velocity[:2] * swing, leaving, local_end, slowing, u)
    out = np.empty((len(times), 3))
    out[:, :2] = origin + _turned(level, turn)
    # The lowest point of the sole is as high as the bump says: toe or heel, passing smoothly between.
    bump = 64.0 * (u * (1.0 - u)) ** 3
    heel, toe, height = soles[_HEEL, 0], soles[_TOE, 0], -soles[0, 2]
    sine = -np.sin(pitch)
    smooth = np.sqrt(sine**2 + (_ROUND * bump) ** 2)
    lowest = height * np.cos(pitch) + 0.5 * (toe + heel) * sine + 0.5 * (toe - heel) * smooth
    lift = gait.clearance + 0.03 * (1.0 - max(step.push, step.strike))
    out[:, 2] = lowest + lift * 16.0 * (u * (1.0 - u)) ** 2
    rising, falling = _LEAP
    highest = rising / (rising + falling)
    leap = (u / highest) ** rising * ((1.0 - u) / (1.0 - highest)) ** falling
    out[:, 2] += gait.leap * step.push * leap
    return out


def _leaving(gait: Gait, soles: Array, step: Step, before: _Stance) -> tuple[Array, Array, Array]:
    """Place, velocity and acceleration (3) of the ankle as it lifts off."""
    h = 1e-3
    times = step.lift + h * np.array([-1.0, 0.0, 1.0])
    stances = [before, _Stance(step.landing, step.land, np.inf, step.strike, 0.0)]
    pitch, _ = _angles(gait, stances, [step], times)
    yaw = np.full(3, before.place.heading)
    ankle = _rolled(soles, before, pitch, yaw)
    return ankle[1], (ankle[2] - ankle[0]) / (2.0 * h), (ankle[2] - 2.0 * ankle[1] + ankle[0]) / h**2


def _heading_before(plan: Footsteps, step: Step) -> float:
    """The body's heading when a step begins."""
    heading = plan.body
    for other in plan.steps:
        if other is step:
            break
        heading = other.body
    return heading


def _quintic(p0: Array, v0: Array, a0: Array, p1: Array, a1: Array, u: Array) -> Array:
    """From place, speed and acceleration at u = 0 to no speed at p1 at u = 1, slowing down by a1 there: (F, 2)."""
    d = p1 - p0
    c3 = 10.0 * d - 6.0 * v0 - 1.5 * a0 + 0.5 * a1
    c4 = -15.0 * d + 8.0 * v0 + 1.5 * a0 - a1
    c5 = 6.0 * d - 3.0 * v0 - 0.5 * a0 + 0.5 * a1
    u = u[:, None]
    return p0 + v0 * u + 0.5 * a0 * u**2 + c3 * u**3 + c4 * u**4 + c5 * u**5


def _turned(v: Array, angle: Array | float) -> Array:
    """Vectors (..., 2) turned by angles."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.stack([cos * v[..., 0] - sin * v[..., 1], sin * v[..., 0] + cos * v[..., 1]], axis=-1)
