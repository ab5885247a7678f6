"""The motions that a file holds, whatever it is: a clip, a file of another maker, or a recording of the world."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ahmss.body.links import LINKS
from ahmss.body.skeleton import Skeleton
from ahmss.database.workspace import Workspace
from ahmss.errors import CommandError
from ahmss.main.judging import motion_of, posed
from ahmss.main.replay import is_recording
from ahmss.motion.clip import Clip, ClipHeader, load
from ahmss.motion.contact import contacts
from ahmss.motion.gltf import Look
from ahmss.motion.importing import import_clip
from ahmss.motion.transfer import transfer
from ahmss.world.recording import Reader

__all__ = ["OTHER_MAKERS", "USUAL", "Held", "body_named", "motions_in", "the_motion_in"]

USUAL = "ken"  # who performs what names nobody
OTHER_MAKERS = (".bvh", ".amc", ".c3d")


@dataclass(frozen=True)
class Held:
    """One motion of a file: whose it is, and what they look like where that is known.

    declared: the contacts are told, not found from the motion.
    """

    clip: Clip
    skeleton: Skeleton
    look: Look | None
    declared: bool = True


def motions_in(path: Path, human: str = "", body: str = "", workspace: Path | None = None) -> dict[str, Held]:
    """The motions in a file by name: the humans of a recording, else one by the file's own name.

    Args:
        path: of a clip, a file of another maker, or a recording.
        human: only this human of a recording.
        body: of humandb; a clip made for another is given to it. Left out: the clip's own, or the usual one.
        workspace: with humandb/; left out: found.

    Raises:
        CommandError: there is no such human.
        DataError: the file can't be read.
    """
    if is_recording(path):
        if body:
            raise CommandError(f"{path}: a recording has bodies of its own; leave --body out, or export a clip first")
        return _recorded(path, human)
    if human:
        raise CommandError(f"{path}: --human names a human of a recording, and this is none; --body names a body")
    if path.suffix.lower() in OTHER_MAKERS:
        skeleton, look = body_named(body or USUAL, workspace)
        clip, _ = import_clip(path, skeleton, rate=None)
        return {path.stem: Held(clip, skeleton, look)}
    return {path.stem: _clip(path, body, workspace)}


def the_motion_in(path: Path, human: str = "", body: str = "", workspace: Path | None = None) -> Held:
    """The one motion that is meant in a file; like `motions_in`.

    Raises:
        CommandError: a recording has several humans, and none is named.
    """
    found = motions_in(path, human, body, workspace)
    if len(found) > 1:
        raise CommandError(f"{path}: several humans are in this recording; name one with --human: {', '.join(found)}")
    return next(iter(found.values()))


def body_named(name: str, workspace: Path | None) -> tuple[Skeleton, Look]:
    """A human of humandb: measures and looks.

    Raises:
        CommandError: there is none of that name.
        DataError: its files are wrong.
    """
    humans = Workspace.find(workspace).humans
    model, shape = humans.get(name), humans.shape(name)
    return model.skeleton, Look(shape.glb, shape.texture.data if shape.texture else None)


def _clip(path: Path, body: str, workspace: Path | None) -> Held:
    """A clip for its own human, or given to another; one of nobody's is of usual proportions."""
    clip = load(path)
    made_for = clip.header.human
    known = made_for in Workspace.find(workspace).humans.names()
    if not known and not body:
        return Held(clip, Skeleton.of(), None)
    skeleton, look = body_named(body or made_for, workspace)
    if body and known and body != made_for:
        clip = transfer(clip, body_named(made_for, workspace)[0], skeleton)
    return Held(clip, skeleton, look)


def _recorded(path: Path, human: str) -> dict[str, Held]:
    with Reader(path) as reader:
        names = posed(reader)
        if human and human not in names:
            raise CommandError(
                f'{path}: no human "{human}" in this recording; there is: {", ".join(names) or "nobody"}'
            )
        return {name: _performed(reader, name) for name in ([human] if human else names)}


def _performed(reader: Reader, human: str) -> Held:
    """What a human of a recording did, on the floor of the world."""
    rotations, root, skeleton = motion_of(reader, human)
    record = next(r for tick in range(len(reader)) for r in reader.scene(tick).humans if r.name == human)
    kept = {name: reader.asset(name) for name in (record.shape, record.texture) if name in reader.assets}
    look = Look(kept[record.shape], kept.get(record.texture)) if record.shape in kept else None
    clip = Clip(
        rotations=rotations,
        root=root,
        importance=np.ones((len(root), len(LINKS) + 1)),
        contacts=contacts(skeleton, rotations, root, reader.rate),
        rate=reader.rate,
        header=ClipHeader(origin=f"{human} in {reader.path.name}", human=skeleton.name),
    )
    return Held(clip, skeleton, look, declared=False)
