"""The limb written out in plain floats agrees with the one to read."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from ahmss.body.components import FLOATS
from ahmss.body.inverse import _measures, ends, solve
from ahmss.body.limb import Goal, solve_limb
from ahmss.body.limb_one import solve_usual

from .strategies import natural_pose, random_rotations, seeds, turn
from .test_inverse import SKELETON, targets_of

UNTURNED = (1.0, 0.0, 0.0, 0.0)


def as_floats(*quaternions):
    return tuple(tuple(q.tolist()) for q in quaternions)


@given(seeds, st.integers(0, 3), st.sampled_from((1.0, 0.4)), st.sampled_from((0.3, 1.0, 3.0)))
def test_both_give_the_same_rotations(seed, row, share, spread):
    rng = np.random.default_rng(seed)
    limb = _measures(SKELETON).limbs[row]
    upper, rotation = random_rotations(rng, 2)
    lower, end = (turn(*rng.uniform(-spread, spread, 3)) for _ in range(2))
    place = tuple((np.array(limb.base) + rng.normal(size=3) * 0.4).tolist())
    (goal,) = as_floats(rotation)
    given_rotations = as_floats(upper, lower, end)
    rows = [UNTURNED] * limb.first + list(given_rotations)
    usual = solve_usual(limb, (0.0, 0.0, 0.0), UNTURNED, rows, (*place, *goal, share))
    assert usual is not None
    assert np.allclose(usual, solve_limb(FLOATS, limb, given_rotations, Goal(place, goal, share)), rtol=0, atol=1e-12)


@given(seeds)
def test_one_pose_is_solved_as_in_a_batch(seed):
    rng = np.random.default_rng(seed)
    rotations, root = natural_pose(SKELETON, rng)
    wanted, _ = natural_pose(SKELETON, rng)
    targets = targets_of(wanted, root, weight=rng.choice([1.0, 0.5]))
    batch = solve(SKELETON, rotations[None], root[None], targets[None])
    assert np.allclose(solve(SKELETON, rotations, root, targets), batch[0], rtol=0, atol=1e-11)
    assert np.allclose(ends(SKELETON, rotations, root), ends(SKELETON, rotations[None], root[None])[0], atol=1e-13)
