"""How natural a motion measures, beside the figures of real capture in docs/conventions.md.

Ten figures: how still the feet stand, how smoothly the joints turn, what pops, what sinks, what bends too far.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import IDENTITY, conjugate, multiply, norm, normalize, rotate, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.motion.contact import foot_points
from ahmss.motion.footing import Support, declared, drifts, found, support
from ahmss.motion.smoothness import JointMotion, Pop, joint_motion, worst_pop

__all__ = ["Excess", "Quality", "beyond_limits", "measure"]

_BODY = 15  # the first links; fingers, which the known captures lack, would dilute the percentile
_FEET = [INDEX["right_foot"], INDEX["left_foot"]]
_HINGES = [INDEX[f"{side}_lower_{limb}"] - 1 for side in ("right", "left") for limb in ("arm", "leg")]  # hips left out


class Excess(NamedTuple):
    """By how much a joint is beyond its limits at the most, degrees, and where; the hips have none."""

    degrees: float
    frame: int
    joint: int


_WITHIN = Excess(0.0, 0, 0)


@dataclass(frozen=True)
class Quality:
    """What was measured. Lengths in metres; joints are counted as in `names`."""

    joints: JointMotion
    support: Support
    drifts: tuple[float, ...]
    pop: Pop
    sunk: float
    excess: Excess = _WITHIN
    names: tuple[str, ...] = LINKS

    def figures(self) -> dict[str, float]:
        """The ten figures by their names, which carry their units where those are not m/s, rad/s2 and rad/s3."""
        figures = {
            "support_speed_mean": self.support.speed_mean,
            "support_speed_p95": self.support.speed_p95,
            "slide_per_stance_cm": 100.0 * self.support.slide_mean,
            "alpha_max": self.joints.acceleration_max,
            "alpha_p99": self.joints.acceleration_p99,
            "jerk_max": self.joints.jerk_max,
            "pop_deg": self.pop.degrees,
            "contact_drift_mm": 1000.0 * max(self.drifts, default=0.0),
            "floor_penetration_mm": 1000.0 * self.sunk,
            "joint_limit_excess_deg": self.excess.degrees,
        }
        return {name: round(value, 6) for name, value in figures.items()}


def measure(rotations: Array, root: Array, rate: float, skeleton: Skeleton, contacts: Array | None = None) -> Quality:
    """Measure a human's motion.

    Args:
        rotations: (frames, 43, 4) unit quaternions, parent <- child; at least 3 frames.
        root: (frames, 3) metres, the floor at z = 0.
        rate: frames a second.
        skeleton: the human's measures.
        contacts: (frames, 2) right and left foot, where they are known; else they are found by height and speed.
    """
    soles = foot_points(skeleton, rotations, root)
    places, world = forward(rotations, root, skeleton.offsets)
    points = soles.copy()
    points[:, :, 0] = places[:, _FEET]  # the ankle, as in the captures that the figures are compared with
    points[:, :, 0, 2] += skeleton.soles[0, 2]
    ends = places + rotate(world, skeleton.tips)
    lowest = min(float(part[..., 2].min()) for part in (soles, places, ends))
    return Quality(
        joints=joint_motion(rotations, rate, _BODY),
        support=support(points, rate),
        drifts=drifts(soles, found(soles, rate) if contacts is None else declared(soles, contacts)),
        pop=worst_pop(rotations),
        sunk=max(-lowest, 0.0),
        excess=beyond_limits(rotations, skeleton),
    )


def beyond_limits(rotations: Array, skeleton: Skeleton) -> Excess:
    """By how much joints (frames, 43, 4) are turned beyond the skeleton's limits, from upright, axis by axis.

    Limits are of the rotation vector's components. Elbows and knees, though, bend first and then turn about their own
    length, as the limbs are solved: there the turn is taken apart, or a bent forearm's twist would pass for a sideways
    bend.
    """
    upright, _ = skeleton.upright()
    turned = multiply(conjugate(upright[1:]), rotations[:, 1:])
    angles = to_rotation_vector(turned)
    angles[:, _HINGES] = _bend_and_turn(turned[:, _HINGES])
    low, high = skeleton.limits[1:, :, 0], skeleton.limits[1:, :, 1]
    beyond = np.maximum(np.maximum(low - angles, angles - high), 0.0).max(axis=-1)
    frame, joint = np.unravel_index(beyond.argmax(), beyond.shape)
    return Excess(float(np.degrees(beyond.max())), int(frame), int(joint) + 1)


def _bend_and_turn(rotations: Array) -> Array:
    """Angles (..., 3) of rotations (..., 4) that are a bend, about y and z, after a turn about x."""
    turn = rotations * np.array([1.0, 1.0, 0.0, 0.0])
    turn = normalize(np.where(norm(turn)[..., None] < 1e-12, IDENTITY, turn))
    bend = to_rotation_vector(multiply(rotations, conjugate(turn)))
    return np.concatenate([to_rotation_vector(turn)[..., :1], bend[..., 1:]], axis=-1)
