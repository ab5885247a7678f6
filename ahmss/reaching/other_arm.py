"""The arm that does not reach, while trunk and hips move: its hand stays beside the hips, turned as it was.

Where the arm can't do that in peace, as it is stretched out or raised and the trunk goes far, it goes along with
the trunk as much as it must. What would bring it into a thing moves it aside.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ahmss.body.arm_path import follow
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, slerp, to_rotation_vector
from ahmss.motion.steps import Steps
from ahmss.reaching.aside import AIR, kept_aside, ramp
from ahmss.reaching.moved_hand import with_hand_moved
from ahmss.reaching.prism import Prism, clearance, over_hand
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.skin import skin_of
from ahmss.reaching.standing import Posture
from ahmss.reaching.twist import handed_back, untwisted

__all__ = ["other_arm", "out_of_things"]

_STAYS = (1.0, 0.75, 0.5, 0.25)  # shares of staying beside the hips, the rest of going along with the trunk
_FASTEST = np.radians(4.5)  # a frame, of a joint in peace
_SWING = np.radians(1.2)  # of an elbow, and of a hand that is not turned as asked, in a frame at the most
_SOFTLY = 10  # frames in which an elbow begins to swing
_GAINS = np.radians(1.2)  # by which that changes from one frame to the next
_BEYOND = np.radians(2.0)  # of a limit
_ASIDE = 1e-4  # metres: what is moved by less is left as it is
_ELBOW = np.radians([0.0, 12.0, -12.0, 25.0, -25.0, 40.0, -40.0, 60.0, -60.0])  # that is tried of an elbow in a thing
_SPARSE = 3  # every so many frames are looked at for that
_BUT_ELBOW = slice(1, None)  # of `skin_of`: all but the elbow, which sinks where the hand is raised


def other_arm(reacher: Reacher, present: Array, hips: Array, spine: tuple[Array, Array]) -> Steps[Array]:
    """The arm's rows (F, 3, 4) of a pose.

    Args:
        reacher: the arm.
        present: (3, 4) its rows before the first frame.
        hips: (F, 7) where its palm is to be to stay beside the hips, world.
        spine: the spine link's place (F, 3) and rotation (F, 4) in the world.
    """
    still = reacher.arm.from_pose(present)
    begun, twist = untwisted(still)
    along = reacher.palm(np.repeat(still[None], len(hips), axis=0), spine)
    for share in _STAYS:
        place = along[:, :3] + share * (hips[:, :3] - along[:, :3])
        turned = slerp(along[:, 3:], hips[:, 3:], np.full(len(hips), share))
        palms = np.concatenate([place, turned], axis=-1)
        way = follow(reacher.arm, reacher.wrist(palms, spine), begun, _SWING, _SOFTLY)
        links = handed_back(way.links, twist)
        steps = to_rotation_vector(multiply(conjugate(np.concatenate([still[None], links[:-1]])), links))
        gains = np.diff(steps, axis=0, prepend=0.0)
        fastest, jerked = (float(np.linalg.norm(a, axis=-1).max()) for a in (steps, gains))
        peaceful = not way.jumps.any() and fastest < _FASTEST and jerked < _GAINS
        if peaceful and float(way.beyond[len(links) // 4 :].max()) < _BEYOND:
            return reacher.arm.into_pose(links)
        yield
    return np.repeat(present[None], len(hips), axis=0)


def out_of_things(reacher: Reacher, prisms: Sequence[Prism], start: Posture, poses: Posture) -> Steps[Array]:
    """The arm's rows (F, 3, 4) of poses (F, 43, 4), (F, 3), its hand where no skin of it is in things.

    Args:
        reacher: the arm. prisms: the things. start: the pose (43, 4), (3,) before: what a hand is deep in, a basin,
            say, or comes out from under, is not in its way. poses: as it would be.
    """
    rows = poses.rotations[:, reacher.links]
    begun, radii = skin_of(reacher, start.rotations, start.root)
    over = (over_hand(prism, start.root, begun, radii) for prism in prisms)
    points, _ = skin_of(reacher, poses.rotations, poses.root)
    room = float(radii.max()) + AIR
    ends = points.min(axis=(0, 1)) - room, points.max(axis=(0, 1)) + room
    on_it = start.root[None]  # who sits on a thing has the hands beside it, or on it
    near = [prism for prism in over if prism is not None and prism.meets(*ends) and not prism.over(on_it)[0]]
    if not near:
        return rows
    yield
    moved = kept_aside(near, points[:, _BUT_ELBOW], radii[_BUT_ELBOW])
    if np.abs(moved).max() > _ASIDE:
        yield
        rows = with_hand_moved(reacher, poses.rotations, poses.root, moved)
    return (yield from _elbow_swung(reacher, near, poses, rows, moved))


def _elbow_swung(reacher: Reacher, near: Sequence[Prism], poses: Posture, rows: Array, moved: Array) -> Steps[Array]:
    """The arm's rows (F, 3, 4) of poses whose hands are moved by (F, 3), the elbow swung out of things as far as that
    takes.
    """
    rotations, best = poses.rotations.copy(), (np.inf, rows)
    share = np.zeros(len(rows))
    for swing in _ELBOW:
        if swing:
            rows = with_hand_moved(reacher, poses.rotations, poses.root, moved, swing * share)
        rotations[:, reacher.links] = rows
        points, radii = skin_of(reacher, rotations[::_SPARSE], poses.root[::_SPARSE])
        lack = (radii - clearance(near, points, float(radii.max()))).max(axis=-1)
        if not swing:
            share = ramp(np.repeat(lack > 0.0, _SPARSE)[: len(rows)])
        best = min(best, (float(lack.max()), rows), key=lambda one: one[0])
        if lack.max() <= 0.0:
            break
        yield
    return best[1]
