"""Skin weights: which links move a point of the skin, and how much of each.

The tree of links is walked from the hips outwards. At each joint a point's share passes on to the child by how far
it lies beyond the joint's plane, softly over a width that suits the joint, and by whether it belongs to that limb.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from ahmss.body.array import Array
from ahmss.body.links import INDEX, LINKS
from humans.arm import FINGERS, finger_chain, upper_arm_loft
from humans.distance import cone
from humans.figure import Figure
from humans.trunk import neck_axis, trunk_loft

__all__ = ["skin_weights"]


def _step(x: Array, width: float) -> Array:
    """From 0 at -width to 1 at +width, smooth."""
    t = np.clip(0.5 + 0.5 * x / width, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def skin_weights(figure: Figure, points: Array, faces: NDArray[np.int64]) -> tuple[NDArray[np.uint8], Array]:
    """The four links of each point (n, 4) and their weights (n, 4), which sum to 1."""
    weights = np.zeros((len(points), len(LINKS)))
    right = points[:, 1] < 0.0
    folded = points * np.array([1.0, -1.0, 1.0])
    for side, rows in (("right", right), ("left", ~right)):
        half = _right_half(figure, np.where(rows[:, None], points if side == "right" else folded, 0.0)[rows])
        for name, column in half.items():
            weights[rows, INDEX[name.replace("right", side)]] += column
    _share_legs(weights, points, figure)
    weights = _smooth(weights, points, faces)
    for side in ("right", "left"):
        _free_knuckles(weights, side)
    return _four(weights)


def _right_half(figure: Figure, p: Array) -> dict[str, Array]:
    """Weights by link of points on the right half."""
    bind, h = figure.bind, figure.height
    hip = bind.place("right_upper_leg")
    trunk, out = {}, {}
    up = p[:, 2]
    waist = _step(up - 0.615 * h, 0.065 * h)
    high, low = neck_axis(figure)
    aside = np.linalg.norm(np.cross(p - low, _unit(high - low)), axis=1)
    neck = _step((p - bind.place("head")) @ np.array([0.35, 0.0, 0.94]) - 0.006 * h, 0.030 * h)
    neck = neck * np.maximum(_step(figure.neck[1] + 0.025 - aside, 0.02), _step(up - 0.875 * h, 0.01 * h))
    # A thigh begins at the fold of the groin, which climbs outwards to the hip's side.
    fold = np.array([0.12, -0.42, -0.90])
    leg = _step((p - hip) @ (fold / np.linalg.norm(fold)) - 0.004 * h, 0.050 * h)
    leg = np.where(up > 0.62 * h, 0.0, leg)
    arm = _arm(figure, p)
    trunk["head"] = neck * (1.0 - arm)
    trunk["spine"] = (waist - waist * neck) * (1.0 - arm)
    trunk["hips"] = (1.0 - waist) * (1.0 - leg) * (1.0 - arm)
    leg = leg * (1.0 - waist) * (1.0 - arm)
    knee, ankle = bind.place("right_lower_leg"), bind.place("right_foot")
    shin = _step((p - knee) @ _unit(ankle - hip), 0.036 * h)
    foot = _step((p - ankle) @ np.array([0.3, 0.0, -0.95]) - 0.002 * h, 0.020 * h)
    out["right_upper_leg"] = leg * (1.0 - shin)
    out["right_lower_leg"] = leg * shin * (1.0 - foot)
    out["right_foot"] = leg * shin * foot
    elbow, wrist = bind.place("right_lower_arm"), bind.place("right_hand")
    shoulder = bind.place("right_upper_arm")
    lower = _step((p - elbow) @ _unit(_unit(elbow - shoulder) + _unit(wrist - elbow)), 0.026 * h)
    hand = _step((p - wrist) @ _unit(wrist - elbow) - 0.002 * h, 0.016 * h)
    out["right_upper_arm"] = arm * (1.0 - lower)
    out["right_lower_arm"] = arm * lower * (1.0 - hand)
    held = arm * lower * hand
    fingers = _fingers(figure, p)
    for name, share in fingers.items():
        out[name] = held * share
    out["right_hand"] = held * (1.0 - sum(fingers.values(), np.zeros(len(p))))
    return trunk | out


def _unit(v: Array) -> Array:
    return v / np.linalg.norm(v)


def _arm(figure: Figure, p: Array) -> Array:
    """How far a point belongs to the arm rather than to the trunk."""
    h, bind = figure.height, figure.bind
    shoulder, elbow = bind.place("right_upper_arm"), bind.place("right_lower_arm")
    along = _unit(_unit(elbow - shoulder) + np.array([0.0, -0.75, 0.0]))
    beyond = _step((p - shoulder) @ along - 0.004 * h, 0.036 * h)
    nearer = trunk_loft(figure, 0.0)(p) - upper_arm_loft(figure, 0.0, -0.1, 1.1)(p)
    far = _step(-p[:, 1] - abs(shoulder[1]) - 0.045 * h, 0.02 * h)
    # The fingertips hang higher than this in the bind pose; legs and feet are below.
    return np.where(p[:, 2] < 0.36 * h, 0.0, beyond * np.maximum(_step(nearer - 0.004, 0.030), far))


def _fingers(figure: Figure, p: Array) -> dict[str, Array]:
    """The shares of the finger links of a point that the hand holds; what is missing to 1 is the palm's."""
    hand = 0.108 * figure.height
    apart = {}
    for finger in FINGERS:
        chain, radii = finger_chain(figure, finger)
        cones = [cone(chain[i], chain[i + 1], radii[i], radii[i + 1])(p) for i in range(len(chain) - 1)]
        apart[finger] = np.min(cones, axis=0)
    nearest = np.min(list(apart.values()), axis=0)
    belongs = {finger: np.exp(-(d - nearest) / 0.0016) for finger, d in apart.items()}
    total = sum(belongs.values(), np.zeros(len(p)))
    shares: dict[str, Array] = {}
    for finger, segments in FINGERS.items():
        chain, radii = finger_chain(figure, finger)
        thumb = finger == "thumb"
        width = (0.11 if thumb else 0.050) * hand
        share = _step((p - chain[0]) @ _unit(chain[1] - chain[0]) - (0.02 if thumb else 0.012) * hand, width)
        share = share * belongs[finger] / total
        if thumb:
            share = share * _step(radii[0] * 1.0 - apart[finger], 0.008)
        for i, segment in enumerate(segments):
            if i + 1 < len(segments):
                bend = _unit(_unit(chain[i + 1] - chain[i]) + _unit(chain[i + 2] - chain[i + 1]))
                on = _step((p - chain[i + 1]) @ bend, 0.032 * hand)
            else:
                on = np.zeros(len(p))
            shares[f"right_{finger}_{segment}"] = share * (1.0 - on)
            share = share * on
    return shares


def _share_legs(weights: Array, points: Array, figure: Figure) -> None:
    """At the crotch both thighs pull: the share crosses from one to the other over a few centimetres."""
    right, left = INDEX["right_upper_leg"], INDEX["left_upper_leg"]
    rows = points[:, 2] > 0.40 * figure.height
    both = weights[rows, right] + weights[rows, left]
    to_left = _step(points[rows, 1], 0.014 * figure.height)
    weights[rows, right], weights[rows, left] = both * (1.0 - to_left), both * to_left


def _free_knuckles(weights: Array, side: str) -> None:
    """What thumb and index would both pull is the palm's: a thumb that opposes drags no knuckle along."""
    thumb = weights[:, [INDEX[f"{side}_thumb_{segment}"] for segment in FINGERS["thumb"]]]
    beside = [f"{side}_index_{segment}" for segment in FINGERS["index"]] + [f"{side}_middle_proximal"]
    whole = thumb.sum(axis=1)
    both = np.minimum(whole, weights[:, [INDEX[name] for name in beside]].sum(axis=1))
    kept = 1.0 - both / np.maximum(whole, 1e-9)
    for i, segment in enumerate(FINGERS["thumb"]):
        weights[:, INDEX[f"{side}_thumb_{segment}"]] = thumb[:, i] * kept
    weights[:, INDEX[f"{side}_hand"]] += both


def _smooth(weights: Array, points: Array, faces: NDArray[np.int64]) -> Array:
    """A few rounds of averaging along the surface, closer neighbours counting more."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    edges = np.concatenate([edges, edges[:, ::-1]])
    length = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    graph = csr_matrix((1.0 / (length + 0.004), (edges[:, 0], edges[:, 1])), shape=(len(points),) * 2)
    degree = np.asarray(graph.sum(axis=1)).ravel()
    for _ in range(2):
        weights = 0.5 * weights + 0.5 * (graph @ weights) / degree[:, None]
    return weights


def _four(weights: Array) -> tuple[NDArray[np.uint8], Array]:
    """The four largest weights of each point, in steps of 1/255."""
    links = np.argsort(-weights, axis=1, kind="stable")[:, :4]
    kept = np.take_along_axis(weights, links, axis=1)
    kept = kept / kept.sum(axis=1, keepdims=True)
    steps = np.floor(kept * 255.0)
    steps[:, 0] += 255.0 - steps.sum(axis=1)
    links = np.where(steps > 0.0, links, 0)
    return links.astype(np.uint8), steps / 255.0
