"""Scripts: what a person would type at the console, line by line, for one or more humans."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from ahmss.errors import CommandError
from ahmss.main.command import Do, Human, Line, Sync, Wait, parse

__all__ = ["Script", "Step", "read_script"]

_LARGEST = 4_000_000  # bytes; a longer script is a mistake


@dataclass(frozen=True, slots=True)
class Step:
    """One line of a script: what it says, and where it stands (`table.txt:3`)."""

    line: Line
    number: int
    where: str


@dataclass(frozen=True, slots=True)
class Script:
    """A script's humans, in the order in which it names them, and its other lines."""

    path: Path
    humans: tuple[Human, ...]
    steps: tuple[Step, ...]

    def part_of(self, human: str) -> tuple[Step, ...]:
        """The steps that one human carries out.

        Lines about the world are the first human's. What stands before the first motion sets the scene, and nobody
        begins before that is done: where there are several humans, a sync of line 0 follows it.
        """
        first = bool(self.humans) and human == self.humans[0].name
        begin = next(
            (i for i, step in enumerate(self.steps) if isinstance(step.line, Do | Wait | Sync)), len(self.steps)
        )
        mine = [step for step in self.steps[:begin] if first]
        if len(self.humans) > 1:
            mine.append(Step(Sync(), 0, f"{self.path.name}: the scene"))
        mine += [step for step in self.steps[begin:] if _concerns(step.line, human, first)]
        return tuple(mine)


def _concerns(line: Line, human: str, first: bool) -> bool:
    """Whether a human carries out a line: its own, and the world's where it is the first."""
    if isinstance(line, Do | Wait):
        return line.human in ("", human)
    return first or isinstance(line, Sync)


def read_script(path: Path) -> Script:
    """Read and check a script.

    Raises:
        CommandError: no such file, a line that the grammar does not allow, or a human that is not named before.
    """
    try:
        if path.stat().st_size > _LARGEST:
            raise CommandError(f"{path}: a script of more than {_LARGEST // 1_000_000} MB is a mistake")
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise CommandError(f"{path}: can't be read as a script: {_reason(error)}") from None
    humans: dict[str, Human] = {}
    steps: list[Step] = []
    for number, line_text in enumerate(text.splitlines(), 1):
        where = f"{path}:{number}"
        line = parse(line_text, f"{where}: ")
        if isinstance(line, Human):
            if line.name in humans:
                raise CommandError(f'{where}: there is a human "{line.name}" already')
            humans[line.name] = line
        elif line is not None:
            steps.append(Step(line, number, where))
    if not humans:
        raise CommandError(f"{path}: no human acts in it; begin with a line like: human ken body ken at 0 0")
    _check_names(steps, tuple(humans))
    return Script(path, tuple(humans.values()), tuple(steps))


def _check_names(steps: list[Step], humans: tuple[str, ...]) -> None:
    """Refuse lines that leave open whom they mean."""
    for step in steps:
        line = step.line
        if not isinstance(line, Do | Wait):
            continue
        if line.human and line.human not in humans:
            raise CommandError(f'{step.where}: no human "{line.human}" in this script; it has: {", ".join(humans)}')
        if not line.human and len(humans) > 1 and isinstance(line, Do):
            raise CommandError(f"{step.where}: who? begin the line with one of: {', '.join(f'{h}:' for h in humans)}")


def _reason(error: OSError | UnicodeDecodeError) -> str:
    return (error.strerror or str(error)) if isinstance(error, OSError) else "it is not UTF-8 text"
