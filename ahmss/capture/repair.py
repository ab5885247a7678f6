"""What a take lacks is filled and stays marked; where a sensor jumps is found and said, and mended only when asked."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.quaternion import conjugate, from_rotation_vector, multiply, to_rotation_vector
from ahmss.capture.stations import TRACKED
from ahmss.capture.take import Take
from ahmss.errors import DataError
from ahmss.motion.contact import runs
from ahmss.motion.resample import continuous

__all__ = ["Gap", "Jump", "fill", "gaps", "jumps", "mend"]

_SPEED = 0.05  # seconds before and after a gap from which the speed there is taken
_GOES_ON = 0.4  # seconds; over a longer gap the speed at its ends goes on only so long
_SUDDEN = 500.0  # rad/s2; sensors on real walkers, unfiltered at 30 Hz, reach 540 where a heel strikes
_TOGETHER = 0.1  # seconds; sudden turns so near each other are one jump
_APART = 15.0  # degrees from the smooth way across it that make a sudden turn a jump; a heel strike measures 6


@dataclass(frozen=True)
class Gap:
    """A stretch in which a sensor gave nothing: its link, the first frame and the one after the last."""

    link: str
    first: int
    end: int


@dataclass(frozen=True)
class Jump:
    """A stretch in which a sensor turns as no body does, by `degrees` away from the smooth way across it."""

    link: str
    first: int
    end: int
    degrees: float


def gaps(take: Take) -> list[Gap]:
    """All drop-outs, sensor by sensor, what is damaged or implausible included."""
    missing = take.missing
    return [Gap(link, first, end) for i, link in enumerate(TRACKED) for first, end in runs(missing[:, i])]


def fill(take: Take) -> Take:
    """The take with its drop-outs filled; its status goes on to mark them.

    Across a gap a sensor goes on with the speed that it has at the ends, by a cubic; before the first and after the
    last reading it rests.

    Raises:
        DataError: a sensor gave nothing in the whole take.
    """
    missing = take.missing
    empty = [link for i, link in enumerate(TRACKED) if missing[:, i].all()]
    if empty:
        raise DataError(
            "take", ", ".join(empty), "nothing came from there in the whole take; see that the sensor is plugged in "
            "and that [stations] of the tracker's configuration names its number"
        )  # fmt: skip
    return _bridged(take, ((TRACKED.index(gap.link), gap.first, gap.end) for gap in gaps(take)), missing)


def jumps(take: Take) -> list[Jump]:
    """Where sensors turn as no body does, in a take without drop-outs or with them filled."""
    turned = to_rotation_vector(multiply(conjugate(take.rotations[:-1]), take.rotations[1:]))
    sudden = np.zeros((take.frames, len(TRACKED)), bool)
    sudden[1:-1] = np.linalg.norm(np.diff(turned, axis=0), axis=-1) * take.rate**2 > _SUDDEN
    return [jump for sensor in range(len(TRACKED)) for jump in _jumps_of(take, sensor, sudden[:, sensor])]


def mend(take: Take, found: Iterable[Jump]) -> Take:
    """The take with a smooth way across each jump."""
    places = [(TRACKED.index(jump.link), jump.first, jump.end) for jump in found]
    bad = np.zeros(take.status.shape, bool)
    for sensor, first, end in places:
        bad[first:end, sensor] = True
    return _bridged(take, places, bad)


def _jumps_of(take: Take, sensor: int, sudden: NDArray[np.bool_]) -> Iterator[Jump]:
    """The jumps of one sensor among its sudden turns (F,)."""
    near = max(round(_TOGETHER * take.rate), 1)
    stretches: list[list[int]] = []
    for first, end in runs(sudden):
        if stretches and first - stretches[-1][1] <= near:
            stretches[-1][1] = end
        else:
            stretches.append([first, end])
    for first, end in stretches:
        bad = np.zeros(take.status.shape, bool)
        bad[first:end, sensor] = True
        smooth = _bridged(take, [(sensor, first, end)], bad)
        apart = multiply(conjugate(smooth.rotations[first:end, sensor]), take.rotations[first:end, sensor])
        degrees = float(np.degrees(np.linalg.norm(to_rotation_vector(apart), axis=-1).max()))
        if degrees > _APART:
            yield Jump(TRACKED[sensor], first, end, degrees)


def _bridged(take: Take, places: Iterable[tuple[int, int, int]], bad: NDArray[np.bool_]) -> Take:
    """The take with a smooth way across each place: a sensor, the first frame and the one after the last."""
    rotations, positions = continuous(take.rotations), take.positions.copy()
    few = max(round(_SPEED * take.rate), 1)
    for sensor, first, end in places:
        before, after = first - 1, end
        if before < 0 or after >= take.frames:
            known = after if before < 0 else before
            rotations[first:end, sensor], positions[first:end, sensor] = (
                rotations[known, sensor],
                positions[known, sensor],
            )
            continue
        start = _good(bad[:, sensor], range(before - 1, before - 1 - few, -1), before)
        stop = _good(bad[:, sensor], range(after + 1, after + 1 + few), after)
        long = _GOES_ON * take.rate
        rotations[first:end, sensor] = _turning(rotations[:, sensor], (start, before, after, stop), long)
        positions[first:end, sensor] = _moving(positions[:, sensor], (start, before, after, stop), long)
    return replace(take, rotations=continuous(rotations), positions=positions)


def _good(bad: NDArray[np.bool_], frames: Iterable[int], edge: int) -> int:
    """The farthest frame from a gap's edge over which its speed can be taken: the last before another gap."""
    for frame in frames:
        if not 0 <= frame < len(bad) or bad[frame]:
            break
        edge = frame
    return edge


def _moving(values: Array, frames: tuple[int, int, int, int], long: float) -> Array:
    """Values (n, ...) between `before` and `after`, with the speeds that they have from `start` and to `stop`."""
    start, before, after, stop = frames
    leaving = (values[before] - values[start]) / max(before - start, 1)
    coming = (values[stop] - values[after]) / max(stop - after, 1)
    return _cubic(values[before], values[after], leaving, coming, after - before, long)


def _turning(rotations: Array, frames: tuple[int, int, int, int], long: float) -> Array:
    """The same of rotations (frames, 4), as rotation vectors seen from the last known one."""
    start, before, after, stop = frames
    seen = to_rotation_vector(multiply(conjugate(rotations[before]), rotations[[start, before, after, stop]]))
    leaving = (seen[1] - seen[0]) / max(before - start, 1)
    coming = (seen[3] - seen[2]) / max(stop - after, 1)
    way = _cubic(seen[1], seen[2], leaving, coming, after - before, long)
    return multiply(rotations[before], from_rotation_vector(way))


def _cubic(start: Array, goal: Array, leaving: Array, coming: Array, steps: int, long: float) -> Array:
    """Hermite's cubic (steps - 1, ...) between two values, with speeds a frame at its ends."""
    t = (np.arange(1, steps) / steps).reshape(-1, *[1] * start.ndim)
    reach = min(float(steps), long)
    return (
        start + (3.0 - 2.0 * t) * t * t * (goal - start)
        + reach * t * (1.0 - t) * ((1.0 - t) * leaving - t * coming)
    )  # fmt: skip
