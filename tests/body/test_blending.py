"""Blending: (4.11) with the hemisphere and the length that it leaves out; the root by increments."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ahmss.body.blending import blend, blend_root
from ahmss.body.quaternion import conjugate, multiply, norm, normalize, slerp, to_rotation_vector
from ahmss.errors import ShapeError

from .strategies import random_rotations, seeds, turn

SHAPES = st.sampled_from([(43, 4), (1, 43, 4), (5, 43, 4), (2, 3, 43, 4)])


def near(rng, previous, motions, spread=0.5):
    """Rotations of some motions, not far from the previous ones, of either sign."""
    shape = (motions, *previous.shape[:-1])
    away = normalize(np.concatenate([np.ones((*shape, 1)), rng.normal(size=(*shape, 3)) * spread], axis=-1))
    return multiply(previous, away) * rng.choice([-1.0, 1.0], size=(*shape, 1))


@given(seeds, SHAPES, st.integers(1, 5))
def test_blend_is_4_11_on_one_hemisphere_normalised(seed, shape, motions):
    rng = np.random.default_rng(seed)
    previous = random_rotations(rng, *shape[:-1])
    rotations = near(rng, previous, motions)
    importance = rng.uniform(0.1, 5.0, size=rotations.shape[:-1])
    blended = blend(rotations, importance, previous)
    aligned = rotations * np.where(np.einsum("m...c,...c->m...", rotations, previous) < 0, -1.0, 1.0)[..., None]
    mean = (importance[..., None] * aligned).sum(axis=0) / importance.sum(axis=0)[..., None]
    assert np.allclose(blended, mean / np.linalg.norm(mean, axis=-1, keepdims=True), atol=1e-12)
    assert np.all(np.einsum("...c,...c->...", blended, previous) > 0.0)


@given(seeds)
def test_signs_of_the_motions_do_not_matter(seed):
    rng = np.random.default_rng(seed)
    previous = random_rotations(rng, 43)
    rotations, importance = near(rng, previous, 3), rng.uniform(0.1, 1.0, (3, 43))
    flipped = rotations * rng.choice([-1.0, 1.0], size=(3, 43, 1))
    assert np.allclose(blend(rotations, importance, previous), blend(flipped, importance, previous), atol=1e-15)
    assert np.allclose(blend(rotations, importance, -previous), -blend(rotations, importance, previous), atol=1e-15)


def test_importance_is_a_weight_not_a_share():
    previous = np.tile([1.0, 0.0, 0.0, 0.0], (43, 1))
    a, b = np.tile(turn(0.2, 0.0, 0.0), (43, 1)), np.tile(turn(0.0, 0.4, 0.0), (43, 1))
    by_weights = blend(np.stack([a, b]), np.stack([np.full(43, 3.0), np.full(43, 1.0)]), previous)
    by_shares = blend(np.stack([a, b]), np.stack([np.full(43, 0.75), np.full(43, 0.25)]), previous)
    assert np.allclose(by_weights, by_shares)
    assert np.allclose(by_weights, slerp(a, b, 0.25), atol=2e-3)
    assert not np.allclose(by_weights, slerp(a, b, 0.75), atol=2e-2)


def test_of_whom_nobody_cares_keeps_its_last_rotation():
    rng = np.random.default_rng(1)
    previous = random_rotations(rng, 2, 43)
    rotations = random_rotations(rng, 3, 2, 43)
    importance = rng.uniform(0.5, 1.0, (3, 2, 43))
    importance[:, 1, 7] = 0.0
    blended = blend(rotations, importance, previous)
    assert np.array_equal(blended[1, 7], previous[1, 7])
    assert not np.allclose(blended[0, 7], previous[0, 7])
    assert np.allclose(norm(blended), 1.0)


def test_one_motion_alone_is_itself():
    rng = np.random.default_rng(2)
    previous, rotations = random_rotations(rng, 43), random_rotations(rng, 1, 43)
    blended = blend(rotations, np.full((1, 43), 0.3), previous)
    assert np.allclose(to_rotation_vector(multiply(conjugate(blended), rotations[0])), 0.0, atol=1e-12)
    nothing = blend(rotations, np.zeros((1, 43)), previous)
    assert np.array_equal(nothing, previous)


def test_a_motion_at_right_angles_to_the_last_output_is_still_taken():
    previous = np.tile([1.0, 0.0, 0.0, 0.0], (43, 1))
    half_turn = np.tile([0.0, 1.0, 0.0, 0.0], (1, 43, 1))
    assert np.allclose(blend(half_turn, np.ones((1, 43)), previous), half_turn[0])


def test_component_major_batches_blend_to_the_same():
    rng = np.random.default_rng(3)
    rotations, importance, previous = random_rotations(rng, 4, 9, 43), rng.uniform(size=(4, 9, 43)), None
    previous = random_rotations(rng, 9, 43)
    turned = np.ascontiguousarray(rotations.transpose(0, 3, 2, 1)).transpose(0, 3, 2, 1)
    assert np.allclose(blend(turned, importance, previous), blend(rotations, importance, previous), atol=1e-14)


@pytest.mark.parametrize(
    ("rotations", "importance", "previous"),
    [((2, 43, 4), (2, 42), (43, 4)), ((2, 43, 4), (2, 43), (1, 43, 4)), ((2, 5, 43, 4), (2, 43), (5, 43, 4))],
)
def test_shapes_that_disagree_are_refused_with_all_three(rotations, importance, previous):
    with pytest.raises(ShapeError, match="blend") as error:
        blend(np.zeros(rotations), np.zeros(importance), np.zeros(previous))
    for shape in (rotations, importance, previous):
        assert str(shape) in str(error.value)


@given(seeds, st.sampled_from([(), (4,), (2, 3)]))
def test_root_goes_by_the_weighted_mean_of_increments(seed, shape):
    rng = np.random.default_rng(seed)
    increments, importance = rng.normal(size=(3, *shape, 3)), rng.uniform(0.1, 2.0, (3, *shape))
    previous = rng.normal(size=(*shape, 3))
    expected = previous + (importance[..., None] * increments).sum(0) / importance.sum(0)[..., None]
    assert np.allclose(blend_root(increments, importance, previous), expected)


def test_one_owner_of_the_root_is_followed_and_none_leaves_it():
    previous = np.array([3.0, -2.0, 0.9])
    increments = np.array([[0.01, 0.02, -0.003], [9.0, 9.0, 9.0]])
    assert np.allclose(blend_root(increments, np.array([0.2, 0.0]), previous), previous + increments[0], atol=1e-15)
    assert np.array_equal(blend_root(increments, np.zeros(2), previous), previous)
