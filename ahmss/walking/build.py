"""Building the library from the subject: each clip performed, cut out, laid along its way and fitted (A.2)."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from ahmss.body.skeleton import Skeleton
from ahmss.walking.catalogue import MIXED, STRAIGHT, TABLE, Key
from ahmss.walking.fitting import (
    Pose,
    close_onto_mirror,
    fit_ends,
    fit_speeds,
    wanted_ends,
    wanted_speeds,
)
from ahmss.walking.gait import GAIT, Gait
from ahmss.walking.library import BODY, RATE, Library, WalkClip
from ahmss.walking.performer import Performed, Stand, perform
from ahmss.walking.plans import Planner, Take
from ahmss.walking.replanting import replanted

__all__ = ["build", "cut_out"]


def build(
    skeleton: Skeleton, stand: Stand, gait: Gait = GAIT, keys: Iterable[Key] = (*TABLE, *MIXED),
    progress: Callable[[int, int], None] | None = None,
) -> Library:  # fmt: skip
    """The subject's clips for one human.

    Args:
        skeleton: whose lengths the subject has.
        stand: the pose in which walks begin and end, the hips over the origin, heading 0.
        gait: the style.
        keys: which clips; all 332 if left out. The straight step is always there: starts and ends are fitted to it.
        progress: is told how many are done, of how many.
    """
    planner = Planner(skeleton, stand, gait)
    straight = close_onto_mirror(_performed(skeleton, stand, gait, planner, STRAIGHT))
    wanted = [key for key in keys if key != STRAIGHT]
    standing = Pose(stand.rotations[:BODY], stand.root)
    clips = {STRAIGHT: straight}
    for number, key in enumerate(wanted):
        raw = _performed(skeleton, stand, gait, planner, key)
        fitted = fit_speeds(fit_ends(raw, *wanted_ends(key, straight, standing)), *wanted_speeds(key, straight))
        clips[key] = replanted(skeleton, raw, fitted)
        if progress is not None:
            progress(number + 1, len(wanted))
    return Library(skeleton.name, float(stand.root[2]), clips)


def _performed(skeleton: Skeleton, stand: Stand, gait: Gait, planner: Planner, key: Key) -> WalkClip:
    take = planner.take(key)
    return cut_out(perform(skeleton, stand, take.plan, gait), take, key)


def cut_out(performed: Performed, take: Take, key: Key) -> WalkClip:
    """The part of a performance that is the clip, laid along its way."""
    first, last = round(take.begin * RATE), round(take.end * RATE)
    part = slice(first, last + 1)
    root, rotations = performed.root[part].copy(), performed.rotations[part].copy()
    if key.kind in ("straight", "end"):
        root[:, 0] -= root[0, 0]
    return WalkClip(key, rotations, root, performed.bearing[part])
