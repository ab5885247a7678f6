"""The precision grip: what is held is between the pads of thumb and fingers (Napier 1956)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, from_axis_angle, from_matrix, multiply, rotate, to_matrix
from ahmss.grasping.closing import PRECISION, THUMB_SLACK, Hands
from ahmss.grasping.field import Field
from ahmss.grasping.hand import ALONG, Hand, Thumb
from ahmss.grasping.holding import Cost, Holding, Trial, best
from ahmss.motion.steps import Steps

__all__ = ["PARTS", "Way", "pinch", "precision", "thickness", "ways_to"]

DEPTHS = np.array([0.015, 0.01, 0.022, 0.006])  # metres behind where the shape begins
SPAN = 0.11  # metres between the pads at the most
STEP = 0.0005  # metres between places that are looked at along a line
UPRIGHT = 0.8  # what it costs to close along the hand rather than across it
SLANT, THIN = np.radians(30.0), 0.03  # how much aslant what is thinner than that may lie between the pads, metres
PARTS = 3  # in which ways are looked for
PADS = 2  # links that touch where the pads are well on it
TILTS = np.radians([0.0, -25.0, 25.0, -50.0, 50.0, -75.0, 75.0, -90.0, 90.0])  # against the site's x, about its z
TILTED, SITES, TRIED = (
    0.8,
    100.0,
    3,
)  # what a radian of that costs; above all is what the site says; ways that are tried
SAME = 0.004, 0.02  # of 1 - cosine of half the turn, and metres aside: a hand that is so near to a way has come it
PINCHES = 2  # fingers that press against the thumb: something held by the little finger alone would turn
PAD = 4  # which ball of a last link is in the middle of its pad
X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


def precision(hand: Hand, field: Field, grip: Array, site: Array, cost: Cost | None = None) -> Steps[Holding | None]:
    """The best precision grip at a site, thumb and fingers along its z, the hand coming along its x.

    Args:
        hand: that grips.
        field: of the object, in whose frame all is.
        grip: (7,) the palm's frame at present.
        site: (7,) where the pads shall be, or further in.
        cost: of palms, for an arm that can't bring the hand everywhere. Where it can't come along x, the hand comes
            from another side of the line on which the pads close, or with thumb and fingers exchanged.

    Returns:
        The grip, which may not hold; None where the shape is thicker than the hand spans, or is not there.
    """
    found: Holding | None = None
    ways: list[Way] = []
    for tilts in np.split(TILTS, PARTS) if cost is not None else (TILTS[:1],):
        ways += ways_to(hand, field, site, tilts)
        yield
    for way in _best_first(ways, grip, cost)[:TRIED]:
        holding = yield from pinch(hand, field, way)
        if holding is not None and holding.holds:
            return holding
        found = found or holding
    return found


@dataclass(frozen=True)
class Way:
    """How a hand comes to what it pinches.

    site (7,), along whose x. thumb: on the side of its z (1.0) or the other (-1.0). tilt: radians by which x is turned
    about the z of the site that was asked for. palm: (7,) about where it holds.
    """

    site: Array
    thumb: float
    tilt: float
    palm: Array

    @property
    def inward(self) -> Array:
        """The direction (3,) in which the hand comes."""
        return rotate(self.site[3:], X)


def ways_to(hand: Hand, field: Field, site: Array, tilts: Array = TILTS) -> list[Way]:
    """The ways in which a hand may come to a site (7,): turned about its z by some tilts, the thumb on either side."""
    turned = multiply(site[3:], from_axis_angle(Z, tilts))
    found: list[Way] = []
    for tilt, row in zip(tilts.tolist(), turned, strict=True):
        own = np.concatenate([site[:3], row])
        for thumb in (1.0, -1.0):
            placed = _placed(hand, field, own, thumb, DEPTHS[0])
            if placed is not None:
                found.append(Way(own, thumb, tilt, _palms(hand, placed[0][None])[0]))
    return found


def pinch(hand: Hand, field: Field, way: Way) -> Steps[Holding | None]:
    """The grip of a hand that comes a way, which may not hold; None where the shape is too thick."""
    holding = yield from _closed(hand, field, way, DEPTHS[:1])
    if holding is None or not holding.well(PADS):
        yield
        holding = yield from _closed(hand, field, way, DEPTHS)
    return holding


def _best_first(ways: list[Way], grip: Array, cost: Cost | None) -> list[Way]:
    """The ways, the best first: as the hand is there, else as the site says, else as the arm takes it most easily."""
    if not ways:
        return []
    palms, tilt = np.array([way.palm for way in ways]), np.abs([way.tilt for way in ways])
    apart = 1.0 - np.abs(multiply(conjugate(palms[:, 3:]), grip[3:])[:, 0])
    total, can = (np.zeros(len(ways)), np.ones(len(ways), bool)) if cost is None else cost(palms)
    # As the site says where the arm can: the thumb on the side that is nearer to how the hand is.
    own = np.where(can & (tilt == 0.0), -SITES + apart, total + TILTED * tilt + apart) + np.where(can, 0.0, SITES)
    off = grip[:3] - palms[:, :3]
    inward = np.array([way.inward for way in ways])
    aside = np.linalg.norm(off - (off * inward).sum(axis=-1, keepdims=True) * inward, axis=-1)
    own = own - np.where((apart < SAME[0]) & (aside < SAME[1]), 3.0 * SITES, 0.0)
    return [ways[i] for i in np.argsort(own, kind="stable")]


def _closed(hand: Hand, field: Field, way: Way, depths: Array) -> Steps[Holding | None]:
    """The best grip of those so deep (n); None where the shape is too thick."""
    tried = [_placed(hand, field, way.site, way.thumb, depth) for depth in depths]
    found = [(pose, rise, i) for i, one in enumerate(tried) if one is not None for pose, rise in [one]]
    if not found:
        return None
    poses = np.array([pose for pose, _, _ in found])  # of the hand
    rises = np.array([[rise] for _, rise, _ in found])
    bends, cost = np.full_like(rises, THUMB_SLACK), 0.05 * np.array([i for _, _, i in found], float)
    hands, curls = Hands(poses[:, :3], to_matrix(poses[:, 3:])), PRECISION[None]
    trial = Trial(hands, _palms(hand, poses), curls, rises, bends, cost, np.zeros_like(rises), PADS, None, PINCHES)
    return (yield from best(hand, field, trial))


def _palms(hand: Hand, poses: Array) -> Array:
    """The palms (n, 7) of hands (n, 7)."""
    grips = multiply(poses[:, 3:], np.broadcast_to(hand.grip[3:], (len(poses), 4)))
    return np.concatenate([poses[:, :3] + rotate(poses[:, 3:], hand.grip[:3]), grips], axis=1)


def _placed(hand: Hand, field: Field, site: Array, thumb: float, depth: float) -> tuple[Array, float] | None:
    """The hand's frame (7,) whose pads are so deep in the shape, and its thumb's plane; None where it is too thick."""
    inward, across = rotate(site[3:], X), rotate(site[3:], Z)
    s = np.arange(0.0, SPAN + 0.05, STEP)
    field = field.alone
    inside = field.clearance(site[:3] - s[:, None] * inward) < 0.0
    begins = float(s[inside][-1]) if inside.any() else 0.0
    middle = site[:3] - max(begins - depth, 0.0) * inward
    sides = thickness(field, middle, across)
    if sides is None or sum(sides) > SPAN:
        return None
    middle = middle + 0.5 * (sides[0] - sides[1]) * across
    place, turn, rise = _pinch(hand, sum(sides))
    frame = np.stack([inward, np.cross(thumb * across, inward), thumb * across], axis=1)
    q_object_hand = from_matrix(frame @ turn.T)
    return np.concatenate([middle - rotate(q_object_hand, place), q_object_hand]), rise


def thickness(field: Field, place: Array, across: Array) -> tuple[float, float] | None:
    """How far the surface is from a place within the shape, along a direction and against it; None beyond `SPAN`."""
    s = np.arange(0.0, SPAN, STEP)
    sides: list[float] = []
    for sign in (1.0, -1.0):
        outside = field.clearance(place + sign * s[:, None] * across) > 0.0
        if not outside.any():
            return None
        sides.append(float(s[outside.argmax()]))
    return sides[0], sides[1]


def _pinch(hand: Hand, width: float) -> tuple[Array, Array, float]:
    """Where in the hand the pads are when they are a width apart: their middle, its axes, and the thumb's plane.

    z goes from the fingers' pads to the thumb's, x away from the wrist. Of all ways to have them so far apart that is
    taken in which the pads face each other most.
    """
    share, out = np.linspace(0.1, 1.1, 31), np.radians(np.linspace(25.0, 110.0, 35))
    bent = share[:, None] * PRECISION
    fingers, radii = hand.finger_balls(np.repeat(bent[:, None], 4, axis=1))
    a = bent.sum(axis=1)
    faces = np.stack([-np.sin(a), hand.towards * np.cos(a), np.zeros_like(a)], axis=-1)
    pads = fingers[:, :2, 2, PAD].mean(axis=1) + radii[:2, 2, PAD].mean() * faces
    reach = hand.thumb_lengths[0] * np.sin(out) + ALONG[PAD] * hand.thumb_lengths[1] * np.sin(out - THUMB_SLACK)
    rise = np.arcsin(np.clip((hand.thumb_root[2] - pads[0, 2]) / reach, -0.6, 0.6))
    balls, thumb_radii = hand.thumb_balls(Thumb(out, rise, np.full_like(out, THUMB_SLACK)))
    b = out - THUMB_SLACK
    back = np.stack([np.sin(b), -hand.towards * np.cos(b) * np.cos(rise), np.cos(b) * np.sin(rise)], axis=-1)
    thumbs = balls[:, 1, PAD] + thumb_radii[1, PAD] * back
    apart = thumbs[None] - pads[:, None]
    length = np.linalg.norm(apart, axis=-1)
    along = apart / np.maximum(length, 1e-9)[..., None]
    facing = np.einsum("ijc,ic->ij", along, faces) - np.einsum("ijc,jc->ij", along, back)
    # What they meet may be between them only where they look at each other; a near miss in width does no harm.
    worth = facing - np.abs(length - max(width, 0.004)) / 0.004 - UPRIGHT * np.abs(along[..., 0])
    i, j = np.unravel_index(int(worth.argmax()), worth.shape)
    z = along[i, j]
    middle = 0.5 * (pads[i] + thumbs[j])
    x = middle - (middle @ z) * z
    x = x / np.linalg.norm(x)
    # Something thin may lie aslant between the pads, so that the hand lies more along it.
    slant = float(np.clip(np.arctan2(z[0], x[0]), -SLANT, SLANT)) if width < THIN else 0.0
    x, z = np.cos(slant) * x + np.sin(slant) * z, np.cos(slant) * z - np.sin(slant) * x
    return middle, np.stack([x, np.cross(z, x), z], axis=1), float(rise[j])
