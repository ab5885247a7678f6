"""Building the library from the subject: each clip performed, cut out, laid along its way and fitted (A.2)."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace

from ahmss.body.links import INDEX
from ahmss.body.skeleton import Skeleton
from ahmss.walking.catalogue import MIXED, STRAIGHT, TABLE, Key
from ahmss.walking.fitting import Pose, close_onto_mirror, fit_ends, turned
from ahmss.walking.gait import GAIT, Gait
from ahmss.walking.library import BODY, RATE, Library, WalkClip
from ahmss.walking.mirroring import mirror
from ahmss.walking.performer import Performed, Stand, perform
from ahmss.walking.plans import Planner, Take

__all__ = ["build", "cut_out"]

_LEGS = [INDEX[f"{side}_{link}"] for side in ("right", "left") for link in ("upper_leg", "lower_leg", "foot")]
_LEGS_POWERS = (10, 10)


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
        clips[key] = _fitted(raw, *_wanted_ends(key, straight, standing))
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


def _fitted(raw: WalkClip, first: Pose, last: Pose) -> WalkClip:
    """Fitted by (A.7), the legs with a higher power: they are solved again, and tell meanwhile where the feet stood."""
    slowly, late = fit_ends(raw, first, last), fit_ends(raw, first, last, *_LEGS_POWERS)
    rotations = slowly.rotations.copy()
    rotations[:, _LEGS] = late.rotations[:, _LEGS]
    return replace(slowly, rotations=rotations)


def _wanted_ends(key: Key, straight: WalkClip, standing: Pose) -> tuple[Pose, Pose]:
    """The poses that a clip begins and ends in: standing, or the straight step's first pose (or its mirror image)."""
    first = Pose(straight.rotations[0], straight.root[0])
    match key.kind:
        case "start":
            return standing, turned(first, key.direction)
        case "end":
            landing = first if key.last == "right" else Pose(*mirror(first.rotations, first.root))
            return landing, turned(standing, key.facing)
        case _:
            return standing, turned(standing, key.direction + key.facing)
