"""Playing a captured or composed motion (Ichiguchi 2000, 5.3.1) in the frames asked for.

The clip's hands and gaze go to their targets in the world; feet that bear weight stay where they touched down. Who
stands too far from where the motion starts for that is refused.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ahmss.algorithm import HumanTask, Transform, run
from ahmss.algorithm.haste import hurried
from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.errors import AlgorithmError
from ahmss.motion.clip import Clip
from ahmss.motion.planting import feet
from ahmss.motion.way import ways_of
from ahmss.skills.staging import Staged, face, part, stage, stands

BEARING = 0.5  # contacts above this bear weight
TOO_FAR = 0.35  # metres that a hand may be asked to go beside where the clip has it
HANDS = {0: "right", 1: "left"}


def playback(task: HumanTask) -> Iterator[Array]:
    """The clip in N frames, where N is 0 at its own pace; the first alone, so that main need not wait for the rest."""
    # The clip's first frame is where the motion starts from, so N frames more are made.
    if task.motion is None:
        raise AlgorithmError("playback needs a motion clip")
    length = hurried(task, max(1, round(task.motion.duration * task.rate)))
    clip = task.resampled(length + 1)
    assert clip is not None
    if length > 1 and stands(clip):
        yield _frames(task, part(clip, 0, 2))
        clip = part(clip, 1, clip.frames)
    yield _frames(task, clip)


def _frames(task: HumanTask, clip: Clip) -> Array:
    """All frames (F - 1, 272) of a clip but its first, each with where the human will be, for those who walk there."""
    staged = stage(task, clip)
    targets = _targets(task, staged)
    _refuse_far(task, staged, targets)
    importance = staged.clip.importance * task.parameter("importance", 1.0)
    ways = ways_of(staged.root[:, :2], 1, len(staged.root), task.rate)
    return task.block(staged.rotations[1:], staged.root[1:], importance[1:], targets[1:], ways)


def _targets(task: HumanTask, staged: Staged) -> Array:
    """The clip's targets (N + 1, 5, 8) in the world, and the feet that bear."""
    targets = np.zeros((staged.clip.frames, 5, 8))
    own_face = staged.clip.header.targets == "face"
    base = face(task, staged.rotations, staged.root) if own_face else staged.base
    if base is not None:
        for row in range(5):
            local = staged.local[:, row]
            placed = base.then(Transform.of(local)).row()
            free = ~local[:, 3:7].any(axis=1)
            targets[:, row, :7] = np.where(free[:, None] & (np.arange(7) > 2), 0.0, placed)
            targets[:, row, 7] = local[:, 7]
    if staged.planted:
        targets[:, 2:4, :7], targets[:, 2:4, 7] = staged.feet, 1.0
    else:
        _plant_steps(task, staged, targets)
    return targets


def _refuse_far(task: HumanTask, staged: Staged, targets: Array) -> None:
    """Refuse a motion whose hand would have to go far beside its own path to meet its target.

    Raises:
        AlgorithmError: says how far, and what to do.
    """
    for row, hand in HANDS.items():
        met = int(targets[:, row, 7].argmax())
        if targets[met, row, 7] < 0.9 or staged.base is None:
            continue
        palm = grips(task.human, staged.rotations[met], staged.root[met])[row, :3]
        away = float(np.linalg.norm(targets[met, row, :3] - palm))
        if away > TOO_FAR:
            raise AlgorithmError(
                f"the {hand} hand is wanted {away:.2f} m from where the motion takes it; bring the human nearer by that"
            )


def _plant_steps(task: HumanTask, staged: Staged, targets: Array) -> None:
    """Each time that a foot bears, keep it where it is on the average of that time."""
    frames = feet(task.human, staged.rotations, staged.root)
    for foot in range(2):
        bears = staged.clip.contacts[:, foot] > BEARING
        for start, end in _spans(bears):
            middle = frames[(start + end) // 2, foot]
            targets[start:end, 2 + foot, :3] = frames[start:end, foot, :3].mean(axis=0)
            targets[start:end, 2 + foot, 3:7] = middle[3:7]
            targets[start:end, 2 + foot, 7] = staged.clip.contacts[start:end, foot]


def _spans(bears: Array) -> list[tuple[int, int]]:
    """Where a row of truths is true: first frame and the one after the last."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], bears, [False]]).astype(np.int8)))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]


if __name__ == "__main__":
    run(playback)
