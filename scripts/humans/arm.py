"""Skin of an arm and its hand, modelled for the right and mirrored for the left."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import INDEX
from humans.distance import Field, Loft, bend, cone, ellipsoid, half_space, intersect, smooth_max, smooth_min
from humans.figure import Figure

__all__ = ["FINGERS", "arm", "bare_arm", "finger_chain", "upper_arm_loft"]

FINGERS = {
    "thumb": ("proximal", "distal"),
    **dict.fromkeys(("index", "middle", "ring", "little"), ("proximal", "intermediate", "distal")),
}


def upper_arm_loft(figure: Figure, thickness: float, start: float = -0.1, end: float = 1.05) -> Loft:
    """The right upper arm from shoulder to elbow, grown by `thickness`; the stations are in centimetres for a man."""
    a, b = figure.bind.place("right_upper_arm"), figure.bind.place("right_lower_arm")
    # share of the bone, half width, front, back
    stations = _grown(figure, float(np.linalg.norm(b - a)), thickness, (
        (-0.15, 2.6, 3.6, 3.8), (0.0, 3.7, 4.6, 4.8), (0.12, 4.5, 5.2, 5.4), (0.27, 5.0, 5.5, 5.5),
        (0.45, 4.7, 5.2, 5.0), (0.7, 4.2, 4.7, 4.4), (0.9, 4.0, 4.0, 4.0), (1.0, 4.1, 3.9, 4.0), (1.3, 4.1, 3.9, 4.0),
    ), start, end)  # fmt: skip
    return Loft(a, b - a, np.array([1.0, 0.0, 0.0]), stations, 2.1)


def forearm_loft(figure: Figure, thickness: float, start: float = -0.1, end: float = 1.0) -> Loft:
    """The right forearm: round below the elbow, flat at the wrist."""
    a, b = figure.bind.place("right_lower_arm"), figure.bind.place("right_hand")
    stations = _grown(figure, float(np.linalg.norm(b - a)), thickness, (
        (-0.3, 4.0, 3.9, 4.0), (0.0, 4.1, 3.9, 4.0), (0.18, 4.2, 4.5, 4.3), (0.4, 3.7, 4.2, 4.0),
        (0.7, 2.7, 3.2, 3.2), (0.92, 2.05, 2.8, 2.8), (1.1, 1.95, 2.75, 2.7),
    ), start, end)  # fmt: skip
    return Loft(a, b - a, figure.bind.matrix("right_lower_arm") @ np.array([0.0, 0.0, -1.0]), stations, 2.1)


def bare_arm(figure: Figure, thickness: float, start: float, end: float) -> Field:
    """The right arm without its hand, from a share of the upper arm to a share of the forearm."""
    a, b, c = (figure.bind.place(f"right_{name}") for name in ("upper_arm", "lower_arm", "hand"))
    along = (b - a) / np.linalg.norm(b - a) + (c - b) / np.linalg.norm(c - b)
    upper, lower = upper_arm_loft(figure, thickness, start, 1.25), forearm_loft(figure, thickness, -0.3, end)
    return bend(upper, lower, b, along, 0.030)


def _grown(
    figure: Figure, length: float, thickness: float, rows: tuple[tuple[float, ...], ...], start: float, end: float
) -> Array:
    """Stations in metres between two shares of a bone, girth after the figure, grown by a thickness."""
    table = np.array(rows)
    girth = 0.01 * figure.limb * figure.height / 1.76
    shares = np.unique(np.concatenate([[start], table[(table[:, 0] > start) & (table[:, 0] < end), 0], [end]]))
    out = np.zeros((len(shares), 5))
    out[:, 0] = shares * length
    for column in (1, 2, 3):
        out[:, column] = np.interp(shares, table[:, 0], table[:, column]) * girth + thickness
    return out


def finger_chain(figure: Figure, finger: str) -> tuple[Array, Array]:
    """Places (n + 1, 3) of a right finger's joints and its tip, and skin radii (n + 1,)."""
    names = [f"right_{finger}_{segment}" for segment in FINGERS[finger]]
    places = [figure.bind.place(name) for name in names]
    radii = [float(figure.skeleton.radii[INDEX[name]]) for name in names]
    tip = figure.skeleton.tips[INDEX[names[-1]]].copy()
    tip[0] -= 0.85 * radii[-1]  # the skin's end, not the sphere's middle, is the tip
    places.append(figure.bind.at(names[-1], tip))
    return np.array(places), np.array([*(r * 1.04 for r in radii), radii[-1] * 0.92])


def _finger(figure: Figure, finger: str) -> Field:
    """One finger, its knuckles a little thicker than its bones."""
    places, radii = finger_chain(figure, finger)
    cones = [cone(places[i], places[i + 1], radii[i], radii[i + 1]) for i in range(len(places) - 1)]

    def distance(p: Array) -> Array:
        d = cones[0](p)
        for other in cones[1:]:
            d = smooth_min(d, other(p), 0.004)
        return d

    return distance


def _palm(figure: Figure) -> Field:
    """Metacarpals with their flesh, and the balls of the thumb and of the little finger."""
    bind, hand = figure.bind, 0.108 * figure.height
    parts: list[Field] = []
    roots = {"index": 0.075, "middle": 0.028, "ring": -0.02, "little": -0.060}
    for finger, across in roots.items():
        start = bind.at("right_hand", np.array([0.06, -0.002, -across]) * hand)
        chain, radii = finger_chain(figure, finger)
        knuckle = chain[0] + bind.matrix("right_hand") @ np.array([0.0, -0.012 * hand, 0.0])
        parts.append(cone(start, knuckle, 0.090 * hand, (0.062 if finger == "little" else 0.069) * hand))
        web = chain[0] + 0.20 * (chain[1] - chain[0])
        web += bind.matrix("right_hand") @ np.array([0.0, -0.006 * hand, 0.0])
        parts.append(cone(knuckle, web, 0.066 * hand, radii[0] * 1.03))
    thumb, radii = finger_chain(figure, "thumb")
    base = bind.at("right_hand", np.array([0.05, -0.03, -0.07]) * hand)
    parts.append(cone(base, thumb[0], 0.085 * hand, 0.088 * hand))
    parts.append(cone(thumb[0], thumb[0] + 0.45 * (thumb[1] - thumb[0]), 0.088 * hand, 0.066 * hand))
    turn = bind.matrix("right_hand")
    parts.append(ellipsoid(bind.at("right_hand", np.array([0.20, -0.035, 0.10]) * hand),
                           np.array([0.19, 0.066, 0.075]) * hand, turn))  # fmt: skip
    # The web between thumb and index.
    index = finger_chain(figure, "index")[0]
    middle_of_web = thumb[0] + 0.30 * (thumb[1] - thumb[0])
    parts.append(cone(middle_of_web, 0.55 * index[0] + 0.45 * base, 0.045 * hand, 0.05 * hand))

    def distance(p: Array) -> Array:
        d = parts[0](p)
        for other in parts[1:]:
            d = smooth_min(d, other(p), 0.009)
        return d

    return distance


def _hollow(figure: Figure) -> Field:
    """What is scooped out of the palm, so that its skin goes through the middle of the grip."""
    grip = figure.skeleton.grips[0, :3]
    radius = 0.06
    middle = figure.bind.at("right_hand", grip - np.array([0.0, radius - 0.0006, 0.0]))
    return ellipsoid(middle, np.full(3, radius))


def hand(figure: Figure) -> Field:
    """The right hand's skin."""
    palm, hollow = _palm(figure), _hollow(figure)
    fingers = {name: _finger(figure, name) for name in FINGERS}

    def distance(p: Array) -> Array:
        d = smooth_max(palm(p), -hollow(p), 0.004)
        apart = np.full(len(p), np.inf)
        for field in fingers.values():
            apart = smooth_min(apart, field(p), 0.0015) if np.isfinite(apart).all() else field(p)
        return smooth_min(d, apart, 0.006)

    return distance


def arm(figure: Figure, start: float) -> Field:
    """The right arm's skin from a share of the upper arm to the fingertips."""
    limb, fingers = bare_arm(figure, 0.0, start, 1.06), hand(figure)
    a, b = figure.bind.place("right_upper_arm"), figure.bind.place("right_lower_arm")
    begin = half_space(a + start * (b - a), a - b)

    wrist, along = figure.bind.place("right_hand"), figure.bind.matrix("right_lower_arm")[:, 0]

    def distance(p: Array) -> Array:
        s = (p - wrist) @ along
        d = np.full(len(p), 1.0)
        near = s < 0.04
        d[near] = limb(p[near])
        far = s > -0.05
        d[far] = smooth_min(d[far], fingers(p[far]), 0.012)
        return d

    return intersect(distance, begin)
