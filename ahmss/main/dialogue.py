"""The dialogue of the thesis, step for step, as a machine of questions and answers (Ichiguchi 2000, 5.1.1 and 5.1.2).

    object -> action -> what the action asks -> frames -> fuse? -- yes --> after how many frames -> object ...
                                                             `--- no --> the motions run
    add -> kind -> position -> orientation -> the object is added

It asks and understands; it prints nothing and runs nothing. The console shows its questions and carries out its lines.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol

from ahmss.errors import CommandError
from ahmss.main.command import Act, Add, Do, Line, parse
from ahmss.main.suggesting import as_a_line, nearest, some

__all__ = ["Catalogue", "Dialogue", "Listing", "Question"]

_KEYWORDS = frozenset({"do", "add", "remove", "set", "wait", "sync", "human"})
_FOR_SOMEBODY = re.compile(r"\s*[^\s:]+\s*:")
_FEW = 12  # names that are said once more to who answers nothing
_YES, _NO = ("yes", "y"), ("no", "n", "")


@dataclass(frozen=True, slots=True)
class Listing:
    """Names to choose from, each with a sentence."""

    title: str
    entries: tuple[tuple[str, str], ...]

    @property
    def names(self) -> tuple[str, ...]:
        """The names alone."""
        return tuple(name for name, _ in self.entries)


class Catalogue(Protocol):
    """What the database part tells the command part."""

    def objects(self) -> Listing:
        """The objects in the world."""
        ...

    def actions(self, name: str) -> Listing:
        """The actions that an object affords now; CommandError where there is no such object."""
        ...

    def kinds(self) -> Listing:
        """The kinds of object in the object database."""
        ...

    def asks(self, name: str, action: str) -> tuple[Sequence[str], int]:
        """What an action asks for, and its usual number of frames (0: as many as it needs)."""
        ...


@dataclass(frozen=True, slots=True)
class Question:
    """One question: what to show before it, its prompt, and the words that may answer it (for completion).

    opening: it is asked first, again and again; to show the same list each time would hide what was said.
    """

    prompt: str
    listing: Listing | None = None
    words: tuple[str, ...] = ()
    opening: bool = False


@dataclass(frozen=True, slots=True)
class _Draft:
    """What was answered so far: finished acts, the one being asked about, and what is asked next."""

    step: str = "object"
    acts: tuple[Act, ...] = ()
    act: Act = field(default_factory=lambda: Act("", ""))
    asks: tuple[str, ...] = ()
    frames: int = 60
    after: int = 0
    add: Add = field(default_factory=lambda: Add(""))


class Dialogue:
    """Asks for one motion after another; `question` is what to ask now, `answer` takes what was typed."""

    def __init__(self, catalogue: Catalogue) -> None:
        self._catalogue = catalogue
        self._draft = _Draft()
        self._before: list[_Draft] = []
        self._steps: dict[str, Callable[[_Draft, str], _Draft | Line]] = {
            "object": self._object, "action": self._action, "frames": self._frames, "fuse": self._fuse,
            "after": self._after, "kind": self._kind, "position": self._position, "orientation": self._orientation,
            "goal_position": self._goal_position, "facing": self._facing, "goal_posture": self._posture,
            "hand": self._hand,
        }  # fmt: skip

    @property
    def question(self) -> Question:
        """What to ask now."""
        draft = self._draft
        match draft.step:
            case "object":
                objects = self._catalogue.objects()
                return Question("object", objects, objects.names, opening=True)
            case "action":
                actions = self._catalogue.actions(draft.act.object)
                return Question(f"what to do with {draft.act.object}", actions, actions.names)
            case "kind":
                kinds = self._catalogue.kinds()
                return Question("object to add", kinds, kinds.names)
            case "goal_position":
                return Question(
                    "goal position (x y [z] in metres, or an object)", None, self._catalogue.objects().names
                )
            case "hand":
                return Question("hand (left, right, or nothing for either)", None, ("left", "right"))
            case "frames":
                usual = draft.frames or "as many as it needs"
                return Question(f"number of frames (nothing for {usual})")
            case "fuse":
                return Question("fuse with another motion? (yes, or nothing for no)", None, ("yes", "no"))
            case step:
                return Question(_PROMPTS[step])

    def answer(self, text: str) -> Line | None:
        """Take an answer, or a whole command in one line; the line to carry out, once there is one.

        Raises:
            CommandError: the answer is none; the question stays.
        """
        first = text.split(maxsplit=1)[0] if text.strip() else ""
        if text.strip() == "add" and self._draft.step == "object":
            self._go(replace(self._draft, step="kind"))
            return None
        if first in _KEYWORDS or _FOR_SOMEBODY.match(text):
            line = parse(text)
            if isinstance(line, Do) and not line.human:
                self.reset()  # who types a whole motion has left the one that was asked about
            return line
        try:
            result = self._steps[self._draft.step](self._draft, text.strip())
        except CommandError as error:
            if self._before:
                raise CommandError(f"{error} (`undo` goes back)") from None
            raise
        if isinstance(result, _Draft):
            self._go(result)
            return None
        self.reset()
        return result

    def undo(self) -> bool:
        """Take the last answer back; False where there is none."""
        if self._before:
            self._draft = self._before.pop()
            return True
        return False

    def reset(self) -> None:
        """Begin again."""
        self._draft = _Draft()
        self._before.clear()

    def _go(self, draft: _Draft) -> None:
        self._before.append(self._draft)
        self._draft = draft

    # A motion (5.1.1)

    def _object(self, draft: _Draft, text: str) -> _Draft:
        try:
            name = _choose(text, self._catalogue.objects().names, "object")
        except CommandError:
            if line := as_a_line(text, self._catalogue):
                how = "actions are done by `do OBJECT ACTION`"
                raise CommandError(f'no object "{text}"; {how}, as in: {line}') from None
            raise
        return replace(draft, step="action", act=Act(name, "", after=draft.after))

    def _action(self, draft: _Draft, text: str) -> _Draft:
        name = _choose(text, self._catalogue.actions(draft.act.object).names, f"action of {draft.act.object}")
        asks, frames = self._catalogue.asks(draft.act.object, name)
        return _next_ask(replace(draft, act=replace(draft.act, action=name), asks=tuple(asks), frames=frames))

    def _goal_position(self, draft: _Draft, text: str) -> _Draft:
        try:
            place = _numbers(text, 2, 3, "x y [z]")
        except CommandError:
            name = _choose(text, self._catalogue.objects().names, "place x y [z] and no object")
            return _next_ask(replace(draft, act=replace(draft.act, goal_object=name)))
        return _next_ask(replace(draft, act=replace(draft.act, goal_place=place)))

    def _facing(self, draft: _Draft, text: str) -> _Draft:
        if not text:
            return _next_ask(draft)
        return _next_ask(replace(draft, act=replace(draft.act, facing_deg=_numbers(text, 1, 1, "degrees")[0])))

    def _posture(self, draft: _Draft, text: str) -> _Draft:
        return _next_ask(replace(draft, act=replace(draft.act, posture=text)))

    def _hand(self, draft: _Draft, text: str) -> _Draft:
        hand = _choose(text, ("left", "right"), "hand") if text else ""
        return _next_ask(replace(draft, act=replace(draft.act, hand=hand)))

    def _frames(self, draft: _Draft, text: str) -> _Draft:
        frames = _whole(text, 1) if text else None  # the action's own, which it may stretch
        return replace(draft, step="fuse", act=replace(draft.act, frames=frames))

    def _fuse(self, draft: _Draft, text: str) -> _Draft | Line:
        acts = (*draft.acts, draft.act)
        if text.lower() in _YES:
            return replace(draft, step="after", acts=acts)
        if text.lower() in _NO:
            return Do(acts)
        raise CommandError(f'"{text}" is neither yes nor no')

    def _after(self, draft: _Draft, text: str) -> _Draft:
        return replace(draft, step="object", after=_whole(text, 0) if text else 0)

    # An object (5.1.2)

    def _kind(self, draft: _Draft, text: str) -> _Draft:
        return replace(draft, step="position", add=Add(_choose(text, self._catalogue.kinds().names, "kind of object")))

    def _position(self, draft: _Draft, text: str) -> _Draft:
        place = _numbers(text, 2, 3, "x y [z]")
        return replace(draft, step="orientation", add=replace(draft.add, place=(*place, 0.0)[:3]))

    def _orientation(self, draft: _Draft, text: str) -> Line:
        facing = _numbers(text, 1, 1, "degrees")[0] if text else 0.0
        return replace(draft.add, facing_deg=facing)


_PROMPTS = {
    "facing": "facing at the goal (degrees, or nothing)",
    "goal_posture": "goal posture (a motion clip)",
    "after": "start the next motion after how many frames (nothing for 0)",
    "position": "position (x y [z] in metres)",
    "orientation": "orientation (degrees about z, nothing for 0)",
}


def _next_ask(draft: _Draft) -> _Draft:
    """Go on with the next thing that the action asks, or with the frames."""
    if not draft.asks:
        return replace(draft, step="frames")
    return replace(draft, step=draft.asks[0], asks=draft.asks[1:])


def _choose(text: str, names: Sequence[str], what: str) -> str:
    """The name that was meant: itself, or the only one whose last part, or parts, it is."""
    if text in names:
        return text
    meant = [name for name in names if name.endswith(f"/{text}")] if text else []
    if len(meant) == 1:
        return meant[0]
    if not text and len(names) > _FEW:
        raise CommandError(f"which {what}? type a name of the list (`list` shows the objects again), or help")
    if not text:
        raise CommandError(f"which {what}? there are: {some(names)}")
    if meant:
        raise CommandError(f'which "{text}"? there are: {", ".join(meant)}')
    near = nearest(text, names)
    hint = f"did you mean {near}?" if near else f"there are: {some(names)}"
    raise CommandError(f'no {what} "{text}"; {hint}')


def _numbers(text: str, least: int, most: int, what: str) -> tuple[float, ...]:
    """Finite numbers, separated by spaces or commas."""
    try:
        numbers = tuple(float(word) for word in text.replace(",", " ").split())
    except ValueError:
        numbers = ()
    if not least <= len(numbers) <= most or any(number - number != 0.0 for number in numbers):
        raise CommandError(f'"{text}" is no {what}')
    return numbers


def _whole(text: str, least: int) -> int:
    """A whole number of frames."""
    if not text.isdecimal() or not least <= int(text) <= 1_000_000:
        raise CommandError(f'"{text}" is no number of frames; allowed: {least} to 1000000')
    return int(text)
