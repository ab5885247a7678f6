"""Random damage to every record format: nothing raises or hangs, and what is given as good can be."""

from __future__ import annotations

import numpy as np
import pytest

from tests.capture.damage import FORMATS, Chain, run


@pytest.mark.parametrize(
    "name", ["FASTRAK ASCII, quaternion", "FASTRAK binary, Euler", "Liberty, quaternion", "ULTRATRAK"]
)
def test_what_is_given_as_good_is_unit_in_range_and_plausible(name):
    outcome = run(FORMATS[name], 240, seed=3)
    assert outcome.damaged > 10
    assert outcome.given - outcome.wrong > 0.85 * outcome.records
    assert outcome.wrong < 0.4 * outcome.damaged
    assert outcome.far < 0.12 * outcome.damaged


@pytest.mark.parametrize("name", FORMATS)
def test_pure_noise(name):
    rng = np.random.default_rng(1)
    chain = Chain(FORMATS[name])
    noise = [rng.integers(0, 256, 700, np.uint8).tobytes() for _ in range(100)]
    frames = [frame for at, data in enumerate(noise) for frame in chain.feed(data, at / 60)]
    assert len(frames) < 10
    assert chain.losses.foreign + chain.losses.skipped_bytes >= 100


@pytest.mark.long
@pytest.mark.timeout(1800)
@pytest.mark.parametrize("name", FORMATS)
def test_a_million_damaged_frames(name):
    """A million over all formats; docs/trackers.md has the figures."""
    outcome = run(FORMATS[name], 1_000_000 // len(FORMATS))
    print("\n" + outcome.row(name))
    assert outcome.given - outcome.wrong > 0.85 * outcome.records
    assert outcome.far < 0.12 * outcome.damaged
