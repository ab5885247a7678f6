"""`ahmss init DIR` and `ahmss new object NAME`: what a user begins with."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from ahmss.database.objectfile import NAME
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, CommandError

__all__ = ["init", "new_object"]

_FOLDERS = ("objectdb", "humandb", "algorithms", "examples")

_OBJECT = """\
# A {name}. Every key is told of in docs/writing-an-object.md; `ahmss check` says what is wrong.
name = "{name}"
sentence = "A box of 10 cm; write here what it is."
shape = "{name}.dxf"           # or .glb .gltf .obj .stl .ply
unit = "cm"                    # of the shape, where its file does not say
color = [196, 120, 72]         # leave it out where the shape has colours of its own

[properties]
mass = 0.4                     # kilograms
size = [0.1, 0.1, 0.1]         # metres

[sites.middle]                 # a place on the object that actions name, metres from its origin
position = [0.0, 0.0, 0.05]
free_axis = "z"                # a hand may come from any side
{affordance}"""

_AFFORDANCE = """
[affordances.{action}]
sentence = "{sentence}"
human_algorithm = "{algorithm}"
site = "middle"
{motion}frames = {frames}
"""


def init(directory: Path, source: Workspace) -> Workspace:
    """Lay out a workspace of the user's own in `directory`, a copy of `source`.

    Raises:
        CommandError: something is there already, or it can't be written.
    """
    taken = [folder for folder in _FOLDERS if (directory / folder).exists()]
    if taken:
        raise CommandError(f"{directory}: {', '.join(taken)} exists already; name another folder")
    if directory.resolve().is_relative_to(source.root) and directory.resolve() != source.root:
        inside = directory.resolve().relative_to(source.root).parts[0]
        if inside in _FOLDERS:
            raise CommandError(f"{directory}: lies in the {inside}/ that would be copied; name another folder")
    try:
        for folder in _FOLDERS:
            if (source.root / folder).is_dir():
                ignore = shutil.ignore_patterns("__pycache__", ".*")
                shutil.copytree(source.root / folder, directory / folder, ignore=ignore)
            else:
                (directory / folder).mkdir(parents=True)
    except OSError as error:
        raise CommandError(f"{directory}: can't be written ({error.strerror or error})") from None
    return Workspace(directory)


def new_object(workspace: Workspace, name: str) -> Path:
    """Write objectdb/NAME/ with a shape and an object.toml that work at once; returns the object.toml.

    Raises:
        CommandError: the name is taken or no name, or the folder can't be written.
    """
    if not NAME.fullmatch(name):
        raise CommandError(f'"{name}" is no name for an object; use letters, digits, _ and -, a letter first')
    folder = workspace.root / "objectdb" / name
    if folder.exists():
        raise CommandError(f"{workspace.label(folder)} exists already; choose another name or change what is there")
    try:
        folder.mkdir()
        (folder / f"{name}.dxf").write_text(_box(5.0, 10.0), encoding="ascii")
        file = folder / "object.toml"
        file.write_text(_OBJECT.format(name=name, affordance=_look(workspace, folder)), encoding="utf-8")
    except OSError as error:
        raise CommandError(f"{workspace.label(folder)}: can't be written ({error.strerror or error})") from None
    return file


def _look(workspace: Workspace, folder: Path) -> str:
    """An action of the object in a folder that works at once: it is looked at as the television is, if there is one."""
    try:
        television = workspace.objects.get("television").affordances["look"]
    except (AhmssError, KeyError):
        return ""
    motion = ""
    if television.motion is not None:
        motion = f'motion = "{Path(os.path.relpath(television.motion, folder)).as_posix()}"\n'
    return _AFFORDANCE.format(
        action="look",
        sentence="Look at it.",
        algorithm=television.human_algorithm,
        motion=motion,
        frames=television.frames,
    )


def _box(half: float, height: float) -> str:
    """The DXF text of a box standing on its origin: six 3DFACEs, seen from outside counter-clockwise."""
    low = [(-half, -half, 0.0), (half, -half, 0.0), (half, half, 0.0), (-half, half, 0.0)]
    high = [(x, y, height) for x, y, _ in low]
    faces = [low[::-1], high] + [[low[i], low[i - 3], high[i - 3], high[i]] for i in range(4)]
    lines: list[object] = [0, "SECTION", 2, "ENTITIES"]
    for face in faces:
        lines += [0, "3DFACE", 8, "box"]
        for corner, point in enumerate(face):
            for axis, value in enumerate(point):
                lines += [10 * (axis + 1) + corner, f"{value:g}"]
    return "\n".join(str(line) for line in [*lines, 0, "ENDSEC", 0, "EOF", ""])
