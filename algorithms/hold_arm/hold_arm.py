"""Keeping the arm's posture: shoulder, elbow and wrist stay at their angles (Ichiguchi 2000, 5.3.4).

For a hand that carries something while the body does something else.
"""

from __future__ import annotations

import numpy as np

from ahmss.algorithm import HumanTask, importance_of, run
from ahmss.body.array import Array
from ahmss.body.links import LINKS


def hold_arm(task: HumanTask) -> Array:
    """All frames (N, 260): the present pose, cared for in the arm and the fingers alone."""
    side = task.hand or "right"
    share = task.parameter("importance", 1.0)
    held = {link: share for link in LINKS if link.startswith(f"{side}_") and not link.endswith(("leg", "foot"))}
    rotations = np.repeat(task.start.rotations[None], task.length, axis=0)
    root = np.repeat(task.start.root[None], task.length, axis=0)
    return task.block(rotations, root, importance_of(held))


if __name__ == "__main__":
    run(hold_arm)
