"""`ahmss new algorithm NAME`: an algorithm of about ten lines that works at once."""

from __future__ import annotations

from pathlib import Path

from ahmss.database.objectfile import NAME
from ahmss.database.workspace import Workspace
from ahmss.errors import CommandError

__all__ = ["LANGUAGES", "new_algorithm"]

LANGUAGES = ("python", "c")

_HUMAN = '''\
"""{title}: bows the head and raises it again. docs/writing-an-algorithm.md says what a task knows."""

import numpy as np

from ahmss.algorithm import HumanTask, run
from ahmss.body.quaternion import from_axis_angle, multiply

LEFT = np.array([0.0, 1.0, 0.0])  # y of the head's frame; a turn about it bows


def {function}(task: HumanTask):
    """One pose a frame; each names the links that it moves."""
    head = task.start.rotations[2]
    depth = task.parameter("depth", 0.4)
    for k in task.frames():
        angle = depth * np.sin(np.pi * k / task.length) ** 2
        yield task.pose({{"head": multiply(head, from_axis_angle(LEFT, angle))}})


if __name__ == "__main__":
    run({function})
'''

_OBJECT = '''\
"""{title}: the object goes with the hand. docs/writing-an-algorithm.md says what a task knows."""

from ahmss.algorithm import ObjectTask, run


def {function}(task: ObjectTask):
    """One pose a frame, where the object is in it."""
    in_palm = None
    for human in task.frames():
        palm = human.grip(task.hand or "right")
        in_palm = in_palm or palm.inverse().then(task.object.frame)
        frame = palm.then(in_palm)
        yield task.pose(frame.place, frame.rotation)


if __name__ == "__main__":
    run({function})
'''

_DEPTH = """
[parameters.depth]
type = "float"
default = 0.4
minimum = 0.0
maximum = 0.8
unit = "rad"
sentence = "How far the head bows."
"""

_TOML = """\
kind = "{kind}"
argv = {argv}
sentence = "{sentence}"    # write here what it does: people read it
world = "none"                 # or "near", "all": which other objects it wants to see
{parameters}"""

_SENTENCES = {"human": "Bows the head and raises it again.", "object": "Goes with the hand."}


def new_algorithm(workspace: Workspace, name: str, kind: str = "human", language: str = "python") -> Path:
    """Write algorithms/NAME/ with a program that works; returns the program.

    Args:
        workspace: where.
        name: of the algorithm and its folder.
        kind: "human" or "object".
        language: "python", or "c" for a human algorithm that starts as a copy of algorithms/nod.

    Raises:
        CommandError: the name is taken or no name, there is no such kind or language, or it can't be written.
    """
    if kind not in ("human", "object"):
        raise CommandError(f'there is no kind of algorithm "{kind}"; it is human or object')
    if language not in LANGUAGES or (language == "c" and kind == "object"):
        raise CommandError(f"there is no start in {language} for kind {kind}; there is python, and c for human")
    if not NAME.fullmatch(name):
        raise CommandError(f'"{name}" is no name for an algorithm; use letters, digits, _ and -, a letter first')
    folder = workspace.root / "algorithms" / name
    if folder.exists():
        raise CommandError(f"{workspace.label(folder)} exists already; choose another name or change what is there")
    files = _python(name, kind) if language == "python" else _c(workspace, name)
    try:
        folder.mkdir(parents=True)
        for file, text in files.items():
            (folder / file).write_text(text, encoding="utf-8")
    except OSError as error:
        raise CommandError(f"{workspace.label(folder)}: can't be written ({error.strerror or error})") from None
    return folder / next(iter(files))


def _python(name: str, kind: str) -> dict[str, str]:
    """The files of a start in Python, the program first."""
    program = (_HUMAN if kind == "human" else _OBJECT).format(title=name, function=name.replace("-", "_"))
    argv = f'["python", "{name}.py"]'
    parameters = _DEPTH if kind == "human" else ""
    toml = _TOML.format(kind=kind, argv=argv, sentence=_SENTENCES[kind], parameters=parameters)
    return {f"{name}.py": program, "algorithm.toml": toml}


def _c(workspace: Workspace, name: str) -> dict[str, str]:
    """The files of a start in C: algorithms/nod under another name."""
    nod = workspace.root / "algorithms" / "nod"
    try:
        program, makefile = (nod / "nod.c").read_text(), (nod / "Makefile").read_text()
    except OSError:
        raise CommandError(f"{workspace.label(nod)}: is missing, and a start in C is a copy of it") from None
    toml = _TOML.format(kind="human", argv=f'["./{name}"]', sentence=_SENTENCES["human"], parameters=_DEPTH)
    return {f"{name}.c": program, "Makefile": makefile.replace("nod", name), "algorithm.toml": toml}
