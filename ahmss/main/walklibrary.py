"""`ahmss walk`: libraries of walk clips made, looked at, taken apart."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np

from ahmss.body.skeleton import Skeleton
from ahmss.database.workspace import Workspace
from ahmss.errors import CommandError
from ahmss.main.stance import standing
from ahmss.main.watching import progressing
from ahmss.motion import clip as clips
from ahmss.walking.build import build
from ahmss.walking.captures import Report, files_in, gather
from ahmss.walking.fitting import Pose
from ahmss.walking.legs import foot_frames, solve_legs
from ahmss.walking.library import BODY, RATE, Library, load, save
from ahmss.walking.nominal import length_of
from ahmss.walking.performer import Stand

__all__ = ["build_library", "export_clip", "show_library"]


def build_library(
    captures: Path | None, body: str, out: Path, workspace: Path | None, *, force: bool, as_json: bool
) -> None:
    """Make a library: the subject's own, or of a folder of captures, filled up with the subject's where it is empty.

    Raises:
        CommandError: the file is there already, or there is no such folder, or it holds no motions.
        DataError: the captures can't be read.
    """
    if out.exists() and not force:
        raise CommandError(f"{out}: it is there already; name another with -o, or say --force to write over it")
    if captures is not None and not captures.is_dir():
        what = (
            "it is a file; name the folder that holds it"
            if captures.exists()
            else "there is no such folder; name one that holds motions"
        )
        raise CommandError(f"{captures}: {what}, or leave it out for the subject's own walks")
    files = [] if captures is None else files_in(captures)
    if captures is not None and not files:
        raise CommandError(f"{captures}: no motions in this folder; it may hold .bvh, .amc with .asf, .c3d or clips")
    found = Workspace.find(workspace)
    model = found.humans.get(body)
    rotations, root = standing(model, (0.0, 0.0), 0.0)
    stand = Stand(rotations, root)
    with progressing("clips") as progress:
        library = build(model.skeleton, stand, progress=progress)
    report = None
    if captures is not None:
        library, report = gather(files, model.skeleton, Pose(rotations[:BODY], root), library)
    save(library, out)
    _say_built(library, report, out, as_json=as_json)


def _say_built(library: Library, report: Report | None, out: Path, *, as_json: bool) -> None:
    if as_json:
        told = {"file": str(out), "human": library.human, "clips": len(library.clips)}
        if report is not None:
            told |= {"captured": [one.key.name for one in report.filled], "missing": len(report.missing)}
            told |= {"subject": [key.name for key in report.fallback]}
        print(json.dumps(told))
        return
    for line in report.lines() if report is not None else ():
        print(line)
    print(f"wrote {out}: {len(library.clips)} clips, for {library.human}")


def show_library(path: Path | None, workspace: Path | None, *, as_json: bool) -> None:
    """Say of each clip of a library how many frames it has, how far it gets and whose it is; None: the floor's."""
    path = path or _shipped(workspace)
    library = load(path)
    if as_json:
        told = [
            {"name": key.name, "frames": clip.frames, "length": round(length_of(clip), 3), "source": clip.source}
            for key, clip in library.clips.items()
        ]
        print(json.dumps({"file": str(path), "human": library.human, "clips": told}))
        return
    print(f"{path}: {len(library.clips)} clips of {library.human}, hips {library.hip_height:.3f} m high")
    for key, clip in library.clips.items():
        print(f"  {key.name:28}{clip.frames:5} frames{length_of(clip):7.2f} m  {clip.source}")
    if library.missing:
        print(f"missing: {', '.join(key.name for key in library.missing)}")


def export_clip(path: Path | None, name: str, out: Path, workspace: Path | None, *, force: bool) -> None:
    """Write one clip of a library as a motion clip, its fingers relaxed; a path of None: the floor's library.

    Its legs are solved onto its feet as they are in a walk: a library's knees are of no matter to walks.

    Raises:
        CommandError: there is no such clip, or the file is there already.
    """
    if Path(name).suffix == ".npz":
        raise CommandError(f"{name} is a file, no clip; name the clip first, as in `ahmss walk export start_90 {name}`")
    asked, path = path, path or _shipped(workspace)
    library = load(path)
    named = {key.name: clip for key, clip in library.clips.items()}
    if name not in named:
        lists = f"ahmss walk info {asked}" if asked else "ahmss walk info"
        raise CommandError(f'{path}: no clip "{name}"; `{lists}` lists them, for instance start_90')
    if out.exists() and not force:
        raise CommandError(f"{out}: it is there already; name another with -o, or say --force to write over it")
    walk = named[name]
    found = Workspace.find(workspace)
    model = found.humans.get(library.human) if library.human in found.humans.names() else None
    skeleton = model.skeleton if model is not None else Skeleton.of(name=library.human)
    rotations = np.repeat(skeleton.relaxed()[0][None], len(walk.root), axis=0)
    rotations[:, :BODY] = walk.rotations
    solve_legs(skeleton, rotations, walk.root, *foot_frames(skeleton, walk.rotations, walk.root))
    root = walk.root.copy()
    if walk.key.kind in ("straight", "end"):  # a motion clip begins under the hips, where they face
        root[:, 1] -= root[0, 1]
    importance = np.ones((len(root), len(rotations[0]) + 1))
    header = clips.ClipHeader(origin=f"{path.name}: {name}", human=library.human)
    made = clips.Clip(rotations, root, importance, walk.bearing.any(axis=-1).astype(float), RATE, None, header)
    clips.save(made, out)
    print(f"wrote {out}: {len(root)} frames, {(len(root) - 1) / RATE:.2f} s")


def _shipped(workspace: Path | None) -> Path:
    """The library of a workspace's floor; a path from the current directory where it is below that."""
    path = Workspace.find(workspace).root / "objectdb" / "floor" / "walk.npz"
    return path.relative_to(Path.cwd()) if path.is_relative_to(Path.cwd()) else path
