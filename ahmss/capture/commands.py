r"""What a tracker is told: one vocabulary for the driver, which encodes it, and the simulator, which decodes it.

From the FASTRAK manual (rev. G, chapter 9), the Liberty and Patriot manuals, and public drivers. A command is a letter;
some end with CR, and then take arguments: `O1,2,11,1<CR>`. FASTRAK's letters are case-sensitive and mean different
things; Liberty takes an argument instead (`F1<CR>` binary, `U1<CR>` centimetres), and stops its output at a poll.
"""

from __future__ import annotations

from dataclasses import dataclass

from ahmss.capture.formats.layout import Kind
from ahmss.errors import CommandError

__all__ = ["ALL_STATIONS", "Command", "CommandDecoder", "encode"]

ALL_STATIONS = 0
"""The station number of a command that is meant for every station (Liberty writes `*`)."""

_ENDS = b"\r\n"


@dataclass(frozen=True)
class Command:
    """One command, by its name in `VOCABULARY`.

    station: 1 and up; ALL_STATIONS for all; None where the command has none.
    arguments: what follows: output items, 0 or 1, a hemisphere's vector, a rate.
    text: for `unknown`, what came.
    """

    name: str
    station: int | None = None
    arguments: tuple[float, ...] = ()
    text: str = ""


@dataclass(frozen=True)
class _Word:
    """How a command is written: its code with a fixed argument, whether CR ends it, whether a station follows.

    question: what stands in place of station and arguments where nothing is set but something asked.
    """

    code: str
    ends: bool = False
    station: bool = False
    question: str = ""


_FASTRAK: dict[str, _Word] = {
    "poll": _Word("P"),
    "continuous": _Word("C"),
    "stop": _Word("c"),
    "binary": _Word("f"),
    "ascii": _Word("F"),
    "inches": _Word("U"),
    "centimetres": _Word("u"),
    "status": _Word("S"),
    "defaults": _Word("W"),
    "reinitialise": _Word("\x19"),
    "save": _Word("\x0b"),
    "output": _Word("O", ends=True, station=True),
    "station": _Word("l", ends=True, station=True, question="1"),
    "hemisphere": _Word("H", ends=True, station=True),
    "boresight": _Word("B", ends=True, station=True),
    "unboresight": _Word("b", ends=True, station=True),
    "alignment": _Word("A", ends=True, station=True),
    "reset_alignment": _Word("R", ends=True, station=True),
    "position_filter": _Word("x", ends=True),
    "attitude_filter": _Word("v", ends=True),
    "stylus": _Word("e", ends=True, station=True),
}

_LIBERTY: dict[str, _Word] = {
    "poll": _Word("P"),
    "continuous": _Word("C", ends=True),
    "binary": _Word("F1", ends=True),
    "ascii": _Word("F0", ends=True),
    "inches": _Word("U0", ends=True),
    "centimetres": _Word("U1", ends=True),
    "status": _Word("\x16", ends=True),
    "defaults": _Word("W0", ends=True),
    "reinitialise": _Word("\x19", ends=True),
    "save": _Word("\x0b", ends=True),
    "counters": _Word("Q0", ends=True),
    "rate": _Word("R", ends=True),
    "output": _Word("O", ends=True, station=True),
    "station": _Word("\x15", ends=True, station=True, question="0"),
    "hemisphere": _Word("H", ends=True, station=True),
    "boresight": _Word("B", ends=True, station=True),
    "unboresight": _Word("\x02", ends=True, station=True),
    "alignment": _Word("A", ends=True, station=True),
    "reset_alignment": _Word("\x12", ends=True, station=True),
    "position_filter": _Word("X", ends=True),
    "attitude_filter": _Word("Y", ends=True),
}

VOCABULARY: dict[Kind, dict[str, _Word]] = {
    "fastrak": _FASTRAK,
    "liberty": _LIBERTY,
    "patriot": _LIBERTY,
    "ultratrak": {},  # only sends
}


def encode(kind: Kind, command: Command) -> bytes:
    """The bytes of a command.

    Raises:
        CommandError: this kind of tracker has no such command.
    """
    words = VOCABULARY[kind]
    word = words.get(command.name)
    if word is None:
        raise CommandError(f"{kind}: no command {command.name!r}; there are: {', '.join(words) or 'none'}")
    fields = [word.question] if word.question and not command.arguments else []
    if not fields and word.station and command.station is not None:
        fields.append("*" if command.station == ALL_STATIONS else str(command.station))
    fields += [f"{argument:g}" for argument in command.arguments]
    return (word.code + ",".join(fields) + ("\r" if word.ends else "")).encode("ascii")


class CommandDecoder:
    """A device's ear: bytes in, commands out, however they are cut up.

    What no command begins with becomes `Command("unknown", text=...)`: a real device answers it with an error. A letter
    that needs no CR acts at once. A line feed ends a command as CR does: public drivers send either. `station` without
    arguments asks which stations there are.
    """

    def __init__(self, kind: Kind) -> None:
        self._words = VOCABULARY[kind]
        self._pending = bytearray()

    def feed(self, data: bytes) -> list[Command]:
        """The commands that these bytes complete, in their order."""
        commands: list[Command] = []
        for byte in data:
            if byte in _ENDS and not self._pending:
                continue
            if byte not in _ENDS:
                self._pending.append(byte)
                command = self._at_once()
            else:
                command = self._ended()
            if command is not None:
                self._pending.clear()
                commands.append(command)
        return commands

    def _at_once(self) -> Command | None:
        """A command without CR, once its letter is there; unknown, when no command begins like this."""
        text = self._pending.decode("latin-1")
        for name, word in self._words.items():
            if not word.ends and text == word.code:
                return Command(name)
        if len(text) == 1 and not any(word.code.startswith(text) for word in self._words.values()):
            return Command("unknown", text=text)
        if len(text) > 200:
            return Command("unknown", text=text)
        return None

    def _ended(self) -> Command:
        """The command that a CR ended."""
        text = self._pending.decode("latin-1")
        found = [(name, word) for name, word in self._words.items() if word.ends and text.startswith(word.code)]
        if not found:
            return Command("unknown", text=text)
        name, word = max(found, key=lambda entry: len(entry[1].code))
        try:
            return _parse(name, word, text[len(word.code) :])
        except ValueError:
            return Command("unknown", text=text)


def _parse(name: str, word: _Word, rest: str) -> Command:
    """Station and arguments; raises ValueError where a field is no number."""
    fields = [field.strip() for field in rest.split(",")] if rest.strip() else []
    station: int | None = None
    if word.station and fields:
        first = fields.pop(0)
        station = ALL_STATIONS if first == "*" else int(first)
    return Command(name, station, tuple(float(field) for field in fields if field))
