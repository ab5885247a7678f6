"""Acclaim's pair of files, read: ASF, a skeleton of bones, and AMC, what they do frame by frame.

A bone has a direction and a length in the world's axes, and axes of its own, C, in which its rotations M are given; it
turns what hangs on it by C M C*. Here a bone is the joint at its beginning, so its end is where its children are.
Angles about x, y, z are taken one after another about axes that stay: R = Rz Ry Rx. Facts: J. Lander, Working with
Motion Capture File Formats (1998).
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ahmss.body.array import Array
from ahmss.body.quaternion import IDENTITY, conjugate, from_axis_angle, multiply
from ahmss.errors import DataError
from ahmss.motion.lines import Lines
from ahmss.motion.source import SourceMotion

__all__ = ["CMU_RATE", "read_amc"]

CMU_RATE = 120.0
"""Frames a second: an AMC file doesn't say, and CMU's, nearly all there are, have these."""

_ANGLES, _PLACES = ("rx", "ry", "rz"), ("tx", "ty", "tz")


@dataclass
class _Bone:
    """One bone as the ASF file has it; the root is one of no length."""

    name: str
    way: Array  # (3,) from its beginning to its end
    axes: Array  # (4,) world <- the bone's own axes
    channels: tuple[str, ...]
    parent: int = -1


def read_amc(path: Path, skeleton: Path | None = None) -> SourceMotion:
    """The motion in an AMC file with its ASF skeleton, in their own units, y up.

    Args:
        path: the AMC file.
        skeleton: the ASF file; None looks beside the AMC: 01_02.amc goes with 01.asf, else with the only one there is.

    Raises:
        DataError: a file is missing or damaged; names the line and what should stand there.
    """
    bones = _read_asf(skeleton or _beside(path))
    lines = Lines.of(path)
    frames = _read_frames(lines, bones)
    rotations, root = _poses(bones, frames)
    names, parents, offsets = _joints(bones)
    ends = np.tile(IDENTITY, (len(rotations), len(names) - len(bones), 1))
    translations = np.tile(offsets, (len(rotations), 1, 1))
    translations[:, 0] = root
    return SourceMotion(
        file=path, format="AMC", names=names, parents=parents, offsets=offsets,
        rotations=np.concatenate([rotations, ends], axis=1), translations=translations, rate=CMU_RATE,
    )  # fmt: skip


def _beside(path: Path) -> Path:
    """The skeleton that belongs to an AMC file."""
    there = sorted(p for p in path.parent.glob("*") if p.suffix.lower() == ".asf")
    for stem in (path.stem, path.stem.split("_")[0]):
        for skeleton in there:
            if skeleton.stem.lower() == stem.lower():
                return skeleton
    if len(there) == 1:
        return there[0]
    raise DataError(path, "", f"its skeleton is missing: put {path.stem.split('_')[0]}.asf beside it")


def _read_asf(path: Path) -> list[_Bone]:
    """The bones, the root first, parents before their children."""
    lines = Lines.of(path)
    radians, root, bones, parents = False, None, {}, {}
    section = ""
    while (words := lines.peek()) is not None:
        lines.next("")
        if words[0].startswith(":"):
            section = words[0].lower()
        elif section == ":units" and words[0].lower() == "angle":
            radians = words[-1].lower().startswith("rad")
        elif section == ":root":
            root = root or {}
            root[words[0].lower()] = words[1:]
        elif section == ":bonedata" and words[0].lower() == "begin":
            bone = _bone(lines, radians)
            bones[bone.name] = bone
        elif section == ":hierarchy" and words[0].lower() not in ("begin", "end"):
            parents |= dict.fromkeys(words[1:], (words[0], lines.number))
    if root is None or not bones or not parents:
        raise lines.error("a skeleton must have :root, :bonedata and :hierarchy; is the file cut short?")
    axes = _axes(lines, root.get("orientation", ["0", "0", "0"]), root.get("axis", ["xyz"])[0], radians)
    order = tuple(word.lower() for word in root.get("order", ["TX", "TY", "TZ", "RX", "RY", "RZ"]))
    return _ordered(lines, _Bone("root", np.zeros(3), axes, order), bones, parents)


def _bone(lines: Lines, radians: bool) -> _Bone:
    """A bone from after its `begin` to its `end`."""
    at, found = lines.number, dict[str, list[str]]()
    while (words := lines.next("end of a bone"))[0].lower() != "end":
        found.setdefault(words[0].lower(), words[1:])
    missing = [key for key in ("name", "direction", "length", "axis") if not found.get(key)]
    if missing:
        raise DataError(lines.path, f"line {at}", f"this bone has no {' and no '.join(missing)}")
    way = np.array([lines.value(word) for word in found["direction"][:3]]) * lines.value(found["length"][0])
    axes = _axes(lines, found["axis"][:3], found["axis"][3] if len(found["axis"]) > 3 else "xyz", radians)
    channels = tuple(word.lower() for word in found.get("dof", []))
    if way.shape != (3,) or not set(channels) <= {*_ANGLES, *_PLACES, "l"}:
        raise DataError(lines.path, f"line {at}", f"direction or dof of bone {found['name'][0]} is wrong")
    return _Bone(found["name"][0], way, axes, channels)


def _axes(lines: Lines, words: list[str], order: str, radians: bool) -> Array:
    """Axes (4,) given by angles, world <- own."""
    angles = [lines.value(word) for word in words]
    if len(angles) != 3 or sorted(order.lower()) != ["x", "y", "z"]:
        raise lines.error("an axis must be three angles, and their order as in XYZ")
    turned = IDENTITY
    for letter in order.lower():
        i = "xyz".index(letter)
        turned = multiply(_turn(i, np.array(angles[i]), radians), turned)
    return turned


def _turn(axis: int, angle: Array, radians: bool) -> Array:
    return from_axis_angle(np.eye(3)[axis], angle if radians else np.radians(angle))


def _ordered(lines: Lines, root: _Bone, bones: dict[str, _Bone], parents: dict[str, tuple[str, int]]) -> list[_Bone]:
    """The root and all bones that hang on it, parents before their children."""
    for child, (parent, line) in parents.items():
        for name in (child, parent):
            if name not in bones and name != "root":
                raise DataError(lines.path, f"line {line}", f'no bone "{name}" has been described')
    out = [root]
    for i, bone in ((i, bone) for i, bone in enumerate(out)):  # grows while it is gone through
        for child, (parent, _) in parents.items():
            if parent == bone.name:
                bones[child].parent = i
                out.append(bones[child])
    if len(out) <= len(bones):
        lost = sorted(set(bones) - {bone.name for bone in out})
        raise DataError(lines.path, ":hierarchy", f"{', '.join(lost)} hang on nothing")
    return out


def _joints(bones: list[_Bone]) -> tuple[tuple[str, ...], tuple[int, ...], Array]:
    """Names, parents and offsets of the bones as joints, then of the ends of those on which nothing hangs."""
    leaves = [i for i in range(len(bones)) if all(bone.parent != i for bone in bones)]
    names = [bone.name for bone in bones] + [f"{bones[i].name}_end" for i in leaves]
    offsets = [bones[bone.parent].way if bone.parent >= 0 else np.zeros(3) for bone in bones]
    offsets += [bones[i].way for i in leaves]
    return tuple(names), (*(bone.parent for bone in bones), *leaves), np.array(offsets)


def _read_frames(lines: Lines, bones: list[_Bone]) -> Array:
    """What the bones' channels hold (frames, channels), bones in their order; angles in degrees."""
    first: dict[str, int] = {}
    count = 0
    for bone in bones:
        first[bone.name], count = count, count + len(bone.channels)
    width = {bone.name: len(bone.channels) for bone in bones}
    scale = 1.0
    rows: list[Any] = []
    seen: set[str] = set()
    while lines.peek() is not None:
        words = lines.next("")
        if words[0].startswith(":"):
            scale = np.degrees(1.0) if words[0].lower() == ":radians" else scale
        elif len(words) == 1 and words[0].isdigit():
            _complete(lines, rows, seen, width)
            rows.append(np.zeros(count))
            seen = set()
        elif not rows:
            raise lines.error(f'"{words[0][:20]}" stands before the number of the first frame')
        else:
            name = words[0]
            if name not in first:
                raise lines.error(f'no bone "{name[:30]}" in the skeleton')
            if len(words) - 1 != width[name]:
                raise lines.error(f"{name} has {len(words) - 1} numbers; its skeleton has {width[name]} for it")
            rows[-1][first[name] : first[name] + width[name]] = [lines.value(word) for word in words[1:]]
            seen.add(name)
    if not rows:
        raise lines.error("there is no frame; is the file cut short?")
    _complete(lines, rows, seen, width)
    values = np.array(rows)
    turning = [channel in _ANGLES for bone in bones for channel in bone.channels]
    values[:, turning] *= scale
    return values


def _complete(lines: Lines, rows: list[Any], seen: set[str], width: dict[str, int]) -> None:
    """Refuse a frame that lacks a bone."""
    lacking = [name for name, channels in width.items() if channels and name not in seen]
    if rows and lacking:
        raise lines.error(f"frame {len(rows)} ends without {', '.join(lacking[:3])}; is the file cut short?")


def _poses(bones: list[_Bone], values: Array) -> tuple[Array, Array]:
    """Rotations (F, bones, 4), parent <- bone, and places of the root (F, 3)."""
    rotations = np.empty((len(values), len(bones), 4))
    root = np.zeros((len(values), 3))
    column = 0
    for i, bone in enumerate(bones):
        turned = np.tile(IDENTITY, (len(values), 1))
        for channel in bone.channels:
            if channel in _ANGLES:
                turned = multiply(_turn(_ANGLES.index(channel), values[:, column], radians=False), turned)
            elif i == 0:
                root[:, _PLACES.index(channel)] = values[:, column]
            column += 1
        rotations[:, i] = multiply(multiply(bone.axes, turned), conjugate(bone.axes))
    return rotations, root
