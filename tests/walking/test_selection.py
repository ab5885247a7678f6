"""Clips are chosen as A.8 to A.13 say, borders included; what is nominal adds up to the distance."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from ahmss.walking.catalogue import MIXED, STRAIGHT, TABLE, Key
from ahmss.walking.selection import Lengths, Selection, bins, candidates, measured, select, side_at, stored

# All are sums of powers of two, so that borders are met exactly.
#   first + last normal right = 2.25      first + last small right = 1.75
#   totals with the normal end: 1 straight (left) 2.875, 2 (right) 3.75, 3 (left) 4.375, 4 (right) 5.25
LENGTHS = Lengths(
    first=1.0,
    straight=0.75,
    last={("normal", "right"): 1.25, ("normal", "left"): 1.125, ("small", "right"): 0.75, ("small", "left"): 0.6875},
    one={"normal": 0.625, "small": 0.3125},
    two={"normal": 1.25, "small": 0.75},
)


def with_ends(normal_right: float, normal_left: float, small_right: float, small_left: float, **changes) -> Lengths:
    last = {
        ("normal", "right"): normal_right, ("normal", "left"): normal_left,
        ("small", "right"): small_right, ("small", "left"): small_left,
    }  # fmt: skip
    return replace(LENGTHS, last=last, **changes)


def nominal(lengths: Lengths, chosen: Selection) -> float:
    """How far the chosen clips get, shrunk as said."""
    if chosen.pattern == "1Step":
        return lengths.one[chosen.stride] * chosen.start_ratio
    if chosen.pattern == "2Step":
        return lengths.two[chosen.stride] * chosen.start_ratio
    end = lengths.last[chosen.stride, chosen.last] * chosen.end_ratio
    return lengths.first * chosen.start_ratio + lengths.straight * chosen.steps + end


def expect(distance, pattern, stride, steps, last, start, end, lengths=LENGTHS, limit=0.8):
    chosen = select(lengths, distance, limit)
    assert (chosen.pattern, chosen.stride, chosen.steps, chosen.last) == (pattern, stride, steps, last)
    assert chosen.start_ratio == pytest.approx(start, abs=1e-12)
    assert chosen.end_ratio == pytest.approx(end, abs=1e-12)
    assert nominal(lengths, chosen) == pytest.approx(distance, abs=1e-12)


@pytest.mark.parametrize(
    ("distance", "pattern", "stride", "ratio"),
    [
        (0.05, "1Step", "small", 0.16),  # 0.05 / 0.3125
        (0.3125, "1Step", "small", 1.0),  # not 0.3125 < Len
        (0.32, "1Step", "normal", 0.512),  # 0.32 / 0.625
        (0.625, "1Step", "normal", 1.0),  # A.10: not 0.625 < Len
        (0.63, "2Step", "small", 0.84),  # 0.63 / 0.75
        (0.75, "2Step", "small", 1.0),  # not 0.75 < Len
        (0.76, "2Step", "normal", 0.608),  # 0.76 / 1.25
        (1.25, "2Step", "normal", 1.0),  # A.10: Len <= 1.25; A.9: not 1.25 < Len
        (1.26, "2Parts", "small", 0.72),  # 1.26 / (1 + 0.75)
        (1.75, "2Parts", "small", 1.0),  # not 1 + 0.75 < Len
        (1.8, "2Parts", "normal", 0.8),  # 1.8 / (1 + 1.25)
        (2.25, "2Parts", "normal", 1.0),  # A.9: Len <= 2.25; A.8: not 2.25 < Len
    ],
)
def test_short_distances(distance, pattern, stride, ratio):
    expect(distance, pattern, stride, 0, "right", ratio, ratio)


def test_just_over_the_border_of_start_and_end_there_is_a_straight():
    # A.8: 2.25 < 2.26. 1 straight: 2.875 > 2.26. A.11 (2.26 - 1 - 0.75) / 1.125 = 0.4533; small, left: 0.51 / 0.6875 =
    # 0.7418 < 0.8. A.12 (2.26 - 0.75) / 2.125 = 0.7106; A.13, 1 straight: 1.51 / 1.6875 = 0.8948.
    expect(2.26, "3Parts", "small", 1, "left", 1.51 / 1.6875, 1.51 / 1.6875)


def test_a_walk_of_three_parts_is_adjusted_at_its_end():
    # 1 straight: 2.875 > 2.75. A.11 (2.75 - 1 - 0.75) / 1.125 = 0.8889 > 0.8.
    expect(2.75, "3Parts", "normal", 1, "left", 1.0, 1.0 / 1.125)
    # 1: 2.875 <= 3.625; 2: 3.75 > 3.625. A.11 (3.625 - 1 - 1.5) / 1.25 = 0.9.
    expect(3.625, "3Parts", "normal", 2, "right", 1.0, 0.9)
    # 3: 4.375 <= 5.2; 4: 5.25 > 5.2. (5.2 - 1 - 3) / 1.25 = 0.96.
    expect(5.2, "3Parts", "normal", 4, "right", 1.0, 0.96)


def test_the_small_end_where_the_normal_one_would_shrink_too_much():
    # 2 straights. A.11 (3.2 - 2.5) / 1.25 = 0.56 < 0.8; small: 0.7 / 0.75 = 0.9333.
    expect(3.2, "3Parts", "small", 2, "right", 1.0, 0.7 / 0.75)
    # 3: 4.375 > 3.875 >= 3.75. (3.875 - 1 - 2.25) / 1.125 = 0.5556; small, left: 0.625 / 0.6875 = 0.9091.
    expect(3.875, "3Parts", "small", 3, "left", 1.0, 0.625 / 0.6875)


def test_borders_of_the_ratio():
    # 2 straights: (3.5 - 2.5) / 1.25 = 0.8, not greater than 0.8. Small: 1 / 0.75 = 1.33 > 1, so 3, left:
    # (3.5 - 3.25) / 0.6875 = 0.3636. A.12 (3.5 - 1.5) / 2.25 = 0.8889; A.13 (3.5 - 2.25) / 1.6875 = 0.7407.
    expect(3.5, "3Parts", "normal", 2, "right", 2.0 / 2.25, 2.0 / 2.25)
    expect(3.5, "3Parts", "normal", 2, "right", 1.0, 0.8, limit=0.79)
    # 2 straights, normal 0.75 / 1.25 = 0.6; small 0.75 / 0.75 = 1 <= 1.
    expect(3.25, "3Parts", "small", 2, "right", 1.0, 1.0)
    # A total of just the distance is not over it: 1: 2.875. 2: 0.375 / 1.25 = 0.3; small 0.375 / 0.75 = 0.5 >= 0.5.
    expect(2.875, "3Parts", "small", 2, "right", 1.0, 0.5, limit=0.5)
    # The same with 0.8: A.12 (2.875 - 1.5) / 2.25 = 0.6111; A.13 1.375 / 1.75 = 0.7857.
    expect(2.875, "3Parts", "small", 2, "right", 1.375 / 1.75, 1.375 / 1.75)


def test_one_more_straight_changes_the_feet():
    # 1 (left): 1 + 0.5 + 1.25 = 2.75 > 2.45. (2.45 - 1.5) / 1.25 = 0.76; small, left: 0.95 / 0.625 = 1.52 > 1. So 2,
    # small, right: (2.45 - 2) / 0.5 = 0.9. (With the left end's length it would be 0.72 and refused.)
    lengths = with_ends(1.25, 1.25, 0.5, 0.625, straight=0.5)
    expect(2.45, "3Parts", "small", 2, "right", 1.0, 0.9, lengths)


def test_straights_are_added_until_the_small_end_is_not_stretched():
    # 1: 1 + 0.25 + 1.3 = 2.55 > 2.49. 1.24 / 1.3 = 0.954 < 0.96. Small: 2.48; 2: 0.99 / 0.5 = 1.98; 3: 1.48; 4: 0.98.
    lengths = with_ends(1.3, 1.3, 0.5, 0.5, straight=0.25)
    expect(2.49, "3Parts", "small", 4, "right", 1.0, 0.98, lengths, limit=0.96)


def test_the_small_end_with_one_more_straight_shrunk_with_the_start():
    # 1: 1 + 0.75 + 1.5 = 3.25 > 2.85. 1.1 / 1.5 = 0.733; small 1.1 / 0.5 = 2.2; 2: 0.35 / 0.5 = 0.7 < 0.8.
    # A.12, 1 straight: (2.85 - 0.75) / 2.5 = 0.84; A.13, 2 straights: (2.85 - 1.5) / 1.5 = 0.9.
    lengths = with_ends(1.5, 1.5, 0.5, 0.5)
    expect(2.85, "3Parts", "small", 2, "right", 0.9, 0.9, lengths)


def test_of_equal_ratios_the_small_end():
    # 1: 3 > 2.5. 0.75 / 1.25 = 0.6 for both strides; A.12 = A.13 = (2.5 - 0.75) / 2.25 = 0.7778.
    expect(2.5, "3Parts", "small", 1, "left", 1.75 / 2.25, 1.75 / 2.25, with_ends(1.25, 1.25, 1.25, 1.25))


def test_where_no_shrinking_serves_start_and_end_are_stretched():
    lengths = with_ends(0.125, 0.125, 0.125, 0.125, first=0.125, straight=1.0)
    # 1: 1.25 > 0.5. A.12 (0.5 - 1) / 0.25 < 0. Without a straight 0.5 / 0.25 = 2.
    expect(0.5, "2Parts", "normal", 0, "right", 2.0, 2.0, lengths)
    # 2: 2.25 > 1.5. A.12 (1.5 - 2) / 0.25 < 0. With 1 straight (1.5 - 1) / 0.25 = 2.
    expect(1.5, "3Parts", "normal", 1, "left", 2.0, 2.0, lengths)


def test_a_hundred_metres():
    # 130 (right): 1 + 97.5 + 1.25 = 99.75 <= 100; 131 (left): 1 + 98.25 + 1.125 = 100.375 > 100.
    # A.11 (100 - 99.25) / 1.125 = 0.667; small: 0.75 / 0.6875 = 1.09 > 1; 132, right: (100 - 100) / 0.75 = 0.
    # A.12 (100 - 98.25) / 2.125 = 0.8235; A.13 (100 - 99) / 1.75 = 0.5714.
    expect(100.0, "3Parts", "normal", 131, "left", 1.75 / 2.125, 1.75 / 2.125)


@pytest.mark.parametrize("straight", [1e-7, 1e-3])
def test_tiny_straights_end(straight):
    lengths = replace(LENGTHS, straight=straight)
    for limit in (0.1, 0.8, 0.9999999999):
        chosen = select(lengths, 1e4, limit)
        assert nominal(lengths, chosen) == pytest.approx(1e4, abs=1e-6)


@pytest.mark.parametrize(
    ("changes", "distance", "named"),
    [({"straight": 0.0}, 3.0, "straight"), ({"first": -1.0}, 3.0, "first"), ({}, 0.0, "distance"),
     ({"one": {"normal": 0.5, "small": float("nan")}}, 3.0, "one small"), ({}, float("inf"), "distance")],
)  # fmt: skip
def test_what_is_no_length_is_refused(changes, distance, named):
    with pytest.raises(ValueError, match=f"{named}: .* greater than 0"):
        select(replace(LENGTHS, **changes), distance)


_length = st.floats(0.05, 2.0)


@given(
    st.builds(
        Lengths, first=_length, straight=_length, one=st.fixed_dictionaries({"normal": _length, "small": _length}),
        two=st.fixed_dictionaries({"normal": _length, "small": _length}),
        last=st.fixed_dictionaries({(s, f): _length for s in ("normal", "small") for f in ("right", "left")}),
    ),
    st.floats(0.05, 100.0), st.floats(0.5, 0.95),
)  # fmt: skip
def test_what_is_nominal_is_the_distance_and_nothing_is_stretched(lengths, distance, limit):
    chosen = select(lengths, distance, limit)
    assert nominal(lengths, chosen) == pytest.approx(distance, abs=1e-9)
    assert chosen.start_ratio > 0.0
    assert chosen.end_ratio > 0.0
    assert chosen.last == side_at(chosen.steps)
    if chosen.pattern == "3Parts" and chosen.start_ratio == 1.0:
        assert chosen.end_ratio >= limit - 1e-12
    else:
        assert chosen.start_ratio == chosen.end_ratio
    assume(lengths.first + min(lengths.last.values()) > lengths.straight)
    assert max(chosen.start_ratio, chosen.end_ratio) <= 1.0 + 1e-12


@pytest.mark.parametrize(
    ("asked", "expected"),
    [
        ((0.0, 0.0), (0, 0, False)),
        ((14.0, 46.0), (0, 60, False)),
        ((15.0, 15.0), (0, 0, False)),  # both fit: the smaller
        ((15.1, -44.9), (30, -30, False)),
        ((-15.1, -44.9), (30, 30, True)),
        ((-40.0, 50.0), (30, -60, True)),
        ((10.0, -80.0), (0, 90, True)),
        ((-10.0, 80.0), (0, 90, False)),
        ((60.0, -170.0), (60, 180, False)),
        ((-60.0, 170.0), (60, 180, True)),
        ((-60.0, -170.0), (60, 180, True)),
        ((180.0, 30.0), (180, 30, False)),
        ((-180.0, 30.0), (180, 30, False)),
        ((-170.0, 30.0), (180, 30, False)),
        ((170.0, -30.0), (180, 30, True)),
        ((-170.0, 0.0), (180, 0, True)),
        ((170.0, 0.0), (180, 0, False)),
        ((-180.0, 0.0), (180, 0, False)),
        ((0.0, -180.0), (0, 180, False)),
        ((0.0, -179.0), (0, 180, True)),
        ((390.0, -330.0), (30, 30, False)),
    ],
)
def test_bins(asked, expected):
    assert bins(*asked) == expected


@given(st.floats(-180.0, 180.0), st.floats(-180.0, 180.0))
def test_bins_are_within_15_degrees_and_in_the_library(direction, facing):
    d, f, mirrored = bins(direction, facing)
    sign = -1.0 if mirrored else 1.0
    for asked, got in ((direction, d), (facing, f)):
        assert abs((asked - sign * got + 180.0) % 360.0 - 180.0) <= 15.0 + 1e-9
    keys = candidates(d, f)
    for key in (keys.first, *keys.one.values(), *keys.two.values()):
        assert stored(key) == (key, False)
    other = bins(-direction, -facing)
    assert other[:2] == (d, f)


def test_every_clip_of_the_library_is_found_as_it_is_and_from_its_mirror_image():
    for key in (*TABLE, *MIXED):
        assert stored(key) == (key, False)
        found, _ = stored(key.mirrored)
        assert found in (*TABLE, *MIXED)
    assert stored(Key("start", -60)) == (Key("start", 60), True)
    assert stored(Key("end", 0, -60, "small", "left")) == (Key("end", 0, 60, "small", "right"), True)
    assert stored(Key("end", 0, -180, "small", "left")) == (Key("end", 0, 180, "small", "left"), False)
    assert stored(Key("one_step", -180, -30)) == (Key("one_step", 180, 30), True)
    assert stored(Key("two_step", -30, 60)) == (Key("two_step", 30, -60), True)
    with pytest.raises(ValueError, match="one_step_45_0_normal"):
        stored(Key("one_step", 45))


def test_lengths_are_those_of_the_clips_that_serve():
    asked: list[Key] = []

    def how_far(key: Key) -> float:
        asked.append(key)
        return {"start": 1.0, "straight": 0.7, "end": 0.5 if key.last == "left" else 0.9}.get(key.kind, 0.4)

    lengths = measured(candidates(60, -30), how_far)
    assert lengths.last["normal", "right"] == 0.5  # the mirror image of one that closes with the left
    assert lengths.last["normal", "left"] == 0.9
    assert Key("start", 60) in asked
    assert STRAIGHT in asked
    assert Key("one_step", 60, -30, "small") in asked
