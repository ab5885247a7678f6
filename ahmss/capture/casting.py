"""Who performs before the simulated tracker: our own subject by the name of what it does, or a motion file."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.body.skeleton import Skeleton
from ahmss.capture.performance import Performance, of_clip
from ahmss.capture.subject import PERFORMANCES, perform
from ahmss.errors import CommandError
from ahmss.motion import clip
from ahmss.motion.clip import Clip
from ahmss.motion.importing import import_clip
from ahmss.motion.planting import feet, stance

__all__ = ["performance_of"]


def performance_of(what: str, skeleton: Skeleton, upright_seconds: float = 2.0) -> Performance:
    """The performance of that name, or of that file: a clip (.npz), or whatever `ahmss motion import` reads.

    Args:
        what: a name or a path.
        skeleton: whose lengths the performer has.
        upright_seconds: how long they stand upright first.

    Raises:
        CommandError: neither a performance nor a file; lists what there is.
        DataError: the file is wrong.
    """
    if what in PERFORMANCES:
        return perform(what, skeleton, upright_seconds=upright_seconds)
    path = Path(what)
    if not path.is_file():
        raise CommandError(
            f'no performance and no file "{what}"; the subject performs {", ".join(PERFORMANCES)}, or give a .npz clip '
            "or a BVH file"
        )
    motion = clip.load(path) if path.suffix == ".npz" else import_clip(path, skeleton)[0]
    try:
        return of_clip(_facing_ahead(motion, skeleton), skeleton, upright_seconds, name=path.stem)
    except ValueError as error:
        raise CommandError(f"{path}: {error}") from error


def _facing_ahead(motion: Clip, skeleton: Skeleton) -> Clip:
    """The clip turned as a whole, so that who stands upright as its first stance faces +x, as calibration wants it."""
    _, heading = stance(feet(skeleton, motion.rotations[0], motion.root[0]))
    back = from_axis_angle(np.array([0.0, 0.0, 1.0]), -heading)
    rotations = motion.rotations.copy()
    rotations[:, 0] = multiply(back, rotations[:, 0])
    return replace(motion, rotations=rotations, root=rotate(back, motion.root))
