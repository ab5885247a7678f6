"""`ahmss motion info`, `quality` and `importance`: what there is to say of a motion, to people and to programs."""

from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

from ahmss.body.links import LINKS
from ahmss.errors import CommandError
from ahmss.main.motionfiles import OTHER_MAKERS, USUAL, Held, body_named, motions_in
from ahmss.main.replay import is_recording
from ahmss.motion.clip import Clip, load
from ahmss.motion.info import Info, describe
from ahmss.motion.quality import Quality, measure
from ahmss.motion.resample import resample
from ahmss.motion.smoothness import SHORTEST
from ahmss.motion.sourcequality import measure_file

__all__ = ["in_frames", "show_importance", "show_info", "show_quality"]

_UNITS = {"support": "m/s", "alpha": "rad/s2", "jerk": "rad/s3"}


def show_info(path: Path, human: str, workspace: Path | None, *, as_json: bool) -> None:
    """Say what is in a file: one motion, or each human's of a recording."""
    told = {name: describe(held.clip) for name, held in motions_in(path, human, "", workspace).items()}
    if as_json:
        _print_json(path, {name: info.plain() for name, info in told.items()})
        return
    for name, info in told.items():
        print("\n  ".join((name, *_lines(info))))


def show_quality(path: Path, human: str, body: str, workspace: Path | None, *, as_json: bool) -> None:
    """Measure a file: a clip, a file of another maker on its own skeleton, or each human of a recording.

    Raises:
        CommandError: the motion is too short, or in a recording that of every human.
    """
    if path.suffix.lower() in OTHER_MAKERS:
        measured = {path.stem: measure_file(path, body_named(body or USUAL, workspace)[0])}
    else:
        motions = motions_in(path, human, body, workspace)
        motions = {name: replace(held, clip=in_frames(path, held.clip)) for name, held in motions.items()}
        measured = {name: _measured(path, held) for name, held in _long_enough(path, motions).items()}
    if as_json:
        _print_json(path, {name: quality.figures() for name, quality in measured.items()})
        return
    for name, quality in measured.items():
        print(name)
        for figure, value in quality.figures().items():
            remark = " ".join(filter(None, (_UNITS.get(figure.split("_")[0], ""), _where(figure, quality))))
            print(f"  {figure:24}{value:12.4g} {remark}".rstrip())


def show_importance(path: Path, *, as_json: bool) -> None:
    """Say how much each joint of a clip matters: the least, the mean and the most over its frames."""
    importance = load(path).importance
    columns = {"least": importance.min(axis=0), "mean": importance.mean(axis=0), "most": importance.max(axis=0)}
    names = (*LINKS, "root")
    rows = {name: {key: round(float(v[i]), 4) for key, v in columns.items()} for i, name in enumerate(names)}
    if as_json:
        print(json.dumps(rows))
        return
    print(f"{'':28}" + "".join(f"{key:>7}" for key in columns))
    for name, row in rows.items():
        print(f"{name:28}" + "".join(f"{value:7.2f}" for value in row.values()))


def in_frames(path: Path, clip: Clip) -> Clip:
    """A clip of keyframes as frames of one second in all, which is said; another as it is."""
    if clip.header.times is None:
        return clip
    print(f"{path}: {clip.frames} keyframes; taken with the frames between them, 1 s in all", file=sys.stderr)
    return resample(clip, round(clip.rate) + 1)


def _long_enough(path: Path, motions: dict[str, Held]) -> dict[str, Held]:
    """The motions without those, said, of humans who are in a recording for a moment only; all where none is longer."""
    short = [name for name, held in motions.items() if held.clip.duration < SHORTEST]
    if len(short) == len(motions):
        return motions
    for name in short:
        seconds = motions[name].clip.duration
        print(
            f"{path}: {name} left out: {seconds:.2f} s are too short to measure; {SHORTEST} s at least", file=sys.stderr
        )
    return {name: held for name, held in motions.items() if name not in short}


def _measured(path: Path, held: Held) -> Quality:
    clip = held.clip
    if clip.duration < SHORTEST:
        raise CommandError(f"{path}: {clip.duration:.2f} s are too short to measure; {SHORTEST} s at least")
    contacts = clip.contacts if held.declared else None
    return measure(clip.rotations, clip.root, clip.rate, held.skeleton, contacts)


def _print_json(path: Path, told: dict[str, dict[str, Any]]) -> None:
    """The one motion of a file; of a recording each human's under its name."""
    print(json.dumps(told if is_recording(path) else next(iter(told.values()))))


def _where(figure: str, quality: Quality) -> str:
    """Which joint a figure comes from, where it is one joint's."""
    if figure == "alpha_max":
        return f"({quality.names[quality.joints.joint]})"
    if figure == "pop_deg" and quality.pop.degrees:
        return f"({quality.names[quality.pop.joint]}, frame {quality.pop.frame})"
    if figure == "joint_limit_excess_deg" and quality.excess.degrees:
        return f"({LINKS[quality.excess.joint]}, frame {quality.excess.frame})"
    return ""


def _lines(info: Info) -> list[str]:
    """What a person reads."""
    length = f"{len(info.keyframes)} keyframes" if info.keyframes else f"{info.frames} frames, {info.seconds:g} s"
    lines = [f"{length} at {info.rate:g} a second, relative to the {info.frame}"]
    lines.append(f"made for {info.human or 'nobody'}; origin: {info.origin or 'unknown'}")
    lines.append(f"hips {info.hips[0]:.3f} to {info.hips[1]:.3f} m high, way {info.way:.2f} m, {info.moved:.2f} m away")
    lines[-1] += f", turned {info.turned_deg:.0f} degrees"
    feet = zip(("right", "left"), info.standing, info.steps, strict=True)
    lines.append("; ".join(f"{side} foot stands {100 * share:.0f}% in {n} stances" for side, share, n in feet))
    turning = ", ".join(f"{name} {degrees:.0f}" for name, degrees in info.turning_deg.items())
    lines.append(f"turns most, degrees: {turning or 'nothing'}")
    targets = ", ".join(f"{name} {100 * share:.0f}%" for name, share in info.targets.items())
    lines.append(f"targets relative to the {info.targets_relative_to}: {targets}" if targets else "no targets")
    return lines
