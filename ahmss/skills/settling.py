"""A clip relative to an object, such as sitting down on a chair, fitted to who plays it.

Its feet stay on the floor where the human's feet are; the hips go from there to the place on the object where the clip
has them, whatever the height of the human, and however exactly they stand before it.
"""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.errors import AlgorithmError
from ahmss.motion.clip import Clip
from ahmss.motion.planting import plant

__all__ = ["settle"]

_FAR, _ASKEW = 0.25, np.radians(30.0)  # metres and radians from where the motion starts that are made good on the way
_LEVEL = 0.05  # metres: hips that rise less than this neither sit down nor stand up
_UP = np.array([0.0, 0.0, 1.0])


def settle(task: HumanTask, clip: Clip, origin: Transform, present: Array) -> tuple[Array, Array]:
    """Rotations (F, 43, 4) and root (F, 3) of the clip in the world.

    The frame in which the hips are highest is taken as standing, where the legs say how high they are; the one in which
    they are lowest as settled, where the object does. In between what differs for this human goes by height.

    Args:
        task: the acting human, and where it is.
        clip: both feet on the floor throughout, relative to the object.
        origin: the object's frame.
        present: (2, 7) the human's feet in the world.

    Raises:
        AlgorithmError: the human is too far from where the motion starts; says where that is.
    """
    rotations, root = clip.rotations.copy(), origin.apply(clip.root)
    rotations[:, 0] = multiply(origin.rotation, clip.rotations[:, 0])
    high, low = int(root[:, 2].argmax()), int(root[:, 2].argmin())
    own, standing = plant(task.human, rotations[high], present)
    rise = root[high, 2] - root[low, 2]
    share = (root[:, 2] - root[low, 2]) / rise if rise > _LEVEL else np.ones(len(root))
    turn = _heading(own) - _heading(rotations[high])
    turn = (turn + np.pi) % (2.0 * np.pi) - np.pi
    _refuse_far((rotations[high], root[high]), turn, float(np.hypot(*(standing - root[high])[:2])))
    fitted = root + share[:, None] * (standing - root[high])
    rotations[:, 0] = multiply(from_axis_angle(_UP, share * turn), rotations[:, 0])
    away = float(np.linalg.norm(fitted[0] - task.start.root))
    if away > _FAR:
        begins = "standing before" if share[0] > 0.5 else "on"
        named = "the object" if task.object is None else task.object.name
        raise AlgorithmError(f"the motion begins {begins} {named}, and the hips are {away:.2f} m from there")
    return rotations, fitted


def _refuse_far(standing: tuple[Array, Array], turn: float, away: float) -> None:
    """Refuse a human whose feet are not where the motion has them."""
    if away <= _FAR and abs(turn) <= _ASKEW:
        return
    x, y, _ = standing[1]
    facing = np.degrees(_heading(standing[0]))
    raise AlgorithmError(
        f"the human stands {away:.2f} m and {abs(np.degrees(turn)):.0f} degrees from where the motion has it; bring it "
        f"to {x:.2f} {y:.2f} facing {facing:.0f}"
    )


def _heading(rotations: Array) -> float:
    """Where the hips of a pose (43, 4) face, radians."""
    ahead = rotate(rotations[0], np.array([0.0, 0.0, -1.0]))
    return float(np.arctan2(ahead[1], ahead[0]))
