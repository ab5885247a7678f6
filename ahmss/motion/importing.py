"""Motions of other makers brought in: a file becomes a clip of one of our humans, and says what was done to it."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ahmss.body.links import LINKS
from ahmss.body.skeleton import Skeleton
from ahmss.errors import CommandError, DataError
from ahmss.motion.alignment import BodyMotion, align
from ahmss.motion.asf import read_amc
from ahmss.motion.bvh import read_bvh
from ahmss.motion.c3d import read_c3d
from ahmss.motion.clip import Clip, ClipHeader
from ahmss.motion.grounding import ground
from ahmss.motion.markers import body_of_markers
from ahmss.motion.naming import parts_of
from ahmss.motion.refining import levelled, refined
from ahmss.motion.retarget import arm_length, leg_length, own_arm_length, own_leg_length, retarget
from ahmss.motion.source import SourceMotion
from ahmss.motion.units import UNITS, guess_unit

__all__ = ["import_clip", "read_body", "read_source"]

_NAMED = 4  # joints that a report names
_LEANING = 0.003  # rise over way of a floor that is worth a word
_GUESSED = 0.1  # importance of fingers that nobody recorded


def import_clip(
    path: Path, skeleton: Skeleton, *, rate: float | None = 60.0, unit: str | None = None
) -> tuple[Clip, list[str]]:
    """The motion in a file, on a human.

    Args:
        path: a BVH, AMC (its ASF beside it) or C3D file.
        skeleton: the human who shall perform it.
        rate: frames a second of the clip; None keeps the file's.
        unit: of length in the file, one of `units.UNITS`; None guesses it from the stature.

    Returns:
        the clip, in the human's floor frame at frame 0, and sentences on what was found and done.

    Raises:
        DataError: the file is damaged, or no body is known in it; names file and place.
        CommandError: there is no such unit.
    """
    body, report = read_body(path, unit)
    if rate is not None and abs(rate - body.rate) > 1e-6:
        report.append(f"{body.rate:g} frames a second became {rate:g}")
        body = body.at_rate(rate)
    report.append(_lengths(body, skeleton))
    rotations, root = retarget(body, skeleton)
    grounded = ground(skeleton, rotations, root, body.rate)
    importance = np.ones((body.frames, len(LINKS) + 1))
    importance[:, 15:-1] = _GUESSED
    report.append("fingers are relaxed")
    clip = Clip(
        rotations=grounded.rotations,
        root=grounded.root,
        importance=importance,
        contacts=grounded.contacts,
        rate=body.rate,
        header=ClipHeader(origin=path.name, human=skeleton.name),
    )
    return clip, report


def _lengths(body: BodyMotion, skeleton: Skeleton) -> str:
    leg, arm = (100.0 * length(body) for length in (leg_length, arm_length))
    own_leg, own_arm = (100.0 * length(skeleton) for length in (own_leg_length, own_arm_length))
    return f"legs of {leg:.0f} cm became {own_leg:.0f} cm, arms of {arm:.0f} cm {own_arm:.0f} cm"


def read_body(path: Path, unit: str | None = None) -> tuple[BodyMotion, list[str]]:
    """What a file says of a body's motion, with its performer's lengths, and sentences on it.

    Raises:
        DataError: the file is damaged, or no body is known in it; names file and place.
        CommandError: there is no such unit.
    """
    if unit is not None and unit not in UNITS:
        raise CommandError(f'no unit "{unit}"; known are {", ".join(UNITS)}')
    if path.suffix.lower() == ".c3d":
        markers = read_c3d(path)
        body, report = body_of_markers(markers)
        return _mended(body, [f"C3D, {body.frames} frames of {len(markers.names)} markers", *report])
    source = read_source(path)
    parts = parts_of(source)
    report = [f"{source.format}, {source.frames} frames, names as in {parts.family} files"]
    if source.format == "AMC":
        report.append(f"AMC files don't say their rate: {source.rate:g} frames a second taken, as CMU's have")
    if parts.unknown:
        more = ", ..." if len(parts.unknown) > _NAMED else ""
        report.append(f"{len(parts.unknown)} joints play no part: {', '.join(parts.unknown[:_NAMED])}{more}")
    if source.begins_apart():
        report.append("frame 0 is a pose by itself, not the motion's: left out")
        source = source.since(1)
    body, said = align(source, parts, 1.0)
    name, metres, stature = guess_unit(leg_length(body))
    if unit is not None:
        name, metres = unit, UNITS[unit]
    elif name:
        report.append(f"unit taken to be {name}: the legs are those of a person of {stature:.2f} m")
    else:
        report.append(f"no known unit fits, so lengths are scaled to a person of {stature:.2f} m")
    body = BodyMotion(body.rotations, metres * body.places, metres * body.toes, body.rate)
    return _mended(body, [*report, *said])


def _mended(body: BodyMotion, report: list[str]) -> tuple[BodyMotion, list[str]]:
    """The motion with what can be known from itself put right."""
    body, slope = levelled(body)
    if slope > _LEANING:
        report.append(f"its floor leans by {100.0 * slope:.1f} %: levelled")
    return refined(body), report


def read_source(path: Path) -> SourceMotion:
    """The joints in a file and what they do, by what its name ends in.

    Raises:
        DataError: the file is damaged, or of a kind that has no joints.
    """
    readers = {".bvh": read_bvh, ".amc": read_amc}
    ending = path.suffix.lower()
    if ending == ".asf":
        raise DataError(path, "", "this is a skeleton alone; name the .amc file that goes with it")
    if ending not in readers:
        raise DataError(path, "", f'motion files end in {", ".join(readers)} or .c3d, not "{path.suffix}"')
    return readers[ending](path)
