"""The six cases by the thesis's own forward kinematics, and its nine misprints by the equations themselves."""

import numpy as np
import pytest

from ahmss.body.arm_cases import CASES, elbow, shoulder_angles, six_cases, wrist_angles

LENGTHS = np.array([0.30, 0.26])
L1, L2 = LENGTHS


def about(axis, theta):
    """(B.1) to (B.7): a rotation (..., 3, 3), written out as the thesis has it."""
    s, c, o, i = np.sin(theta), np.cos(theta), np.zeros_like(theta), np.ones_like(theta)
    rows = {
        "x": ((i, o, o), (o, c, -s), (o, s, c)),
        "y": ((c, o, s), (o, i, o), (-s, o, c)),
        "z": ((c, -s, o), (s, c, o), (o, o, i)),
    }[axis]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def wrist_pose(angles):
    """(B.8): place (..., 3) and rotation (..., 3, 3) of angles (..., 7)."""
    upper = about("z", angles[..., 0]) @ about("x", angles[..., 1]) @ about("z", angles[..., 2])
    forearm = upper @ about("y", angles[..., 3])
    hand = forearm @ about("y", angles[..., 4]) @ about("x", angles[..., 5]) @ about("z", angles[..., 6])
    return L1 * upper[..., 2] + L2 * forearm[..., 2], hand


def random_angles(rng, n, most=np.pi):
    angles = rng.uniform(-np.pi, np.pi, (n, 7))
    angles[:, 3] = rng.uniform(0.0, most, n)
    return angles


def errors(angles, place, rotation):
    """The largest error of place and rotation elements of all solutions (..., 24)."""
    p, r = wrist_pose(angles)
    of_place = np.abs(p - place[..., None, :]).max(axis=-1)
    return np.maximum(of_place, np.abs(r - rotation[..., None, :, :]).max(axis=(-2, -1)))


def different(solutions):
    return len({tuple(np.round(np.concatenate([np.cos(a), np.sin(a)]), 5) + 0.0) for a in solutions})


def test_each_of_24_brings_the_wrist_back():
    true = random_angles(np.random.default_rng(1), 3000)
    place, rotation = wrist_pose(true)
    found = six_cases(LENGTHS, place, rotation, true)
    assert found.angles.shape == (3000, 24, 7)
    assert found.real.all()
    assert errors(found.angles, place, rotation).max() < 1e-9
    assert np.all(found.angles[..., 3] >= 0.0)  # the elbow bends one way
    assert np.abs(found.angles).max() <= np.pi + 1e-12


def test_each_case_keeps_its_joint_and_has_the_true_arm_among_its_four():
    true = random_angles(np.random.default_rng(2), 500)
    found = six_cases(LENGTHS, *wrist_pose(true), true)
    four = found.angles.reshape(500, 6, 4, 7)
    off = np.abs(np.exp(1j * four) - np.exp(1j * true)[:, None, None, :])
    for i, joint in enumerate(CASES):
        assert off[:, i, :, joint].max() < 1e-9
    assert off.max(axis=-1).min(axis=-1).max() < 1e-6


def test_15_of_24_are_different_where_the_fixed_joints_are_a_true_arm_s():
    true = random_angles(np.random.default_rng(3), 200, most=2.8)
    found = six_cases(LENGTHS, *wrist_pose(true), true)
    assert {different(each) for each in found.angles} == {15}


def test_joints_fixed_anywhere_give_true_solutions_or_none():
    rng = np.random.default_rng(4)
    place, rotation = wrist_pose(random_angles(rng, 3000))
    found = six_cases(LENGTHS, place, rotation, random_angles(rng, 3000))
    assert errors(found.angles, place, rotation)[found.real].max() < 1e-9
    shares = found.real.reshape(3000, 6, 4).mean(axis=(0, 2))
    assert shares[3] == 1.0  # (B.26) always has roots
    assert np.all((shares[[0, 1, 2, 4, 5]] > 0.2) & (shares[[0, 1, 2, 4, 5]] < 0.95))


def test_a_case_without_real_roots_has_no_solution_at_all():
    """The joint's angle along the whole swing of the elbow, in both names, never comes to the fixed one."""
    rng = np.random.default_rng(5)
    one, present = random_angles(rng, 60, most=2.6), random_angles(rng, 60)
    place, rotation = wrist_pose(one)
    real = six_cases(LENGTHS, place, rotation, present).real.reshape(60, 6, 4).any(axis=-1)
    line = place / np.linalg.norm(place, axis=-1, keepdims=True)
    turn = swung_about(line, np.linspace(0.0, 2.0 * np.pi, 4001))  # (60, 4001, 3, 3)
    upper = about("z", one[:, 0]) @ about("x", one[:, 1]) @ about("z", one[:, 2])
    upper = turn @ upper[:, None]
    forearm = upper @ about("y", one[:, 3])[:, None]
    names = np.stack([*shoulder_angles(upper), *wrist_angles(np.swapaxes(forearm, -1, -2) @ rotation[:, None])])
    for i, joint in enumerate(CASES):
        away = names[joint if joint < 3 else joint - 1] - present[:, None, None, joint]
        crossed = (np.sin(away[:, 1:]) * np.sin(away[:, :-1]) <= 0.0) & (np.cos(away[:, 1:]) > 0.5)
        assert np.array_equal(crossed.any(axis=(1, 2)), real[:, i])


def swung_about(axis, phi):
    """Rodrigues: rotations (n, m, 3, 3) by phi (m) about axes (n, 3)."""
    k = np.zeros((len(axis), 3, 3))
    for i, j, component, sign in ((0, 1, 2, -1), (0, 2, 1, 1), (1, 2, 0, -1)):
        k[:, i, j], k[:, j, i] = sign * axis[:, component], -sign * axis[:, component]
    k = k[:, None]
    s, c = np.sin(phi)[:, None, None], np.cos(phi)[:, None, None]
    return np.eye(3) + s * k + (1.0 - c) * (k @ k)


@pytest.mark.parametrize("far", [1.0001 * (L1 + L2), 0.9 * abs(L1 - L2)])
def test_out_of_reach_there_is_no_solution(far):
    true = random_angles(np.random.default_rng(6), 50)
    place, rotation = wrist_pose(true)
    place *= far / np.linalg.norm(place, axis=-1, keepdims=True)
    assert not six_cases(LENGTHS, place, rotation, true).real.any()


SINGULAR = {
    "s4 = 0, a straight arm": {3: 0.0},
    "s2 = 0, the upper arm along the axis": {1: 0.0},
    "s2 = 0, the other way": {1: np.pi},
    "c6 = 0": {5: np.pi / 2},
    "c6 = 0, the other way": {5: -np.pi / 2},
    "s2 = 0 and c6 = 0": {1: 0.0, 5: np.pi / 2},
    "a straight arm along the axis": {1: 0.0, 3: 0.0},
    "the hand along the forearm": {4: 0.0, 5: 0.0, 6: 0.0},
    "a straight arm, the hand along it": {3: 0.0, 4: 0.0, 5: 0.0},
    "all angles 0": dict.fromkeys(range(7), 0.0),
    "nearly s2 = 0": {1: 1e-7},
    "nearly c6 = 0": {5: np.pi / 2 - 1e-7},
    "very nearly s2 = 0 and c6 = 0": {1: 1e-11, 5: np.pi / 2 - 1e-11},
}


@pytest.mark.parametrize("name", SINGULAR)
def test_singular_poses_have_their_own_branch(name):
    true = random_angles(np.random.default_rng(7), 200, most=2.8)
    for joint, angle in SINGULAR[name].items():
        true[:, joint] = angle
    place, rotation = wrist_pose(true)
    found = six_cases(LENGTHS, place, rotation, true)
    assert found.real.all()
    assert np.isfinite(found.angles).all()
    assert errors(found.angles, place, rotation).max() < 1e-9


@pytest.mark.parametrize("almost", [1e-9, 1e-8, 1e-7, 1e-6, 1e-4])
def test_an_almost_straight_arm_keeps_its_digits(almost):
    true = random_angles(np.random.default_rng(8), 500)
    true[:, 3] = almost
    place, rotation = wrist_pose(true)
    found = six_cases(LENGTHS, place, rotation, true)
    assert errors(found.angles, place, rotation)[found.real].max() < 1e-9
    assert found.real.any(axis=-1).all()


def test_a_straight_arm_out_of_the_fixed_joint_s_line_has_none_of_that_case():
    true = random_angles(np.random.default_rng(9), 50)
    true[:, 3] = 0.0
    place, rotation = wrist_pose(true)
    elsewhere = true.copy()
    elsewhere[:, :2] += 0.3
    real = six_cases(LENGTHS, place, rotation, elsewhere).real.reshape(50, 6, 4)
    assert not real[:, :2].any()
    assert real[:, 2:4].all()


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_where_two_axes_fall_together_the_thesis_s_angle_is_0(sign):
    a, b = np.random.default_rng(11).uniform(-1.5, 1.5, (2, 20))
    theta_5, theta_6, theta_7 = wrist_angles(about("y", a) @ about("x", np.full(20, sign * np.pi / 2)) @ about("z", b))
    assert np.allclose(theta_7, 0.0, atol=1e-12)  # (B.22)
    assert np.allclose(theta_6, sign * np.pi / 2)
    assert np.allclose(theta_5, (a - sign * b)[:, None])
    theta_1, theta_2, theta_3 = shoulder_angles(about("z", a) @ about("z", b))
    assert np.allclose(theta_3, 0.0, atol=1e-12)  # (B.36)
    assert np.allclose(theta_2, 0.0)
    assert np.allclose(theta_1, (a + b)[:, None])


def test_batches_of_any_shape():
    true = random_angles(np.random.default_rng(10), 12)
    place, rotation = wrist_pose(true)
    many = six_cases(LENGTHS, place, rotation, true)
    shaped = six_cases(LENGTHS, place.reshape(3, 4, 3), rotation.reshape(3, 4, 3, 3), true.reshape(3, 4, 7))
    assert np.array_equal(shaped.angles.reshape(12, 24, 7), many.angles)
    one = six_cases(LENGTHS, place[5], rotation[5], true[5])
    assert one.angles.shape == (24, 7)
    assert np.allclose(one.angles, many.angles[5], rtol=0, atol=1e-12)
    none = six_cases(LENGTHS, place[:0], rotation[:0], true[:0])
    assert none.angles.shape == (0, 24, 7)


def test_the_elbow_by_the_law_of_cosines():
    theta_4, real = elbow(LENGTHS, np.array([L1 + L2, np.hypot(L1, L2), abs(L1 - L2), 0.7]))
    assert np.allclose(theta_4, [0.0, np.pi / 2, np.pi, 0.0], atol=1e-7)
    assert real.tolist() == [True, True, True, False]


class Equations:
    """Both sides of the equations that are wrong in print, at a true arm: each as printed and as it is right."""

    def __init__(self, seed):
        self.t = random_angles(np.random.default_rng(seed), 1)[0]
        self.p, self.R = wrist_pose(self.t)
        self.s = dict(zip(range(1, 8), np.sin(self.t), strict=True))
        self.c = dict(zip(range(1, 8), np.cos(self.t), strict=True))
        self.along = self.c[4] * L2 + L1
        self.alpha, self.beta, self.gamma = -(self.R.T @ self.p)

    def b_15(self):
        s, c, p = self.s, self.c, self.p
        eta = (p[2] - self.along * c[2]) / (s[4] * L2 * s[2])
        # The second root must have the first's sine: that is what (B.12) gives.
        return np.sin(-(np.pi - np.arcsin(eta))) - eta, np.sin(np.pi - np.arcsin(eta)) - eta

    def b_17_second(self):
        s, c, p = self.s, self.c, self.p
        right = (-s[1] * p[0] + c[1] * p[1]) * c[2] + s[2] * p[2]
        return s[4] * L2 * c[3] - right, s[4] * L2 * s[3] - right

    def b_17_third(self):
        s, c, p = self.s, self.c, self.p
        left = self.along - c[2] * p[2]
        return left - (s[1] * p[0] - c[1] * p[0]) * s[2], left - (s[1] * p[0] - c[1] * p[1]) * s[2]

    def b_20(self):
        r33 = (about("y", self.t[4]) @ about("x", self.t[5]) @ about("z", self.t[6]))[2, 2]
        return self.c[5] * self.s[6] - r33, self.c[5] * self.c[6] - r33

    def b_24(self):
        # beta is the y of the shoulder in the hand's frame.
        R, p = self.R, self.p
        truth = (R.T @ (np.zeros(3) - p))[1]
        common = R[0, 1] * p[0] + R[1, 1] * p[1]
        return -(common + R[2, 2] * p[2]) - truth, -(common + R[2, 1] * p[2]) - truth

    def b_25(self):
        s, c = self.s, self.c
        u, v = self.alpha * c[7] - self.beta * s[7], self.alpha * s[7] + self.beta * c[7]
        right = -c[4] * L1 - L2
        printed = -u * s[5] + v * c[5] * c[6] + self.gamma * c[5] * c[6]
        return printed - right, -u * s[5] + v * c[5] * s[6] + self.gamma * c[5] * c[6] - right

    def b_30(self):
        s, c = self.s, self.c
        side = c[5] * s[4] * L1 + s[5] * (c[4] * L1 + L2)
        root = np.sqrt(self.alpha**2 + self.beta**2 - side**2)
        return self._root_of_b_30(np.arctan2(root, side**2), side), self._root_of_b_30(np.arctan2(root, side), side)

    def _root_of_b_30(self, half, side):
        theta_7 = np.arctan2(-self.beta, self.alpha) + half
        return self.alpha * np.cos(theta_7) - self.beta * np.sin(theta_7) - side

    def b_32(self):
        s, c = self.s, self.c
        a, b, side = self.alpha * c[6], self.beta * c[6], self.gamma * s[6]
        half = np.arctan2(np.sqrt(a**2 + b**2 - side**2), side)
        first, second = np.arctan2(b, a) + half, np.arctan2(a, b) + half
        return tuple(a * np.sin(theta_7) + b * np.cos(theta_7) - side for theta_7 in (first, second))

    def b_36(self):
        upper = about("z", self.t[0]) @ about("x", self.t[1]) @ about("z", self.t[2])
        r31, r32, s2 = upper[2, 0], upper[2, 1], self.s[2]
        return tuple(np.sin(np.arctan2(r31 / s2, sign * r32 / s2) - self.t[2]) for sign in (-1.0, 1.0))


@pytest.mark.parametrize(
    "equation", ["b_15", "b_17_second", "b_17_third", "b_20", "b_24", "b_25", "b_30", "b_32", "b_36"]
)
def test_nine_equations_are_wrong_in_print_and_right_as_corrected(equation):
    pairs = np.abs([getattr(Equations(seed), equation)() for seed in range(20)])
    assert np.median(pairs[:, 0]) > 0.01
    assert pairs[:, 1].max() < 1e-9
