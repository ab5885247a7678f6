"""Closing the fingers onto a shape, each until it touches; many hands at once, so that the best may be taken.

A finger curls as a whole until one of its links touches; the links beyond go on until they touch too. The thumb comes
back from its own side until it touches the shape, or the fingers.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.grasping.field import Solid
from ahmss.grasping.hand import Hand, Thumb

__all__ = [
    "HOOK",
    "POWER",
    "PRECISION",
    "THUMB_MOST",
    "THUMB_SLACK",
    "TOUCH",
    "Fingers",
    "Hands",
    "close_fingers",
    "close_thumb",
    "hook_fingers",
    "tightened",
]

TOUCH = 0.0015  # metres within which skin counts as touching
AWAY = 0.03  # metres beyond which skin is not near
SINK = 0.0003  # metres that skin gives way
COARSE, FINE = 16, 6  # places looked at on the way, then between the last that is free and the first that is not
MOST = np.radians([95.0, 108.0, 80.0])  # that the joints bend at most
STRAIGHTENED = 0.3  # of its bend that the end joint keeps while the joint before it goes on
NOTHING = 9  # the number of no link
EASED, TIGHTENED = np.radians([12.0, 30.0])  # by which joints open before they close anew, and close at the most
KNUCKLE = np.radians(25.0)  # by which a knuckle bends until its finger lies on a bar
FOLLOWS = 0.12  # of all the way that a finger without anything to touch bends further than the one beside it
THUMB_MOST, THUMB_LEAST, THUMB_BEND, THUMB_SLACK = np.radians([118.0, 22.0, 60.0, 8.0])


# Radians at knuckle, middle and end joint of a finger that is curled all the way: about something thick, hooked about a
# bar, and with straight ends against the thumb.
POWER, HOOK, PRECISION = np.radians([[80.0, 105.0, 70.0], [45.0, 105.0, 75.0], [85.0, 55.0, 25.0]])
LEAST = -0.1  # of that, where fingers begin


@dataclass(frozen=True)
class Hands:
    """C hands in the object's frame: places (C, 3) and turning matrices (C, 3, 3)."""

    place: Array
    turn: Array

    def seen(self, points: Array) -> Array:
        """Points (C, ..., 3) of the hands' frames in the object's."""
        flat = points.reshape(len(self.place), -1, 3)
        return (flat @ self.turn.transpose(0, 2, 1) + self.place[:, None]).reshape(points.shape)

    def chosen(self, which: NDArray[np.intp]) -> Hands:
        """Some of them."""
        return Hands(self.place[which], self.turn[which])


@dataclass(frozen=True)
class Fingers:
    """Fingers that have closed, of C hands.

    flexion: (C, 4, 3) radians. gaps: (C, 4, 3) metres between each link's skin and the shape. touches: (C, 4, 3, 3)
    where each link's skin is nearest to it: middles of balls, in the object's frame.
    """

    flexion: Array
    gaps: Array
    touches: Array

    def loose(self) -> Array:
        """How far (C, 4) each finger is from the shape, metres, the mean of its links; those far away count alike."""
        return np.clip(self.gaps, 0.0, AWAY).mean(axis=2)

    def or_better(self, other: Fingers) -> Fingers:
        """Finger by finger these or the others, whichever is better around the shape."""
        take = (other.loose() < self.loose())[..., None]
        return Fingers(
            np.where(take, other.flexion, self.flexion), np.where(take, other.gaps, self.gaps),
            np.where(take[..., None], other.touches, self.touches),
        )  # fmt: skip


def close_fingers(hand: Hand, hands: Hands, solid: Solid, curl: Array) -> Fingers:
    """Close the four fingers of each hand onto a solid, curling in the proportions of `curl` (3,)."""

    end = np.broadcast_to(curl, (len(hands.place), 4, 3))
    flexion, link = _meet(LEAST * end, end, _gaps_from(hand, hands, solid, 0, LEAST * end))
    loose = link == NOTHING
    for joint in (1, 2):
        first = flexion.copy()
        first[..., joint + 1 :] *= STRAIGHTENED  # or the end would meet a round thing before the link between does
        last = first.copy()
        last[..., joint] = np.maximum(MOST[joint], first[..., joint])
        further, _ = _meet(first, last, _gaps_from(hand, hands, solid, joint, first))
        flexion = np.where((link < joint)[..., None], further, flexion)
    for finger in range(1, 4):  # beside one that holds, a finger with nothing to touch is bent as that one is
        own, beside = flexion[:, finger], flexion[:, finger - 1] + FOLLOWS * curl
        flexion[:, finger] = np.where(loose[:, finger, None], np.minimum(own, beside), own)
    middles, radii = hand.finger_balls(flexion)
    return Fingers(flexion, *_nearest(solid, hands.seen(middles), radii))


def hook_fingers(hand: Hand, hands: Hands, solid: Solid, start: Array) -> Fingers:
    """Close fingers that lie across a bar around it: the knuckle until it touches, then the middle joint, then the end.

    A finger that does not lie across it is bent as the one beside it is, as far as it can.

    Args:
        hand: that closes.
        hands: C of them.
        solid: that has the bar.
        start: (C, 4, 3) the flexion of the fingers across it, the ends bent as they go through behind it.
    """
    end = start + np.array([KNUCKLE, 0.0, 0.0])
    across, link = _meet(start, end, _gaps_from(hand, hands, solid, 0, start))
    loose = (link == NOTHING)[..., None]
    flexion = np.where(loose, start, across)
    for joint in (1, 2):
        last = flexion.copy()
        last[..., joint] = MOST[joint]
        further, _ = _meet(flexion, last, _gaps_from(hand, hands, solid, joint, flexion))
        flexion = np.where(loose, start, further)
    apart = np.abs(np.arange(4)[:, None] - np.arange(4)) + np.where(loose[..., 0], NOTHING, 0)[:, None]
    beside = np.take_along_axis(flexion, apart.argmin(axis=2)[..., None], axis=1)
    as_beside, _ = _meet(start, beside, _gaps_from(hand, hands, solid, 0, start))
    flexion = np.where(loose, as_beside, flexion)
    middles, radii = hand.finger_balls(flexion)
    return Fingers(flexion, *_nearest(solid, hands.seen(middles), radii))


def tightened(hand: Hand, hands: Hands, solid: Solid, flexion: Array) -> Array:
    """The flexion (C, 4, 3) of fingers that are nearly closed around a solid, and now until they touch it."""
    start, most = flexion - EASED, np.minimum(flexion + TIGHTENED, MOST)
    found, _ = _meet(start, most, _gaps_from(hand, hands, solid, 0, start))
    for joint in (1, 2):
        last = found.copy()
        last[..., joint] = np.maximum(most[..., joint], found[..., joint])
        found, _ = _meet(found, last, _gaps_from(hand, hands, solid, joint, found))
    return found


def _gaps_from(hand: Hand, hands: Hands, solid: Solid, joint: int, start: Array) -> Callable[[Array], Array]:
    """The gaps (C, 4, n, links) of the links from a joint on, along paths of flexions (C, 4, n, 3).

    A ball that touches at the start, beside the joint before, stops nothing unless it goes deeper.
    """

    def of_balls(path: Array) -> Array:
        middles, radii = hand.finger_balls(path.swapaxes(1, 2))
        return solid.clearance(hands.seen(middles[..., joint:, :, :])) - radii[:, joint:]

    before = np.minimum(of_balls(start[:, :, None]), 0.0) if joint else np.zeros(())

    def gaps(path: Array) -> Array:
        return (of_balls(path) - before).min(axis=-1).swapaxes(1, 2) + SINK

    return gaps


def close_thumb(
    hand: Hand, hands: Hands, solid: Solid, flexion: Array, rise: Array, bend: Array
) -> tuple[Thumb, Array, Array]:
    """Bring the thumb of each hand back onto a solid, or onto the fingers that have closed.

    Args:
        hand: that closes.
        hands: C of them.
        solid: that they close on.
        flexion: (C, 4, 3) of the fingers.
        rise: (C,) the plane in which the thumb moves, radians out of the palm to the thumb's side.
        bend: (C,) of its end while it moves.

    Returns:
        The thumbs (C), the gaps (C, 2) of their links, and where they touch (C, 2, 3) in the object's frame.
    """
    middles, radii = hand.finger_balls(flexion)
    others, wide = middles[:, :2].reshape(len(rise), 1, -1, 3), radii[:2].reshape(-1)  # the two that it can meet

    def gaps(path: Array) -> Array:
        """The gaps (C, n, 2) of a thumb's links along paths (C, n, 2) of its way out and its bend."""
        middles, radii = hand.thumb_balls(Thumb(path[..., 0], rise[:, None], path[..., 1]))
        to_solid = solid.clearance(hands.seen(middles)) - radii
        flat = middles[..., 1:, :, :].reshape(*path.shape[:2], -1, 3)  # its root lies beside theirs
        square = (flat**2).sum(axis=-1)[..., None] + (others**2).sum(axis=-1)[..., None, :]
        apart = np.sqrt(np.maximum(square - 2.0 * flat @ others.swapaxes(-1, -2), 0.0)) - wide
        found = to_solid.min(axis=-1)
        found[..., 1] = np.minimum(found[..., 1], (apart.min(axis=-1) - radii[1]).min(axis=-1))
        return found + SINK

    def end_gaps(path: Array) -> Array:
        return gaps(path)[..., 1:]

    count = len(rise)
    start, end = (np.stack([np.full(count, out), bend], axis=1) for out in (THUMB_MOST, THUMB_LEAST))
    found, link = _meet(_free(start, end, gaps), end, gaps)
    bent, _ = _meet(found, np.stack([found[:, 0], np.full(count, THUMB_BEND)], axis=1), end_gaps)
    found = np.where((link == 0)[:, None], bent, found)
    thumb = Thumb(found[:, 0], rise, found[:, 1])
    middles, radii = hand.thumb_balls(thumb)
    return thumb, *_nearest(solid, hands.seen(middles), radii)


def _nearest(solid: Solid, balls: Array, radii: Array) -> tuple[Array, Array]:
    """The gap (...) of the ball of each link (..., B, 3) that is nearest to a solid, and its middle (..., 3)."""
    gaps = solid.clearance(balls) - radii
    nearest = gaps.argmin(axis=-1)[..., None]
    return gaps.min(axis=-1), np.take_along_axis(balls, nearest[..., None], axis=-2)[..., 0, :]


def _meet(start: Array, end: Array, gaps_of: Callable[[Array], Array]) -> tuple[Array, NDArray[np.intp]]:
    """Where on straight ways between (..., k) the first of some links touches, and which.

    Args:
        start: (..., k) of the ways.
        end: (..., k) of the ways.
        gaps_of: gives gaps (..., n, links) at places (..., n, k).

    Returns:
        The places (..., k): the start where it touches already, the end where nothing does; and the links (...),
        `NOTHING` where nothing does.
    """
    first, last, touched, _ = _between(start, end, COARSE, gaps_of)
    place, _, _, link = _between(first, last, FINE, gaps_of)
    return np.where(touched[..., None], place, end), np.where(touched, link, NOTHING)


def _free(start: Array, end: Array, gaps_of: Callable[[Array], Array]) -> Array:
    """The first place of straight ways (..., k), as in `_meet`, at which nothing touches; the start where all does."""
    path = start[..., None, :] + np.linspace(0.0, 1.0, COARSE)[:, None] * (end - start)[..., None, :]
    i = (gaps_of(path).min(axis=-1) > 0.0).argmax(axis=-1)
    return np.take_along_axis(path, i[..., None, None], axis=-2)[..., 0, :]


def _between(
    start: Array, end: Array, steps: int, gaps_of: Callable[[Array], Array]
) -> tuple[Array, Array, NDArray[np.bool_], NDArray[np.intp]]:
    """The last free place, the first that is not (both (..., k)), whether there is one, and the link that touches."""
    share = np.linspace(0.0, 1.0, steps)[:, None]
    path = start[..., None, :] + share * (end - start)[..., None, :]
    gaps = gaps_of(path)
    closed = gaps.min(axis=-1) <= 0.0
    touched = closed.any(axis=-1)
    i = np.where(touched, closed.argmax(axis=-1), steps - 1)[..., None, None]
    before = np.take_along_axis(path, np.maximum(i - 1, 0), axis=-2)[..., 0, :]
    link = np.take_along_axis(gaps, i, axis=-2)[..., 0, :].argmin(axis=-1)
    here = np.take_along_axis(path, i, axis=-2)[..., 0, :]
    return before, here, touched, link
