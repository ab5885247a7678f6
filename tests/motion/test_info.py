"""A clip in figures, against motions that are known."""

from dataclasses import replace

import msgspec
import numpy as np
import pytest

from ahmss.body.quaternion import from_axis_angle, multiply
from ahmss.motion.info import describe


def test_what_a_clip_holds_is_told(swing):
    info = describe(swing)
    assert (info.frames, info.rate, info.seconds) == (61, 60.0, 1.0)
    assert (info.origin, info.human, info.frame, info.keyframes) == ("made here", "nobody", "human", ())
    assert info.moved == pytest.approx(np.hypot(0.3, 0.1), abs=1e-4)
    parabola = 0.5 * np.hypot(0.6, 0.1) + 0.01 / 1.2 * np.arcsinh(6.0)  # its length
    assert info.way == pytest.approx(parabola, abs=1e-4)
    assert info.turned_deg == 0.0
    assert info.hips == (pytest.approx(swing.root[0, 2], abs=1e-4),) * 2
    assert info.standing == (pytest.approx(30 / 61, abs=1e-4), 1.0)
    assert info.steps == (1, 1)
    assert info.turning_deg == {"right_upper_arm": pytest.approx(np.degrees(1.2), abs=0.01)}
    assert info.importance["root"] == pytest.approx(0.6)
    assert len(info.importance) == 44
    assert info.targets == {"right_hand": pytest.approx(20 / 61, abs=1e-4)}
    assert info.targets_relative_to == "site"


def test_turns_are_counted_beyond_a_half(swing):
    rotations = swing.rotations.copy()
    angles = np.linspace(0.0, 2.5 * np.pi, 61)
    rotations[:, 0] = multiply(from_axis_angle(np.array([0.0, 0.0, 1.0]), angles), rotations[:, 0])
    assert describe(replace(swing, rotations=rotations)).turned_deg == pytest.approx(450.0, abs=0.01)


def test_a_single_keyframe_has_no_way(swing):
    header = msgspec.structs.replace(swing.header, times=(1.0,))
    one = replace(
        swing, rotations=swing.rotations[:1], root=swing.root[:1], importance=np.zeros((1, 44)),
        contacts=swing.contacts[:1], targets=None, header=header,
    )  # fmt: skip
    info = describe(one)
    assert (info.way, info.moved, info.turned_deg, info.seconds) == (0.0, 0.0, 0.0, 0.0)
    assert info.keyframes == (1.0,)
    assert (info.turning_deg, info.importance, info.targets, info.targets_relative_to) == ({}, {}, {}, "")
    assert list(info.plain())[:3] == ["frames", "rate", "seconds"]
