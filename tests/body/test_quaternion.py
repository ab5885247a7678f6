"""Quaternion algebra, (4.4) to (4.8) and (5.7), by its laws and against scipy."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation, Slerp

from ahmss.body import components as c
from ahmss.body.quaternion import (
    IDENTITY,
    about_z,
    align,
    between,
    conjugate,
    from_axis_angle,
    from_matrix,
    from_rotation_vector,
    inverse,
    multiply,
    norm,
    normalize,
    rotate,
    slerp,
    to_matrix,
    to_rotation_vector,
)

from .strategies import random_rotations, rotations, seeds, shapes

RNG = np.random.default_rng(7)


def scipy_of(q):
    return Rotation.from_quat(np.asarray(q)[..., [1, 2, 3, 0]])


def same_rotation(p, q, tolerance=1e-12):
    return np.allclose(np.abs(np.einsum("...i,...i->...", p, q)), 1.0, atol=tolerance)


def test_product_is_4_4_term_by_term():
    p, q = np.array([2.0, 3.0, 5.0, 7.0]), np.array([11.0, 13.0, 17.0, 19.0])
    expected = [
        2 * 11 - 3 * 13 - 5 * 17 - 7 * 19,
        2 * 13 + 3 * 11 + 5 * 19 - 7 * 17,
        2 * 17 - 3 * 19 + 5 * 11 + 7 * 13,
        2 * 19 + 3 * 17 - 5 * 13 + 7 * 11,
    ]
    assert multiply(p, q).tolist() == expected
    assert multiply(np.tile(p, (400, 1)), q)[399].tolist() == expected  # the way of many
    assert list(c.multiply(tuple(p), tuple(q))) == expected
    assert list(c.relative(c.conjugate(tuple(p)), tuple(q))) == expected


def test_i_j_is_k():
    i, j, k = np.eye(4)[1:]
    assert np.array_equal(multiply(i, j), k)
    assert np.array_equal(multiply(j, k), i)
    assert np.array_equal(multiply(k, i), j)
    for unit in (i, j, k):
        assert np.array_equal(multiply(unit, unit), -IDENTITY)


@given(rotations(), rotations())
def test_product_composes_as_scipy_does(p, q):
    assert same_rotation(multiply(p, q), (scipy_of(p) * scipy_of(q)).as_quat()[[3, 0, 1, 2]])


def test_conjugate_norm_and_inverse_are_4_5_to_4_7():
    q = np.array([1.0, -2.0, 3.0, -4.0])
    assert conjugate(q).tolist() == [1.0, 2.0, -3.0, 4.0]
    assert norm(q) == 30.0
    assert np.allclose(inverse(q), np.array([1.0, 2.0, -3.0, 4.0]) / 30.0)
    assert np.allclose(multiply(q, inverse(q)), IDENTITY)
    assert np.allclose(multiply(inverse(q), q), IDENTITY)


@given(rotations(), seeds)
def test_vector_goes_by_q_v_conjugate(q, seed):
    v = np.random.default_rng(seed).normal(size=3)
    sandwich = multiply(multiply(q, np.concatenate([[0.0], v])), conjugate(q))
    assert np.allclose(rotate(q, v), sandwich[1:], atol=1e-12)
    assert np.allclose(rotate(q, v), scipy_of(q).apply(v), atol=1e-12)
    assert np.allclose(rotate(-q, v), rotate(q, v), atol=1e-12)
    assert np.allclose(c.rotate(tuple(q), tuple(v)), rotate(q, v), atol=1e-12)


def test_what_is_left_of_a_rotation_without_its_turn_about_z_is_a_tilt_about_a_level_axis():
    tilt = from_axis_angle(np.array([0.6, 0.8, 0.0]), 0.7)
    for angle in (-2.0, 0.0, 0.4, 3.0):
        turn = from_axis_angle(np.array([0.0, 0.0, 1.0]), angle)
        found = about_z(np.stack([multiply(turn, tilt), turn]))
        assert np.allclose(found * np.sign(np.vecdot(found, turn))[:, None], turn, atol=1e-12)
    assert np.allclose(about_z(np.array([0.0, 1.0, 0.0, 0.0])), [1.0, 0.0, 0.0, 0.0])


def test_quarter_turn_about_z_takes_x_to_y():
    quarter = from_axis_angle(np.array([0.0, 0.0, 1.0]), np.pi / 2)
    assert np.allclose(rotate(quarter, np.array([1.0, 0.0, 0.0])), [0.0, 1.0, 0.0])


@given(shapes, seeds)
def test_every_leading_shape_serves(shape, seed):
    rng = np.random.default_rng(seed)
    p, q, v = random_rotations(rng, *shape), random_rotations(rng, *shape), rng.normal(size=(*shape, 3))
    assert multiply(p, q).shape == conjugate(p).shape == slerp(p, q, 0.3).shape == (*shape, 4)
    assert rotate(p, v).shape == to_rotation_vector(p).shape == (*shape, 3)
    assert to_matrix(p).shape == (*shape, 3, 3)
    flat = [multiply(a, b) for a, b in zip(p.reshape(-1, 4), q.reshape(-1, 4), strict=True)]
    if flat:
        assert np.allclose(multiply(p, q).reshape(-1, 4), flat, atol=1e-15)


def test_shapes_broadcast():
    one, many = random_rotations(RNG), random_rotations(RNG, 3, 5)
    assert np.allclose(multiply(one, many)[2, 4], multiply(one, many[2, 4]))
    assert np.allclose(multiply(many, one)[2, 4], multiply(many[2, 4], one))
    assert multiply(many[:, :1], many[:1]).shape == (3, 5, 4)


@given(rotations())
def test_rotation_vector_and_back(q):
    v = to_rotation_vector(q)
    assert np.linalg.norm(v) <= np.pi + 1e-12
    assert same_rotation(from_rotation_vector(v), q)
    if abs(q[0]) > 1e-6:  # at half a turn both axes serve
        assert np.allclose(to_rotation_vector(-q), v, atol=1e-9)
        assert np.allclose(v, scipy_of(q).as_rotvec(), atol=1e-9)


@given(st.floats(1e-100, 1e-9))
def test_tiny_turns_keep_their_digits(angle):
    v = np.array([angle, -2.0 * angle, 0.5 * angle])
    assert np.allclose(to_rotation_vector(from_rotation_vector(v)), v, rtol=1e-12, atol=0.0)


@given(rotations())
def test_matrix_and_back(q):
    assert np.allclose(to_matrix(q), scipy_of(q).as_matrix(), atol=1e-12)
    back = from_matrix(to_matrix(q))
    assert same_rotation(back, q)
    assert back[0] >= 0.0


@given(rotations(), rotations(), st.floats(0.0, 1.0))
def test_slerp_is_5_7(p, q, t):
    q = align(q, p)
    theta = np.arccos(min(float(p @ q), 1.0))
    if theta < 1e-3 or theta > np.pi / 2 - 1e-6:
        return
    expected = (p * np.sin((1 - t) * theta) + q * np.sin(t * theta)) / np.sin(theta)
    assert np.allclose(slerp(p, q, t), expected, atol=1e-9)
    by_scipy = Slerp([0.0, 1.0], Rotation.concatenate([scipy_of(p), scipy_of(q)]))(t)
    assert same_rotation(slerp(p, q, t), by_scipy.as_quat()[[3, 0, 1, 2]], 1e-9)


@given(rotations(), rotations(), st.floats(0.0, 1.0))
def test_slerp_goes_the_short_way_whatever_the_signs(p, q, t):
    way = slerp(p, q, t)
    assert np.isclose(norm(way), 1.0)
    assert np.allclose(slerp(p, -q, t), way, atol=1e-7) or abs(p @ q) < 1e-7
    whole = np.linalg.norm(to_rotation_vector(multiply(conjugate(p), q)))
    part = np.linalg.norm(to_rotation_vector(multiply(conjugate(p), way)))
    assert part == pytest.approx(t * whole, abs=1e-6)


@given(rotations(), st.floats(1e-12, 1e-6))
def test_slerp_of_nearly_equal_rotations_has_no_holes(p, angle):
    q = multiply(p, from_rotation_vector(np.array([angle, 0.0, 0.0])))
    half = to_rotation_vector(multiply(conjugate(p), slerp(p, q, 0.5)))
    assert half[0] == pytest.approx(0.5 * angle, rel=1e-3, abs=1e-15)


@given(seeds)
def test_between_is_the_smallest_turn(seed):
    rng = np.random.default_rng(seed)
    u, v = rng.normal(size=(2, 5, 3)) * rng.uniform(0.1, 9.0)
    q = between(u, v)
    assert np.allclose(np.cross(rotate(q, u), v), 0.0, atol=1e-9)
    assert np.all(np.einsum("ni,ni->n", rotate(q, u), v) > 0.0)
    assert np.allclose(np.einsum("ni,ni->n", q[:, 1:], u), 0.0, atol=1e-9)  # no turn about u itself
    for a, b, expected in zip(u, v, q, strict=True):
        assert np.allclose(c.between(c.FLOATS, tuple(a), tuple(b)), expected, atol=1e-12)


@pytest.mark.parametrize("u", [(1.0, 0.0, 0.0), (0.0, -2.0, 0.0), (0.3, 0.4, -0.5)])
def test_between_opposite_directions_is_a_half_turn(u):
    u = np.array(u)
    floats, arrays = tuple(u.tolist()), tuple(u[:, None])
    minus = tuple((-u).tolist())
    by_arrays = np.array(c.between(c.ARRAYS, arrays, tuple(-u[:, None])))[:, 0]
    for q in (between(u, -u), np.array(c.between(c.FLOATS, floats, minus)), by_arrays):
        assert np.allclose(rotate(q, u), -u)


def test_align_chooses_the_hemisphere_of_the_reference():
    q, reference = random_rotations(RNG, 50), random_rotations(RNG, 50)
    aligned = align(q, reference)
    assert np.all(np.einsum("ni,ni->n", aligned, reference) >= 0.0)
    assert np.all((aligned == q).all(axis=1) | (aligned == -q).all(axis=1))


@settings(max_examples=30)
@given(seeds)
def test_components_say_the_same_for_floats_and_arrays(seed):
    rng = np.random.default_rng(seed)
    p, q = random_rotations(rng, 6), random_rotations(rng, 6)
    axis = normalize(rng.normal(size=(6, 3)))
    x = rng.uniform(-3.0, 3.0, 6)
    low, high = -0.8, 1.3
    results = {
        "about": c.about(c.ARRAYS, tuple(axis.T), x),
        "nlerp": c.nlerp(c.ARRAYS, tuple(p.T), tuple(q.T), np.abs(x) / 3.0),
        "twist": (c.twist(c.ARRAYS, tuple(p.T), tuple(axis.T)),),
        "saturate": (c.saturate(c.ARRAYS, x, low, high),),
    }
    for i in range(6):
        a, b, n, s = tuple(p[i].tolist()), tuple(q[i].tolist()), tuple(axis[i].tolist()), float(x[i])
        one = {
            "about": c.about(c.FLOATS, n, s),
            "nlerp": c.nlerp(c.FLOATS, a, b, abs(s) / 3.0),
            "twist": (c.twist(c.FLOATS, a, n),),
            "saturate": (c.saturate(c.FLOATS, s, low, high),),
        }
        for name, value in one.items():
            assert np.allclose(value, [component[i] for component in results[name]], atol=1e-14), name


@given(st.floats(-20.0, 20.0))
def test_saturate_keeps_its_limits_and_is_plain_inside(x):
    y = c.saturate(c.FLOATS, x, -0.8, 1.3)
    assert -0.8 <= y <= 1.3
    if -0.56 <= x <= 0.91:
        assert y == x
    assert c.saturate(c.FLOATS, x + 0.01, -0.8, 1.3) >= y


def test_twist_is_the_turn_about_the_axis_that_is_left_when_the_swing_is_taken_off():
    swing = from_axis_angle(np.array([0.0, 0.6, 0.8]), 1.1)
    for angle in (-3.0, -0.4, 0.0, 0.7, 3.0):
        q = multiply(swing, from_axis_angle(np.array([1.0, 0.0, 0.0]), angle))
        for signed in (q, -q):
            assert c.twist(c.FLOATS, tuple(signed.tolist()), (1.0, 0.0, 0.0)) == pytest.approx(angle)
    axis = np.array([2.0, -1.0, 2.0]) / 3.0
    across = from_axis_angle(np.array([1.0, 2.0, 0.0]) / np.sqrt(5.0), 0.7)
    q = multiply(across, from_axis_angle(axis, 0.9))
    assert c.twist(c.FLOATS, tuple(q.tolist()), tuple(axis.tolist())) == pytest.approx(0.9)


def test_one_alone_is_as_it_is_among_others():
    p, q = (random_rotations(RNG, 20) for _ in range(2))
    v, u = RNG.normal(size=(2, 20, 3))
    for made, rows in (
        (multiply, (p, q)),
        (rotate, (p, v)),
        (normalize, (3.0 * p,)),
        (from_rotation_vector, (v,)),
        (between, (u, v)),
    ):
        many = made(*rows)
        alone = np.stack([made(*(row[i] for row in rows)) for i in range(20)])
        assert np.abs(alone - many).max() <= 4e-16, made
    angle = RNG.normal(size=20)
    alone = np.stack([from_axis_angle(axis, float(turn)) for axis, turn in zip(u, angle, strict=True)])
    assert np.abs(alone - from_axis_angle(u, angle)).max() <= 4e-16
    assert np.array_equal(from_rotation_vector(np.zeros(3)), IDENTITY)
    assert np.isnan(normalize(np.zeros(4))).all()


def test_few_and_many_are_turned_alike():
    q, v = random_rotations(RNG, 3000), RNG.normal(size=(3000, 3))
    assert np.array_equal(rotate(q, v)[:5], rotate(q[:5], v[:5]))
    assert np.array_equal(multiply(q, q[::-1])[:5], multiply(q[:5], q[::-1][:5]))
