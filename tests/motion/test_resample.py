"""Resampling: the same motion in another number of frames, with its importance."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ahmss.body.quaternion import conjugate, from_rotation_vector, multiply, slerp, to_rotation_vector
from ahmss.motion.clip import ClipHeader
from ahmss.motion.resample import continuous, interpolate_rotations, resample


def angle(p, q):
    return np.linalg.norm(to_rotation_vector(multiply(conjugate(p), q)), axis=-1)


@pytest.mark.parametrize("frames", [2, 31, 60, 121, 200])
def test_ends_stay_and_the_rest_lies_on_the_motion(swing, frames):
    out = resample(swing, frames)
    assert out.frames == frames
    assert out.rate == swing.rate
    assert np.all(angle(out.rotations[[0, -1]], swing.rotations[[0, -1]]) < 1e-7)
    assert np.allclose(out.root[[0, -1]], swing.root[[0, -1]])
    t = np.linspace(0.0, 1.0, frames)
    expected = from_rotation_vector(np.stack([0.0 * t, 0.6 * (1.0 - np.cos(2.0 * np.pi * t)), 0.0 * t], axis=-1))
    arm = multiply(conjugate(swing.rotations[0, 3]), out.rotations[:, 3])
    assert angle(expected, arm).max() < 1e-4
    assert np.allclose(out.root[:, 0], 0.3 * t**2, atol=1e-6)
    assert np.allclose(out.importance, np.linspace(0.2, 1.0, frames)[:, None] * np.ones(44))
    assert np.allclose(np.linalg.norm(out.rotations, axis=-1), 1.0)


def test_twice_the_frames_are_as_smooth(swing):
    out = resample(swing, 121)
    steps = to_rotation_vector(multiply(conjugate(out.rotations[:-1]), out.rotations[1:]))
    assert np.abs(np.diff(steps, n=2, axis=0)).max() < 2e-4  # linear pieces would show 1e-3


def test_the_same_number_is_the_same_clip(swing):
    assert resample(swing, 61) is swing


def test_one_frame_is_the_last(swing):
    assert np.all(angle(resample(swing, 1).rotations[0], swing.rotations[-1]) < 1e-7)


def test_one_frame_fills_any_length(swing):
    still = replace(swing, rotations=swing.rotations[:1], root=swing.root[:1], importance=swing.importance[:1],
                    contacts=swing.contacts[:1], targets=swing.targets[:1])  # fmt: skip
    out = resample(still, 5)
    assert np.all(angle(out.rotations, still.rotations[0]) < 1e-12)
    assert out.targets.shape == (5, 5, 8)


@pytest.mark.parametrize("frames", [0, -3])
def test_no_frames_are_refused(swing, frames):
    with pytest.raises(ValueError, match="ask for 1 or more"):
        resample(swing, frames)


@pytest.mark.parametrize("frames", [31, 61 * 3])
def test_a_target_never_comes_from_where_there_is_none(swing, frames):
    out = resample(swing, frames).targets
    held = out[:, 0, 7] > 0.0
    assert held.any()
    assert not held.all()
    assert out[held, 0, :3].min(axis=0) == pytest.approx(swing.targets[20, 0, :3], abs=1e-9)
    assert np.all(out[:, 0, 7] <= 1.0)
    assert not out[:, 1:].any()
    strong = out[:, 0, 7] > 0.5
    assert np.allclose(out[strong, 0, 3:7], (1.0, 0.0, 0.0, 0.0))


def test_keyframes_go_by_slerp_at_their_times(swing):
    keys = replace(
        swing, rotations=swing.rotations[[0, 15, 30]], root=swing.root[[0, 15, 30]], targets=None,
        importance=swing.importance[[0, 15, 30]], contacts=swing.contacts[[0, 15, 30]],
        header=ClipHeader(times=(0.25, 0.5, 1.0)),
    )  # fmt: skip
    out = resample(keys, 7)
    assert out.header.times is None
    at = np.linspace(0.25, 1.0, 7)
    expected = slerp(keys.rotations[1], keys.rotations[2], (at[4] - 0.5) / 0.5)
    assert np.all(angle(out.rotations[4], expected) < 1e-7)
    assert np.all(angle(out.rotations[2], keys.rotations[1]) < 1e-7)


@given(st.integers(2, 12), st.integers(0, 1000))
def test_signs_are_made_continuous(frames, seed):
    rng = np.random.default_rng(seed)
    walk = np.cumsum(rng.normal(size=(frames, 3)) * 0.3, axis=0)
    q = from_rotation_vector(walk) * rng.choice([-1.0, 1.0], size=(frames, 1))
    smooth = continuous(q)
    assert np.all(np.einsum("fi,fi->f", smooth[1:], smooth[:-1]) >= 0.0)
    assert np.allclose(np.abs(np.einsum("fi,fi->f", smooth, q)), 1.0)
    known = np.arange(frames, dtype=float)
    assert np.all(angle(interpolate_rotations(known, q, known), q) < 1e-6)
