"""Which clips a walk takes, how many straight steps, and by how much each is shrunk (Ichiguchi 2000, A.3.1).

Where the text leaves room:

* Both of two clips may be within 15 degrees; the one of the smaller angle is taken.
* Item 2 takes the normal stride when its ratio is greater than the limit and the small one when it is smaller. At the
  limit itself the small one is tried.
* "One more straight" is said once; item 3 calls the number one at which the small stride's ratio is not above 1. So it
  is repeated where once isn't enough: where an end is longer than a straight and a small end together.
* Straights are counted up until the walk is longer than the distance (literally: not if it is just as long).
* A.12 and A.13 never exceed 1, since the walk that they shrink is longer than the distance, or as long (A.13). They may
  be 0 or less where start and end together are shorter than a straight, which a library should not have. Then there is
  one straight fewer, and start and end are stretched: the only ratios above 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Literal

from ahmss.walking.catalogue import BIN, MIXED, SIDES, STRAIGHT, STRIDES, TABLE, Key, Side, Stride

__all__ = [
    "Candidates",
    "Lengths",
    "Pattern",
    "Selection",
    "bins",
    "candidates",
    "measured",
    "select",
    "side_at",
    "stored",
]

Pattern = Literal["1Step", "2Step", "2Parts", "3Parts"]

_KNOWN = frozenset((*TABLE, *MIXED))


@dataclass(frozen=True)
class Candidates:
    """The keys to choose among for one direction and facing; an end's facing may be negative: see `stored`."""

    first: Key
    straight: Key
    last: Mapping[tuple[Stride, Side], Key]
    one: Mapping[Stride, Key]
    two: Mapping[Stride, Key]


@dataclass(frozen=True)
class Lengths:
    """How far each candidate gets, metres, all greater than 0."""

    first: float
    straight: float
    last: Mapping[tuple[Stride, Side], float]  # by stride and by the foot that is put beside the other at last
    one: Mapping[Stride, float]
    two: Mapping[Stride, float]


@dataclass(frozen=True)
class Selection:
    """What a walk is made of.

    stride: of the one clip (1Step, 2Step) or of the end. steps: straights, 0 but for 3Parts. last: of the end clip, the
    foot that is put beside the other; right where `steps` is even. start_ratio, end_ratio: by which lengths are
    multiplied, the same for both but where A.11 holds; straights keep theirs.
    """

    pattern: Pattern
    stride: Stride
    steps: int
    last: Side
    start_ratio: float
    end_ratio: float


def bins(direction: float, facing: float) -> tuple[int, int, bool]:
    """The clips' direction and facing for those asked for, in degrees, and whether the walk is their mirror image.

    Args:
        direction: of the way against the heading at the start; positive to the left, any angle.
        facing: the last heading against the way.

    Returns:
        direction 0 to 180; facing, -150 to 180, negative only where the direction is neither 0 nor 180; mirrored: where
        the direction is negative, or is 0 or 180 and the facing is negative. A way straight back is 180 or -180; if its
        own mirror image serves as well (facing 0), it is turned to on the side where it is nearer.
    """
    direction, facing = _wrapped(direction), _wrapped(facing)
    d, f = _binned(direction), _binned(facing)
    if d in (-180, 0, 180):
        mirrored = f < 0 or (f == 0 and d == -180)
        return abs(d), abs(f), mirrored
    mirrored = d < 0
    return abs(d), _one_half_turn(-f if mirrored else f), mirrored


def candidates(direction: int, facing: int) -> Candidates:
    """The keys for a direction and a facing as `bins` gives them."""
    return Candidates(
        first=Key("start", direction),
        straight=STRAIGHT,
        last={(stride, last): Key("end", 0, facing, stride, last) for stride in STRIDES for last in SIDES},
        one={stride: Key("one_step", direction, facing, stride) for stride in STRIDES},
        two={stride: Key("two_step", direction, facing, stride) for stride in STRIDES},
    )


def stored(key: Key) -> tuple[Key, bool]:
    """The key under which a library has a clip, and whether the clip must be mirrored to become `key`'s.

    An end with a negative facing is the mirror image of the end with the positive one that closes with the other foot.
    A start to the right is that of the one to the left.

    Raises:
        ValueError: the table has neither the key nor its mirror image.
    """
    key = _whole(key)
    if key in _KNOWN:
        return key, False
    mirrored = _whole(key.mirrored)
    if mirrored in _KNOWN:
        return mirrored, True
    raise ValueError(f"no clip of a walk is called {key.name}")


def measured(keys: Candidates, how_far: Callable[[Key], float]) -> Lengths:
    """The candidates' lengths; `how_far` is asked for keys as the library has them."""

    def of(key: Key) -> float:
        return how_far(stored(key)[0])

    return Lengths(
        first=of(keys.first),
        straight=of(keys.straight),
        last={which: of(key) for which, key in keys.last.items()},
        one={stride: of(key) for stride, key in keys.one.items()},
        two={stride: of(key) for stride, key in keys.two.items()},
    )


def side_at(steps: int) -> Side:
    """The `last` of the end that follows so many straights after a start with the left foot."""
    return "right" if steps % 2 == 0 else "left"


def select(lengths: Lengths, distance: float, limit: float = 0.8) -> Selection:
    """Choose pattern, stride, number of straights and ratios for a distance (A.8 to A.13).

    Args:
        lengths: of the candidates for the direction and the facing.
        distance: to the goal (Len), metres.
        limit: the ratio of an end under which it looks unnatural (R_limit).

    Raises:
        ValueError: a length, the distance or the limit is not a positive number.
    """
    _check(lengths, distance, limit)
    first, last = lengths.first, lengths.last
    if first + last["normal", "right"] < distance:  # (A.8)
        return _three_parts(lengths, distance, limit)
    if lengths.two["normal"] < distance:  # (A.9)
        stride: Stride = "normal" if first + last["small", "right"] < distance else "small"
        ratio = distance / (first + last[stride, "right"])
        return Selection("2Parts", stride, 0, "right", ratio, ratio)
    if lengths.one["normal"] < distance:  # (A.10)
        return _whole_clip("2Step", lengths.two, distance)
    return _whole_clip("1Step", lengths.one, distance)


def _whole_clip(pattern: Pattern, lengths: Mapping[Stride, float], distance: float) -> Selection:
    stride: Stride = "normal" if lengths["small"] < distance else "small"
    ratio = distance / lengths[stride]
    return Selection(pattern, stride, 0, "right", ratio, ratio)


def _three_parts(lengths: Lengths, distance: float, limit: float) -> Selection:
    """Items 1 to 3 of the pattern 3Parts."""
    Len, Len_First, Len_M = distance, lengths.first, lengths.straight

    def ending(stride: Stride, num: int) -> float:
        return lengths.last[stride, side_at(num)]

    def ratio(stride: Stride, num: int) -> float:  # (A.11)
        return (Len - Len_First - Len_M * num) / ending(stride, num)

    def ratio_of_both(stride: Stride, num: int) -> float:  # (A.12) normal, (A.13) small
        return (Len - Len_M * num) / (Len_First + ending(stride, num))

    def surely_short(stride: Stride) -> int:  # a number of straights that is not yet enough, near the one that is
        longest = max(ending(stride, 0), ending(stride, 1))
        return math.floor((Len - Len_First - longest) / Len_M) - 1

    Num = max(1, surely_short("normal"))
    while Len_First + Len_M * Num + ending("normal", Num) <= Len:
        Num += 1
    if ratio("normal", Num) > limit:
        return Selection("3Parts", "normal", Num, side_at(Num), 1.0, ratio("normal", Num))

    Num2 = Num
    if ratio("small", Num2) > 1.0:
        Num2 = max(Num + 1, surely_short("small"))
        while ratio("small", Num2) > 1.0:
            Num2 += 1
    if limit <= ratio("small", Num2) <= 1.0:
        return Selection("3Parts", "small", Num2, side_at(Num2), 1.0, ratio("small", Num2))

    ratio1, ratio2 = ratio_of_both("normal", Num), ratio_of_both("small", Num2)
    if max(ratio1, ratio2) <= 0.0:
        stretched = ratio_of_both("normal", Num - 1)
        return Selection("3Parts" if Num > 1 else "2Parts", "normal", Num - 1, side_at(Num - 1), stretched, stretched)
    if ratio1 > ratio2:
        return Selection("3Parts", "normal", Num, side_at(Num), ratio1, ratio1)
    return Selection("3Parts", "small", Num2, side_at(Num2), ratio2, ratio2)


def _check(lengths: Lengths, distance: float, limit: float) -> None:
    named = {"first": lengths.first, "straight": lengths.straight, "distance": distance, "limit": limit}
    named |= {f"last {stride} {side}": length for (stride, side), length in lengths.last.items()}
    named |= {f"one {stride}": length for stride, length in lengths.one.items()}
    named |= {f"two {stride}": length for stride, length in lengths.two.items()}
    for name, value in named.items():
        if not (math.isfinite(value) and value > 0.0):
            raise ValueError(f"{name}: {value}; it must be a number greater than 0")


def _wrapped(angle: float) -> float:
    """The angle in degrees, greater than -180 and up to 180."""
    return 180.0 - (180.0 - angle) % 360.0


def _binned(angle: float) -> int:
    """The nearest multiple of 30 degrees, of two the smaller; its sign as the angle's, so -180 is possible."""
    return int(math.copysign(BIN * math.ceil(abs(angle) / BIN - 0.5), angle))


def _one_half_turn(angle: int) -> int:
    return 180 if angle == -180 else angle


def _whole(key: Key) -> Key:
    return replace(key, direction=_one_half_turn(key.direction), facing=_one_half_turn(key.facing))
