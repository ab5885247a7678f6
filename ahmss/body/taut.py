"""A taut string through a corridor of intervals, one a frame: the way that changes least, and most evenly.

The intervals are what is left of arcs on a circle, when from one frame to the next only so much may change.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ahmss.body.array import Array

__all__ = ["Gate", "corridor", "taut_string"]

Gate = tuple[float, float]
"""The lowest and the highest value that a frame allows."""

_TURN = 2.0 * math.pi
_INSIDE = 1e-10  # radians by which the string keeps off an arc's end, so that rounding keeps it on the arc
_WHOLE = 1e-9  # radians: an arc that lacks less of the circle is the circle


def corridor(arcs: Array, start: float, steps: Sequence[float]) -> list[Gate]:
    """The gates (F) or fewer, up to the last frame that can be reached from the start by such steps.

    Values are not wrapped: who goes round goes over pi. From every value in a gate one within a step lies in the gate
    before and one in the gate after it. Where the way parts, that branch is taken whose end lies nearest to the start.

    Args:
        arcs: (F, n, 2) radians, beginnings and ends of what each frame allows; nan where there are fewer than n.
        start: the value before the first frame.
        steps: (F,) the most that a value changes from the frame before to each, up to a whole turn.
    """
    reached: list[list[Gate]] = []
    before: list[Gate] = [(start, start)]
    whole: list[bool] = np.any(arcs[..., 1] - arcs[..., 0] >= _TURN - _WHOLE, axis=-1).tolist()
    for frame, all_round, step in zip(arcs, whole, steps, strict=True):
        grown = _joined([(low - step, high + step) for low, high in before])
        before = [_capped(part, start) for part in grown]
        if not all_round:
            allows = frame.tolist()
            before = [gate for part in before for gate in _on_arcs(allows, part)]
        if not before:
            break
        reached.append(before)
    if not reached:
        return []
    gates = [min(reached[-1], key=lambda gate: _distance(gate, start))]
    for parts, step in zip(reversed(reached[:-1]), reversed(steps[1 : len(reached)]), strict=True):
        low, high = gates[-1][0] - step, gates[-1][1] + step
        if len(parts) > 1:
            near = [(a, b) for a, b in parts if a <= high + _INSIDE and b >= low - _INSIDE]  # rounding parts some
            leading = ((max(low, min(a, high)), min(high, max(b, low))) for a, b in near)
            gates.append(min(leading, key=lambda gate: _distance(gate, start)))
        else:
            (a, b), *_ = parts
            gates.append((max(low, min(a, high)), min(high, max(b, low))))
    gates.reverse()
    # A gate that two branches led to is reached from the one that was taken only in part.
    previous = (start, start)
    for i, ((low, high), step) in enumerate(zip(gates, steps, strict=False)):
        previous = gates[i] = (max(low, previous[0] - step), min(high, previous[1] + step))
    return gates


def taut_string(gates: Sequence[Gate], start: float, paces: Sequence[float]) -> Array:
    """The values (F,) through gates (F) of a string that is fast at the start and free at the end.

    Of all ways through the gates it has the least sum of squared steps over paces, and the smallest largest step in
    proportion to its pace.

    Args:
        gates: what each frame allows.
        start: the value before the first.
        paces: (F,) > 0, how long the time from the frame before to each counts: where it is short, steps are small.
    """
    n = len(gates)
    time = np.concatenate([[0.0], np.cumsum(paces)])
    out, times = np.empty(n), time.tolist()
    at, value = 0, start  # the string's last bend: a count of gates passed, and its value there
    while at < n:
        bend, there = _next_bend(gates, times, at, value)
        share = (time[at + 1 : bend + 1] - time[at]) / (time[bend] - time[at])
        out[at:bend] = value + share * (there - value)
        at, value = bend, there
    return out


def _next_bend(gates: Sequence[Gate], time: Sequence[float], at: int, value: float) -> tuple[int, float]:
    """Where the string that bends at a place bends next; the end of the last level piece is one too."""
    least, most = -math.inf, math.inf  # the slopes that pass all gates so far
    least_at = most_at = at
    began = time[at]
    for j in range(at + 1, len(gates) + 1):
        away, (low, high) = time[j] - began, gates[j - 1]
        low, high = (low - value) / away, (high - value) / away
        if low > most:
            return most_at, gates[most_at - 1][1]
        if high < least:
            return least_at, gates[least_at - 1][0]
        if low >= least:
            least, least_at = low, j
        if high <= most:
            most, most_at = high, j
    if least > 0.0:
        return least_at, gates[least_at - 1][0]
    if most < 0.0:
        return most_at, gates[most_at - 1][1]
    return len(gates), value


def _on_arcs(arcs: list[list[float]], part: Gate) -> list[Gate]:
    """What arcs on the circle, none of them all round, have in common with an interval of the line, in rising order."""
    low, high = part
    found: list[Gate] = []
    for begin, end in arcs:
        if math.isnan(begin):
            break
        inset = min(_INSIDE, 0.5 * (end - begin))
        first, last = math.ceil((low - end) / _TURN), math.floor((high - begin) / _TURN)
        for turns in range(first, last + 1):
            a, b = max(low, begin + inset + turns * _TURN), min(high, end - inset + turns * _TURN)
            if a <= b:
                found.append((a, b))
    return sorted(found)


def _joined(parts: list[Gate]) -> list[Gate]:
    """Intervals in rising order, those that touch made one."""
    if len(parts) == 1:
        return parts
    out = [parts[0]]
    for low, high in parts[1:]:
        if low <= out[-1][1]:
            out[-1] = (out[-1][0], max(out[-1][1], high))
        else:
            out.append((low, high))
    return out


def _capped(part: Gate, start: float) -> Gate:
    """No more than a turn from the start: beyond it everything comes again."""
    return max(part[0], start - _TURN), min(part[1], start + _TURN)


def _distance(gate: Gate, value: float) -> float:
    return max(gate[0] - value, value - gate[1], 0.0)
