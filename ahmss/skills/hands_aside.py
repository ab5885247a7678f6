"""The hands of a motion that is known moved out of what stands about.

What the shipped algorithms share, and an author may use.
"""

from __future__ import annotations

import numpy as np

from ahmss.algorithm.task import HumanTask
from ahmss.body.array import Array
from ahmss.reaching.aside import kept_aside
from ahmss.reaching.prism import over_hand
from ahmss.reaching.reacher import SIDES, Reacher
from ahmss.reaching.skin import skin_of
from ahmss.skills.reaching import prisms_of

__all__ = ["hands_aside"]


def hands_aside(task: HumanTask, rotations: Array, root: Array) -> Array:
    """By how much (n, 2, 3), right and left, hands go aside for what stands about in poses (n, 43, 4), (n, 3).

    They may come from a table's top; what they come to lie in, as a lap under a table, is not in their way, nor what
    is sat on.
    """
    moved = np.zeros((len(root), len(SIDES), 3))
    prisms = [prism for prism in prisms_of(task) if not prism.sought and not prism.over(root).any()]
    for row, side in enumerate(SIDES):
        points, radii = skin_of(Reacher.of(task.human, side), rotations, root)
        over = (over_hand(prism, root[-1], points[-1], radii) for prism in prisms)
        moved[:, row] = kept_aside([prism for prism in over if prism is not None], points, radii)
    return moved
