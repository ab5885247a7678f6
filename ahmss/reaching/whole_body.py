"""A body as balls, but forearms and hands, which go where they are sent: points in it, and how thick skin is around."""

from __future__ import annotations

import numpy as np

from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import rotate
from ahmss.body.skeleton import Skeleton

__all__ = ["body_points"]

_STATURE = 1.76  # metres, of the body whose skin the balls are of: within 1.5 cm of it in front
# Link, share of its length from its joint, metres to either side of that, over it (behind it in the trunk), of skin.
_BALLS = (
    *(("hips", share, 0.058, 0.0, thick) for share, thick in ((0.0, 0.109), (0.9, 0.11))),
    *(("spine", share, 0.05, 0.0, thick) for share, thick in ((0.25, 0.105), (0.9, 0.09))),
    *(("spine", share, 0.05, -0.018, thick) for share, thick in ((0.5, 0.107), (0.72, 0.1))),
    *(("head", share, 0.0, 0.0, thick) for share, thick in ((0.05, 0.06), (0.5, 0.105), (0.72, 0.105))),
    *(("upper_leg", share, 0.0, 0.0, 0.085) for share in (0.15, 0.4)),
    *(("upper_leg", share, 0.0, 0.0, thick) for share, thick in ((0.65, 0.08), (0.85, 0.065))),
    *(("lower_leg", share, 0.0, 0.0, 0.054) for share in np.linspace(0.0, 0.56, 9).tolist()),
    *(("lower_leg", share, 0.0, 0.0, thick) for share, thick in ((0.65, 0.052), (0.75, 0.05), (0.87, 0.048))),
    ("foot", -0.2, 0.018, -0.045, 0.022),
    ("foot", 0.25, 0.01, -0.03, 0.034),
    ("foot", 0.5, 0.02, -0.04, 0.027),
    ("foot", 0.8, 0.02, -0.046, 0.023),
    ("foot", 0.95, 0.012, -0.05, 0.018),
    *(("upper_arm", share, 0.0, 0.0, thick) for share, thick in ((0.0, 0.055), (0.2, 0.053), (0.45, 0.05))),
)  # fmt: skip


def _placed() -> list[tuple[int, float, float, float, float]]:
    """Each ball, with the number of its link, to the side that it is on."""
    return [
        (INDEX[name], share, side * aside, over, thick)
        for link, share, aside, over, thick in _BALLS
        for name in ((link,) if link in INDEX else (f"right_{link}", f"left_{link}"))
        for side in ((-1.0, 1.0) if aside else (0.0,))
    ]


_PLACED = _placed()
_LINKS = [link for link, *_ in _PLACED]
_SHARES = np.array([[share] for _, share, *_ in _PLACED])
_OFF = np.array([[0.0, aside, over] for _, _, aside, over, _ in _PLACED])
_THICK = np.array([thick for *_, thick in _PLACED])


def body_points(skeleton: Skeleton, rotations: Array, root: Array) -> tuple[Array, Array]:
    """Points (..., n, 3) of poses (..., 43, 4), (..., 3) in the world, and how thick skin is there (n,), metres."""
    size = skeleton.stature / _STATURE
    places, turned = forward(rotations, root, skeleton.offsets)
    off = _SHARES * skeleton.tips[_LINKS] + size * _OFF
    return places[..., _LINKS, :] + rotate(turned[..., _LINKS, :], off), size * _THICK
