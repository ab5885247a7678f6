"""The programs that docs/writing-an-algorithm.md prints do what it says."""

from __future__ import annotations

import re
import sys
import types
from pathlib import Path

import numpy as np
import pytest
from algorithm_rig import ROOT

from ahmss.algorithm import HumanTask, ObjectTask, frames
from ahmss.motion.clip import Clip, save
from ahmss.motion.resample import resample

PAGE = Path(__file__).parents[2] / "docs" / "writing-an-algorithm.md"
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE.read_text(), re.DOTALL)


def block(start: str) -> str:
    (found,) = [text for text in BLOCKS if start in text]
    return found


def test_the_ten_lines_and_their_test(monkeypatch: pytest.MonkeyPatch):
    bow = types.ModuleType("bow")
    exec(block("def bow("), bow.__dict__)
    monkeypatch.setitem(sys.modules, "bow", bow)
    program: dict[str, object] = {}
    exec(block("def test_the_head_comes_up_again"), program)
    program["test_the_head_comes_up_again"]()


def test_the_block(make_start, tmp_path):
    rotations = np.tile([1.0, 0.0, 0.0, 0.0], (12, 43, 1))
    save(Clip(rotations, np.zeros((12, 3)), np.ones((12, 44)), np.ones((12, 2)), 60.0), tmp_path / "clip.npz")
    program: dict[str, object] = {"resample": resample, "HumanTask": HumanTask}
    exec(block("def play("), program)
    poses = list(frames(program["play"], make_start(frames=20, motion=str(tmp_path / "clip.npz"))))
    assert len(poses) == 20
    np.testing.assert_allclose(poses[-1].root, ROOT)


def test_the_object(make_start):
    program: dict[str, object] = {"ObjectTask": ObjectTask}
    exec(block("def carried("), program)
    humans = np.zeros((2, 190))
    humans[:, 176:183] = [[0, 0, 1, 1, 0, 0, 0], [0.5, 0, 1, 1, 0, 0, 0]]
    poses = list(frames(program["carried"], make_start("object", frames=2), humans))
    np.testing.assert_allclose(poses[1].place - poses[0].place, [0.5, 0.0, 0.0])
