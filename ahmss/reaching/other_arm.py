"""The arm that does not reach, while trunk and hips move: its hand stays beside the hips, turned as it was.

Where the arm can't do that in peace, as it is stretched out or raised and the trunk goes far, it goes along with
the trunk as much as it must.
"""

from __future__ import annotations

import numpy as np

from ahmss.body.arm_path import follow
from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, multiply, slerp, to_rotation_vector
from ahmss.motion.steps import Steps
from ahmss.reaching.reacher import Reacher
from ahmss.reaching.twist import handed_back, untwisted

__all__ = ["other_arm"]

_STAYS = (1.0, 0.75, 0.5, 0.25)  # shares of staying beside the hips, the rest of going along with the trunk
_FASTEST = np.radians(4.5)  # a frame, of a joint in peace
_SWING = np.radians(1.2)  # of an elbow, and of a hand that is not turned as asked, in a frame at the most
_SOFTLY = 10  # frames in which an elbow begins to swing
_GAINS = np.radians(1.2)  # by which that changes from one frame to the next
_BEYOND = np.radians(2.0)  # of a limit


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
