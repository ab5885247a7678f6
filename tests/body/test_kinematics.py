"""Forward kinematics, (4.9) and (4.10), against scipy link by link."""

import numpy as np
import pytest
from hypothesis import given, settings
from scipy.spatial.transform import Rotation

from ahmss.body.array import component_major
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS, PARENTS
from ahmss.body.quaternion import conjugate
from ahmss.body.skeleton import Skeleton

from .strategies import random_rotations, seeds, turn

SKELETON = Skeleton.of(1.7, "female")


def by_scipy(rotations, root, offsets):
    """Each link by following its chain upwards, with rotation matrices."""
    places, world = [], []
    for link, parent in enumerate(PARENTS):
        own = Rotation.from_quat(rotations[link, [1, 2, 3, 0]])
        if parent < 0:
            places.append(root)
            world.append(own)
        else:
            places.append(places[parent] + world[parent].apply(offsets[link]))
            world.append(world[parent] * own)
    return np.array(places), np.array([r.as_quat()[[3, 0, 1, 2]] for r in world])


@settings(max_examples=20)
@given(seeds)
def test_forward_agrees_with_scipy(seed):
    rng = np.random.default_rng(seed)
    rotations, root = random_rotations(rng, 43), rng.normal(size=3)
    offsets = SKELETON.offsets + rng.normal(size=(43, 3)) * 0.1
    places, world = forward(rotations, root, offsets)
    expected_places, expected_world = by_scipy(rotations, root, offsets)
    assert np.allclose(places, expected_places, atol=1e-12)
    assert np.allclose(np.abs(np.einsum("li,li->l", world, expected_world)), 1.0, atol=1e-12)


@pytest.mark.parametrize("shape", [(), (1,), (5,), (2, 3), (0,), (400,)])
def test_forward_takes_every_leading_shape(shape):
    rng = np.random.default_rng(3)
    rotations, root = random_rotations(rng, *shape, 43), rng.normal(size=(*shape, 3))
    places, world = forward(rotations, root, SKELETON.offsets)
    assert places.shape == (*shape, 43, 3)
    assert world.shape == (*shape, 43, 4)
    one_places, one_world = places.reshape(-1, 43, 3), world.reshape(-1, 43, 4)
    for i, (r, p) in enumerate(zip(rotations.reshape(-1, 43, 4), root.reshape(-1, 3), strict=True)):
        if i % 97 == 0:
            expected = forward(r, p, SKELETON.offsets)
            assert np.allclose(one_places[i], expected[0], atol=1e-13)
            assert np.allclose(one_world[i], expected[1], atol=1e-13)


def test_forward_leaves_its_input_alone():
    rotations, root = SKELETON.upright()
    before = rotations.copy(), root.copy()
    forward(rotations, root, SKELETON.offsets)
    assert np.array_equal(rotations, before[0])
    assert np.array_equal(root, before[1])


def test_4_10_composes_the_parent_first():
    rotations, root = SKELETON.upright()
    hips, spine, arm = (INDEX[name] for name in ("hips", "spine", "right_upper_arm"))
    rotations[spine], rotations[arm] = turn(0.3, -0.5, 0.2), turn(-0.7, 0.1, 0.9)
    _, world = forward(rotations, root, SKELETON.offsets)
    chain = [Rotation.from_quat(rotations[link, [1, 2, 3, 0]]) for link in (hips, spine, arm)]
    expected = (chain[0] * chain[1] * chain[2]).as_quat()[[3, 0, 1, 2]]
    assert abs(world[arm] @ expected) == pytest.approx(1.0, abs=1e-12)
    assert abs(world[arm] @ conjugate(expected)) < 0.99  # the other way round is another rotation


def test_parents_stand_before_children_and_a_hand_has_fourteen_finger_links():
    assert len(LINKS) == 43
    assert all(parent < link for link, parent in enumerate(PARENTS))
    for side in ("right", "left"):
        hand = INDEX[f"{side}_hand"]
        assert sum(PARENTS[link] == hand for link in range(43)) == 5


def test_component_major_batches_give_the_same_and_can_be_overwritten():
    rng = np.random.default_rng(8)
    rotations, root = random_rotations(rng, 1300, 43), rng.normal(size=(1300, 3))  # more than one chunk
    laid_out = component_major(1300, 43, 4)
    laid_out[...] = rotations
    expected = forward(rotations[1200], root[1200], SKELETON.offsets)
    out = forward(laid_out, root, SKELETON.offsets)
    for result, one in zip(out, expected, strict=True):
        assert np.allclose(result[1200], one, atol=1e-13)
    kept = [a.copy() for a in out]
    again = forward(rotations[::-1], root[::-1], SKELETON.offsets, out)
    assert again is out
    for result, before in zip(out, kept, strict=True):
        assert np.allclose(result[::-1], before, atol=1e-13)
    assert np.getbufsize() == 8192  # numpy's own


def test_component_major_lays_the_humans_together():
    assert component_major(4, 10, 43, 4).strides == (4 * 43 * 10 * 8, 8, 10 * 8, 43 * 10 * 8)
    assert component_major(4, 10, 43).strides == (43 * 10 * 8, 8, 10 * 8)
