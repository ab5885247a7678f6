"""The command part: what a person types, a script holds or a human model sends, read into records by one grammar.

    line   = "add" KIND ["as" NAME] ["at" X Y [Z]] ["facing" DEG]  |  "remove" NAME  |  "set" OBJECT STATE VALUE
           | "human" NAME ["body" BODY] ["at" X Y] ["facing" DEG]
           | [HUMAN ":"] "do" chain { "with" chain }
           | [HUMAN ":"] "wait" ( SECONDS | OBJECT STATE OP VALUE ["within" SECONDS] )  |  "sync"
    chain  = act { "then" act }
    act    = ( OBJECT | "at" X Y [Z] ) ACTION { detail } ["frames" N] ["after" N]
    detail = ("to" | "at") X Y [Z] | "to" NAME | "facing" DEG | "hand" ("left" | "right") | "pose" CLIP | KEY "=" VALUE

Metres and degrees. `#` begins a comment. A word in quotes is never a keyword: `do "hand" open`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NoReturn, TypeVar

from ahmss.errors import CommandError
from ahmss.main.words import Word, split

__all__ = ["OPERATORS", "Act", "Add", "Do", "Human", "Line", "Remove", "Set", "Sync", "Wait", "expected", "parse"]

_T = TypeVar("_T")
Value = str | float
Place = tuple[float, ...]

_IN_WORDS = {
    "OBJECT": "an object", "ACTION": "an action", "KIND": "a kind of object", "NAME": "a name", "BODY": "a body",
    "HUMAN": "a human", "STATE": "a state of that object", "VALUE": "a value", "CLIP": "a motion clip",
    "X": "a number (x in metres)", "Y": "a number (y in metres)", "Z": "a number (z in metres)",
    "DEGREES": "a number (degrees)", "SECONDS": "a number (seconds)", "N": "a number of frames",
    "KEY": "a parameter", "KEY=VALUE": "a parameter (key=value)",
}  # fmt: skip
OPERATORS = ("==", "!=", "<", "<=", ">", ">=")
_MOST_FRAMES = 1_000_000
_NEVER_NAMES = frozenset(
    {"with", "then", "to", "at", "facing", "hand", "pose", "frames", "after", "=", ":", *OPERATORS}
)


@dataclass(frozen=True, slots=True)
class Add:
    """Place a new object of a kind in the world."""

    kind: str
    name: str = ""
    place: Place = (0.0, 0.0, 0.0)
    facing_deg: float = 0.0


@dataclass(frozen=True, slots=True)
class Remove:
    """Take an object out of the world."""

    name: str


@dataclass(frozen=True, slots=True)
class Set:
    """Set an object's state."""

    object: str
    state: str
    value: Value


@dataclass(frozen=True, slots=True)
class Human:
    """A virtual human of the script, and where it stands at first."""

    name: str
    body: str = ""
    place: Place = (0.0, 0.0)
    facing_deg: float = 0.0


@dataclass(frozen=True, slots=True)
class Act:
    """One motion: an action that an object affords, and what was said about it.

    The object is named, or found at `object_place`. The goal is a place (metres) or another object's name.
    `frames` is None (or 0) where the affordance's own number serves; `after` frames later it joins the others.
    One that `follows` begins when the act before it in the line has ended, `after` counted from there.
    """

    object: str
    action: str
    object_place: Place = ()
    goal_place: Place = ()
    goal_object: str = ""
    facing_deg: float | None = None
    hand: str = ""
    posture: str = ""
    parameters: tuple[tuple[str, Value], ...] = ()
    frames: int | None = None
    after: int = 0
    follows: bool = False


@dataclass(frozen=True, slots=True)
class Do:
    """Motions to be made together; `human` is empty where only one is there."""

    acts: tuple[Act, ...]
    human: str = ""


@dataclass(frozen=True, slots=True)
class Wait:
    """Wait for some seconds, or until an object's state compares as said, `within` seconds at most (None: as usual)."""

    seconds: float = 0.0
    object: str = ""
    state: str = ""
    operator: str = ""
    value: Value = ""
    human: str = ""
    within: float | None = None


@dataclass(frozen=True, slots=True)
class Sync:
    """All humans of the script reach this line before any goes on."""


Line = Add | Remove | Set | Human | Do | Wait | Sync


def parse(text: str, where: str = "") -> Line | None:
    """Read one line; None for an empty one or a comment.

    Args:
        text: the line as it was typed.
        where: what stands before the column in an error, such as `table.txt:3: `.

    Raises:
        CommandError: `where` and `column N: what came, and what is expected there`.
    """
    try:
        words = split(text)
        return _Reader(words, len(text.rstrip()) + 1).line() if words else None
    except CommandError as error:
        raise CommandError(f"{where}{error}") from None


def expected(text: str) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """What may stand at the end of an unfinished line, and the words before it, for completion.

    Keywords stand for themselves; capitals (`OBJECT`, `ACTION`, `KIND` ...) for names that only the world knows.
    Nothing is expected where the line is already wrong.
    """
    try:
        words = split(text)
    except CommandError:
        return (), ()
    reader = _Reader(words, len(text) + 1)
    try:
        reader.line()
    except CommandError:
        if not reader.at_end:
            return (), ()
    return tuple(dict.fromkeys(reader.wanted)), tuple(word.text for word in words)


class _Reader:
    """Reads words from left to right; `wanted` holds what it looked for since the last word that it took."""

    def __init__(self, words: tuple[Word, ...], end: int) -> None:
        self._words, self._next, self._end = words, 0, end
        self.wanted: list[str] = []

    @property
    def at_end(self) -> bool:
        return self._next == len(self._words)

    # What a line is made of

    def line(self) -> Line:
        if len(self._words) > 1 and self._words[1].text == ":" and not self._words[1].quoted:
            human = self._name("HUMAN")
            self._take(":")
            return self._finish(self._choose({"do": lambda: self._do(human), "wait": lambda: self._wait(human)}))
        readings: dict[str, Callable[[], Line]] = {
            "do": self._do, "add": self._add, "wait": self._wait, "set": self._set,
            "human": self._human, "remove": lambda: Remove(self._name("OBJECT")), "sync": Sync,
        }  # fmt: skip
        return self._finish(self._choose(readings))

    def _add(self) -> Add:
        add = Add(self._name("KIND"))
        if self._take("as"):
            add = replace(add, name=self._name("NAME"))
        if self._take("at"):
            add = replace(add, place=(*self._place(), 0.0)[:3])
        if self._take("facing"):
            add = replace(add, facing_deg=self._number("DEGREES"))
        return add

    def _set(self) -> Set:
        return Set(self._name("OBJECT"), self._name("STATE"), self._value())

    def _human(self) -> Human:
        human = Human(self._name("NAME"))
        if self._take("body"):
            human = replace(human, body=self._name("BODY"))
        if self._take("at"):
            human = replace(human, place=(self._number("X"), self._number("Y")))
        if self._take("facing"):
            human = replace(human, facing_deg=self._number("DEGREES"))
        return human

    def _wait(self, human: str = "") -> Wait:
        self.wanted.append("SECONDS")
        if self._is_number():
            return Wait(self._seconds(), human=human)
        name = self._name("OBJECT")
        if self.at_end:
            self.wanted.append("STATE")
            self._refuse(-1, f"a number (seconds), or an object with a state of it, as in `wait {name} STATE == VALUE`")
        state = self._name("STATE")
        for operator in OPERATORS:
            if self._take(operator):
                value = self._value()
                within = self._seconds() if self._take("within") else None
                return Wait(0.0, name, state, operator, value, human, within)
        return self._refuse()

    def _seconds(self) -> float:
        seconds = self._number("SECONDS")
        return seconds if seconds >= 0.0 else self._refuse(-1, "seconds that are not negative")

    def _do(self, human: str = "") -> Do:
        acts = [self._act()]
        while (follows := self._take("then")) or self._take("with"):
            acts.append(replace(self._act(), follows=follows))
        return Do(tuple(acts), human)

    def _act(self) -> Act:
        place = self._place() if self._take("at") else ()
        act = Act("" if place else self._name("OBJECT"), self._name("ACTION"), object_place=place)
        said: set[str] = set()
        while True:
            start = self._next
            what, changed = self._detail(act)
            if not what:
                return act
            if what in said:
                self._refuse(start, f"only one {what} for each action; join actions by `with` or `then`")
            said.add(what)
            act = changed

    def _detail(self, act: Act) -> tuple[str, Act]:
        """What kind of detail follows (empty: none), and the act with it."""
        if self._take("to"):
            self.wanted.append("X")
            if self._is_number():
                return "goal", replace(act, goal_place=self._place())
            return "goal", replace(act, goal_object=self._name("OBJECT"))
        if self._take("at"):
            return "goal", replace(act, goal_place=self._place())
        if self._take("facing"):
            return "facing", replace(act, facing_deg=self._number("DEGREES"))
        if self._take("hand"):
            return "hand", replace(act, hand=self._choose({"left": lambda: "left", "right": lambda: "right"}))
        if self._take("pose"):
            return "pose", replace(act, posture=self._name("CLIP"))
        if self._take("frames"):
            return "frames", replace(act, frames=self._count("N", 1))
        if self._take("after"):
            return "after", replace(act, after=self._count("N", 0))
        return self._parameter(act)

    def _parameter(self, act: Act) -> tuple[str, Act]:
        self.wanted.append("KEY=VALUE")
        follows = self._words[self._next + 1 : self._next + 2]
        if not follows or follows[0].text != "=" or follows[0].quoted:
            return "", act
        key = self._name("KEY")
        self._take("=")
        return f"`{key}=`", replace(act, parameters=(*act.parameters, (key, self._value())))

    # Words

    def _peek(self) -> Word | None:
        return None if self.at_end else self._words[self._next]

    def _advance(self) -> str:
        word = self._words[self._next]
        self._next += 1
        self.wanted.clear()
        return word.text

    def _take(self, keyword: str) -> bool:
        """Take the next word if it is the keyword or sign."""
        self.wanted.append(keyword)
        word = self._peek()
        if word is None or word.quoted or word.text != keyword:
            return False
        self._advance()
        return True

    def _choose(self, readings: dict[str, Callable[[], _T]]) -> _T:
        for keyword, read in readings.items():
            if self._take(keyword):
                return read()
        return self._refuse()

    def _name(self, what: str) -> str:
        self.wanted.append(what)
        word = self._peek()
        if word is None or not word.text or (not word.quoted and word.text in _NEVER_NAMES):
            self._refuse()
        return self._advance()

    def _is_number(self) -> bool:
        word = self._peek()
        return word is not None and not word.quoted and _finite(word.text) is not None

    def _number(self, what: str) -> float:
        self.wanted.append(what)
        word = self._peek()
        number = None if word is None or word.quoted else _finite(word.text)
        if number is None:
            self._refuse()
        self._advance()
        return number

    def _count(self, what: str, least: int) -> int:
        number = self._number(what)
        if number != int(number) or not least <= number <= _MOST_FRAMES:
            self._refuse(-1, f"a whole number from {least} to {_MOST_FRAMES}")
        return int(number)

    def _place(self) -> Place:
        place = (self._number("X"), self._number("Y"))
        self.wanted.append("Z")
        return (*place, self._number("Z")) if self._is_number() else place

    def _value(self) -> Value:
        quoted = (word := self._peek()) is not None and word.quoted
        text = self._name("VALUE")
        number = None if quoted else _finite(text)
        return text if number is None else number

    def _finish(self, line: _T) -> _T:
        return line if self.at_end else self._refuse()

    def _refuse(self, at: int | None = None, allowed: str = "") -> NoReturn:
        """Say what came at word `at` (the next one if left out, -1 the last taken) and what is expected."""
        index = self._next if at is None else self._next - 1 if at < 0 else at
        word = self._words[index] if index < len(self._words) else None
        came = "the line ends here" if word is None else f'"{word.text}" can\'t stand here'
        if not allowed:
            wanted = [_IN_WORDS.get(what, f"`{what}`") for what in dict.fromkeys(self.wanted)]
            allowed = " or ".join(wanted) or "the end of the line"
        raise CommandError(f"column {word.column if word else self._end}: {came}; expected: {allowed}")


def _finite(text: str) -> float | None:
    """The number that a word is, if it is one."""
    try:
        number = float(text)
    except ValueError:
        return None
    return number if math.isfinite(number) else None
