"""`ahmss check`: everything in a workspace read through, each fault in one sentence."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import msgspec

from ahmss.database.algorithms import NotBuilt
from ahmss.database.document import one_of
from ahmss.database.missing import check_files
from ahmss.database.parameter import fill
from ahmss.database.records import Affordance, AlgorithmEntry, ObjectKind
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, DataError
from ahmss.motion import clip
from ahmss.walking import library

__all__ = ["Report", "check"]


class Report(msgspec.Struct, frozen=True):
    """What was looked at, what is wrong, in the order of the folders, and what is not wrong but worth knowing."""

    objects: int
    humans: int
    algorithms: int
    motions: int
    problems: tuple[str, ...]
    notes: tuple[str, ...] = ()


def check(workspace: Workspace, progress: Callable[[str], None] = lambda _: None) -> Report:
    """Read all objects, shapes, motions, humans and algorithms; `progress` is told what is being looked at."""
    problems: dict[str, None] = {}  # each sentence once, in order
    objects, humans = workspace.objects.names(), workspace.humans.names()
    motions: set[str] = set()
    for name in objects:
        progress(f"objectdb/{name}")
        problems |= dict.fromkeys(_object(workspace, name, motions))
    for name in humans:
        progress(f"humandb/{name}")
        problems |= dict.fromkeys(_said(lambda name=name: workspace.humans.shape(name)))
    entries = workspace.algorithms.list()
    broken = [entry for entry in entries if isinstance(entry, DataError)]
    notes = [str(entry) for entry in broken if isinstance(entry, NotBuilt)]
    problems |= dict.fromkeys(str(entry) for entry in broken if not isinstance(entry, NotBuilt))
    return Report(len(objects), len(humans), len(entries), len(motions), tuple(problems), tuple(notes))


def _object(workspace: Workspace, name: str, motions: set[str]) -> Iterator[str]:
    """What is wrong with one kind."""
    try:
        kind = workspace.objects.get(name)
    except AhmssError as error:
        yield str(error)
        return
    if kind.contains:
        yield from _said(lambda: workspace.objects.place(name, name))
    yield from _said(lambda: workspace.objects.shape(name))
    for affordance in kind.affordances.values():
        yield from _affordance(workspace, kind, affordance)
        if affordance.motion is not None:
            motions.add(str(affordance.motion))
            yield from _said(lambda used=affordance: _load_motion(workspace, kind, used))


def _affordance(workspace: Workspace, kind: ObjectKind, affordance: Affordance) -> Iterator[str]:
    """Whether its algorithms exist, are of the right kind and take its parameters."""
    place = f"{workspace.label(kind.directory / 'object.toml')}: affordances.{affordance.name}"
    if affordance.of:
        yield from _forwarded(workspace, kind, affordance, place)
        return
    known: set[str] | None = set()
    for key, name in (("human", affordance.human_algorithm), ("object", affordance.object_algorithm)):
        if name is None:
            continue
        try:
            entry = workspace.algorithms.find(name, kind.directory)
        except AhmssError as error:
            yield f"{place}.{key}_algorithm: {error}"
            known = None
            continue
        if entry.kind not in ("", key):
            yield f'{place}.{key}_algorithm: "{name}" moves {entry.kind}s; name one that moves {key}s'
        known = None if known is None or entry.parameters is None else known | set(entry.parameters)
        yield from _filled(f"{place}.parameters", entry, affordance, kind)
    for parameter in affordance.parameters:
        if known is not None and parameter not in known:
            yield f'{place}.parameters: no parameter "{parameter}"{one_of(parameter, known)}'


def _forwarded(workspace: Workspace, kind: ObjectKind, affordance: Affordance, place: str) -> Iterator[str]:
    """Whether what it contains affords the action."""
    inner = next(entry.kind for entry in kind.contains if entry.name == affordance.of)
    try:
        affords = workspace.objects.get(inner).affordances
    except AhmssError:  # is told of its own kind
        return
    if affordance.name not in affords:
        yield f'{place}.of: "{affordance.of}" does not afford it; it affords: {", ".join(affords) or "nothing"}'


def _filled(place: str, entry: AlgorithmEntry, affordance: Affordance, kind: ObjectKind) -> Iterator[str]:
    try:
        fill(entry.parameters, affordance.parameters, kind.states)
    except ValueError as error:
        yield f"{place}.{error}"


def _load_motion(workspace: Workspace, kind: ObjectKind, affordance: Affordance) -> None:
    check_files(workspace, kind, affordance.name)
    assert affordance.motion is not None
    if library.is_library(affordance.motion):
        library.load(affordance.motion)
    else:
        clip.load(affordance.motion)


def _said(look: Callable[[], object]) -> Iterator[str]:
    """The sentence of the error that `look` raises."""
    try:
        look()
    except AhmssError as error:
        yield str(error)
