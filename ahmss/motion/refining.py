"""What a motion itself says of how its joints lie to our links: soles are level while they stand, a hinge has one axis.

Zero poses and markers tell directions of bones well, turns about them badly: CMU's elbows bend 30 degrees aside of
where their T-pose has them. Constant turns are mended here; no joint moves.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import between, conjugate, from_axis_angle, multiply, rotate
from ahmss.motion.alignment import BodyMotion
from ahmss.motion.contact import runs, speeds

__all__ = ["levelled", "refined", "standing"]

_STILL = 0.25  # metres a second: a foot whose ankle and toes are both slower stands flat
_LEAST = 0.1  # seconds of such frames
_MOST_TILT = np.radians(35.0)
_BENT = np.radians(12.0)  # an elbow or knee that never bends by more shows no axis
_ONE_AXIS = 0.9  # share of the bending that is about one axis
_MOST_TURN = np.radians(60.0)
_STANCES = 4  # as many show which way a floor leans
_SURE = 0.15  # metres over which stances must be spread before a slope along them is believed
_RAMP = 0.03  # rise over way
_X, _UP = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


def refined(body: BodyMotion) -> BodyMotion:
    """The same motion with level soles, and elbows and knees that bend about their links' y axes."""
    rotations = body.rotations.copy()
    for side in ("right", "left"):
        _bend_about_y(body, rotations, side, ("upper_arm", "lower_arm", "hand"))
        _bend_about_y(body, rotations, side, ("upper_leg", "lower_leg", "foot"))
        _hinge_knee(rotations, side)
    _level_soles(body, rotations)
    return replace(body, rotations=rotations)


def levelled(body: BodyMotion) -> tuple[BodyMotion, float]:
    """The motion over a level floor, and how steep the floor was: rise over way.

    A room's axes lean a little where it was calibrated badly, and after a few steps the feet are centimetres over the
    floor. The floor is the plane through the ankles of all stances; one as steep as a ramp is no fault and stays.
    """
    flat, ankles = standing(body), body.places[:, [INDEX["right_foot"], INDEX["left_foot"]]]
    stances = [ankles[a:b, foot].mean(axis=0) for foot in range(2) for a, b in runs(flat[:, foot])]
    if len(stances) < _STANCES:
        return body, 0.0
    middle = np.mean(stances, axis=0)
    ways = np.array(stances) - middle
    level = ways[:, :2]
    slope = np.linalg.solve(level.T @ level + len(ways) * _SURE**2 * np.eye(2), level.T @ ways[:, 2])
    steep = float(np.linalg.norm(slope))
    if steep > _RAMP:
        return body, 0.0
    places, toes = body.places.copy(), body.toes.copy()
    places[..., 2] -= (places[..., :2] - middle[:2]) @ slope
    toes[..., 2] -= (toes[..., :2] - middle[:2]) @ slope
    return replace(body, places=places, toes=toes), steep


def standing(body: BodyMotion) -> NDArray[np.bool_]:
    """Which feet stand flat (F, 2), right and left: both ankle and toes are slow."""
    feet = body.places[:, [INDEX["right_foot"], INDEX["left_foot"]]]
    return np.maximum(speeds(feet, body.rate), speeds(body.toes, body.rate)) < _STILL


def _bend_about_y(body: BodyMotion, rotations: Array, side: str, parts: tuple[str, str, str]) -> None:
    """Turn the upper link about its own x so that the mean axis of the bend is its y."""
    upper, lower, end = (INDEX[f"{side}_{part}"] for part in parts)
    bones = np.diff(body.places[:, [upper, lower, end]], axis=1)
    bones /= np.maximum(np.linalg.norm(bones, axis=-1, keepdims=True), 1e-12)
    axes = rotate(conjugate(rotations[:, upper]), np.cross(bones[:, 0], bones[:, 1]))
    size = np.linalg.norm(axes, axis=-1)
    if np.percentile(size, 90.0) < np.sin(_BENT):
        return
    mean = (size[:, None] * axes).sum(axis=0)
    turn = float(np.arctan2(mean[2], mean[1]))
    if np.linalg.norm(mean) > _ONE_AXIS * float((size * size).sum()) and abs(turn) < _MOST_TURN:
        rotations[:, upper] = multiply(rotations[:, upper], from_axis_angle(_X, turn))


def _hinge_knee(rotations: Array, side: str) -> None:
    """Take what turns the shin about itself against the thigh out of it: the foot has it."""
    upper, lower = INDEX[f"{side}_upper_leg"], INDEX[f"{side}_lower_leg"]
    bone = rotate(conjugate(rotations[:, upper]), rotate(rotations[:, lower], _X))
    rotations[:, lower] = multiply(rotations[:, upper], between(_X, bone))


def _level_soles(body: BodyMotion, rotations: Array) -> None:
    """Turn each foot by a constant so that its sole is level, as a rule, while it stands flat."""
    flat = standing(body)
    for foot, name in enumerate(("right_foot", "left_foot")):
        frames = np.flatnonzero(flat[:, foot])
        if len(frames) < max(_LEAST * body.rate, 2):
            continue
        link = INDEX[name]
        up = np.median(rotate(conjugate(rotations[frames, link]), _UP), axis=0)
        if up[2] > np.cos(_MOST_TILT) * np.linalg.norm(up):
            rotations[:, link] = multiply(rotations[:, link], between(_UP, up))
