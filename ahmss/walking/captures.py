"""A walk library out of a user's own captures: cut, binned by measure, fitted, and filled up where they are empty."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from ahmss.body.skeleton import Skeleton
from ahmss.errors import DataError
from ahmss.motion.smoothness import worst_pop
from ahmss.walking.capture_report import Filled, Report
from ahmss.walking.catalogue import MIXED, STRAIGHT, TABLE, Key, Stride
from ahmss.walking.cutting import Cut, Unused, cuts
from ahmss.walking.fitting import Pose, fit_ends, fit_speeds, wanted_ends, wanted_speeds
from ahmss.walking.library import RATE, Library, WalkClip
from ahmss.walking.likeness import closing, unlike
from ahmss.walking.nominal import length_of
from ahmss.walking.recording import MOTION_FILES, read
from ahmss.walking.replanting import closed, replanted

__all__ = ["files_in", "gather"]

_USUAL = 0.1  # share by which a step's length and time may differ from the usual one's
# Without a fallback of both strides: of the hips' height, how long a clip with a normal stride is at the least.
_NORMAL = {
    "end": 1.1,
    "one_step": 0.45,
    "two_step": 0.95,
}
_MOVED = 50.0  # degrees for 1 m/s of the hips where they shall stand
_SAME, _HERE = 0.02, 1e-4  # degrees and metres: what a file rounds


def files_in(folder: Path) -> list[Path]:
    """The motion files in a folder and those under it, in the order of their names."""
    return sorted(path for path in folder.rglob("*") if path.suffix.lower() in MOTION_FILES and path.is_file())


def gather(
    files: Sequence[Path], skeleton: Skeleton, standing: Pose, fallback: Library | None = None
) -> tuple[Library, Report]:
    """A library for one human from motion files, and what became of them.

    Each clip is cut by what its feet do and binned by where it goes, whatever its file is called. Of several for one
    key that one serves which has to be corrected least and jumps least. Starts and ends, the fallback's too, are fitted
    to the straight step that serves.

    Args:
        files: BVH, AMC or C3D files, or clips.
        skeleton: the human's measures.
        standing: the pose in which the human's walks begin and end, heading 0, the hips over the origin.
        fallback: whose clips fill what the captures leave empty.

    Raises:
        DataError: there is no straight step, neither in the files nor in the fallback.
    """
    found, unused, unread = _read(files, skeleton, standing)
    straights = [one for one in found if one.clip.key == STRAIGHT]
    best = _best_straight(straights)
    given = _scaled(fallback, float(standing.root[2])) if fallback is not None else {}
    if best is None and STRAIGHT not in given:
        where = files[0].parent if files else Path()
        raise DataError(
            where, "", "no straight step in these files: a step of steady walking with one before and after it"
        )
    straight = closed(skeleton, best.clip) if best is not None else given[STRAIGHT]
    clips = {STRAIGHT: straight}
    filled = [] if best is None else [_filled(best, straight, closing(best.clip))]
    for key, (cut, clip, spare) in _chosen(found, skeleton, straight, standing, given).items():
        clips[key] = clip
        unused += [Unused(c.file, c.first, c.last, f"another {key.name}") for c in spare]
        filled.append(_filled(cut, clip, _correction(cut.clip, *wanted_ends(key, straight, standing))))
    unused += _spare_steps(straights, best)
    taken = {one.key for one in filled}
    rest = [key for key in (*TABLE, *MIXED) if key not in taken]
    for key in rest:
        if key in given and key != STRAIGHT:
            clips[key] = _fitted(skeleton, given[key], straight, standing)
    report = Report(
        filled=tuple(sorted(filled, key=lambda one: one.key)),
        fallback=tuple(key for key in rest if key in clips),
        missing=tuple(key for key in rest if key not in clips),
        unused=tuple(sorted(unused, key=lambda one: (one.file, one.first, one.last))),
        unread=tuple(unread),
    )
    return Library(skeleton.name, float(standing.root[2]), clips), report


def _read(files: Iterable[Path], skeleton: Skeleton, standing: Pose) -> tuple[list[Cut], list[Unused], list[str]]:
    """What is in the files; one that can't be read does not stop the others."""
    found: list[Cut] = []
    unused: list[Unused] = []
    unread: list[str] = []
    for path in files:
        try:
            recording = read(path, skeleton)
        except DataError as error:
            unread.append(str(error))
            continue
        for one in cuts(recording, skeleton, standing):
            if isinstance(one, Cut):
                found.append(one)
            else:
                unused.append(one)
    return found, unused, unread


def _best_straight(straights: Sequence[Cut]) -> Cut | None:
    """Of the steps that are about as long as usual in way and time the one that is nearest to closed."""
    if not straights:
        return None
    lengths, times = (
        np.array(values) for values in zip(*((length_of(c.clip), c.clip.frames) for c in straights), strict=True)
    )
    usual = (np.abs(lengths / np.median(lengths) - 1.0) < _USUAL) & (np.abs(times / np.median(times) - 1.0) < _USUAL)
    candidates = [cut for cut, fits in zip(straights, usual, strict=True) if fits] or list(straights)
    return min(candidates, key=lambda cut: closing(cut.clip) + _faults(cut.clip, cut.clip))


def _chosen(
    found: Sequence[Cut], skeleton: Skeleton, straight: WalkClip, standing: Pose, given: dict[Key, WalkClip]
) -> dict[Key, tuple[Cut, WalkClip, list[Cut]]]:
    """For each key the cut that serves it best, fitted, and the others."""
    tried: dict[Key, list[tuple[float, Cut, WalkClip]]] = {}
    for cut in found:
        if cut.clip.key != STRAIGHT:
            cut = _with_stride(cut, given, float(standing.root[2]))
            clip = _fitted(skeleton, cut.clip, straight, standing)
            cost = _correction(cut.clip, *wanted_ends(clip.key, straight, standing)) + _faults(cut.clip, clip)
            tried.setdefault(clip.key, []).append((cost, cut, clip))
    out: dict[Key, tuple[Cut, WalkClip, list[Cut]]] = {}
    for key, several in tried.items():
        (_, cut, clip), *rest = sorted(several, key=lambda one: one[0])
        spare: list[Cut] = []
        for _, other, _ in rest:
            if not any(other.file == c.file and other.first <= c.last and c.first <= other.last for c in (cut, *spare)):
                spare.append(other)
        out[key] = cut, clip, spare
    return out


def _correction(clip: WalkClip, first: Pose, last: Pose) -> float:
    """By how much a clip's joints must be turned at its ends, degrees."""
    return float(np.hypot(unlike(clip.rotations[0], first.rotations), unlike(clip.rotations[-1], last.rotations)))


def _faults(cut: WalkClip, fitted: WalkClip) -> float:
    """What else speaks against a clip, as if degrees of correction: joints that jump, standing that moves."""
    stands = {"start": [0], "end": [-2], "one_step": [0, -2], "two_step": [0, -2], "straight": []}[cut.key.kind]
    moved = sum(float(np.linalg.norm(cut.root[k + 1] - cut.root[k])) * RATE for k in stands)
    return worst_pop(fitted.rotations).degrees + _MOVED * moved


def _with_stride(cut: Cut, given: dict[Key, WalkClip], hip_height: float) -> Cut:
    """The cut with the stride that its length tells: the nearer one's of the fallback's two, if it has both."""
    key = cut.clip.key
    if key.kind == "start":
        return cut
    length = length_of(cut.clip)
    normal, small = (given.get(replace(key, stride=stride)) for stride in ("normal", "small"))
    border = _NORMAL[key.kind] * hip_height
    if normal is not None and small is not None:
        border = 0.5 * (length_of(normal) + length_of(small))
    stride: Stride = "normal" if length > border else "small"
    return replace(cut, clip=replace(cut.clip, key=replace(key, stride=stride)))


def _fitted(skeleton: Skeleton, clip: WalkClip, straight: WalkClip, standing: Pose) -> WalkClip:
    """A clip that joins standing and the straight step, its feet standing; one that does already stays as it is."""
    first, last = wanted_ends(clip.key, straight, standing)
    fitted = fit_ends(clip, first, last)
    if _correction(clip, first, last) < _SAME and np.abs(fitted.root - clip.root).max() < _HERE:
        return clip
    return replanted(skeleton, clip, fit_speeds(fitted, *wanted_speeds(clip.key, straight)))


def _scaled(library: Library, hip_height: float) -> dict[Key, WalkClip]:
    """A library's clips for a human of another height."""
    scale = hip_height / library.hip_height
    return {key: replace(clip, root=scale * clip.root) for key, clip in library.clips.items()}


def _filled(cut: Cut, clip: WalkClip, corrected: float) -> Filled:
    return Filled(
        clip.key, cut.file, cut.first / RATE, cut.last / RATE, cut.mirrored, cut.direction, cut.facing, length_of(clip),
        corrected,
    )  # fmt: skip


def _spare_steps(straights: Sequence[Cut], best: Cut | None) -> list[Unused]:
    """The straight steps that were not taken, file by file."""
    out: list[Unused] = []
    for file in sorted({cut.file for cut in straights}):
        spare = [cut for cut in straights if cut.file == file and cut is not best]
        if spare:
            what = f"{len(spare)} more straight steps" if len(spare) > 1 else "another straight step"
            out.append(Unused(file, min(cut.first for cut in spare), max(cut.last for cut in spare), what))
    return out
