"""Walks to goals of every kind over an empty floor: and what is asked of each.

A grid and many more random goals are walked by `make test-long`.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from itertools import pairwise

import numpy as np
import pytest

from ahmss.body.quaternion import norm, rotate
from ahmss.walking.journey import Journey
from ahmss.walking.library import BODY
from ahmss.walking.mirroring import mirror

from . import measures as m
from .measures import HUMANS, Goal, Walk

_APART = 0.085  # metres between the middle lines of the shanks: they have 0.103 in a straight walk
_BESIDE = 0.088  # metres between the middle lines of the soles: a shoe is 0.09 wide
_LONG = 12.0  # metres from which speeds are judged: less is starting, turning and stopping for the most part


@lru_cache(maxsize=64)
def walked(goal: Goal) -> tuple[Walk, Journey]:
    return m.walked(goal)


def random_goals(count: int, seed: int, furthest: float) -> list[Goal]:
    """Goals of all distances from 5 cm, as many a decade; every fifth of those over 20 m is kept."""
    rng = np.random.default_rng(seed)
    made: list[Goal] = []
    while len(made) < count:
        distance = float(np.exp(rng.uniform(np.log(0.05), np.log(furthest))))
        start, direction, facing = rng.uniform(-180.0, 180.0, 3).tolist()
        if distance < 20.0 or rng.random() < 0.2:
            made.append(Goal(HUMANS[len(made) % 2], start, distance, direction, facing))
    return made


def arrives(walk: Walk, goal: Goal) -> str:
    place, heading = m.arrival(walk, goal.place, goal.heading)
    return f"{1e3 * place:.2f} mm and {heading:.2f} degrees off" if place > 0.01 or heading > 1.0 else ""


def arrives_on_its_feet(walk: Walk, goal: Goal) -> str:
    """The feet too: beside each other as they stand, under the hips."""
    standing = m.subject(goal.name).standing
    cos, sin = np.cos(goal.heading), np.sin(goal.heading)
    wanted = goal.place + standing.ankles @ np.array([[cos, sin], [-sin, cos]])
    away = float(np.linalg.norm(walk.places[-1, m.FEET, :2] - wanted, axis=-1).max())
    return f"a foot {1e3 * away:.1f} mm off" if away > 0.01 else ""


def begins_where_it_stands(walk: Walk, goal: Goal) -> str:
    """But for what main eases over: a walker's knees are a little softer than those of who just stands."""
    rotations, root = m.subject(goal.name).at((0.0, 0.0), goal.start)
    gap = float(np.linalg.norm(root - walk.root[0]))
    same = np.abs((rotations[:BODY] * walk.rotations[0, :BODY]).sum(axis=-1))
    turned = float(np.degrees(2.0 * np.arccos(np.clip(same, 0.0, 1.0)).max()))
    return f"{1e3 * gap:.1f} mm, {turned:.2f} degrees" if gap > 0.006 or turned > 5.0 else ""


def feet_stay(walk: Walk, _: Goal) -> str:
    drift = m.drift(walk)
    return f"a point that bears moves {1e3 * drift:.2f} mm" if drift > 0.001 else ""


def a_foot_always_bears(walk: Walk, _: Goal) -> str:
    share = m.supported(walk)
    return "" if share == 1.0 else f"in {100 * (1 - share):.1f}% of the frames no foot bears"


def nothing_slides_on_the_floor(walk: Walk, _: Goal) -> str:
    way = m.scuffed(walk)
    return f"a point goes {1e3 * way:.0f} mm over the floor while it touches it" if way > 0.02 else ""


def what_is_near_the_floor_stands(walk: Walk, _: Goal) -> str:
    way = float(m.slid(walk).max())
    return f"a point within 2 mm of the floor goes {1e3 * way:.1f} mm in a frame" if way > 0.001 else ""


def nothing_sinks(walk: Walk, _: Goal) -> str:
    sunk = m.sunk(walk)
    return f"{1e3 * sunk:.2f} mm under the floor" if sunk > 0.003 else ""


def knees_bend_forwards(walk: Walk, _: Goal) -> str:
    flexion, ahead = float(m.knee_flexion(walk).min()), float(m.knees_ahead(walk).min())
    return f"bent by {flexion:.1f} degrees, {1e3 * ahead:.1f} mm ahead" if flexion < 0.0 or ahead < 0.0 else ""


def bones_keep_their_lengths(walk: Walk, _: Goal) -> str:
    """Rotations are rotations, and no leg is too short for where its foot shall be."""
    off, missed = float(np.abs(norm(walk.rotations) - 1.0).max()), m.missed(walk)
    return f"norm off by {off:.1e}; feet missed by {missed:.1e} m" if off > 1e-9 or missed > 1e-6 else ""


def feet_do_not_pass_through_each_other(walk: Walk, _: Goal) -> str:
    frames = m.crossed(walk)
    return f"in {frames} frames" if frames else ""


def legs_do_not_brush_each_other(walk: Walk, _: Goal) -> str:
    apart = m.shanks_apart(walk)
    return f"the shanks' middle lines are {1e3 * apart:.0f} mm apart" if apart < _APART else ""


def feet_stand_beside_each_other(walk: Walk, _: Goal) -> str:
    apart = m.soles_apart(walk)
    return f"the soles' middle lines are {1e3 * apart:.0f} mm apart while both bear" if apart < _BESIDE else ""


def supports_as_still_as_real(walk: Walk, _: Goal) -> str:
    found = m.standing_speed(walk)
    slow = found.speed_mean <= m.SUPPORT_MEAN and found.speed_p95 <= m.SUPPORT_P95
    return "" if slow else f"{found.speed_mean:.3f}, {found.speed_p95:.3f} m/s"


def joints_as_smooth_as_real(walk: Walk, _: Goal) -> str:
    found = m.joints(walk)
    smooth = found.acceleration_max <= m.ACCELERATION_MAX and found.acceleration_p99 <= m.ACCELERATION_P99
    return "" if smooth and found.jerk_max <= m.JERK_MAX else str(found)


def nothing_pops(walk: Walk, _: Goal) -> str:
    at_seams, elsewhere = m.worst_pops(walk)
    return f"{at_seams:.1f} at seams, {elsewhere:.1f} elsewhere" if max(at_seams, elsewhere) > m.POP else ""


def hips_go_as_smoothly_as_real(walk: Walk, _: Goal) -> str:
    found = m.hips_acceleration(walk)
    return f"{found:.1f} m/s2" if found > m.HIPS_ACCELERATION else ""


def goes_as_fast_as_people(walk: Walk, goal: Goal) -> str:
    if goal.distance < _LONG:
        return ""
    speed = m.mean_speed(walk)
    return "" if 0.9 <= speed <= 1.6 else f"{speed:.3f} m/s"


Check = Callable[[Walk, Goal], str]
CHECKS: tuple[Check, ...] = (
    arrives, arrives_on_its_feet, begins_where_it_stands, feet_stay, a_foot_always_bears, nothing_slides_on_the_floor,
    what_is_near_the_floor_stands, nothing_sinks, knees_bend_forwards, bones_keep_their_lengths,
    feet_do_not_pass_through_each_other, legs_do_not_brush_each_other, feet_stand_beside_each_other,
    supports_as_still_as_real, joints_as_smooth_as_real, nothing_pops, hips_go_as_smoothly_as_real,
    goes_as_fast_as_people,
)  # fmt: skip


def faults(goal: Goal) -> list[str]:
    walk, _ = m.walked(goal)
    return [f"{check.__name__}: {fault}" for check in CHECKS if (fault := check(walk, goal))]


@pytest.mark.parametrize("goal", random_goals(40, seed=2000, furthest=100.0), ids=str)
def test_to_a_random_goal(goal: Goal) -> None:
    assert not faults(goal)


BORDERS = [
    Goal("ken", 0.0, distance, direction, facing)
    for distance in (0.05, 0.35, 0.75, 1.45, 2.2)
    for direction, facing in ((0.0, 0.0), (15.0, -15.0), (180.0, 180.0), (-180.0, 0.0), (-90.0, 90.0), (165.0, -165.0))
]


@pytest.mark.parametrize("goal", BORDERS, ids=str)
def test_at_the_borders_of_bins_and_patterns_one_arrives_and_stands(goal: Goal) -> None:
    walk, _ = walked(goal)
    for check in (arrives, arrives_on_its_feet, begins_where_it_stands, feet_stay, nothing_sinks, knees_bend_forwards):
        assert not check(walk, goal), check.__name__


@pytest.mark.parametrize(
    "goal",
    [
        Goal("aiko", 90.0, 0.85, -45.0, 0.0),  # two steps aside
        Goal("aiko", 0.0, 0.62, 75.0, -165.0),  # turns so far that the first foot goes nowhere
        Goal("aiko", -72.0, 1.37, 105.0, -135.0),  # ends beside the leg that bears
        Goal("aiko", 180.0, 1.2, 75.0, 0.0),
        Goal("aiko", 0.0, 0.66, 105.0, 105.0),  # a foot that is still turned in leaves the ground
        Goal("ken", 0.0, 0.7, 90.0, 90.0),
        Goal("ken", 0.0, 0.72, -60.0, 90.0),  # feet would stand in each other
        Goal("aiko", 0.0, 0.57, 45.0, -120.0),
        Goal("aiko", 145.54, 0.16, -159.54, -110.57),
    ],
    ids=str,
)
def test_legs_keep_apart_on_short_ways_aside(goal: Goal) -> None:
    walk, _ = walked(goal)
    for check in (legs_do_not_brush_each_other, feet_stand_beside_each_other, nothing_pops):
        assert not check(walk, goal), check.__name__


def test_a_mirrored_goal_is_walked_to_as_in_a_mirror() -> None:
    for direction, facing, distance in ((40.0, 70.0, 3.0), (100.0, -50.0, 0.3), (120.0, 80.0, 0.8)):
        one, _ = m.walked(Goal("ken", 0.0, distance, direction, facing))
        other, _ = m.walked(Goal("ken", 0.0, distance, -direction, -facing))
        _, root = mirror(one.rotations[:, :15], one.root)
        assert len(root) == len(other.root)
        np.testing.assert_allclose(other.root, root, atol=2e-3)  # the stance itself is not quite its mirror image


@pytest.mark.parametrize("share", [0.75, 1.0, 1.3])
@pytest.mark.parametrize("goal", [Goal(name, 20.0, 5.0, 100.0, 10.0) for name in HUMANS], ids=str)
def test_no_foot_slides_as_it_lands_or_lifts_at_any_pace(goal: Goal, share: float) -> None:
    natural = walked(goal)[1].natural
    walk, _ = m.walked(goal, round(share * natural))
    assert not what_is_near_the_floor_stands(walk, goal)


@pytest.mark.parametrize("goal", [Goal("aiko", 0.0, 6.0, 30.0, 0.0), Goal("aiko", 0.0, 0.4, 0.0, 0.0)], ids=str)
def test_who_is_small_walks_at_the_librarys_cadence(goal: Goal) -> None:
    walk, made = walked(goal)
    clips = len(made.nominal.root) - 1
    assert made.natural == clips == len(walk.root) - 1
    assert (made.rates == 1.0).all()


@pytest.mark.parametrize("direction", [150.0, 180.0, -150.0])
def test_hips_that_turn_round_at_once_are_hardly_beyond_their_limits(direction: float) -> None:
    """An ankle is beyond them a little where a foot rolls that is turned."""
    walk, _ = walked(Goal("ken", 0.0, 4.0, direction, 0.0))
    assert m.beyond(walk, m.HIPS).max() < 1.0
    assert m.beyond(walk, m.FEET).max() < 8.0
    assert m.beyond(walk, m.KNEES).max() < 1.0


@pytest.mark.parametrize("direction", [90.0, -90.0])
def test_the_first_footstep_of_a_start_shares_its_turn_with_the_second(direction: float) -> None:
    """Of feet that turn by 90 degrees the first goes by 15 to 46 and the second by 79 to 96."""
    _, made = walked(Goal("ken", 0.0, 4.0, direction, 0.0))
    first, second = sorted(made.shaped.footprints, key=lambda prints: int(prints.since[1]))
    leading, following = (abs(float(np.degrees(prints.headings[1] - prints.headings[0]))) for prints in (first, second))
    assert 30.0 < leading < 60.0
    assert following == pytest.approx(90.0, abs=10.0)


@pytest.mark.parametrize("direction", [120.0, -150.0, 180.0])
def test_the_pelvis_is_never_turned_far_against_a_foot(direction: float) -> None:
    """Who turns far begins on the spot: a hip and an ankle together turn by 65 degrees and a little."""
    walk, _ = walked(Goal("ken", 0.0, 4.0, direction, 0.0))
    ahead = rotate(walk.world[:, m.FEET], np.array([1.0, 0.0, 0.0]))
    yaw = np.arctan2(ahead[..., 1], ahead[..., 0]) - m.heading_of(walk.rotations[:, 0])[:, None]
    assert np.degrees(np.abs((yaw + np.pi) % (2.0 * np.pi) - np.pi)).max() < 75.0


def test_turned_as_a_whole_it_is_the_same_walk() -> None:
    one, _ = m.walked(Goal("aiko", 0.0, 2.3, 70.0, -30.0))
    other, _ = m.walked(Goal("aiko", 135.0, 2.3, 70.0, -30.0))
    turn = np.radians(135.0)
    level = one.root[:, :2] @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    np.testing.assert_allclose(other.root, np.c_[level, one.root[:, 2]], atol=1e-9)
    np.testing.assert_allclose(np.abs((one.rotations[:, 1:] * other.rotations[:, 1:]).sum(axis=-1)), 1.0, atol=1e-9)


def test_the_walk_grows_with_the_distance_and_is_never_in_a_hurry() -> None:
    """As many frames or more the further it is, but for a frame or two in what is hardly a step."""
    frames = [
        len(m.walked(Goal("ken", 0.0, distance, 0.0, 0.0))[0].root) for distance in (0.1, 0.5, 1.0, 2.0, 4.0, 8.0)
    ]
    assert all(after >= before - 2 for before, after in pairwise(frames))
    assert frames[2:] == sorted(frames[2:])


# The whole of it


GRID = [
    Goal(HUMANS[(i + j + k) % 2], 90.0 * (i % 4), distance, direction, facing)
    for i, distance in enumerate((0.05, 0.12, 0.3, 0.45, 0.62, 0.85, 1.2, 1.7, 2.4, 3.6, 9.0, 40.0))
    for j, direction in enumerate((-180.0, -165.0, -90.0, -45.0, -15.0, 0.0, 15.0, 30.0, 75.0, 135.0, 179.9, 180.0))
    for k, facing in enumerate((-180.0, -165.0, -105.0, -60.0, -15.0, 0.0, 15.0, 45.0, 90.0, 150.0, 180.0))
    if distance < 5.0 or (j + k) % 4 == 0
]


@pytest.mark.long
@pytest.mark.parametrize("goal", GRID, ids=str)
def test_of_the_grid(goal: Goal) -> None:
    assert not faults(goal)


@pytest.mark.long
@pytest.mark.parametrize("goal", random_goals(500, seed=500, furthest=100.0), ids=str)
def test_of_five_hundred_random_goals(goal: Goal) -> None:
    assert not faults(goal)


@pytest.mark.long
@pytest.mark.parametrize("facing", [-150.0, -90.0, 90.0, 120.0, 180.0])
@pytest.mark.parametrize("direction", [-165.0, -120.0, -90.0, 90.0, 120.0, 150.0, 180.0])
@pytest.mark.parametrize("name", HUMANS)
def test_who_turns_before_a_long_walk_and_after_it_is_not_slow(name: str, direction: float, facing: float) -> None:
    goal = Goal(name, 0.0, _LONG, direction, facing)
    assert not goes_as_fast_as_people(walked(goal)[0], goal)
