"""A script played as fast as it goes, with what is needed to measure it: who did what in which frame, and where hands
were to be.

The poses come from the server's recording, in which a frame's human and objects belong together; what was under way
comes from the main that made it, which runs in this process.
"""

from __future__ import annotations

import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ahmss.bench.survey import Doing
from ahmss.body.array import Array
from ahmss.body.links import INDEX
from ahmss.body.quaternion import normalize
from ahmss.body.skeleton import Skeleton
from ahmss.database.workspace import Workspace
from ahmss.errors import CommandError
from ahmss.main.process import MainProcess, Setup
from ahmss.main.script import Script, read_script
from ahmss.world.process import ServerProcess
from ahmss.world.recording import Reader
from ahmss.world.view import World

__all__ = ["Acted", "Thing", "act"]

_REST = 60  # frames after the script, in which the body comes to rest
_WEIGHTS = 227 + 8 * np.arange(4)  # of the targets of hands and feet, in a POSE row
_BODY = np.concatenate([np.delete(np.arange(176, 220), INDEX["head"]), _WEIGHTS])
_SURE = 0.999  # the weight from which on a hand is to be where its target is


@dataclass(frozen=True)
class Thing:
    """An object as it was seen, by frame: poses (F, 7), NaN where it was not there; who has it, in which hand; states.

    hands: "" for what is in no hand, as a door that is moved or a chair that is sat on.
    """

    kind: str
    poses: Array
    holders: tuple[str, ...]
    hands: tuple[str, ...]
    states: tuple[Mapping[str, object], ...]


@dataclass(frozen=True)
class Acted:
    """What one human did in F frames.

    doings: the motions of each frame. wanted (F, 2, 7): where the right and the left palm were to be, NaN where no
    motion alone said so. owner (F, 2): the number of the motion that said it, 0 for none. failures: what went wrong.
    """

    human: str
    body: str
    skeleton: Skeleton
    rate: float
    rotations: Array
    root: Array
    doings: tuple[tuple[Doing, ...], ...]
    wanted: Array
    owner: NDArray[np.int64]
    things: dict[str, Thing] = field(default_factory=dict[str, Thing])
    failures: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _Note:
    """What was under way in a frame."""

    doings: tuple[Doing, ...]
    wanted: Array
    owner: tuple[int, int]


def act(path: Path, workspace: Workspace, seed: int = 0) -> Acted:
    """Play a script of one human.

    Raises:
        CommandError: the script is wrong, or of several humans.
        AhmssError: a process could not be started.
    """
    script = read_script(path)
    if len(script.humans) != 1:
        raise CommandError(
            f"{path}: {len(script.humans)} humans; what one does is measured, give it a script of its own"
        )
    with tempfile.TemporaryDirectory(prefix="ahmss-judge-") as folder:
        recording = Path(folder) / "acted.rec"
        notes, failures = _play(script, workspace, recording, seed)
        return _seen(recording, script, notes, failures)


def _play(script: Script, workspace: Workspace, recording: Path, seed: int) -> tuple[dict[int, _Note], tuple[str, ...]]:
    """Carry the script out; notes by the human's frame, and what went wrong."""
    (human,) = script.humans
    notes: dict[int, _Note] = {}
    with ServerProcess(lockstep=(human.name,), recording=recording, log=recording.with_suffix(".log")) as server:
        setup = Setup(
            human.name, human.body, human.place, human.facing_deg, server.address, workspace.root, fast=True, seed=seed,
            names=(human.name,),
        )  # fmt: skip
        main = MainProcess(setup, _nobody)
        try:
            for step in script.part_of(human.name):
                main.agenda.add(step)
            resting = 0
            while resting < _REST:
                resting = resting + 1 if main.agenda.done else 0
                main.frame()
                notes[main.communication.frame] = _note(main)
            return notes, tuple(main.report.messages)
        finally:
            main.close(stay=True)


def _nobody(text: str) -> None:
    """Told to nobody: what went wrong is in the report."""
    del text


def _note(main: MainProcess) -> _Note:
    """What is under way now."""
    doings: list[Doing] = []
    wanted, owner = np.full((2, 7), np.nan), [0, 0]
    givers = [0, 0]
    objects = main.communication.world.objects
    for order, given in main.control.under_way:
        if not _drives(given.row):
            continue
        record = objects.get(order.object)
        kind = order.object if record is None else record.kind
        doings.append(Doing(kind, order.affordance.name, order.human_algorithm.carries))
        for hand in range(2):
            row = given.row[220 + 8 * hand : 228 + 8 * hand]
            if row[7] > 0.0:
                givers[hand] += 1
            if row[7] > _SURE:
                wanted[hand], owner[hand] = row[:7], given.number
    for hand in range(2):
        if givers[hand] != 1 or not owner[hand]:
            wanted[hand], owner[hand] = np.nan, 0
    return _Note(tuple(doings), wanted, (owner[0], owner[1]))


def _drives(row: Array) -> bool:
    """Whether a motion's frame (260,) moves more than the eyes and the head, which go ahead."""
    return bool((row[_BODY] > 0.0).any())


def _seen(recording: Path, script: Script, notes: Mapping[int, _Note], failures: tuple[str, ...]) -> Acted:
    """The recording's frames, beside the notes of them, from the first motion on."""
    (human,) = script.humans
    world, last = World(), -1
    rotations: list[Array] = []
    roots: list[Array] = []
    kept: list[_Note] = []
    kinds: dict[str, str] = {}
    seen: dict[str, list[_Look]] = {}
    with Reader(recording) as reader:
        record = None
        for tick in range(len(reader)):
            reader.show(tick, world)
            record = world.humans.get(human.name)
            row = np.flatnonzero(world.human_ids == record.id) if record is not None else []
            if record is None or not len(row) or (frame := int(world.human_frames[row[0]])) == last:
                continue
            last = frame
            note = notes.get(frame)
            if note is None or (not kept and not note.doings):
                continue
            root, turned = world.human(human.name)
            roots.append(root)
            rotations.append(turned)
            kept.append(note)
            for name, thing in world.objects.items():
                kinds[name] = thing.kind
                rows = seen.setdefault(name, [])
                rows += [_ABSENT] * (len(kept) - 1 - len(rows))
                rows.append(_Look(world.pose(name), thing.holder, thing.hand, thing.states))
        if record is None or not kept:
            raise CommandError(f"{script.path}: nothing is done in it that could be measured")
        skeleton, rate = Skeleton.from_record(reader.skeleton(record)), reader.rate
    for rows in seen.values():
        rows += [_ABSENT] * (len(kept) - len(rows))
    things = {name: _thing(kinds[name], rows) for name, rows in seen.items()}
    return Acted(
        human.name, human.body or human.name, skeleton, rate, normalize(np.array(rotations)), np.array(roots),
        tuple(note.doings for note in kept), np.array([note.wanted for note in kept]),
        np.array([note.owner for note in kept]), things, failures,
    )  # fmt: skip


class _Look(NamedTuple):
    """An object in one frame."""

    pose: Array
    holder: str
    hand: str
    states: Mapping[str, object]


_ABSENT = _Look(np.full(7, np.nan), "", "", {})


def _thing(kind: str, looks: Sequence[_Look]) -> Thing:
    poses, holders, hands, states = zip(*looks, strict=True)
    return Thing(kind, np.array(poses), holders, hands, states)
