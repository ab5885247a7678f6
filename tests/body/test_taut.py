"""The taut string against a solver that minimises, and corridors against a search on a grid."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.optimize import minimize

from ahmss.body import taut

from .strategies import seeds


def taut_string(gates, start):
    """A string through frames of one pace."""
    return taut.taut_string(gates, start, [1.0] * len(gates))


def corridor(arcs, start, step):
    """A corridor of one step for all frames."""
    return taut.corridor(arcs, start, [step] * len(arcs))


def gates_of(rng, n):
    middle = np.cumsum(rng.normal(size=n) * 0.3)
    half = rng.uniform(0.01, 0.6, n)
    return [(m - h, m + h) for m, h in zip(middle.tolist(), half.tolist(), strict=True)]


@given(seeds, st.integers(1, 12))
def test_no_way_through_the_gates_has_smaller_steps(seed, n):
    rng = np.random.default_rng(seed)
    gates, start = gates_of(rng, n), float(rng.normal() * 0.3)
    string = taut_string(gates, start)
    assert all(low - 1e-12 <= value <= high + 1e-12 for value, (low, high) in zip(string, gates, strict=True))

    def energy(values):
        return np.sum(np.diff(values, prepend=start) ** 2)

    best = minimize(energy, [(a + b) / 2 for a, b in gates], bounds=gates, method="L-BFGS-B", options={"ftol": 1e-15})
    assert energy(string) <= best.fun + 1e-9


@given(seeds, st.integers(1, 12))
def test_no_way_at_uneven_paces_has_smaller_steps_over_them(seed, n):
    rng = np.random.default_rng(seed)
    gates, start, paces = gates_of(rng, n), float(rng.normal() * 0.3), rng.uniform(0.1, 1.0, n)
    string = taut.taut_string(gates, start, paces.tolist())
    assert all(low - 1e-12 <= value <= high + 1e-12 for value, (low, high) in zip(string, gates, strict=True))

    def energy(values):
        return np.sum(np.diff(values, prepend=start) ** 2 / paces)

    best = minimize(energy, [(a + b) / 2 for a, b in gates], bounds=gates, method="L-BFGS-B", options={"ftol": 1e-15})
    assert energy(string) <= best.fun + 1e-6


def test_an_arc_of_one_place_just_a_step_away_is_come_to():
    """Rounding parted the two: the way back to the frame before was then none."""
    rng = np.random.default_rng(1)
    for at, far in rng.uniform((-3.0, 0.01), (3.0, 0.3), (4000, 2)).tolist():
        begin = np.nextafter(at + far, 9.0)  # a step away, and a rounding more
        gates = corridor(arcs_of([(begin - 1e-10, begin + 0.5)], [(at, at)]), begin + 0.1, far + 0.2)
        assert len(gates) == 2
        gates = corridor(arcs_of([(begin - 1e-10, begin + 0.5)], [(at, at)]), begin + 0.5 * far, far)
        if len(gates) == 2:
            assert gates[0][0] <= gates[0][1]
            assert abs(gates[0][0] - gates[1][0]) <= far + 1e-9


def test_a_corridor_widens_by_the_step_of_each_frame():
    arcs = arcs_of(*[[(-np.pi, np.pi)]] * 3)
    gates = taut.corridor(arcs, 0.0, [0.1, 0.2, 0.4])
    assert np.allclose(gates, [(-0.1, 0.1), (-0.3, 0.3), (-0.7, 0.7)])


def test_a_string_that_nothing_touches_stays_level():
    assert np.array_equal(taut_string([(-1.0, 1.0)] * 5, 0.25), np.full(5, 0.25))


def test_a_string_bends_only_where_it_must():
    string = taut_string([(-1, 1), (-1, 1), (-1, 1), (1.5, 2), (-1, 0.3), (-1, 1)], 0.0)
    assert np.allclose(string, [1 / 3, 2 / 3, 1.0, 1.5, 0.3, 0.3])


def arcs_of(*frames):
    """Arcs (F, 2, 2), nan where a frame has one only."""
    arcs = np.full((len(frames), 2, 2), np.nan)
    for i, frame in enumerate(frames):
        arcs[i, : len(frame)] = frame
    return arcs


def test_a_corridor_takes_the_branch_that_leads_on():
    """Two arcs; the nearer one ends blind."""
    parting, blind = [(-1.0, -0.2), (0.1, 1.0)], [(-1.0, -0.6)]
    arcs = arcs_of([(-1.0, 1.0)], parting, parting, blind)
    gates = corridor(arcs, 0.05, 0.5)
    assert len(gates) == 4
    assert gates[2][1] < -0.1
    string = taut_string(gates, 0.05)
    assert np.abs(np.diff(string, prepend=0.05)).max() <= 0.5


def test_what_lies_between_two_branches_is_not_reached():
    arcs = arcs_of([(-1.0, 1.0)], [(-1.0, -0.6), (0.6, 1.0)], [(-0.05, 0.05)])
    assert len(corridor(arcs, 0.0, 0.6)) == 3
    assert len(corridor(arcs, 0.0, 0.5)) == 2


def test_of_two_branches_that_lead_on_the_nearer_one_is_taken():
    arcs = arcs_of([(-1.0, 1.0)], [(-1.0, -0.3), (0.2, 1.0)], [(-1.0, -0.3), (0.2, 1.0)])
    assert np.allclose(taut_string(corridor(arcs, 0.0, 0.5), 0.0), [0.1, 0.2, 0.2])
    assert np.allclose(taut_string(corridor(-arcs[..., ::-1], 0.0, 0.5), 0.0), [-0.1, -0.2, -0.2])


def test_a_whole_circle_has_no_seam():
    arcs = arcs_of(*[[(-np.pi, np.pi)]] * 3)
    gates = corridor(arcs, np.pi - 0.1, 0.2)
    assert np.allclose(gates, [(np.pi - 0.1 - 0.2 * k, np.pi - 0.1 + 0.2 * k) for k in (1, 2, 3)], rtol=0, atol=1e-12)


def test_a_corridor_ends_where_no_step_leads_on():
    arcs = arcs_of([(-1.0, 1.0)], [(-1.0, 1.0)], [(2.5, 3.0)], [(-1.0, 1.0)])
    assert len(corridor(arcs, 0.0, 0.2)) == 2
    assert corridor(arcs[2:], 0.0, 0.2) == []
    assert len(corridor(arcs, 0.0, 2.0)) == 4


def test_a_corridor_goes_over_half_a_turn_without_a_break():
    arcs = arcs_of([(2.5, 3.5)], [(3.0, 4.0)], [(-3.0, -2.0)], [(-np.pi, np.pi)])
    gates = corridor(arcs, 3.0, 0.5)
    assert len(gates) == 4
    string = taut_string(gates, 3.0)
    assert string[2] == pytest.approx(2.0 * np.pi - 3.0, abs=1e-6)
    assert np.abs(np.diff(string)).max() < 0.5


@given(seeds, st.floats(0.05, 0.6))
def test_a_way_is_found_if_and_only_if_a_search_finds_one(seed, step):
    """On a grid whose steps are a part of the step allowed; arcs that begin and end in between."""
    rng = np.random.default_rng(seed)
    cell = step / 8.0
    grid = np.arange(-int(7.0 / cell), int(7.0 / cell) + 1) * cell
    frames = []
    for _ in range(25):
        begin = rng.uniform(-np.pi, 0.0)
        middle = begin + rng.uniform(0.6, 2.5)
        second = middle + rng.uniform(0.1, 1.0)
        frames.append([(begin, middle), (second, second + rng.uniform(0.3, 1.0))])
    arcs = arcs_of(*frames)
    gates = corridor(arcs, 0.0, step)
    strict, generous = (search(arcs, grid, cell, reach, slack) for reach, slack in ((8, -cell), (10, cell)))
    assert strict <= len(gates) <= generous
    if gates:
        string = taut_string(gates, 0.0)
        assert np.abs(np.diff(string, prepend=0.0)).max() <= step + 1e-9
        turned = np.mod(string[:, None] - arcs[: len(gates), :, 0], 2.0 * np.pi)
        assert (turned <= (arcs[..., 1] - arcs[..., 0])[: len(gates)]).any(axis=-1).all()


def search(arcs, grid, cell, reach, slack):
    """How many frames a search on the grid gets through, moving by so many cells a frame."""
    at = np.abs(grid) < 0.5 * cell
    for frame, each in enumerate(arcs):
        at = np.convolve(at, np.ones(2 * reach + 1), "same") > 0.5
        fine = np.zeros(len(grid), bool)
        for begin, end in each:
            fine |= np.mod(grid - begin + slack, 2.0 * np.pi) <= end - begin + 2.0 * slack
        at &= fine & (np.abs(grid) <= 2.0 * np.pi)
        if not at.any():
            return frame
    return len(arcs)
