"""How a hand brings a round thing to the face: which side of it is ahead, and where the elbow is.

A cup has no front. Its rim meets the lips however it is turned about its own axis; so of its turns, and of the swings
of the elbow, those are taken that a person takes with the grip that the hand happens to have. What people do as they
drink: the upper arm 43 degrees ahead and 31 aside, the elbow bent by 130, the forearm about half-way between palm up
and palm down, the wrist near straight (Safaee-Rad et al. 1990, "Normal functional range of motion of upper limb joints
during performance of three feeding activities").
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ahmss.algorithm.place import Transform
from ahmss.algorithm.task import HumanTask
from ahmss.body.arm import excess, hand_angles
from ahmss.body.arm_swing import swing_of
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.reaching.reacher import Reacher
from ahmss.skills.staging import Staged, face

__all__ = ["with_ease"]

_UP, _ALONG = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
_TURNS = np.radians(np.arange(-180.0, 180.0, 4.0))  # of the thing about its axis
_SWINGS = np.radians(np.arange(-80.0, 81.0, 4.0))  # of the elbow, from where it hangs down and a little out
_OUT = 0.4  # how far it is out there, to one down
# What costs 1, degrees: the forearm's turn, the hand's bend to the sides, to palm and back.
_WIDTHS = np.radians([50.0, 15.0, 22.0])
_RAISED, _RAISES = np.radians(20.0), np.radians(16.0)  # an upper arm from which on, and by how much more
_ASIDE, _ASIDES = np.radians(30.0), np.radians(20.0)  # which way it is raised, from ahead to its side
_CHANGES = np.radians(30.0)  # from the key before
_BEYOND, _MISSING = 50.0, 60.0  # a radian beyond a joint's limit, a metre too far


def with_ease(task: HumanTask, staged: Staged) -> Staged:
    """A clip whose targets are seen from the face, the held thing turned and the arm posed as it is easy at each key.

    The arm's rotations and the target's are new, its places stay. All stays as it is where the thing is not round, or
    none is held.
    """
    if task.object is None or task.site is None or not task.object.sites[task.message.site].free_axis:
        return staged
    reacher = Reacher.of(task.human, task.hand or "right")
    on_site = task.site.inverse().then(task.start.grip(reacher.side))
    targets, rotations = staged.local.copy(), staged.rotations.copy()
    before: Array | None = None
    for key in np.flatnonzero(targets[:, reacher.row, 7]):
        places, world = forward(rotations[key], staged.root[key], task.human.offsets)
        spine = places[INDEX["spine"]], world[INDEX["spine"]]
        site = Transform.of(targets[key, reacher.row, :7])
        turned = multiply(site.rotation, from_axis_angle(_UP, _TURNS))
        base = face(task, rotations[key], staged.root[key])
        palms = base.then(Transform(np.broadcast_to(site.place, (len(_TURNS), 3)), turned)).then(on_site).row()
        links, cost = _arms(reacher, palms, spine)
        if before is not None:
            changed = 8.0 * (1.0 - np.abs(turned @ before))  # the angle between them squared, about
            cost = cost + changed[:, None] / _CHANGES**2
        turn, swing = np.unravel_index(int(np.argmin(cost)), cost.shape)
        before = targets[key, reacher.row, 3:7] = turned[turn]
        rotations[key, reacher.links] = reacher.arm.into_pose(links[turn, swing])
    return replace(staged, clip=replace(staged.clip, targets=targets), rotations=rotations)


def _arms(reacher: Reacher, palms: Array, spine: tuple[Array, Array]) -> tuple[Array, Array]:
    """The arms (n, m, 3, 4) of palms (n, 7) at each swing of the elbow, and what they cost (n, m)."""
    wrist = reacher.wrist(palms, spine)
    hanging = np.array([1.0, -_OUT * reacher.sign, 0.0])  # in the shoulder frame: x down, y right, z back
    swing = swing_of(reacher.arm, replace(wrist, place=wrist.place[:, None], rotation=wrist.rotation[:, None]), hanging)
    links = swing.links(_SWINGS * -reacher.sign)
    down, right, back = np.moveaxis(rotate(links[..., 0, :], _ALONG), -1, 0)
    bent = ((hand_angles(links) / _WIDTHS) ** 2).sum(axis=-1)
    raised = np.arccos(np.clip(down, -1.0, 1.0))
    aside = np.arctan2(-reacher.sign * right, -back) - _ASIDE
    cost = bent + (np.maximum(raised - _RAISED, 0.0) / _RAISES) ** 2 + (np.sin(raised) * aside / _ASIDES) ** 2
    cost = cost + _BEYOND * excess(reacher.arm, links) + _MISSING * np.abs(swing.missing)
    return links, cost
