"""What can be typed at the running simulator, to break it and to mend it."""

from __future__ import annotations

from ahmss.capture.simulator.faults import Faults
from ahmss.capture.simulator.options import SimulatorOptions
from ahmss.errors import CommandError

__all__ = ["HELP", "Console"]

HELP = """\
weak [STATION ...]     the device calls these stations' signal weak; none given: all
silent [STATION ...]   these stations send nothing, their plug is out; none given: all
drop SHARE             so many of all bytes get lost, 0 to 1; so too: double SHARE, flip SHARE
off | on               the device's power
unplug [LINE ...]      the cable is out and the port gone; plug [LINE ...] puts it back; none given: all
mend                   everything works again
... for SECONDS        behind any of these: it mends itself
status                 what goes over the lines
quit                   the end, as Ctrl-C"""


class Console:
    """Turns typed lines into faults; those given `for` a time end by themselves."""

    def __init__(self, options: SimulatorOptions) -> None:
        self._faults = options.faults
        self._stations = range(1, options.stations + 1)
        self._lines = range(1, len(options.units()) + 1)
        self._until: list[tuple[float, tuple[str, ...]]] = []

    def obey(self, line: str, now: float) -> str:
        """Do what a line says.

        Returns:
            `help`, `status` or `quit` where the line asks for that, else "".

        Raises:
            CommandError: it can't be understood; says what can.
        """
        words = line.split()
        if not words:
            return ""
        seconds = None
        if len(words) >= 2 and words[-2] == "for":
            seconds, words = self._share(words[-1], most=1e6), words[:-2]
        if not words:
            raise CommandError(f'"{line.strip()}" says not what to do; help lists the words')
        if words[0] in ("help", "status", "quit"):
            return words[0]
        undo = self._act(words[0], words[1:])
        if seconds is not None and undo:
            self._until.append((now + seconds, undo))
        return ""

    def pass_time(self, now: float) -> None:
        """End what was for a time that is over."""
        for end in [entry for entry in self._until if entry[0] <= now]:
            self._until.remove(end)
            self._act(end[1][0], list(end[1][1:]))

    def next_time(self) -> float | None:
        """When something ends by itself."""
        return min((end for end, _ in self._until), default=None)

    def _act(self, verb: str, words: list[str]) -> tuple[str, ...]:
        """Carry out one verb; what undoes it."""
        faults = self._faults
        if verb in ("drop", "double", "flip"):
            before = getattr(faults, verb)
            setattr(faults, verb, self._share(words[0] if words else "", most=1.0))
            return verb, str(before)
        if verb in ("off", "on"):
            faults.off = verb == "off"
            return ("on",)
        if verb == "mend":
            faults.mend()
            self._until.clear()
            return ()
        opposite = {"weak": "strong", "silent": "heard", "unplug": "plug"}
        opposite |= {after: before for before, after in opposite.items()}
        if verb not in opposite:
            raise CommandError(f'no command "{verb}"; help lists the words')
        numbers = self._numbers(words, self._lines if "plug" in verb else self._stations)
        self._change(verb, faults, numbers)
        return opposite[verb], *(str(number) for number in numbers)

    @staticmethod
    def _change(verb: str, faults: Faults, numbers: set[int]) -> None:
        match verb:
            case "weak":
                faults.weak |= numbers
            case "strong":
                faults.weak -= numbers
            case "silent":
                faults.silent |= numbers
            case "heard":
                faults.silent -= numbers
            case "unplug":
                faults.unplugged |= numbers
            case _:
                faults.unplugged -= numbers

    @staticmethod
    def _numbers(words: list[str], there: range) -> set[int]:
        numbers = {int(word) for word in words if word.isdecimal()}
        if len(numbers) < len(set(words)) or not numbers <= set(there):
            allowed = f"numbers from 1 to {there[-1]}" if len(there) > 1 else "1, the only one there is"
            raise CommandError(f'"{" ".join(words)}": give {allowed}')
        return numbers or set(there)

    @staticmethod
    def _share(word: str, most: float) -> float:
        try:
            value = float(word)
        except ValueError:
            raise CommandError(f'"{word}" is no number') from None
        if not 0.0 <= value <= most:
            raise CommandError(f"{word} is not from 0 to {most:g}")
        return value
