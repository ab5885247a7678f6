"""A clip of standing still and one of swinging an arm."""

from __future__ import annotations

import numpy as np
import pytest

from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_rotation_vector, multiply
from ahmss.body.skeleton import Skeleton
from ahmss.motion.clip import Clip, ClipHeader


@pytest.fixture
def skeleton():
    return Skeleton.of(1.7, "female")


@pytest.fixture
def swing(skeleton):
    """One second at 60 Hz: the right arm swings smoothly, a hand target has weight in the middle."""
    pose, place = skeleton.upright()
    frames = 61
    t = np.arange(frames) / 60.0
    rotations = np.repeat(pose[None], frames, axis=0)
    vectors = np.zeros((frames, 3))
    vectors[:, 1] = 0.6 * (1.0 - np.cos(2.0 * np.pi * t))
    arm = INDEX["right_upper_arm"]
    rotations[:, arm] = multiply(rotations[:, arm], from_rotation_vector(vectors))
    rotations[1::2] *= -1.0  # signs must not matter
    root = place + np.stack([0.3 * t**2, 0.1 * t, 0.0 * t], axis=-1)
    targets = np.zeros((frames, 5, 8))
    targets[20:40, 0, :3] = np.array([0.3, -0.2, 1.0]) + 0.1 * t[20:40, None]
    targets[20:40, 0, 3:7] = (1.0, 0.0, 0.0, 0.0)
    targets[20:40, 0, 7] = 1.0
    importance = np.tile(np.linspace(0.2, 1.0, frames)[:, None], 44)
    contacts = np.ones((frames, 2))
    contacts[30:, 0] = 0.0
    return Clip(rotations, root, importance, contacts, 60.0, targets, ClipHeader(origin="made here", human="nobody"))
