"""BVH, read: any tree of joints, any order of channels, positions on any joint.

A file has a hierarchy of joints (offsets and channels) and a table of numbers, one row a frame. Rotations are degrees
about the axes in the order of the channels, each in the frame that the one before left: R = R1 R2 R3. A position
channel stands in place of the offset. Facts: Meredith & Maddock, Motion Capture File Formats Explained (2001).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import IDENTITY, from_axis_angle, multiply
from ahmss.motion.lines import LARGEST, Lines
from ahmss.motion.source import SourceMotion

__all__ = ["read_bvh"]

_AXES = {"x": 0, "y": 1, "z": 2}
_CHANNELS = {f"{axis}{kind}" for axis in _AXES for kind in ("position", "rotation")}
_MOST_FRAMES = 1_000_000


@dataclass
class _Joint:
    """One joint of the hierarchy as it stands in the file."""

    name: str
    parent: int
    line: int
    offset: tuple[float, ...] | None = None
    channels: tuple[str, ...] = ()


def read_bvh(path: Path) -> SourceMotion:
    """The motion in a BVH file, in its own units and axes.

    Raises:
        DataError: the file is missing or damaged; names the line and what should stand there.
    """
    lines = Lines.of(path)
    joints = _hierarchy(lines)
    frames, step = _times(lines)
    values = _values(lines, frames, sum(len(joint.channels) for joint in joints))
    rotations, translations = _poses(joints, values)
    return SourceMotion(
        file=path,
        format="BVH",
        names=tuple(joint.name for joint in joints),
        parents=tuple(joint.parent for joint in joints),
        offsets=np.array([joint.offset for joint in joints]),
        rotations=rotations,
        translations=translations,
        rate=_rate(step),
    )


def _hierarchy(lines: Lines) -> list[_Joint]:
    """All joints and ends, parents first; the line that starts the motion has been read."""
    words = lines.next("HIERARCHY")
    if words[0].upper() != "HIERARCHY":
        raise lines.error(f'a BVH file starts with HIERARCHY, not "{words[0][:20]}"')
    joints: list[_Joint] = []
    open_joints: list[int] = []
    named = -1  # the joint whose brace is still to come
    while (words := lines.next("MOTION"))[0].upper() != "MOTION":
        while words:
            keyword = words[0].upper()
            if keyword in ("ROOT", "JOINT", "END"):
                joints.append(_named(lines, words, joints, open_joints))
                named = len(joints) - 1
                words = ["{"] if words[-1] == "{" else []
            elif keyword == "{" and named >= 0:
                open_joints.append(named)
                named, words = -1, words[1:]
            elif keyword == "}" and open_joints:
                _check(lines, joints[open_joints.pop()])
                words = words[1:]
            elif keyword in ("OFFSET", "CHANNELS") and open_joints:
                words = _measure(lines, words, joints[open_joints[-1]])
            else:
                raise lines.error(f'"{words[0][:20]}" is no part of a hierarchy that can stand here')
    if open_joints or not joints:
        raise lines.error("MOTION comes before the hierarchy is closed; a brace is missing")
    return joints


def _named(lines: Lines, words: list[str], joints: list[_Joint], open_joints: list[int]) -> _Joint:
    """The joint that a ROOT, JOINT or End Site line names."""
    parent = open_joints[-1] if open_joints else -1
    root = words[0].upper() == "ROOT"
    if root != (parent < 0):
        raise lines.error("a ROOT stands outside all braces, a JOINT or End Site inside another's")
    if words[0].upper() == "END":
        return _Joint(f"{joints[parent].name}_end", parent, lines.number)
    name = " ".join(word for word in words[1:] if word != "{")
    if not name:
        raise lines.error(f"this {words[0]} has no name")
    if any(joint.name == name for joint in joints):
        raise lines.error(f'there are two joints named "{name}"')
    return _Joint(name, parent, lines.number)


def _measure(lines: Lines, words: list[str], joint: _Joint) -> list[str]:
    """Take in a joint's OFFSET or CHANNELS, and give the words that follow."""
    if words[0].upper() == "OFFSET":
        joint.offset = tuple(lines.value(word) for word in words[1:4])
        if len(joint.offset) != 3:
            raise lines.error(f"OFFSET of {joint.name} has {len(joint.offset)} numbers; it must have 3")
        return words[4:]
    count = int(words[1]) if len(words) > 1 and words[1].isdigit() else -1
    channels = tuple(word.lower() for word in words[2 : 2 + max(count, 0)])
    if count < 0 or len(channels) != count:
        raise lines.error(f"CHANNELS of {joint.name} must be a number and as many names")
    unknown = [word for word in channels if word not in _CHANNELS]
    if unknown or len(set(channels)) < count:
        wrong = unknown[0] if unknown else "one twice"
        raise lines.error(f"CHANNELS of {joint.name} has {wrong}; known are X, Y, Z with position or rotation")
    joint.channels = channels
    return words[2 + count :]


def _check(lines: Lines, joint: _Joint) -> None:
    if joint.offset is None:
        raise lines.error(f"{joint.name} of line {joint.line} has no OFFSET")


def _times(lines: Lines) -> tuple[int, float]:
    """Number of frames, and seconds from one to the next."""
    words = lines.next("Frames:")
    if words[0].lower() != "frames:" or len(words) != 2 or not words[1].isdigit() or int(words[1]) < 1:
        raise lines.error('here must stand "Frames:" and how many there are, 1 or more')
    frames = int(words[1])
    if frames > _MOST_FRAMES:
        raise lines.error(f"{frames} frames; at most {_MOST_FRAMES} are read")
    words = lines.next("Frame Time:")
    if [word.lower() for word in words[:2]] != ["frame", "time:"] or len(words) != 3:
        raise lines.error('here must stand "Frame Time:" and its seconds')
    step = lines.value(words[2])
    if not 1e-4 <= step <= 10.0:
        raise lines.error(f"a frame time of {step:g} s; it must be from 0.0001 to 10 s")
    return frames, step


def _rate(step: float) -> float:
    """Frames a second; frame times are written rounded, so that a rate that is nearly whole is meant to be so."""
    rate = 1.0 / step
    return float(round(rate)) if abs(rate - round(rate)) < 1e-3 * rate and rate > 1.0 else rate


def _values(lines: Lines, frames: int, channels: int) -> Array:
    """The table (frames, channels)."""
    values = np.empty((frames, channels))
    for frame in range(frames):
        words = lines.next(f"frame {frame} of {frames}")
        if len(words) != channels:
            raise lines.error(f"frame {frame} has {len(words)} numbers; the joints have {channels} channels")
        try:
            values[frame] = words
        except ValueError:
            values[frame] = [lines.value(word) for word in words]
        if not (np.abs(values[frame]) <= LARGEST).all():
            raise lines.error(f"frame {frame} has a number that is not finite, or larger than any place or angle")
    if lines.peek() is not None:
        raise lines.error(f"more follows the last of {frames} frames; Frames: must say how many there are")
    return values


def _poses(joints: list[_Joint], values: Array) -> tuple[Array, Array]:
    """Rotations (F, J, 4) and translations (F, J, 3) of the joints."""
    rotations = np.tile(IDENTITY, (len(values), len(joints), 1))
    translations = np.tile(np.array([joint.offset for joint in joints]), (len(values), 1, 1))
    column = 0
    for i, joint in enumerate(joints):
        for channel in joint.channels:
            axis = _AXES[channel[0]]
            if channel.endswith("position"):
                translations[:, i, axis] = values[:, column]
            else:
                turn = from_axis_angle(np.eye(3)[axis], np.radians(values[:, column]))
                rotations[:, i] = multiply(rotations[:, i], turn)
            column += 1
    return rotations, translations
